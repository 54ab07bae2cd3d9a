//! What stands before the numbers: version line, labels, `TILT=`.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::candela::lines::lines;
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

/// What a line says about the edition.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Version {
    /// It is a version line, as its standard spells it.
    Spelt(Revision),
    /// It names an edition in another way: two digits, no colon, a wrong prefix.
    Meant(Revision),
    /// It names one and goes on, or begins as a version line does: told only on the first line.
    Begun(Revision),
}

/// What a line says about the edition; `None`: a free label. Signs and blanks don't count: `IESNA LM-63-02` is LM-63-2002.
fn version_of(line: &str) -> Option<Version> {
    let close: String = line.chars().filter(|c| !c.is_whitespace()).map(|c| c.to_ascii_uppercase()).collect();
    match close.as_str() {
        "IESNA91" => return Some(Version::Spelt(Revision::Y1991)),
        "IESNA:LM-63-1995" => return Some(Version::Spelt(Revision::Y1995)),
        "IESNA:LM-63-2002" => return Some(Version::Spelt(Revision::Y2002)),
        "IES:LM-63-2019" => return Some(Version::Spelt(Revision::Y2019)),
        _ => {}
    }
    // What must not be taken for an edition: the number of a report, the standard's name in a sentence.
    let word: String = close.chars().filter(|c| !matches!(c, ':' | '-' | '_' | '.' | '/')).collect();
    let of_maker = word.strip_prefix("IESNA").or_else(|| word.strip_prefix("IES"));
    let of_standard = of_maker.unwrap_or(&word).strip_prefix("LM63");
    let year = of_standard.or(of_maker)?;
    let digits = year.find(|c: char| !c.is_ascii_digit()).unwrap_or(year.len());
    let revision = match &year[..digits] {
        "86" | "1986" => Some(Revision::Y1986),
        "91" | "1991" => Some(Revision::Y1991),
        "95" | "1995" => Some(Revision::Y1995),
        "02" | "2002" => Some(Revision::Y2002),
        "19" | "2019" => Some(Revision::Y2019),
        _ => None,
    };
    match revision {
        Some(revision) if digits == year.len() => Some(Version::Meant(revision)),
        Some(revision) if of_standard.is_some() && of_maker.is_some() => Some(Version::Begun(revision)),
        _ => of_maker.map(|_| Version::Begun(Revision::Y2019)),
    }
}

/// Reads up to and with the TILT line.
///
/// # Errors
/// [`Kind::Missing`] when there is no TILT line, at the first line of numbers; [`Kind::Limit`] for a flood of labels.
pub(crate) fn read_header(text: &str) -> Result<Header<'_>> {
    let (mut version, mut labels) = (FoundVersion::default(), Vec::new());
    let mut numbers_at = None;
    for (offset, line) in lines(text) {
        if let Ok((_, value)) = tilt_line(line) {
            let start = offset + line.len() - value.trim_start().len();
            let (tilt, body) = ((value.trim(), start), offset + line.len());
            let (revision, warnings) = version.conclude();
            return Ok(Header { revision, labels, tilt, body, warnings });
        }
        if line.trim().is_empty() {
            continue;
        }
        if version.takes(line, || line_column(text, offset).0) {
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
    let (line, column) = line_column(text, numbers_at.unwrap_or(text.trim_end().len()));
    let found = if numbers_at.is_some() { "numbers before any TILT line" } else { "the end of the file" };
    let required = "a line TILT=NONE, TILT=INCLUDE or TILT=file before the numbers";
    Err(Diagnostic::new(Kind::Missing, found, required).at(line, column).hint("is this an LM-63 file?"))
}

/// The edition that the lines before TILT have named.
#[derive(Debug, Default)]
struct FoundVersion {
    /// Whether a line was seen.
    begun: bool,
    /// The first line, if it only begins as a version line does: a later one that names an edition outdoes it.
    guess: Option<(Revision, Diagnostic)>,
    /// The edition that a line names.
    named: Option<Revision>,
    warnings: Vec<Diagnostic>,
}

impl FoundVersion {
    /// Looks at one line, whose number `at` gives; whether it is the version line, and no label.
    fn takes(&mut self, line: &str, at: impl Fn() -> usize) -> bool {
        let is_first = !std::mem::replace(&mut self.begun, true);
        let version = version_of(line);
        let warning = |revision: Revision, required: &str, does: &str| {
            Diagnostic::new(Kind::Unknown, format!("version line {}", quoted(line.trim())), required)
                .at(at(), 1)
                .hint(format!("{does} the rules of {}", revision.name()))
        };
        let spellings = "IESNA91, IESNA:LM-63-1995, IESNA:LM-63-2002 or IES:LM-63-2019";
        match (version, self.named) {
            (Some(Version::Spelt(revision)), None) if is_first => self.named = Some(revision),
            (Some(Version::Meant(revision)), None) if is_first => {
                self.named = Some(revision);
                self.warnings.push(warning(revision, spellings, "read by"));
            }
            (Some(Version::Begun(revision)), None) if is_first => {
                self.guess = Some((revision, warning(revision, spellings, "read by")));
            }
            (Some(Version::Spelt(revision) | Version::Meant(revision)), None) => {
                self.named = Some(revision);
                self.warnings.push(warning(revision, "the version line as the first one", "read by"));
            }
            (Some(Version::Spelt(revision) | Version::Meant(revision)), Some(named)) if revision != named => {
                self.warnings.push(warning(named, "one version line", "it is not followed: read by"));
                return false;
            }
            _ => return false,
        }
        true
    }

    /// The revision, and what is to be said about it.
    fn conclude(mut self) -> (Revision, Vec<Diagnostic>) {
        match (self.named, self.guess) {
            (Some(revision), _) => (revision, self.warnings),
            (None, Some((revision, warning))) => {
                self.warnings.push(warning);
                (revision, self.warnings)
            }
            (None, None) => (Revision::Y1986, self.warnings),
        }
    }
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
            ("IESNA91", Some(Version::Spelt(Revision::Y1991))),
            ("  IESNA:LM-63-1995 ", Some(Version::Spelt(Revision::Y1995))),
            ("IESNA:LM-63-2002", Some(Version::Spelt(Revision::Y2002))),
            ("IES:LM-63-2019", Some(Version::Spelt(Revision::Y2019))),
            ("IESNA: LM-63-2002", Some(Version::Spelt(Revision::Y2002))),
            ("IESNA86", Some(Version::Meant(Revision::Y1986))),
            ("IESNA95", Some(Version::Meant(Revision::Y1995))),
            ("IESNA:LM-63-1991", Some(Version::Meant(Revision::Y1991))),
            ("IESNA:LM-63-2019", Some(Version::Meant(Revision::Y2019))),
            ("IESNA:LM-63-91", Some(Version::Meant(Revision::Y1991))),
            ("ies:lm-63-02", Some(Version::Meant(Revision::Y2002))),
            ("IESNA LM-63-2002", Some(Version::Meant(Revision::Y2002))),
            ("LM-63-1995", Some(Version::Meant(Revision::Y1995))),
            ("IESNA:LM-63-1991 by a tool", Some(Version::Begun(Revision::Y1991))),
            ("IES:LM-63-2031", Some(Version::Begun(Revision::Y2019))),
            ("IES file of a tool", Some(Version::Begun(Revision::Y2019))),
            ("LM-63-1991 is the format", None),
            ("[IESNA91]", None),
            ("ERCO Leuchten GmbH", None),
            ("REPORT NUMBER: 1", None),
        ] {
            assert_eq!(version_of(line), expected, "{line}");
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
