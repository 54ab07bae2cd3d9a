//! Fields of the head: one a line, text behind a number allowed.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::candela::lines::{Lines, lines};
use crate::files::candela::number::{Number, is_decimal};
use crate::files::excerpt::{line_column, quoted};

/// A line without the blanks around its text.
#[derive(Debug, Clone, Copy)]
pub(super) struct Field<'a> {
    pub text: &'a str,
    pub offset: usize,
}

/// What is still to be read of a text, and what is wrong in it and tolerated.
pub(super) struct Fields<'a> {
    /// Up to a DOS end-of-file mark (Ctrl-Z), if there is one.
    text: &'a str,
    pub lines: Lines<'a>,
    pub warnings: Vec<Diagnostic>,
    /// The first number with a decimal point, and the first with a comma.
    pub signs: [Option<Number<'a>>; 2],
}

pub(super) fn is_blank(c: char) -> bool {
    c.is_whitespace() || c == '\0'
}

/// The value of a word: a finite decimal number with a point, or with one comma.
pub(super) fn value(word: &str) -> Option<f64> {
    let has_comma = word.matches(',').count() == 1 && !word.contains('.');
    let with_point = has_comma.then(|| word.replace(',', "."));
    let word = with_point.as_deref().unwrap_or(word);
    is_decimal(word).then(|| word.parse().ok()).flatten().filter(|x: &f64| x.is_finite())
}

impl<'a> Fields<'a> {
    pub fn new(text: &'a str) -> Self {
        let text = text.find('\u{1a}').map_or(text, |end| &text[..end]);
        Self { text, lines: lines(text), warnings: Vec::new(), signs: [None; 2] }
    }

    /// The same diagnostic, at this byte.
    pub fn place(&self, offset: usize, diagnostic: Diagnostic) -> Diagnostic {
        let (line, column) = line_column(self.text, offset);
        diagnostic.at(line, column)
    }

    /// The same diagnostic, where the file ends.
    pub fn at_end(&self, diagnostic: Diagnostic) -> Diagnostic {
        self.place(self.text.trim_end_matches(is_blank).len(), diagnostic)
    }

    /// Keeps a warning at this byte.
    pub fn warn(&mut self, offset: usize, kind: Kind, found: &str, required: &str, hint: &str) {
        let d = Diagnostic::new(kind, found, required);
        let d = if hint.is_empty() { d } else { d.hint(hint) };
        self.warnings.push(self.place(offset, d));
    }

    pub fn refuse<T>(&self, number: &Number<'_>, kind: Kind, what: &str, required: &str) -> Result<T> {
        let found = format!("{what} {}", number.text);
        Err(self.place(number.offset, Diagnostic::new(kind, found, required)))
    }

    /// Remembers how a number is written.
    pub fn see(&mut self, number: Number<'a>) {
        for (seen, sign) in self.signs.iter_mut().zip(['.', ',']) {
            if seen.is_none() && number.text.contains(sign) {
                *seen = Some(number);
            }
        }
    }

    /// The next line; `what` names it in the message where the file has ended.
    pub fn field(&mut self, what: &str) -> Result<Field<'a>> {
        match self.lines.next() {
            Some((offset, line)) => {
                let blanks = line.len() - line.trim_start_matches(is_blank).len();
                Ok(Field { text: line.trim_matches(is_blank), offset: offset + blanks })
            }
            None => Err(self.at_end(Diagnostic::new(
                Kind::Missing,
                "the end of the file",
                format!("a line: {what}"),
            ))),
        }
    }

    /// The number that the next line begins with.
    pub fn number(&mut self, what: &str) -> Result<Number<'a>> {
        let field = self.field(what)?;
        self.number_of(field, what)
    }

    /// The number that this line begins with. A second one is told: two lines may have run together.
    pub fn number_of(&mut self, field: Field<'a>, what: &str) -> Result<Number<'a>> {
        let Field { text: line, offset } = field;
        let mut words = line.split(is_blank).filter(|word| !word.is_empty());
        let required = format!("a number: {what}");
        let Some(text) = words.next() else {
            return Err(self.place(offset, Diagnostic::new(Kind::Missing, "a blank line", required)));
        };
        let Some(value) = value(text) else { return Err(self.no_number(text, offset, &required)) };
        let number = Number { value, text, offset };
        self.see(number);
        if words.next().and_then(self::value).is_some() {
            let hint = "the first one is read";
            self.warn(offset, Kind::Syntax, &quoted(line), &format!("one number: {what}"), hint);
        }
        Ok(number)
    }

    /// The error that a word is no number.
    pub fn no_number(&self, word: &str, offset: usize, required: &str) -> Diagnostic {
        let too_large = word.parse::<f64>().is_ok() && is_decimal(word);
        let kind = if too_large { Kind::Range } else { Kind::Syntax };
        let d = self.place(offset, Diagnostic::new(kind, quoted(word), required));
        match hint_for(word, too_large) {
            Some(hint) => d.hint(hint),
            None => d,
        }
    }

    /// A number that decides nothing: a blank line is `otherwise`, and so is, with a warning, what does not
    /// fit.
    pub fn tolerated(
        &mut self,
        what: &str,
        fits: fn(f64) -> bool,
        required: &str,
        otherwise: f64,
    ) -> Result<f64> {
        let field = self.field(what)?;
        let word = field.text.split(is_blank).next().unwrap_or_default();
        match value(word).filter(|&x| fits(x)) {
            Some(number) => {
                self.see(Number { value: number, text: word, offset: field.offset });
                Ok(number)
            }
            None => {
                if !word.is_empty() {
                    let found = format!("{what} {}", quoted(field.text));
                    let hint = format!("read as {otherwise}");
                    self.warn(field.offset, Kind::Range, &found, required, &hint);
                }
                Ok(otherwise)
            }
        }
    }
}

fn hint_for(word: &str, too_large: bool) -> Option<&'static str> {
    let lower = word.to_ascii_lowercase();
    if too_large {
        Some("the value is beyond the range of a double")
    } else if lower.contains("nan") || lower.contains("inf") {
        Some("every value must be a finite number")
    } else if word.contains(',') {
        Some("one comma stands for the decimal point; thousands are not parted")
    } else if lower.contains('d') && lower.replace('d', "e").parse::<f64>().is_ok() {
        Some("write the exponent with E")
    } else {
        None
    }
}
