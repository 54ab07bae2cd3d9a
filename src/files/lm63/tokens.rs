//! The stream of numbers after `TILT=`: tokens, not lines.
//!
//! Real files put one number on each line, wrap anywhere or write one line of 700 characters, so line ends, blanks,
//! tabs and commas all separate. A token is a decimal number or it is refused, with its place.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::candela::number::{Number, is_decimal};
use crate::files::excerpt::{line_column, quoted};

/// Position in a text of numbers.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Tokens<'a> {
    text: &'a str,
    offset: usize,
    end: usize,
}

fn is_separator(c: char) -> bool {
    c.is_whitespace() || c == ',' || c == '\0'
}

impl<'a> Tokens<'a> {
    /// The numbers of `text` from byte `offset` on. A DOS end-of-file mark (Ctrl-Z) ends them.
    pub fn new(text: &'a str, offset: usize) -> Self {
        let end = text[offset..].find('\u{1a}').map_or(text.len(), |i| offset + i);
        Self { text, offset, end }
    }

    /// The same diagnostic, at this byte.
    pub fn place(&self, offset: usize, diagnostic: Diagnostic) -> Diagnostic {
        let (line, column) = line_column(self.text, offset);
        diagnostic.at(line, column)
    }

    /// The next word, if there is one, and its place; the position does not move past it.
    pub fn peek(&mut self) -> Option<(&'a str, usize)> {
        let rest = self.text[self.offset..self.end].trim_start_matches(is_separator);
        self.offset = self.end - rest.len();
        let word = rest.split(is_separator).next()?;
        (!word.is_empty()).then_some((word, self.offset))
    }

    /// The next token, which must be a finite number; `what` names it in the message.
    pub fn number(&mut self, what: &str) -> Result<Number<'a>> {
        let required = || format!("a number: {what}");
        let Some((found, offset)) = self.peek() else {
            let missing = Diagnostic::new(Kind::Missing, "the end of the file", required());
            return Err(self.end_of_numbers(missing));
        };
        let is_decimal = is_decimal(found);
        match found.parse::<f64>() {
            Ok(value) if is_decimal && value.is_finite() => {
                self.offset += found.len();
                Ok(Number { value, text: found, offset })
            }
            _ => {
                let kind = if is_decimal { Kind::Range } else { Kind::Syntax };
                let hint = if is_decimal { Some(TOO_LARGE) } else { hint_for(found) };
                let refused = self.place(offset, Diagnostic::new(kind, quoted(found), required()));
                Err(match hint {
                    Some(hint) => refused.hint(hint),
                    None => refused,
                })
            }
        }
    }

    /// The next `n` tokens as numbers. The caller has checked that there are as many ([`Self::require`]).
    pub fn numbers(&mut self, n: usize, what: &str) -> Result<Vec<Number<'a>>> {
        (0..n).map(|_| self.number(what)).collect()
    }

    /// Checks, before anything is allocated, that `n` more numbers follow. A word in their midst is refused at its
    /// place, the end of the file at the end; `name(i)` names the i-th of them in the message.
    pub fn require(&self, n: u64, name: impl Fn(u64) -> String) -> Result<()> {
        let mut ahead = *self;
        for have in 0..n {
            if ahead.peek().is_none() {
                let found = format!("the end of the file after {have} of {n} numbers");
                let required = format!("{n} numbers; the next is {}", name(have));
                return Err(self.end_of_numbers(Diagnostic::new(Kind::Missing, found, required)));
            }
            if let Err(refused) = ahead.number("") {
                // Read once more, for the message: names are made for the one number that needs it.
                ahead.number(&name(have))?;
                return Err(refused);
            }
        }
        Ok(())
    }

    /// How many numbers follow, up to the first thing that is none.
    pub fn count(&self) -> u64 {
        let mut ahead = *self;
        std::iter::from_fn(|| ahead.number("").ok()).count() as u64
    }

    fn end_of_numbers(&self, diagnostic: Diagnostic) -> Diagnostic {
        self.place(self.text[..self.end].trim_end().len(), diagnostic)
    }

    /// The text not read yet, with its offset, and what stands behind an end-of-file mark.
    pub fn rest(&mut self) -> (usize, &'a str, &'a str) {
        self.peek();
        let behind = self.text.get(self.end + 1..).unwrap_or("");
        (self.offset, &self.text[self.offset..self.end], behind)
    }
}

const TOO_LARGE: &str = "the value is beyond the range of a double";

fn hint_for(found: &str) -> Option<&'static str> {
    let lower = found.to_ascii_lowercase();
    if found.contains(';') {
        Some("numbers are separated by blanks, commas or line ends; LM-63 has no comments")
    } else if lower.contains("nan") || lower.contains("inf") {
        Some("every value must be a finite number")
    } else if lower.contains('d') && lower.replace('d', "e").parse::<f64>().is_ok() {
        Some("write the exponent with E")
    } else {
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_in_every_dress() {
        let text = "1 -2,3.5\t.25\r\n+4.\r1.4E+0010,,\n2e-1\u{a0}7\u{1a} 9";
        let mut tokens = Tokens::new(text, 0);
        let values: Vec<f64> = tokens.numbers(8, "value").unwrap().iter().map(|n| n.value).collect();
        assert_eq!(values, [1.0, -2.0, 3.5, 0.25, 4.0, 1.4e10, 0.2, 7.0]);
        assert!(tokens.peek().is_none(), "Ctrl-Z ends the numbers");
        assert_eq!(tokens.rest().2, " 9");
    }

    #[test]
    fn what_is_no_number_is_refused_at_its_place() {
        for (bad, kind) in [
            ("nan", Kind::Syntax),
            ("-inf", Kind::Syntax),
            ("1;", Kind::Syntax),
            ("1.0D+02", Kind::Syntax),
            ("1.2.3", Kind::Syntax),
            ("0x10", Kind::Syntax),
            ("1e", Kind::Syntax),
            (".", Kind::Syntax),
            ("1e999", Kind::Range),
        ] {
            let text = format!("1 2\r\n  {bad} 4");
            let error = Tokens::new(&text, 0).numbers(3, "value").unwrap_err();
            assert_eq!(
                (error.kind(), error.line(), error.column()),
                (kind, Some(2), Some(3)),
                "{bad}: {error}"
            );
        }
        let error = Tokens::new("1 2\r3 ", 0).require(4, |i| format!("value {i}")).unwrap_err();
        assert_eq!((error.kind(), error.line(), error.column()), (Kind::Missing, Some(2), Some(2)));
    }
}
