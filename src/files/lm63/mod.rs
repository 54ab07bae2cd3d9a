//! Reader of IES LM-63 files (1986, 1991, 1995, 2002, 2019).
//!
//! The standards are strict and the files are not: the reader takes what can be understood in one way only, says in
//! a warning what it took how, and refuses the rest with line and column. docs/PHOTOMETRY.md lists all three.
//!
//! ```text
//! [version line]                      none in 1986
//! [KEYWORD] text ...
//! TILT=NONE | TILT=INCLUDE | TILT=file
//! {geometry  pairs  angles  factors}  INCLUDE only
//! lamps lumens/lamp multiplier nV nH type units width length height
//! ballast-factor field-12 input-watts
//! V[nV]  H[nH]  candela[nH][nV]
//! ```

mod body;
mod commas;
mod doubts;
mod header;
mod tilt;
mod tokens;
mod turned;
pub mod write;

pub use body::generation_type;

use crate::error::{Kind, Result};
use crate::files::excerpt::quoted;
use crate::photometry::Photometry;
use body::Reader;
use header::{Header, has_tilt_line, read_header};
use std::rc::Rc;

/// Gives the bytes of the tilt file of this name, which has no folder.
pub type TiltFile<'a> = &'a mut dyn FnMut(&str) -> Result<Rc<[u8]>>;

/// Reads the text of a file; messages have line and column, and no file.
pub(super) fn parse_text(text: &str, tilt_file: TiltFile<'_>) -> Result<Photometry> {
    let header = read_header(text)?;
    let (body, has_tilt_table) = (header.body, header.tilt.0.eq_ignore_ascii_case("INCLUDE"));
    let read = parse_body(text, header, tilt_file);
    // Where all is as the counts say, commas are what they should be.
    let is_whole = matches!(read, Ok((_, 0)));
    let refusal = if is_whole { None } else { commas::refusal(text, body, has_tilt_table) };
    refusal.map_or(read, Err).map(|(photometry, _)| photometry)
}

/// Also the count of numbers left over.
fn parse_body(text: &str, header: Header<'_>, tilt_file: TiltFile<'_>) -> Result<(Photometry, u64)> {
    let mut reader = Reader { warnings: header.warnings, ..Reader::new(text, header.body) };
    let tilt = tilt::read(header.tilt, &mut reader, tilt_file)?;
    let luminaire = reader.luminaire(header.revision)?;
    let surplus = warn_about_rest(&mut reader);
    let mut photometry = Photometry { labels: header.labels, tilt, warnings: reader.warnings, ..luminaire };
    doubts::compare(&mut photometry);
    Ok((photometry, surplus))
}

/// What stands behind the last candela value: another luminaire, surplus numbers, other text; the count of
/// surplus numbers.
fn warn_about_rest(reader: &mut Reader) -> u64 {
    let (offset, rest, behind_mark) = reader.tokens.rest();
    let blank = |text: &str| text.chars().all(|c| c.is_whitespace() || c == '\0' || c == '\u{1a}');
    let required = "nothing after the last candela value";
    if has_tilt_line(rest) || has_tilt_line(behind_mark) {
        let hint = "the first luminaire is read";
        reader.warn(offset, Kind::Syntax, "another luminaire", "one luminaire", hint);
    } else if !blank(rest) {
        let surplus = reader.tokens.count();
        let word = reader.tokens.peek().map_or(String::new(), |(word, _)| quoted(word));
        let found = match surplus {
            0 => format!("text {word}"),
            1 => "1 surplus number".to_owned(),
            n => format!("{n} surplus numbers"),
        };
        reader.warn(offset, Kind::Syntax, &found, required, "it is ignored");
        return surplus;
    } else if !blank(behind_mark) {
        reader.warn(offset, Kind::Syntax, "text behind the end-of-file mark", required, "it is ignored");
    }
    0
}

#[cfg(test)]
mod tests;
