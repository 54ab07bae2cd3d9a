//! One diagnostic for everything that can be wrong with what a user hands in.
//!
//! A diagnostic names the place (file, line, column) as far as it is known, what was found there, what is
//! required, and, where there is something to say, what to do. Warnings are diagnostics too: they are kept in
//! lists and returned, never printed by the library.

pub mod invalid;
pub mod warning;
pub mod words;

use std::fmt;
use std::path::Path;

pub use invalid::Invalid;

/// Result of everything in this library that can fail on data.
pub type Result<T, E = Diagnostic> = std::result::Result<T, E>;

/// What sort of rule was broken; the class a caller can match on.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Kind {
    /// A file could not be read or written.
    Io,
    /// Text that is not of its format.
    Syntax,
    /// Something required is absent.
    Missing,
    /// A key, name or reference that means nothing here.
    Unknown,
    /// A value outside what is allowed.
    Range,
    /// More than a stated cap allows.
    Limit,
    /// Geometry that cannot be traced as it stands.
    Geometry,
    /// Known, but not available in this version.
    Unavailable,
    /// Stopped by the user.
    Interrupted,
}

/// A place in a text, both counted from 1; columns count characters.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub struct Place {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
}

/// A message about one place in one input: what was found, what is required, what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Diagnostic(Box<Detail>);

#[derive(Debug, Clone, PartialEq, Eq)]
struct Detail {
    kind: Kind,
    file: Option<String>,
    line: Option<usize>,
    column: Option<usize>,
    found: String,
    required: String,
    hint: Option<String>,
}

impl Diagnostic {
    /// A diagnostic without a place yet; `found` and `required` are clauses without a final stop.
    pub fn new(kind: Kind, found: impl Into<String>, required: impl Into<String>) -> Self {
        Self(Box::new(Detail {
            kind,
            file: None,
            line: None,
            column: None,
            found: found.into(),
            required: required.into(),
            hint: None,
        }))
    }

    /// The same, in this file. A file already named is kept: the innermost place is the useful one.
    #[must_use]
    pub fn in_file(mut self, file: impl AsRef<Path>) -> Self {
        if self.0.file.is_none() {
            self.0.file = Some(file.as_ref().display().to_string());
        }
        self
    }

    /// The same, in this file instead of the one where it was found: of a file that is made elsewhere and then renamed.
    #[must_use]
    pub(crate) fn moved_to(mut self, file: impl AsRef<Path>) -> Self {
        self.0.file = Some(file.as_ref().display().to_string());
        self
    }

    /// The same, at this line and column, both counted from 1.
    #[must_use]
    pub fn at(mut self, line: usize, column: usize) -> Self {
        self.0.line = Some(line);
        self.0.column = Some(column);
        self
    }

    /// The same, at this place if there is one.
    #[must_use]
    pub fn placed(self, place: Option<Place>) -> Self {
        match place {
            Some(place) => self.at(place.line, place.column),
            None => self,
        }
    }

    /// The same, with advice on what to do.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.0.hint = Some(hint.into());
        self
    }

    /// The class of the broken rule.
    pub fn kind(&self) -> Kind {
        self.0.kind
    }

    /// The file, as the user named it.
    pub fn file(&self) -> Option<&str> {
        self.0.file.as_deref()
    }

    /// Line, counted from 1.
    pub fn line(&self) -> Option<usize> {
        self.0.line
    }

    /// Column in characters, counted from 1.
    pub fn column(&self) -> Option<usize> {
        self.0.column
    }

    /// What was found.
    pub fn found(&self) -> &str {
        &self.0.found
    }

    /// What is required.
    pub fn required(&self) -> &str {
        &self.0.required
    }

    /// What to do about it.
    pub fn advice(&self) -> Option<&str> {
        self.0.hint.as_deref()
    }
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let detail = &self.0;
        if let Some(file) = &detail.file {
            write!(f, "{file}:")?;
            if let Some(line) = detail.line {
                write!(f, "{line}:")?;
                if let Some(column) = detail.column {
                    write!(f, "{column}:")?;
                }
            }
            f.write_str(" ")?;
        } else if let Some(line) = detail.line {
            write!(f, "line {line}, column {}: ", detail.column.unwrap_or(1))?;
        }
        write!(f, "found {}; required: {}", detail.found, detail.required)?;
        if let Some(hint) = &detail.hint {
            write!(f, " (hint: {hint})")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

/// One error where a caller collects all of them: `?` works where a scene is built.
impl From<Diagnostic> for Vec<Diagnostic> {
    fn from(error: Diagnostic) -> Self {
        vec![error]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn message_names_place_found_required_and_hint() {
        let d = Diagnostic::new(Kind::Range, "-3", "a positive length")
            .at(4, 7)
            .in_file("a.toml")
            .in_file("outer.toml")
            .hint("lengths are in metres");
        assert_eq!(
            d.to_string(),
            "a.toml:4:7: found -3; required: a positive length (hint: lengths are in metres)"
        );
        assert_eq!((d.file(), d.line(), d.column()), (Some("a.toml"), Some(4), Some(7)));
    }
}
