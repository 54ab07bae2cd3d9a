//! The three lists: C angles, gamma angles, values. Usually one number a line; some programs write several.

use super::fields::{Fields, is_blank, value};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::candela::lines::Lines;
use crate::files::candela::number::Number;

/// Position in the lists.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stream<'a> {
    lines: Lines<'a>,
    /// What is left of a line, and its place.
    rest: (usize, &'a str),
    /// Whether a number of this line was read: then text may follow.
    is_begun: bool,
}

/// What comes next.
pub(super) enum Next<'a> {
    Number(Number<'a>),
    /// A word that is no number, and its place.
    Word(&'a str, usize),
    End,
}

impl<'a> Stream<'a> {
    pub fn new(lines: Lines<'a>) -> Self {
        Self { lines, rest: (0, ""), is_begun: false }
    }

    /// The next number or what stands in its place. Text behind a number (`90 deg`) is passed over: words
    /// without a digit that are no `nan` or `inf`.
    pub fn next(&mut self) -> Next<'a> {
        loop {
            let (offset, line) = self.rest;
            let text = line.trim_start_matches(is_blank);
            let offset = offset + line.len() - text.len();
            let word = text.split(is_blank).next().unwrap_or_default();
            if word.is_empty() {
                let Some(line) = self.lines.next() else { return Next::End };
                (self.rest, self.is_begun) = (line, false);
                continue;
            }
            let behind = (offset + word.len(), &text[word.len()..]);
            if let Some(value) = value(word) {
                (self.rest, self.is_begun) = (behind, true);
                return Next::Number(Number { value, text: word, offset });
            }
            let lower = word.to_ascii_lowercase();
            let is_text = !word.contains(|c: char| c.is_ascii_digit())
                && !["nan", "inf"].iter().any(|bad| lower.contains(bad));
            if !(self.is_begun && is_text) {
                return Next::Word(word, offset);
            }
            self.rest = (offset + text.len(), "");
        }
    }

    /// The next number, which must be there; `what` names it in the message.
    pub fn number(&mut self, fields: &mut Fields<'a>, what: impl Fn() -> String) -> Result<Number<'a>> {
        match self.next() {
            Next::Number(number) => {
                fields.see(number);
                Ok(number)
            }
            Next::Word(word, offset) => Err(fields.no_number(word, offset, &format!("a number: {}", what()))),
            Next::End => {
                let required = format!("a number: {}", what());
                Err(fields.at_end(Diagnostic::new(Kind::Missing, "the end of the file", required)))
            }
        }
    }

    /// How many numbers follow, up to the first thing that is none; counted up to `most`.
    pub fn count(mut self, most: u64) -> u64 {
        (0..most).take_while(|_| matches!(self.next(), Next::Number(_))).count() as u64
    }

    /// Passes over `n` numbers, or fewer.
    pub fn skipped(mut self, n: u64) -> Self {
        (0..n).all(|_| matches!(self.next(), Next::Number(_)));
        self
    }
}
