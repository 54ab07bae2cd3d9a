//! The text of a scene file while it is read: places in it, and the errors and warnings found so far.

use std::cell::{Cell, RefCell};
use std::ops::Range;

use crate::error::{Diagnostic, Kind, Place};
use crate::files::excerpt::visible;

/// A value and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Placed<T> {
    pub value: T,
    pub place: Place,
}

/// Most errors that are kept for one file; those beyond it are counted.
pub const MOST_ERRORS: usize = 100;

/// The text being read, and what was found wrong with it so far.
pub struct Document<'t> {
    name: &'t str,
    text: &'t str,
    line_starts: Vec<usize>,
    errors: RefCell<Vec<Diagnostic>>,
    unkept: Cell<usize>,
    warnings: RefCell<Vec<Diagnostic>>,
    files: RefCell<Vec<Placed<String>>>,
}

impl<'t> Document<'t> {
    /// A document of this text; `name` is the file's, for messages.
    pub fn new(text: &'t str, name: &'t str) -> Self {
        let ends = text.bytes().enumerate().filter(|(_, b)| *b == b'\n').map(|(i, _)| i + 1);
        Self {
            name,
            text,
            line_starts: std::iter::once(0).chain(ends).collect(),
            errors: RefCell::default(),
            unkept: Cell::new(0),
            warnings: RefCell::default(),
            files: RefCell::default(),
        }
    }

    /// Line and column of a byte; beyond the end, those of the end.
    pub fn place(&self, byte: usize) -> Place {
        let byte = byte.min(self.text.len());
        let line = self.line_starts.partition_point(|start| *start <= byte);
        let start = self.line_starts.get(line.wrapping_sub(1)).copied().unwrap_or(0);
        let before = self.text.as_bytes().get(start..byte).unwrap_or_default();
        // Every byte that does not continue a character begins one.
        let characters = before.iter().filter(|b| (**b & 0xC0) != 0x80).count();
        Place { line, column: characters + 1 }
    }

    /// The text there, cut to one line of at most 40 characters.
    pub fn excerpt(&self, span: Range<usize>) -> String {
        visible(&cut(self.text.get(span).unwrap_or_default()))
    }

    /// Keep the mention of a file.
    pub(super) fn names(&self, file: &Placed<String>) {
        self.files.borrow_mut().push(file.clone());
    }

    /// The files that are mentioned, in the order in which they were read.
    pub(super) fn files(&self) -> Vec<Placed<String>> {
        self.files.borrow().clone()
    }

    /// Keep an error. One that is only counted is not even made.
    pub fn error(&self, make: impl FnOnce() -> Diagnostic) {
        let mut errors = self.errors.borrow_mut();
        if errors.len() < MOST_ERRORS {
            errors.push(make().in_file(self.name));
        } else {
            self.unkept.set(self.unkept.get() + 1);
        }
    }

    /// Keep an error about this place.
    pub fn error_at(&self, place: Place, kind: Kind, found: impl Into<String>, required: impl Into<String>) {
        self.error(|| Diagnostic::new(kind, found, required).at(place.line, place.column));
    }

    /// Keep a warning about this place.
    pub fn warn_at(&self, place: Place, kind: Kind, found: impl Into<String>, required: impl Into<String>) {
        let warning = Diagnostic::new(kind, found, required).at(place.line, place.column);
        self.warnings.borrow_mut().push(warning.in_file(self.name));
    }

    /// The warnings, or the errors in the order of the file.
    pub fn finish(self) -> Result<Vec<Diagnostic>, Vec<Diagnostic>> {
        let mut errors = self.errors.into_inner();
        if errors.is_empty() {
            return Ok(self.warnings.into_inner());
        }
        errors.sort_by_key(|e| (e.line(), e.column()));
        if self.unkept.get() > 0 {
            let found = format!("{} more errors, not listed", self.unkept.get());
            errors.push(Diagnostic::new(Kind::Limit, found, "a scene without errors").in_file(self.name));
        }
        Err(errors)
    }
}

/// The first line of a text, at most 40 characters of it.
pub(super) fn cut(text: &str) -> String {
    const LONGEST: usize = 40;
    let line = text.lines().next().unwrap_or_default();
    let mut cut: String = line.chars().take(LONGEST).collect();
    if cut.len() < text.trim_end().len() {
        cut.push_str("...");
    }
    cut
}
