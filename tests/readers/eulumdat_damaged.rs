//! Damaged EULUMDAT files: a result or a diagnostic, never a panic, and no other numbers without a word where
//! a line is missing, doubled or blank.

use caustix::files::photometric;
use std::path::PathBuf;

use crate::damage::Damage;
use crate::photometry_damaged::survives;
use crate::support::data;
use crate::support::ldt::{EVEN, Ldt, TO_90, even};
use crate::support::random::Generator;

fn made() -> Vec<(&'static str, String)> {
    const TWO: [[&str; 6]; 2] =
        [["1", "LED", "1000", "3000", "80", "10"], ["2", "LED", "2500", "3000", "80", "22"]];
    let few = Ldt { gamma: even(30.0, 7), steps: [15.0, 30.0], ..Ldt::new(3, TO_90) };
    let bell = |gamma: f64, _| 600.0 * gamma.cos().max(0.0);
    vec![
        ("Isym 3", few.text()),
        ("one plane", Ldt { c: vec![0.0], gamma: even(5.0, 19), ..Ldt::new(1, bell) }.text()),
        ("two sets", Ldt { sets: &TWO, gamma: even(15.0, 13), steps: [15.0; 2], ..Ldt::new(1, EVEN) }.text()),
    ]
}

/// Small real files where they are at hand.
fn real() -> Vec<PathBuf> {
    let names = [
        "copyleft/eurs__4058075580695_FL_MAX_LUM_1200W_757_ASYM_50X110WAL.ldt",
        "copyleft/luxpy__Testlamp_Isym4_43cef5d76a391dd85c41d4d09d68600d.ldt",
        "permissive/pv-ldt__multiple_lamp_sets.ldt",
        "no-licence/vb__sample_isym4.ldt",
    ];
    data::real_folder().into_iter().flat_map(|f| names.map(|name| f.join("ldt").join(name))).collect()
}

fn texts() -> Vec<(String, Vec<u8>)> {
    let made = made().into_iter().map(|(name, text)| (name.to_owned(), text.into_bytes()));
    let real = real().into_iter().map(|path| (path.display().to_string(), std::fs::read(path).unwrap()));
    made.chain(real).collect()
}

#[test]
fn every_truncation_is_refused_but_for_digits_of_the_last_number() {
    for (name, bytes) in texts() {
        let end = bytes.iter().rposition(|b| !b.is_ascii_whitespace()).unwrap() + 1;
        let last = bytes[..end].iter().rposition(|&b| b == b'\n').unwrap() + 1;
        for length in 0..bytes.len() {
            let read = survives(&bytes[..length]);
            assert!(!read || length > last, "{name}: {length} of {} bytes were read", bytes.len());
        }
    }
}

/// Whatever line is lost, doubled, blank or put in, numbers are the same, or it is told.
#[test]
fn a_line_too_many_or_too_few_is_never_silent() {
    for (name, text) in made() {
        let plain = photometric::parse(text.as_bytes(), "a.ldt").unwrap();
        let lines: Vec<&str> = text.lines().collect();
        let (mut refused, mut told, mut same) = (0, 0, 0);
        for i in 0..lines.len() {
            for kind in ["lost", "doubled", "blank", "0", "17.5", "two in one"] {
                let mut other = lines.clone();
                let joined = format!("{} {}", lines[i], lines.get(i + 1).unwrap_or(&""));
                match kind {
                    "lost" => drop(other.remove(i)),
                    "doubled" => other.insert(i, lines[i]),
                    "blank" => other[i] = "",
                    "two in one" => {
                        other.drain(i..(i + 2).min(lines.len()));
                        other.insert(i, &joined);
                    }
                    number => other.insert(i, number),
                }
                let read = photometric::parse(other.join("\r\n").as_bytes(), "a.ldt");
                match read {
                    Err(_) => refused += 1,
                    Ok(read) if read.web == plain.web => same += 1,
                    Ok(read) => {
                        let more = read.warnings.len() > plain.warnings.len();
                        assert!(more, "{name}: line {} {kind}, and nothing is said", i + 1);
                        told += 1;
                    }
                }
            }
        }
        println!("{name}: {refused} refused, {told} told, {same} with the same numbers");
        assert!(refused > told, "{name}");
    }
}

/// What goes in where something else was.
const DAMAGE: Damage = Damage { tokens: &TOKENS, changes: 4, cut: 40 };
const TOKENS: [&str; 14] = [
    "nan",
    "-1",
    "0",
    "1e308",
    "-1e308",
    "2147483647",
    "99999",
    "\r\n99999\r\n",
    ";",
    "TILT=NONE",
    "\n",
    "\u{1a}",
    "360",
    "1,5",
];

#[test]
fn thousands_of_mutations_are_results_or_diagnostics() {
    let mut generator = Generator(1990);
    let (mut read, mut refused) = (0, 0);
    for (_, bytes) in texts() {
        for _ in 0..3000 {
            if survives(&DAMAGE.mutate(&bytes, &mut generator)) { read += 1 } else { refused += 1 }
        }
    }
    println!("mutations: {read} read, {refused} refused");
    assert!(read > 500 && refused > 1000, "the mutations reach both ends: {read}, {refused}");
}

#[test]
fn counts_that_ask_for_memory_are_refused_at_once() {
    let lines = Ldt::new(0, EVEN).lines();
    for (line, text) in [(4, "100000"), (6, "100000"), (4, "1e18"), (26, "1e18"), (26, "1000")] {
        let mut other = lines.clone();
        other[line - 1] = text.to_owned();
        other.push("0 ".repeat(100_000));
        assert!(!survives(other.join("\n").as_bytes()), "line {line}: {text}");
    }
}
