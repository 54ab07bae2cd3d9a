//! A table of a TOML file, read key by key: typed values, the place of every one, and no key left unread.
//!
//! serde's derive would report the first error of a file in its own words. Here each message names place,
//! what was found and what is required, all errors of a file are collected, and an unknown key is answered
//! with the nearest known one. The keys a reader asks for are the keys that are known: they are written once.

use std::cell::RefCell;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::document::Document;
pub(super) use super::document::Placed;
use crate::error::invalid::Invalid;
use crate::error::{Diagnostic, Kind, Place};
use crate::files::suggest;

pub(super) type Value<'t> = &'t Spanned<DeValue<'t>>;

/// One table whose keys are taken one after the other; [`Table::finish`] reports those nobody asked for.
pub(super) struct Table<'t, 'd> {
    document: &'d Document<'t>,
    entries: &'t DeTable<'t>,
    /// What it is, for messages: `an [[emitter]]`.
    what: String,
    /// Where its header stands.
    place: Place,
    known: Vec<&'static str>,
    /// Keys that are missing, with what was found and what is required. They are told when the table ends, but for
    /// those that an unknown key was meant to be.
    missing: RefCell<Vec<(&'static str, String, String)>>,
    /// Known keys that unknown ones were meant to be.
    meant: Vec<&'static str>,
}

impl Drop for Table<'_, '_> {
    fn drop(&mut self) {
        for (key, found, required) in self.missing.take() {
            if !self.meant.contains(&key) {
                self.document.error_at(self.place, Kind::Missing, found, required);
            }
        }
    }
}

impl<'t, 'd> Table<'t, 'd> {
    /// The table `entries` whose header stands at `place`.
    pub fn new(document: &'d Document<'t>, entries: &'t DeTable<'t>, what: &str, place: Place) -> Self {
        let (known, missing, meant) = (Vec::new(), RefCell::default(), Vec::new());
        Self { document, entries, what: what.to_string(), place, known, missing, meant }
    }

    /// Where its header stands.
    pub fn place(&self) -> Place {
        self.place
    }

    /// The document it is part of.
    pub fn document(&self) -> &'d Document<'t> {
        self.document
    }

    /// Name it more exactly in messages, once its type is known.
    pub fn call(&mut self, what: &str) {
        self.what = what.to_string();
    }

    /// Where this key's value stands, if the key is there.
    pub fn place_of(&self, key: &str) -> Option<Place> {
        self.entries.get(key).map(|value| self.at(value))
    }

    pub(super) fn at(&self, value: Value<'t>) -> Place {
        self.document.place(value.span().start)
    }

    /// The value of a key, if it is a text: for keys that take a word or a number.
    pub fn word_of(&self, key: &str) -> Option<&'t str> {
        self.entries.get(key)?.get_ref().as_str()
    }

    /// Whether it is a list.
    pub(super) fn is_list(&self, key: &str) -> bool {
        self.entries.get(key).is_some_and(|value| value.get_ref().is_array())
    }

    /// The value of a key, which is known from now on.
    pub(super) fn take(&mut self, key: &'static str) -> Option<Value<'t>> {
        self.known.push(key);
        self.entries.get(key)
    }

    /// Keep an error about the value of `key` (about the table, if the key is absent).
    pub fn error(&self, key: &'static str, kind: Kind, required: &str) {
        match self.entries.get(key) {
            Some(value) => _ = self.wrong::<()>(key, value, kind, required),
            None => self.missing(key, required),
        }
    }

    /// Keep an error about a value; nothing is made of it.
    pub(super) fn wrong<T>(&self, label: &str, value: Value<'t>, kind: Kind, required: &str) -> Option<T> {
        self.document.error_at(self.at(value), kind, self.shown(label, value), required);
        None
    }

    /// Keep an error about a value of another kind, with what to do.
    pub(super) fn advised<T>(
        &self,
        label: &str,
        value: Value<'t>,
        kind: Kind,
        required: &str,
        hint: &str,
    ) -> Option<T> {
        let error = || Diagnostic::new(kind, self.shown(label, value), required);
        self.document.error(|| error().placed(Some(self.at(value))).hint(hint));
        None
    }

    fn shown(&self, label: &str, value: Value<'t>) -> String {
        format!("{label} = {}", self.document.excerpt(value.span()))
    }

    /// What a constructor made of the values; what it refused is an error at the key that it names.
    pub fn accept<T>(&self, made: Result<T, Invalid>) -> Option<T> {
        made.map_err(|e| match self.entries.get(e.what()) {
            Some(value) if matches!(e, Invalid::NoDirection { what: "aim", .. }) => {
                let hint = "not the point that is aimed at: that point minus `position`";
                _ = self.advised::<()>(e.what(), value, e.kind(), &e.required(), hint);
            }
            Some(_) => self.error(e.what(), e.kind(), &e.required()),
            None => self.document.error_at(self.place, e.kind(), e.found(), e.required()),
        })
        .ok()
    }

    fn missing(&self, key: &'static str, required: &str) {
        self.absent(key, format!("{} without `{key}`", self.what), format!("{key} = {required}"));
    }

    /// Keep the error that a key is missing, unless one that nobody knows was meant to be it.
    pub(super) fn absent(&self, key: &'static str, found: impl Into<String>, required: impl Into<String>) {
        self.missing.borrow_mut().push((key, found.into(), required.into()));
    }

    /// What `read` makes of a key; absent: an error.
    pub fn needed<T>(
        &mut self,
        key: &'static str,
        required: &str,
        read: impl FnOnce(&mut Self, &'static str) -> Option<T>,
    ) -> Option<T> {
        let value = read(self, key);
        if value.is_none() && !self.entries.contains_key(key) {
            self.missing(key, required);
        }
        value
    }

    /// A text.
    pub fn text(&mut self, key: &'static str) -> Option<Placed<String>> {
        let value = self.take(key)?;
        match value.get_ref().as_str() {
            Some(text) => Some(Placed { value: text.to_string(), place: self.at(value) }),
            None => self.wrong(key, value, Kind::Syntax, "a text in quotes"),
        }
    }

    /// The path of a file: a text that is not empty.
    pub fn path(&mut self, key: &'static str) -> Option<Placed<String>> {
        const REQUIRED: &str = "the path of a file, relative to the scene file";
        let path = self.needed(key, REQUIRED, Self::text)?;
        if path.value.is_empty() || path.value.contains('\0') {
            self.error(key, Kind::Range, REQUIRED);
            return None;
        }
        self.document.names(&path);
        Some(path)
    }

    /// One of these words.
    pub fn word<T: Copy>(&mut self, key: &'static str, words: &[(&str, T)]) -> Option<T> {
        let value = self.take(key)?;
        let found = value.get_ref().as_str();
        if let Some((_, meaning)) = words.iter().find(|(word, _)| Some(*word) == found) {
            return Some(*meaning);
        }
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        self.document.error(|| {
            let error = Diagnostic::new(Kind::Unknown, self.shown(key, value), suggest::list(&known));
            let error = error.placed(Some(self.at(value)));
            suggest::hinted(error, found.unwrap_or_default(), &known, '"')
        });
        None
    }

    /// `true` or `false`.
    pub fn truth(&mut self, key: &'static str) -> Option<bool> {
        let value = self.take(key)?;
        match value.get_ref() {
            DeValue::Boolean(truth) => Some(*truth),
            _ => self.wrong(key, value, Kind::Syntax, "true or false"),
        }
    }

    /// A table of its own, `{ ... }` or `[header.key]`.
    pub fn table(&mut self, key: &'static str, what: &str) -> Option<Table<'t, 'd>> {
        let value = self.take(key)?;
        let required = match value.get_ref().is_array() {
            true => format!("one table, headed [{key}] (single brackets)"),
            false => "a table { ... }".into(),
        };
        self.table_in(key, value, what, &required)
    }

    fn table_in(&self, label: &str, value: Value<'t>, what: &str, required: &str) -> Option<Table<'t, 'd>> {
        match value.get_ref().as_table() {
            Some(entries) => Some(Table::new(self.document, entries, what, self.at(value))),
            None => self.wrong(label, value, Kind::Syntax, required),
        }
    }

    /// A list of 1 to `most` tables, `[{ ... }, { ... }]` or several `[[key]]`; `required` are the words for it.
    pub fn tables(
        &mut self,
        key: &'static str,
        what: &str,
        most: usize,
        required: &str,
    ) -> Option<Vec<Table<'t, 'd>>> {
        let value = self.take(key)?;
        let Some(items) = value.get_ref().as_array() else {
            return self.wrong(key, value, Kind::Syntax, required);
        };
        if items.is_empty() || items.len() > most {
            let found = format!("{} {key} tables", items.len());
            self.document.error_at(self.at(value), Kind::Limit, found, required);
        }
        // Too many are looked at all the same: what refers to one of them is no second error.
        if items.is_empty() {
            return None;
        }
        let table = |(i, item)| self.table_in(&format!("{key}[{i}]"), item, what, required);
        // All of them are looked at before one that is no table ends it.
        let tables: Vec<_> = items.iter().enumerate().map(table).collect();
        tables.into_iter().collect()
    }

    /// Every entry as a table with its name and the name's place, in the order of the file; entries that are
    /// no tables are errors. `required` are the words for one of them.
    pub fn named_tables(self, what: &str, most: usize, required: &str) -> Vec<(String, Table<'t, 'd>)> {
        let mut entries: Vec<_> = self.entries.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        if entries.len() > most {
            let found = format!("{} entries in {}", entries.len(), self.what);
            self.document.error_at(self.place, Kind::Limit, found, format!("at most {most}"));
        }
        let named = entries.into_iter().filter_map(|(key, value)| {
            let mut table = self.table_in(&shown(key.get_ref()), value, what, required)?;
            table.place = self.document.place(key.span().start);
            Some((key.get_ref().to_string(), table))
        });
        named.collect()
    }

    /// Report every key that nobody asked for, with the nearest one that is known here.
    pub fn finish(mut self) {
        let entries = self.entries.iter();
        for (key, _) in entries.filter(|(key, _)| !self.known.contains(&key.get_ref().as_ref())) {
            let name = key.get_ref().as_ref();
            self.meant.extend(suggest::meant(name, &self.known));
            self.document.error(|| {
                let found = format!("the unknown key `{}` in {}", shown(name), self.what);
                let error = Diagnostic::new(Kind::Unknown, found, suggest::list(&self.known));
                let error = error.placed(Some(self.document.place(key.span().start)));
                suggest::hinted(error, name, &self.known, '`')
            });
        }
    }
}

/// A name from a file, for a message: at most 40 characters, control characters escaped.
pub(super) fn shown(name: &str) -> String {
    let short: String = name.chars().take(40).collect();
    short.escape_debug().to_string()
}
