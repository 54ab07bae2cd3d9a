//! Words of a text table, each with its line and column.
//!
//! Exported tables mix blanks, tabs and commas and end their rows as they like, so a table is read as one stream of words;
//! only names and rows of our own format care for the end of a line. `#` begins a comment that ends with its line.

use crate::error::{Diagnostic, Kind, Result};

/// A word and where it stands; line and column count from 1, the column in characters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Word<'a> {
    pub text: &'a str,
    pub line: usize,
    pub column: usize,
}

impl Word<'_> {
    /// This diagnostic, at this word.
    pub fn place(&self, diagnostic: Diagnostic) -> Diagnostic {
        diagnostic.at(self.line, self.column)
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
    rest: &'a str,
    line: usize,
    column: usize,
}

/// At most 40 characters of a text that a file brought in, quoted.
pub(crate) fn quoted(text: &str) -> String {
    const MOST: usize = 40;
    match text.char_indices().nth(MOST) {
        None => format!("{text:?}"),
        Some((end, _)) => format!("{:?}...", &text[..end]),
    }
}

fn separates(c: char) -> bool {
    c.is_whitespace() || matches!(c, ',' | ';' | '\0' | '\u{1a}' | '\u{feff}')
}

impl<'a> Words<'a> {
    pub fn new(text: &'a str) -> Self {
        Self::from_place(text, 1, 1)
    }

    /// A part of a file that begins at this line and column.
    pub fn from_place(text: &'a str, line: usize, column: usize) -> Self {
        Self { rest: text, line, column }
    }

    /// Moves behind `bytes` bytes, which end at a character.
    fn skip(&mut self, bytes: usize) {
        let (gone, rest) = self.rest.split_at(bytes);
        let mut after_cr = false;
        for c in gone.chars() {
            match c {
                '\n' if after_cr => {}
                '\n' | '\r' => (self.line, self.column) = (self.line + 1, 1),
                _ => self.column += 1,
            }
            after_cr = c == '\r';
        }
        // CR LF cut in two would count as two line ends.
        self.rest = if after_cr { rest.strip_prefix('\n').unwrap_or(rest) } else { rest };
    }

    /// Moves to the next word; with `within_line`, not beyond the end of the line.
    fn seek(&mut self, within_line: bool) {
        loop {
            let stop = |c: char| !separates(c) || (within_line && matches!(c, '\n' | '\r'));
            self.skip(self.rest.find(stop).unwrap_or(self.rest.len()));
            if !self.rest.starts_with('#') {
                return;
            }
            self.skip(self.rest.find(['\n', '\r']).unwrap_or(self.rest.len()));
        }
    }

    fn take(&mut self) -> Option<Word<'a>> {
        let end = self.rest.find(separates).unwrap_or(self.rest.len());
        if end == 0 {
            return None;
        }
        let word = Word { text: &self.rest[..end], line: self.line, column: self.column };
        self.skip(end);
        Some(word)
    }

    /// The next word.
    pub fn next(&mut self) -> Option<Word<'a>> {
        self.seek(false);
        self.take()
    }

    /// The next word of this line.
    pub fn next_in_line(&mut self) -> Option<Word<'a>> {
        self.seek(true);
        self.take()
    }

    /// The next word, which stays.
    pub fn peek(&self) -> Option<Word<'a>> {
        let mut ahead = *self;
        ahead.next()
    }

    /// The rest of this line without its comment and surrounding blanks.
    pub fn rest_of_line(&mut self) -> &'a str {
        let end = self.rest.find(['\n', '\r', '#']).unwrap_or(self.rest.len());
        let text = self.rest[..end].trim();
        self.skip(end);
        text
    }

    /// This diagnostic, here.
    pub fn place(&self, diagnostic: Diagnostic) -> Diagnostic {
        diagnostic.at(self.line, self.column)
    }

    /// The next word, or that the file ends before `required`.
    pub fn expect(&mut self, required: &str) -> Result<Word<'a>> {
        let missing = Diagnostic::new(Kind::Missing, "the end of the file", required);
        self.next().ok_or_else(|| self.place(missing))
    }

    /// At most so many words can follow: what an allocation may be made for before they are read.
    pub fn room(&self) -> usize {
        self.rest.len() / 2 + 1
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

/// The text of a file: UTF-8, or what stands for it (a comment in another encoding must not stop a table).
pub(crate) fn decode(bytes: &[u8]) -> std::borrow::Cow<'_, str> {
    String::from_utf8_lossy(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_know_their_places() {
        let mut words = Words::new("\u{feff}a  b,c # comment, no word\r\n\t1.5;;2\r#\n\n  end");
        let mut seen = Vec::new();
        while let Some(word) = words.next() {
            seen.push((word.text, word.line, word.column));
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
        let word = |text| Word { text, line: 3, column: 4 };
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
