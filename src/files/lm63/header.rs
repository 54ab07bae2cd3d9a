//! What stands before the numbers: version line, labels, `TILT=`.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::{line_column, quoted};
use crate::photometry::Revision;
use nom::bytes::complete::{tag_no_case, take_until};
use nom::character::complete::{char, multispace0, space0};
use nom::combinator::rest;
use nom::sequence::delimited;
use nom::{IResult, Parser};

/// Label lines that are kept at most: real files have a few dozen.
const MAX_LABELS: usize = 10_000;

/// Everything up to and with the TILT line.
#[derive(Debug)]
pub(crate) struct Header<'a> {
    pub revision: Revision,
    pub labels: Vec<(String, String)>,
    /// What follows `TILT=`, trimmed, and its byte.
    pub tilt: (&'a str, usize),
    /// The byte where the numbers begin.
    pub body: usize,
    pub warnings: Vec<Diagnostic>,
}

/// Lines with their byte offsets; CR LF, LF and CR end a line, also mixed in one file.
fn lines(text: &str) -> impl Iterator<Item = (usize, &str)> {
    let mut offset = 0;
    std::iter::from_fn(move || {
        if offset >= text.len() {
            return None;
        }
        let tail = &text[offset..];
        let length = tail.find(['\r', '\n']).unwrap_or(tail.len());
        let ending = if tail[length..].starts_with("\r\n") { 2 } else { 1 };
        let line = (offset, &tail[..length]);
        offset += length + ending;
        Some(line)
    })
}

/// `TILT=` at the beginning of a line, blanks and case ignored: what follows it. A label that has TILT in its
/// midst is no TILT line.
fn tilt_line(line: &str) -> IResult<&str, &str> {
    let (line, _) = (multispace0, tag_no_case("TILT"), space0, char('=')).parse(line)?;
    rest(line)
}

/// Whether a TILT line is in the text: the mark of another luminaire.
pub(crate) fn has_tilt_line(text: &str) -> bool {
    lines(text).any(|(_, line)| tilt_line(line).is_ok())
}

/// `[KEYWORD] text`, with or without the blank.
fn label_line(line: &str) -> IResult<&str, (&str, &str)> {
    let (line, keyword) = delimited((multispace0, char('[')), take_until("]"), char(']')).parse(line)?;
    let (line, text) = rest(line)?;
    Ok((line, (keyword.trim(), text.trim())))
}

/// The revision of a version line, and whether the line is as its standard spells it; `None`: a free label.
fn revision_of(line: &str) -> Option<(Revision, bool)> {
    let line: String = line.chars().filter(|c| !c.is_whitespace()).map(|c| c.to_ascii_uppercase()).collect();
    let year = line.strip_prefix("IESNA:LM-63-").or_else(|| line.strip_prefix("IES:LM-63-"));
    Some(match (line.as_str(), year) {
        ("IESNA91", _) => (Revision::Y1991, true),
        ("IESNA:LM-63-1995", _) => (Revision::Y1995, true),
        ("IESNA:LM-63-2002", _) => (Revision::Y2002, true),
        ("IES:LM-63-2019", _) => (Revision::Y2019, true),
        ("IESNA86", _) | (_, Some("1986")) => (Revision::Y1986, false),
        (_, Some("1991")) => (Revision::Y1991, false),
        ("IESNA95", _) | (_, Some("1995")) => (Revision::Y1995, false),
        (_, Some("2002")) => (Revision::Y2002, false),
        (other, _) if other.starts_with("IES") => (Revision::Y2019, false),
        _ => return None,
    })
}

/// Reads up to and with the TILT line.
///
/// # Errors
/// [`Kind::Missing`] when there is no TILT line, at the first line of numbers; [`Kind::Limit`] for a flood of labels.
pub(crate) fn read_header(text: &str) -> Result<Header<'_>> {
    let (mut revision, mut labels, mut warnings) = (Revision::Y1986, Vec::new(), Vec::new());
    let mut first = true;
    let mut numbers_at = None;
    for (offset, line) in lines(text) {
        if let Ok((_, value)) = tilt_line(line) {
            let start = offset + line.len() - value.trim_start().len();
            let (tilt, body) = ((value.trim(), start), offset + line.len());
            return Ok(Header { revision, labels, tilt, body, warnings });
        }
        if line.trim().is_empty() {
            continue;
        }
        if std::mem::take(&mut first)
            && let Some((found, as_spelt)) = revision_of(line)
        {
            revision = found;
            if !as_spelt {
                warnings.push(version_warning(line, revision).at(line_column(text, offset).0, 1));
            }
            continue;
        }
        if numbers_at.is_none()
            && line.split([' ', '\t', ',']).all(|w| w.is_empty() || w.parse::<f64>().is_ok())
        {
            numbers_at = Some(offset);
        }
        if labels.len() == MAX_LABELS {
            let required = format!("at most {MAX_LABELS} label lines");
            let d = Diagnostic::new(Kind::Limit, "one more label line", required);
            return Err(d.at(line_column(text, offset).0, 1));
        }
        add_label(&mut labels, line);
    }
    if is_eulumdat(text) {
        let d = Diagnostic::new(Kind::Unavailable, "an EULUMDAT file (.ldt)", "an IES LM-63 file (.ies)");
        return Err(d.at(1, 1).hint("EULUMDAT is not read yet: convert the file to IES LM-63"));
    }
    let (line, column) = line_column(text, numbers_at.unwrap_or(text.trim_end().len()));
    let found = if numbers_at.is_some() { "numbers before any TILT line" } else { "the end of the file" };
    let required = "a line TILT=NONE, TILT=INCLUDE or TILT=file before the numbers";
    Err(Diagnostic::new(Kind::Missing, found, required).at(line, column).hint("is this an LM-63 file?"))
}

/// Whether lines 2 to 7 are those of an EULUMDAT file: kind, symmetry, planes and their distance, angles and theirs.
fn is_eulumdat(text: &str) -> bool {
    let numbers: Vec<f64> = lines(text)
        .skip(1)
        .take(6)
        .map_while(|(_, line)| line.trim().replace(',', ".").parse().ok())
        .collect();
    let [kind, symmetry, planes, between_planes, angles, between_angles] = numbers[..] else { return false };
    let is_whole = |x: f64, low: f64, high: f64| x.fract() == 0.0 && (low..=high).contains(&x);
    is_whole(kind, 0.0, 3.0)
        && is_whole(symmetry, 0.0, 4.0)
        && is_whole(planes, 1.0, 1e4)
        && is_whole(angles, 1.0, 1e4)
        && (0.0..=360.0).contains(&between_planes)
        && (0.0..=180.0).contains(&between_angles)
}

fn version_warning(line: &str, revision: Revision) -> Diagnostic {
    let required = "IESNA91, IESNA:LM-63-1995, IESNA:LM-63-2002 or IES:LM-63-2019";
    Diagnostic::new(Kind::Unknown, format!("version line {}", quoted(line.trim())), required)
        .hint(format!("read by the rules of {}", revision.name()))
}

fn add_label(labels: &mut Vec<(String, String)>, line: &str) {
    match (label_line(line), labels.last_mut()) {
        (Ok((_, (keyword, text))), Some((_, before))) if keyword.eq_ignore_ascii_case("MORE") => {
            before.push('\n');
            before.push_str(text);
        }
        (Ok((_, (keyword, text))), _) => labels.push((keyword.to_owned(), text.to_owned())),
        (Err(_), _) => labels.push((String::new(), line.trim().to_owned())),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn version_lines_of_the_wild() {
        for (line, expected) in [
            ("IESNA91", Some((Revision::Y1991, true))),
            ("  IESNA:LM-63-1995 ", Some((Revision::Y1995, true))),
            ("IESNA:LM-63-2002", Some((Revision::Y2002, true))),
            ("IES:LM-63-2019", Some((Revision::Y2019, true))),
            ("IESNA: LM-63-2002", Some((Revision::Y2002, true))),
            ("IESNA95", Some((Revision::Y1995, false))),
            ("IESNA:LM-63-1991", Some((Revision::Y1991, false))),
            ("IESNA:LM-63-2019", Some((Revision::Y2019, false))),
            ("IES:LM-63-2031", Some((Revision::Y2019, false))),
            ("ERCO Leuchten GmbH", None),
            ("REPORT NUMBER: 1", None),
        ] {
            assert_eq!(revision_of(line), expected, "{line}");
        }
    }

    #[test]
    fn labels_continue_and_tilt_is_found_whatever_the_line_end() {
        let text = "IESNA91\r[TEST]12\n[_TOTAL INPUT ] 5 W\r\n[MORE] x\n----\rno TILT=HERE\r\n\r\n tilt = None \r\n1 2";
        let header = read_header(text).unwrap();
        let pair = |a: &str, b: &str| (a.to_owned(), b.to_owned());
        assert_eq!(
            header.labels,
            [pair("TEST", "12"), pair("_TOTAL INPUT", "5 W\nx"), pair("", "----"), pair("", "no TILT=HERE")]
        );
        assert_eq!(header.tilt.0, "None");
        assert_eq!(&text[header.body..], "\r\n1 2");
        assert_eq!(line_column(text, header.tilt.1), (8, 9));
    }

    #[test]
    fn no_tilt_line_is_refused_at_the_first_line_of_numbers() {
        let error = read_header("IESNA91\n[TEST] 1\n 1 1000 1\n2 3\n").unwrap_err();
        assert_eq!((error.kind(), error.line(), error.column()), (Kind::Missing, Some(3), Some(1)));
    }
}
