//! Words of a text table, each with its place.
//!
//! Exported tables mix blanks, tabs and commas and end their rows as they like, so a table is read as one stream of words;
//! only names and rows of our own format care for the end of a line. `#` begins a comment that ends with its line.

use std::ops::Range;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::{line_column, quoted};

/// A word, the text that it stands in, and the byte where it begins there.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Word<'a> {
    pub text: &'a str,
    pub within: &'a str,
    pub byte: usize,
}

impl Word<'_> {
    /// This diagnostic, at this word.
    pub fn place(&self, diagnostic: Diagnostic) -> Diagnostic {
        let (line, column) = line_column(self.within, self.byte);
        diagnostic.at(line, column)
    }

    /// What was found is this word.
    pub fn refuse(&self, kind: Kind, required: impl Into<String>) -> Diagnostic {
        self.place(Diagnostic::new(kind, quoted(self.text), required))
    }

    pub fn is(&self, keyword: &str) -> bool {
        self.text.eq_ignore_ascii_case(keyword)
    }
}

/// A text with a position in it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Words<'a> {
    text: &'a str,
    byte: usize,
}

fn separates(c: char) -> bool {
    c.is_whitespace() || matches!(c, ',' | ';' | '\0' | '\u{1a}' | '\u{feff}')
}

fn ends_line(c: char) -> bool {
    matches!(c, '\n' | '\r')
}

impl<'a> Words<'a> {
    pub fn new(text: &'a str) -> Self {
        Self::between(text, 0..text.len())
    }

    /// The words of a part of a text; their places are those in the whole.
    pub fn between(text: &'a str, bytes: Range<usize>) -> Self {
        Self { text: &text[..bytes.end], byte: bytes.start }
    }

    /// Moves to the next character that `stop` names, or to the end; gives what is passed.
    fn pass(&mut self, stop: impl Fn(char) -> bool) -> &'a str {
        let rest = &self.text[self.byte..];
        let passed = &rest[..rest.find(stop).unwrap_or(rest.len())];
        self.byte += passed.len();
        passed
    }

    /// The next word; none, if a character that `stop` names comes first.
    fn take(&mut self, stop: impl Fn(char) -> bool) -> Option<Word<'a>> {
        self.pass(|c| !separates(c) || stop(c));
        while self.text[self.byte..].starts_with('#') {
            self.pass(ends_line);
            self.pass(|c| !separates(c) || stop(c));
        }
        let byte = self.byte;
        let text = self.pass(separates);
        (!text.is_empty()).then_some(Word { text, within: self.text, byte })
    }

    /// The next word.
    pub fn next(&mut self) -> Option<Word<'a>> {
        self.take(|_| false)
    }

    /// The next word of this line.
    pub fn next_in_line(&mut self) -> Option<Word<'a>> {
        self.take(ends_line)
    }

    /// The next word, which stays.
    pub fn peek(&self) -> Option<Word<'a>> {
        let mut ahead = *self;
        ahead.next()
    }

    /// The rest of this line without its comment and surrounding blanks.
    pub fn rest_of_line(&mut self) -> &'a str {
        self.pass(|c| c == '#' || ends_line(c)).trim()
    }

    /// This diagnostic, here.
    pub fn place(&self, diagnostic: Diagnostic) -> Diagnostic {
        Word { text: "", within: self.text, byte: self.byte }.place(diagnostic)
    }

    /// That something is missing here.
    pub fn missing(&self, found: impl Into<String>, required: impl Into<String>) -> Diagnostic {
        self.place(Diagnostic::new(Kind::Missing, found, required))
    }

    /// The next word, or that the file ends before `required`.
    pub fn expect(&mut self, required: &str) -> Result<Word<'a>> {
        self.next().ok_or_else(|| self.missing("the end of the file", required))
    }

    /// The next word must be this keyword; else it is refused, with what is `required`.
    pub fn keyword(&mut self, keyword: &str, required: &str) -> Result<Word<'a>> {
        let word = self.expect(keyword)?;
        if word.is(keyword) { Ok(word) } else { Err(word.refuse(Kind::Syntax, required)) }
    }

    /// Whether so many words can follow at all, asked before memory is taken for them.
    pub fn have_room_for(&self, words: usize) -> bool {
        words <= (self.text.len() - self.byte) / 2 + 1
    }

    /// A table that can hold so many values; those of a file too short for them are not asked for. `what` announces them.
    pub fn table_of(&self, values: usize, what: &str) -> Result<Vec<f32>> {
        if self.have_room_for(values) {
            return Ok(Vec::with_capacity(values));
        }
        let found = format!("a file too short for the {values} values that {what}");
        Err(self.missing(found, "all values"))
    }

    /// The number that the next word is; `what` names it.
    pub fn number(&mut self, what: &str) -> Result<f64> {
        number(&self.expect(what)?, what)
    }

    /// Adds the next `count` values to a table.
    pub fn values(&mut self, count: usize, table: &mut Vec<f32>) -> Result<()> {
        for _ in 0..count {
            table.push(value(&self.expect("a value of the table")?)?);
        }
        Ok(())
    }
}

/// The number that a word is: decimal and finite; `what` names it.
pub(crate) fn number(word: &Word, what: &str) -> Result<f64> {
    let digits = word.text.trim_start_matches(['+', '-']);
    let looks = digits.starts_with(|c: char| c.is_ascii_digit() || c == '.');
    match word.text.parse::<f64>() {
        Ok(value) if looks && value.is_finite() => Ok(value),
        Ok(value) if looks || value.is_infinite() => {
            Err(word.refuse(Kind::Range, format!("a finite number: {what}")))
        }
        _ => Err(word.refuse(Kind::Syntax, format!("a number: {what}"))),
    }
}

/// A table's value: a number that single precision holds.
pub(crate) fn value(word: &Word) -> Result<f32> {
    let value = number(word, "a value of the table, 1/sr")? as f32;
    if value.is_finite() {
        Ok(value)
    } else {
        Err(word.refuse(Kind::Range, "a value of the table below 3.4e38 per steradian"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_know_their_places() {
        let mut words = Words::new("\u{feff}a  b,c # comment, no word\r\n\t1.5;;2\r#\n\n  end");
        let mut seen = Vec::new();
        while let Some(word) = words.next() {
            let (line, column) = line_column(word.within, word.byte);
            seen.push((word.text, line, column));
        }
        assert_eq!(
            seen,
            [("a", 1, 2), ("b", 1, 5), ("c", 1, 7), ("1.5", 2, 2), ("2", 2, 7), ("end", 5, 3)],
            "CR LF is one line end, CR and LF one each"
        );
        let mut words = Words::new("a b # c\n d");
        let line: Vec<&str> = std::iter::from_fn(|| words.next_in_line()).map(|w| w.text).collect();
        assert_eq!((line.as_slice(), words.next().unwrap().text), (["a", "b"].as_slice(), "d"));
        assert_eq!(Words::new("  two words  # no\nx").rest_of_line(), "two words");
    }

    #[test]
    fn numbers_are_decimal_and_finite() {
        let word = |text| Word { text, within: "\n\n   x", byte: 5 };
        for (text, x) in [("1", 1.0), ("-2.5E-03", -2.5e-3), ("+.5", 0.5), ("3.", 3.0)] {
            assert_eq!(number(&word(text), "x").unwrap(), x);
        }
        for (text, kind) in [
            ("nan", Kind::Syntax),
            ("inf", Kind::Range),
            ("-infinity", Kind::Range),
            ("1e999", Kind::Range),
            ("1.2.3", Kind::Syntax),
            ("0x1", Kind::Syntax),
            ("1d3", Kind::Syntax),
            ("-", Kind::Syntax),
        ] {
            let error = number(&word(text), "x").unwrap_err();
            assert_eq!((error.kind(), error.line(), error.column()), (kind, Some(3), Some(4)), "{text}");
        }
        assert_eq!(value(&word("1e39")).unwrap_err().kind(), Kind::Range);
    }
}
