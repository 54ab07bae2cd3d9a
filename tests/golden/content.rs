//! Hashes of what a file holds, by its ending.

use std::fs::File;
use std::io::BufReader;
use std::path::Path;

use serde_json::Value;
use sha2::{Digest, Sha256};

use crate::book::Parts;
use crate::openexr;

/// The lines of a photometric file that say neither the version nor the scene's hash.
fn photometric(text: &str) -> String {
    let is_kept =
        |line: &&str| !line.contains("simulated by caustix") && !line.starts_with("[_SCENE_SHA256]");
    text.lines().filter(is_kept).collect::<Vec<_>>().join("\n")
}

/// Keys of JSON that another run, machine or version may fill otherwise.
const KEYS_LEFT_OUT: [&str; 12] = [
    "caustix",
    "files_bytes",
    "map",
    "memory_mb",
    "ns_per_sample",
    "path",
    "photons_per_s",
    "sha256",
    "threads",
    "time",
    // Of a forecast: how fast this machine is.
    "seconds",
    "time_s",
];

/// Columns of a CSV that are times.
const COLUMNS_LEFT_OUT: [&str; 2] = ["photons_per_s", "ratio_equal_time"];

/// The longest number that JSON holds without loss.
const LONGEST_TOLD: usize = 24;

/// 16 hexadecimal digits of SHA-256.
pub fn hash(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().take(8).map(|byte| format!("{byte:02x}")).collect()
}

/// The text itself where it is short and one word, so that a difference shows both values; else its hash.
pub fn told(text: &str) -> String {
    let is_word = !text.is_empty() && text.bytes().all(|b| b.is_ascii_graphic() && b != b'=');
    if is_word && text.len() <= LONGEST_TOLD { text.to_string() } else { hash(text.as_bytes()) }
}

/// The parts of a file and their hashes; `None` for one that tells times, which are not compared.
pub fn parts(path: &Path) -> Option<Parts> {
    let read = || std::fs::read(path).unwrap();
    let text = || std::fs::read_to_string(path).unwrap();
    match path.extension()?.to_str()? {
        "exr" => Some(openexr::parts(path)),
        "csv" => Some(csv(&text())),
        "json" => Some(json(&serde_json::from_str(&text()).unwrap())),
        "ply" => Some(ply(&read())),
        // After the comment, which names the version and the scene's hash.
        "vtp" => Some(vec![("body".into(), hash(text().split_once("-->").unwrap().1.as_bytes()))]),
        "png" => Some(png(path)),
        "ies" | "ldt" => Some(vec![("text".into(), hash(photometric(&text()).as_bytes()))]),
        "svg" => Some(vec![("text".into(), hash(&read()))]),
        // compare.md: its tables are those of compare.csv, with times between them; photons as saved: a
        // binary file.
        "md" | "map" => None,
        // The state of a run: its time of tracing is in it, and resumed runs are compared by their results.
        "state" => None,
        other => panic!("{}: no way to compare a file .{other}", path.display()),
    }
}

/// A part a column: a row that is too long or too short shows as one, too.
fn csv(text: &str) -> Parts {
    let mut rows = text.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let names = rows.next().unwrap();
    let mut columns: Vec<String> = names.iter().map(|name| format!("{name}\n")).collect();
    for row in rows {
        assert_eq!(row.len(), names.len(), "a row of another length: {row:?}");
        columns.iter_mut().zip(row).for_each(|(column, field)| *column += &format!("{field}\n"));
    }
    let kept = names.iter().zip(columns).filter(|(name, _)| !COLUMNS_LEFT_OUT.contains(name));
    let mut parts: Parts =
        kept.map(|(name, column)| (format!("column:{name}"), hash(column.as_bytes()))).collect();
    parts.push(("columns".into(), hash(names.join(",").as_bytes())));
    parts
}

/// A part for each key of the second level (`ledger_lm.absorbed`, `receivers.0`).
fn json(value: &Value) -> Parts {
    let mut parts = Parts::new();
    for (first, value) in entries(value) {
        // A list of plain values is one part.
        let is_plain = value.as_array().is_some_and(|list| list.iter().all(|v| !v.is_object()));
        let second = entries(value);
        if second.is_empty() || is_plain {
            parts.push((first, told(&canonical(value))));
        } else {
            let named = second.into_iter().map(|(key, v)| (format!("{first}.{key}"), told(&canonical(v))));
            parts.extend(named);
        }
    }
    parts
}

fn entries(value: &Value) -> Vec<(String, &Value)> {
    match value {
        Value::Object(map) => {
            let kept = map.iter().filter(|(key, _)| !KEYS_LEFT_OUT.contains(&key.as_str()));
            kept.map(|(key, value)| (key.clone(), value)).collect()
        }
        Value::Array(list) => list.iter().enumerate().map(|(i, value)| (i.to_string(), value)).collect(),
        _ => Vec::new(),
    }
}

/// The value as text with sorted keys, without what is left out. Of files that a scene names the names, not
/// the hashes.
fn canonical(value: &Value) -> String {
    match value {
        Value::Object(_) => {
            let mut all = entries(value);
            all.sort_by(|a, b| a.0.cmp(&b.0));
            let all: Vec<String> = all.iter().map(|(key, v)| format!("{key:?}:{}", canonical(v))).collect();
            format!("{{{}}}", all.join(","))
        }
        Value::Array(list) => format!("[{}]", list.iter().map(canonical).collect::<Vec<_>>().join(",")),
        hash if is_hash(hash) => "a hash".to_string(),
        // The shortest digits that read back as the same bits.
        other => other.to_string(),
    }
}

/// Hashes are of files that tell times and versions: that there is one is all that counts.
fn is_hash(value: &Value) -> bool {
    value.as_str().is_some_and(|s| s.len() == 64 && is_hexadecimal(s))
}

fn is_hexadecimal(text: &str) -> bool {
    text.bytes().all(|b| b.is_ascii_hexdigit())
}

/// The lines of the header but the version's and the scene's hash, and all that follows them.
fn ply(bytes: &[u8]) -> Parts {
    const END: &[u8] = b"end_header\n";
    let at = bytes.windows(END.len()).position(|window| window == END).unwrap() + END.len();
    let header = String::from_utf8(bytes[..at].to_vec()).unwrap();
    let left_out =
        |line: &&str| line.starts_with("comment caustix ") || line.starts_with("comment scene sha256 ");
    let header: Vec<&str> = header.lines().filter(|line| !left_out(line)).collect();
    vec![("header".into(), hash(header.join("\n").as_bytes())), ("body".into(), hash(&bytes[at..]))]
}

fn png(path: &Path) -> Parts {
    let mut reader = png::Decoder::new(BufReader::new(File::open(path).unwrap())).read_info().unwrap();
    let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
    reader.next_frame(&mut pixels).unwrap();
    let ((width, height), (colour, depth)) = (reader.info().size(), reader.output_color_type());
    let size = format!("{width} x {height} {colour:?}{} ", depth as u8);
    vec![("pixels".into(), hash(&[size.as_bytes(), &pixels].concat()))]
}
