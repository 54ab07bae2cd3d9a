//! The names of one sort of part, each used once.

use std::collections::BTreeMap;

use super::document::Document;
use super::table::{Placed, Table, shown};
use crate::error::{Diagnostic, Kind, Place};
use crate::files::suggest;

/// Longest name, in characters.
const LONGEST_NAME: usize = 100;

/// Names with their places and indices; parts with an error keep theirs, so that a reference to one is no
/// second error.
pub(crate) struct Names {
    what: &'static str,
    known: BTreeMap<String, (Place, usize)>,
    /// What is to be said of a name that comes twice.
    also: Option<&'static str>,
}

impl Names {
    pub(crate) fn new(what: &'static str) -> Self {
        Self { what, known: BTreeMap::new(), also: None }
    }

    /// The same, with advice on a name that comes twice.
    pub(crate) fn advising(self, hint: &'static str) -> Self {
        Self { also: Some(hint), ..self }
    }

    /// Add a name, compared as `key`; a second use is an error at its place that says where the first one is.
    pub(crate) fn insert(&mut self, document: &Document<'_>, name: &Placed<String>, key: &str, index: usize) {
        let Placed { value: name, place } = name;
        let what = self.what;
        if name.is_empty() || name.chars().count() > LONGEST_NAME || name.chars().any(char::is_control) {
            let found = format!("the {what} name `{}`", shown(name));
            let required =
                format!("a name of 1 to {LONGEST_NAME} characters, none of them a control character");
            document.error_at(*place, Kind::Range, found, required);
        }
        if let Some((first, _)) = self.known.get(key) {
            let found =
                format!("the {what} name `{}` a second time (first in line {})", shown(name), first.line);
            let required = format!("a name of its own for every {what}");
            document.error(|| {
                let error = Diagnostic::new(Kind::Range, found, required).at(place.line, place.column);
                match self.also {
                    Some(hint) => error.hint(hint),
                    None => error,
                }
            });
            return;
        }
        self.known.insert(key.to_string(), (*place, index));
    }

    /// Names, places and indices in the order of the file.
    pub(crate) fn in_order(&self) -> Vec<(&str, Place, usize)> {
        let mut all: Vec<_> =
            self.known.iter().map(|(name, (place, i))| (name.as_str(), *place, *i)).collect();
        all.sort_by_key(|(_, _, index)| *index);
        all
    }

    /// The name and the index of the part that `key` names; absent or unknown: an error with the nearest known name.
    pub(crate) fn refer(&self, table: &mut Table<'_, '_>, key: &'static str) -> Option<(String, usize)> {
        let required = format!("the name of a {}, in quotes", self.what);
        let Placed { value: name, place } = table.needed(key, &required, Table::text)?;
        if let Some((_, index)) = self.known.get(&name) {
            return Some((name, *index));
        }
        table.document().error(|| self.unknown(&name).at(place.line, place.column));
        None
    }

    fn unknown(&self, name: &str) -> Diagnostic {
        const MOST_LISTED: usize = 20;
        let what = self.what;
        let names: Vec<&str> = self.in_order().into_iter().map(|(name, _, _)| name).collect();
        let required = match names.len() {
            0 => format!("a {what} of this scene: there is none"),
            1..=MOST_LISTED => format!("a {what} of this scene: {}", suggest::list(&names)),
            many => format!("one of the {many} {what}s of this scene"),
        };
        let found = format!("the unknown {what} `{}`", shown(name));
        suggest::hinted(Diagnostic::new(Kind::Unknown, found, required), name, &names, '`')
    }
}
