//! Writes IES LM-63 (2002 and 2019): type C, metres, `TILT=NONE`, no factors beside the intensities.

use crate::files::decimal::{rounded, rounded_table, text};
use crate::files::letters::ascii;
use crate::photometry::export::{Export, PhotometricFile};
use crate::photometry::web::Symmetry;
use crate::photometry::{LuminousOpening, Web};

/// The edition that a file is written by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Edition {
    /// LM-63-2002, which most programs read.
    Y2002,
    /// LM-63-2019, which says where the intensities come from.
    Y2019,
}

/// Labels that both editions require, in this order.
const REQUIRED: [&str; 4] = ["TEST", "TESTLAB", "ISSUEDATE", "MANUFAC"];
/// What stands where a required label has no text.
const NOT_STATED: &str = "not stated";
/// Characters of a label's line, without CR LF: the standard has 256 with them.
const LABEL_COLUMNS: usize = 254;
/// Characters of a line of numbers: what all editions allow.
const NUMBER_COLUMNS: usize = 130;

/// The bytes of a file. Intensities have nine significant digits; those below 1e-12 of the largest are
/// written as 0.
pub fn write(export: &Export, edition: Edition) -> PhotometricFile {
    let mut notes = Vec::new();
    let web = stored(export.web(), &mut notes);
    let (version, field12) = match edition {
        Edition::Y2002 => ("IESNA:LM-63-2002", "1"),
        Edition::Y2019 => ("IES:LM-63-2019", export.origin.code()),
    };
    let mut lines = vec![version.to_owned()];
    lines.extend(labels(export, &mut notes));
    lines.push("TILT=NONE".to_owned());
    let (lamps, each_lm) = lamps(export);
    let [width, length, height] = opening(&export.opening, &mut notes).map(text);
    let counts = format!("{} {}", web.vertical_deg.len(), web.horizontal_deg.len());
    lines.push(format!("{} {} 1 {counts} 1 2 {width} {length} {height}", text(lamps), text(each_lm)));
    lines.push(format!("1 {field12} {}", text(export.input_watts)));
    for row in [&web.vertical_deg, &web.horizontal_deg].into_iter().map(Vec::as_slice).chain(rows(&web)) {
        lines.extend(wrapped(row));
    }
    let bytes = (lines.join("\r\n") + "\r\n").into_bytes();
    PhotometricFile { bytes, table: web.over_circle(), notes }
}

fn rows(web: &Web) -> impl Iterator<Item = &[f64]> {
    web.candela.chunks_exact(web.vertical_deg.len().max(1))
}

/// The table by the planes that these editions have: 0 alone, 0..90, 0..180, or the whole circle with both
/// its ends.
fn stored(web: &Web, notes: &mut Vec<String>) -> Web {
    let mut stored = match web.symmetry() {
        Symmetry::Rotational => Web { horizontal_deg: vec![0.0], ..web.clone() },
        Symmetry::Quadrants | Symmetry::Bilateral0To180 => web.clone(),
        _ => web.over_circle(),
    };
    stored
        .vertical_deg
        .iter_mut()
        .chain(&mut stored.horizontal_deg)
        .for_each(|angle| *angle = rounded(*angle));
    stored.candela = rounded_table(&stored.candela);
    let (first, last) = (stored.vertical_deg[0], stored.vertical_deg[stored.vertical_deg.len() - 1]);
    if ![0.0, 90.0].contains(&first) || ![90.0, 180.0].contains(&last) {
        notes.push(format!(
            "vertical angles over {first}..{last}, which LM-63 wants over 0..90, 90..180 or 0..180: dark beyond them"
        ));
    }
    stored
}

/// Number of lamps, and lumens of each: -1 in absolute photometry. A number that is not whole stands for one
/// lamp.
fn lamps(export: &Export) -> (f64, f64) {
    let lamps = if export.lamps >= 1.0 && export.lamps.fract() == 0.0 { export.lamps } else { 1.0 };
    (lamps, export.lamps_lm.map_or(-1.0, |lm| lm / lamps))
}

fn opening(opening: &LuminousOpening, notes: &mut Vec<String>) -> [f64; 3] {
    if opening.heights_m.is_some_and(|heights| heights.iter().any(|&h| h != heights[0])) {
        notes.push(
            "the heights of the luminous opening differ by side: LM-63 has one, the largest".to_owned(),
        );
    }
    opening.fields()
}

/// The lines of the labels: the required ones first.
fn labels(export: &Export, notes: &mut Vec<String>) -> Vec<String> {
    let required = REQUIRED.map(|key| (key.to_owned(), export.label(key).unwrap_or(NOT_STATED).to_owned()));
    let is_required = |key: &str| REQUIRED.iter().any(|required| key.eq_ignore_ascii_case(required));
    // Of several with one required keyword the others follow.
    let mut taken = Vec::new();
    let others = export.labels.iter().filter(|(key, text)| {
        if !is_required(key) {
            return true;
        }
        let (is_blank, word) = (text.trim().is_empty(), key.to_ascii_uppercase());
        let is_another = taken.contains(&word);
        if !is_blank {
            taken.push(word);
        }
        is_another && !is_blank
    });
    let all = required.iter().chain(others.collect::<Vec<_>>());
    all.flat_map(|(key, text)| label(key, text, notes)).collect()
}

/// The lines of one label; what a line can't hold goes on behind `[MORE]`.
fn label(key: &str, value: &str, notes: &mut Vec<String>) -> Vec<String> {
    let (plain_key, _) = ascii(&key.replace(['[', ']'], ""));
    let plain_key = match plain_key.trim() {
        // A free line, which has been no label since 1991; and MORE continues what it should not here.
        key if key.is_empty() || key.eq_ignore_ascii_case("MORE") => "OTHER",
        key => key,
    };
    let mut lines = Vec::new();
    for part in value.split('\n') {
        let (plain, changed) = ascii(part);
        if changed {
            notes.push(format!(
                "[{plain_key}] \"{}\" is written \"{}\": LM-63 is ASCII",
                part.trim(),
                plain.trim()
            ));
        }
        let mut rest = plain.trim();
        loop {
            let word = if lines.is_empty() { plain_key } else { "MORE" };
            let room = LABEL_COLUMNS.saturating_sub(word.len() + 3).max(1);
            let (now, later) = split_at_blank(rest, room);
            lines.push(format!("[{word}] {now}").trim_end().to_owned());
            rest = later;
            if rest.is_empty() {
                break;
            }
        }
    }
    lines
}

/// As much ASCII as fits, up to a blank if there is one, and what is left.
fn split_at_blank(text: &str, room: usize) -> (&str, &str) {
    if text.len() <= room {
        return (text, "");
    }
    let at = text[..=room].rfind(' ').filter(|&at| at > 0).unwrap_or(room);
    (text[..at].trim_end(), text[at..].trim_start())
}

/// Numbers in lines.
fn wrapped(values: &[f64]) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in values.iter().map(|&value| text(value)) {
        match lines.last_mut() {
            Some(line) if line.is_empty() => line.push_str(&word),
            Some(line) if line.len() + 1 + word.len() <= NUMBER_COLUMNS => {
                line.push(' ');
                line.push_str(&word);
            }
            _ => lines.push(word),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photometric;
    use crate::photometry::export::DataOrigin;
    use crate::photometry::opening::OpeningShape;
    use crate::photometry::{Format, PhotometricType, Revision};

    /// About 1000 cd, in no order; at the poles one value.
    fn table(v: &[f64], h: &[f64]) -> Web {
        let noise = |i: usize| f64::from((i * 7919 + 13) as u32 % 1009) / 70.0;
        let at = |i: usize| 1000.0 + if v[i % v.len()] % 180.0 == 0.0 { 0.0 } else { noise(i) };
        let candela = (0..v.len() * h.len()).map(at).collect();
        Web::new(PhotometricType::C, v.to_vec(), h.to_vec(), candela).unwrap()
    }

    #[test]
    fn what_is_written_reads_back_as_the_same_table() {
        let v = [0.0, 33.3, 60.0, 90.0];
        for (web, warnings) in [
            (table(&v, &[0.0]), 0),
            (table(&v, &[0.0, 22.5, 90.0]), 0),
            (table(&v, &[0.0, 1.0 / 3.0, 180.0]), 0),
            (table(&v, &[90.0, 180.0, 200.0, 270.0]), 0),
            (table(&v, &[90.0, 190.0, 270.0]), 0),
            (table(&v, &[0.0, 120.0, 345.0]), 0),
            (table(&v, &[5.0, 120.0, 345.0]), 0),
            (table(&[90.0, 120.0, 180.0], &[0.0]), 0),
            (table(&[0.0, 70.0, 140.0], &[0.0]), 1),
        ] {
            let export = Export::new("a", web.clone()).unwrap();
            for (edition, revision) in [(Edition::Y2002, Revision::Y2002), (Edition::Y2019, Revision::Y2019)]
            {
                let written = write(&export, edition);
                let read = photometric::parse(&written.bytes, "a.ies").unwrap();
                assert_eq!((read.format, read.factor()), (Format::Lm63(revision), 1.0));
                assert_eq!(read.warnings.len(), warnings, "{:?}", read.warnings);
                assert_eq!(written.notes.len(), warnings, "{:?}", written.notes);
                assert_eq!(read.web.over_circle(), written.table);
                let circle = web.over_circle();
                for (is, was) in written.table.candela.iter().zip(&circle.candela) {
                    assert!((is - was).abs() <= 5e-9 * was, "{is} {was}");
                }
                for (is, was) in written.table.horizontal_deg.iter().zip(&circle.horizontal_deg) {
                    assert!((is - was).abs() <= 5e-9 * was, "{is} {was}");
                }
                let text = String::from_utf8(written.bytes).unwrap();
                let lines: Vec<&str> = text.split_terminator("\r\n").collect();
                assert!(
                    lines
                        .iter()
                        .all(|line| line.len() <= 254 && line.bytes().all(|b| (b' '..=b'~').contains(&b)))
                );
            }
        }
    }

    #[test]
    fn a_small_file_to_the_letter() {
        let web =
            Web::new(PhotometricType::C, vec![0.0, 90.0], vec![0.0, 90.0], vec![1e3, 0.0, 1e3, 2.0 / 3.0])
                .unwrap();
        let mut export = Export::new("Stra\u{df}e", web).unwrap();
        export.labels.push(("MANUFAC".to_owned(), "we".to_owned()));
        export.labels.push((String::new(), "a free line".to_owned()));
        export.labels.push(("IssueDate".to_owned(), " ".to_owned()));
        export.labels.push(("ISSUEDATE".to_owned(), "2026-01-02".to_owned()));
        export.labels.push(("MANUFAC".to_owned(), "they".to_owned()));
        (export.lamps, export.lamps_lm, export.input_watts) = (2.0, Some(1500.0), 12.5);
        export.opening =
            LuminousOpening { shape: OpeningShape::Disk, size_m: [0.1, 0.1, 0.0], heights_m: None };
        export.origin = DataOrigin::Simulation;
        let written = write(&export, Edition::Y2019);
        let expected = "IES:LM-63-2019\r\n[TEST] not stated\r\n[TESTLAB] not stated\r\n[ISSUEDATE] 2026-01-02\r\n\
            [MANUFAC] we\r\n[LUMINAIRE] Strasse\r\n[OTHER] a free line\r\n[MANUFAC] they\r\nTILT=NONE\r\n\
            2 750 1 2 2 1 2 -0.1 -0.1 0\r\n1 1.00010 12.5\r\n0 90\r\n0 90\r\n1000 0\r\n1000 0.666666667\r\n";
        assert_eq!(String::from_utf8(written.bytes).unwrap(), expected);
        assert_eq!(written.notes.len(), 1, "{:?}", written.notes);
    }

    #[test]
    fn long_labels_go_on_behind_more() {
        let mut export = Export::new("a", table(&[0.0, 90.0], &[0.0])).unwrap();
        let words = "word ".repeat(120);
        export.labels =
            vec![("OTHER".to_owned(), format!("first\n{words}")), ("MORE".to_owned(), "x".repeat(600))];
        let written = write(&export, Edition::Y2002);
        let text = String::from_utf8(written.bytes.clone()).unwrap();
        assert!(text.lines().all(|line| line.len() <= 254), "{text}");
        assert!(text.contains("[OTHER] first\r\n[MORE] word word"), "{text}");
        let read = photometric::parse(&written.bytes, "a.ies").unwrap();
        let others: Vec<&str> = read.labels.iter().filter(|l| l.0 == "OTHER").map(|l| l.1.as_str()).collect();
        assert_eq!(others[0].replace('\n', " "), format!("first {}", words.trim()));
        assert_eq!(others[1].replace('\n', ""), "x".repeat(600));
    }
}
