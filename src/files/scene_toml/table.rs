//! A table of a TOML file, read key by key: typed values, the place of every one, and no key left unread.
//!
//! serde's derive would report the first error of a file in its own words. Here each message names place,
//! what was found and what is required, all errors of a file are collected, and an unknown key is answered
//! with the nearest known one. The keys a reader asks for are the keys that are known: they are written once.

use glam::DVec3;
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::document::Document;
use super::suggest;
use crate::error::invalid::{Interval, Invalid};
use crate::error::{Diagnostic, Kind, Place};
use crate::math::frame::unit;

/// A value and where it stands.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placed<T> {
    /// The value.
    pub value: T,
    /// Where it stands in the scene file.
    pub place: Place,
}

/// Components of directions.
pub(super) const DIRECTION: Interval = Interval { low: -1e9, high: 1e9, words: "a number from -1e9 to 1e9" };

type Value<'t> = &'t Spanned<DeValue<'t>>;

/// One table whose keys are taken one after the other; [`Table::finish`] reports those nobody asked for.
pub struct Table<'t, 'd> {
    document: &'d Document<'t>,
    entries: &'t DeTable<'t>,
    /// What it is, for messages: `an [[emitter]]`.
    what: String,
    /// Where its header stands.
    place: Place,
    known: Vec<&'static str>,
}

impl<'t, 'd> Table<'t, 'd> {
    /// The table `entries` whose header stands at `place`.
    pub fn new(document: &'d Document<'t>, entries: &'t DeTable<'t>, what: &str, place: Place) -> Self {
        Self { document, entries, what: what.to_string(), place, known: Vec::new() }
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
        self.entries.get(key).map(|value| self.document.place(value.span().start))
    }

    /// The value of a key, which is known from now on.
    fn take(&mut self, key: &'static str) -> Option<Value<'t>> {
        self.known.push(key);
        self.entries.get(key)
    }

    /// Whether `key` names one of these words, which mean something but cannot be used yet: an error that
    /// says so.
    pub fn is_unavailable(&self, key: &str, later: &[&str], available: &[&str]) -> bool {
        let Some(value) = self.entries.get(key) else { return false };
        let Some(word) = value.get_ref().as_str().filter(|word| later.contains(word)) else { return false };
        let required = format!("{}; {word} is not available yet", suggest::list(available));
        self.error_in(key, value, Kind::Unavailable, required);
        true
    }

    /// Keep an error about the value of `key` (about the table, if the key is absent).
    pub fn error(&self, key: &str, kind: Kind, required: impl Into<String>) {
        match self.entries.get(key) {
            Some(value) => self.error_in(key, value, kind, required),
            None => self.missing(key, required),
        }
    }

    fn error_in(&self, label: &str, value: Value<'t>, kind: Kind, required: impl Into<String>) {
        let found = format!("{label} = {}", self.document.excerpt(value.span()));
        self.document.error_at(self.document.place(value.span().start), kind, found, required);
    }

    /// What a constructor made of the values; what it refused is an error at the key that it names.
    pub fn accept<T>(&self, made: Result<T, Invalid>) -> Option<T> {
        made.map_err(|e| match self.entries.get(e.what()) {
            Some(value) => self.error_in(e.what(), value, e.kind(), e.required()),
            None => self.document.error_at(self.place, e.kind(), e.found(), e.required()),
        })
        .ok()
    }

    fn missing(&self, key: &str, required: impl Into<String>) {
        let found = format!("{} without `{key}`", self.what);
        self.document.error_at(self.place, Kind::Missing, found, format!("{key} = {}", required.into()));
    }

    /// What a taken value is; absent or wrong: an error.
    pub fn require<T>(&self, key: &str, value: Option<T>, required: &str) -> Option<T> {
        if value.is_none() && !self.entries.contains_key(key) {
            self.missing(key, required);
        }
        value
    }

    /// A text.
    pub fn text(&mut self, key: &'static str) -> Option<Placed<String>> {
        let value = self.take(key)?;
        let Some(text) = value.get_ref().as_str() else {
            self.error_in(key, value, Kind::Syntax, "a text in quotes");
            return None;
        };
        Some(Placed { value: text.to_string(), place: self.document.place(value.span().start) })
    }

    /// The path of a file: a text that is not empty.
    pub fn path(&mut self, key: &'static str) -> Option<Placed<String>> {
        const REQUIRED: &str = "the path of a file, relative to the scene file";
        let path = self.text(key);
        let path = self.require(key, path, REQUIRED)?;
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
        let known: Vec<&str> = words.iter().map(|(word, _)| *word).collect();
        let found = value.get_ref().as_str();
        if let Some((_, meaning)) = words.iter().find(|(word, _)| Some(*word) == found) {
            return Some(*meaning);
        }
        let place = self.document.place(value.span().start);
        let shown = format!("{key} = {}", self.document.excerpt(value.span()));
        let mut error = Diagnostic::new(Kind::Unknown, shown, suggest::list(&known));
        if let Some(near) = found.and_then(|f| suggest::nearest(f, &known)) {
            error = error.hint(format!("did you mean \"{near}\"?"));
        }
        self.document.error(error.at(place.line, place.column));
        None
    }

    /// `true` or `false`.
    pub fn truth(&mut self, key: &'static str) -> Option<bool> {
        let value = self.take(key)?;
        if let DeValue::Boolean(truth) = value.get_ref() {
            return Some(*truth);
        }
        self.error_in(key, value, Kind::Syntax, "true or false");
        None
    }

    /// A number in this interval.
    pub fn number(&mut self, key: &'static str, interval: &Interval) -> Option<f64> {
        let value = self.take(key)?;
        self.number_in(key, value, interval)
    }

    /// The same, absent: an error.
    pub fn needed_number(&mut self, key: &'static str, interval: &Interval) -> Option<f64> {
        let number = self.number(key, interval);
        self.require(key, number, interval.words)
    }

    fn number_in(&self, label: &str, value: Value<'t>, interval: &Interval) -> Option<f64> {
        let Some(number) = number_of(value.get_ref()) else {
            self.error_in(label, value, Kind::Syntax, interval.words);
            return None;
        };
        let inside = interval.contains(number);
        if !inside {
            self.error_in(label, value, Kind::Range, interval.words);
        }
        inside.then_some(number)
    }

    /// `N` numbers in this interval, in a list.
    pub fn numbers<const N: usize>(&mut self, key: &'static str, interval: &Interval) -> Option<[f64; N]> {
        let value = self.take(key)?;
        self.numbers_in(key, value, interval)
    }

    fn numbers_in<const N: usize>(
        &self,
        key: &str,
        value: Value<'t>,
        interval: &Interval,
    ) -> Option<[f64; N]> {
        let items = value.get_ref().as_array().filter(|items| items.len() == N);
        let Some(items) = items else {
            let required = format!("a list of {N} numbers, each {}", interval.words);
            self.error_in(key, value, Kind::Syntax, required);
            return None;
        };
        let mut numbers = [0.0; N];
        let mut good = true;
        for (i, (slot, item)) in numbers.iter_mut().zip(items.iter()).enumerate() {
            match self.number_in(&format!("{key}[{i}]"), item, interval) {
                Some(number) => *slot = number,
                None => good = false,
            }
        }
        good.then_some(numbers)
    }

    /// A vector `[x, y, z]` whose components lie in this interval.
    pub fn vector(&mut self, key: &'static str, interval: &Interval) -> Option<DVec3> {
        self.numbers::<3>(key, interval).map(DVec3::from_array)
    }

    /// The same, absent: an error; `words` are for a message.
    pub fn needed_vector(&mut self, key: &'static str, interval: &Interval, words: &str) -> Option<DVec3> {
        let vector = self.vector(key, interval);
        self.require(key, vector, words)
    }

    /// A direction that is not zero, of length 1; `default` where the key is absent, an error without one.
    pub fn direction(&mut self, key: &'static str, default: Option<DVec3>) -> Option<DVec3> {
        const REQUIRED: &str = "a direction [x, y, z] that is not zero";
        let vector = self.vector(key, &DIRECTION);
        if vector.is_none() && self.place_of(key).is_none() && default.is_some() {
            return default;
        }
        let unit = unit(self.require(key, vector, REQUIRED)?);
        if unit.is_none() {
            self.error(key, Kind::Range, REQUIRED);
        }
        unit
    }

    /// A number for all three components, or a vector.
    pub fn number_or_vector(&mut self, key: &'static str, interval: &Interval) -> Option<DVec3> {
        let value = self.take(key)?;
        if value.get_ref().is_array() {
            return self.numbers_in::<3>(key, value, interval).map(DVec3::from_array);
        }
        if number_of(value.get_ref()).is_none() {
            let required = format!("{}, or a list of 3 such numbers", interval.words);
            self.error_in(key, value, Kind::Syntax, required);
            return None;
        }
        self.number_in(key, value, interval).map(DVec3::splat)
    }

    /// A whole number in this range.
    pub fn integer(&mut self, key: &'static str, low: u64, high: u64, words: &str) -> Option<u64> {
        let value = self.take(key)?;
        self.integer_in(key, value, low, high, words)
    }

    fn integer_in(&self, label: &str, value: Value<'t>, low: u64, high: u64, words: &str) -> Option<u64> {
        let Some(integer) = value.get_ref().as_integer() else {
            self.error_in(label, value, Kind::Syntax, words);
            return None;
        };
        let number = u64::from_str_radix(integer.as_str(), integer.radix()).ok();
        let inside = number.filter(|n| (low..=high).contains(n));
        if inside.is_none() {
            self.error_in(label, value, Kind::Range, words);
        }
        inside
    }

    /// Two cell counts of at least 1 each and a product of at most `most`.
    pub fn cells(&mut self, key: &'static str, most: u64, words: &str) -> Option<[u32; 2]> {
        let value = self.take(key)?;
        let Some(items) = value.get_ref().as_array().filter(|items| items.len() == 2) else {
            self.error_in(key, value, Kind::Syntax, words);
            return None;
        };
        let mut cells = [0u32; 2];
        let mut good = true;
        for (i, (slot, item)) in cells.iter_mut().zip(items.iter()).enumerate() {
            let label = format!("{key}[{i}]");
            match self.integer_in(&label, item, 1, most.min(u64::from(u32::MAX)), words) {
                Some(count) => *slot = count as u32,
                None => good = false,
            }
        }
        if good && u64::from(cells[0]) * u64::from(cells[1]) > most {
            self.error_in(key, value, Kind::Limit, words);
            good = false;
        }
        good.then_some(cells)
    }

    /// Whether the value of a key is a text: for keys that take a word or a number.
    pub fn is_text(&self, key: &str) -> bool {
        self.entries.get(key).is_some_and(|value| value.get_ref().is_str())
    }

    /// A count as [`super::count::parse_count`] reads it: a number, or a text.
    pub fn count(&mut self, key: &'static str) -> Option<u64> {
        let value = self.take(key)?;
        let text = match value.get_ref() {
            DeValue::Integer(integer) if integer.radix() != 10 => {
                u64::from_str_radix(integer.as_str(), integer.radix())
                    .map(|n| n.to_string())
                    .unwrap_or_default()
            }
            DeValue::Integer(integer) => integer.as_str().to_string(),
            DeValue::Float(float) => float.as_str().to_string(),
            DeValue::String(text) => text.to_string(),
            _ => String::new(),
        };
        match super::count::parse_count(&text) {
            Ok(count) => Some(count),
            Err(error) => {
                self.error_in(key, value, error.kind(), error.required());
                None
            }
        }
    }

    /// A table of its own, `{ ... }` or `[header.key]`.
    pub fn table(&mut self, key: &'static str, what: &str) -> Option<Table<'t, 'd>> {
        let value = self.take(key)?;
        let Some(entries) = value.get_ref().as_table() else {
            self.error_in(key, value, Kind::Syntax, "a table { ... }");
            return None;
        };
        Some(Table::new(self.document, entries, what, self.document.place(value.span().start)))
    }

    /// A list of 1 to `most` tables, `[{ ... }, { ... }]` or several `[[key]]`; `required` are the words for
    /// it.
    pub fn tables(
        &mut self,
        key: &'static str,
        what: &str,
        most: usize,
        required: &str,
    ) -> Option<Vec<Table<'t, 'd>>> {
        let value = self.take(key)?;
        let Some(items) = value.get_ref().as_array() else {
            self.error_in(key, value, Kind::Syntax, required);
            return None;
        };
        if items.is_empty() || items.len() > most {
            let found = format!("{} {key} tables", items.len());
            self.document.error_at(self.document.place(value.span().start), Kind::Limit, found, required);
            return None;
        }
        let mut tables = Vec::new();
        for (i, item) in items.iter().enumerate() {
            match item.get_ref().as_table() {
                Some(entries) => {
                    let place = self.document.place(item.span().start);
                    tables.push(Table::new(self.document, entries, what, place));
                }
                None => self.error_in(&format!("{key}[{i}]"), item, Kind::Syntax, required),
            }
        }
        (tables.len() == items.len()).then_some(tables)
    }

    /// Every entry as a table with its name and the name's place, in the order of the file; entries that are
    /// no tables are errors. `required` are the words for one of them.
    pub fn named_tables(self, what: &str, most: usize, required: &str) -> Vec<(String, Table<'t, 'd>)> {
        let mut entries: Vec<_> = self.entries.iter().collect();
        entries.sort_by_key(|(key, _)| key.span().start);
        if entries.len() > most {
            let found = format!("{} entries in {}", entries.len(), self.what);
            self.document.error_at(self.place, Kind::Limit, found, format!("at most {most}"));
            entries.truncate(most);
        }
        let mut tables = Vec::new();
        for (key, value) in entries {
            let place = self.document.place(key.span().start);
            match value.get_ref().as_table() {
                Some(inner) => {
                    tables.push((key.get_ref().to_string(), Table::new(self.document, inner, what, place)));
                }
                None => self.error_in(&shown(key.get_ref()), value, Kind::Syntax, required),
            }
        }
        tables
    }

    /// Report every key that nobody asked for, with the nearest one that is known here.
    pub fn finish(self) {
        for (key, _) in self.entries.iter() {
            let name = key.get_ref().as_ref();
            if self.known.contains(&name) {
                continue;
            }
            if self.document.is_full() {
                self.document.count_error();
                continue;
            }
            let place = self.document.place(key.span().start);
            let found = format!("the unknown key `{}` in {}", shown(name), self.what);
            let mut error = Diagnostic::new(Kind::Unknown, found, suggest::list(&self.known));
            if let Some(near) = suggest::nearest(name, &self.known) {
                error = error.hint(format!("did you mean `{near}`?"));
            }
            self.document.error(error.at(place.line, place.column));
        }
    }
}

/// A name from a file, for a message: at most 40 characters, control characters escaped.
pub fn shown(name: &str) -> String {
    let short: String = name.chars().take(40).collect();
    short.escape_debug().to_string()
}

/// A TOML number as f64; integers are welcome where a number is.
fn number_of(value: &DeValue<'_>) -> Option<f64> {
    match value {
        DeValue::Float(float) => float.as_str().parse().ok(),
        DeValue::Integer(integer) if integer.radix() == 10 => integer.as_str().parse().ok(),
        DeValue::Integer(integer) => {
            u64::from_str_radix(integer.as_str(), integer.radix()).ok().map(|n| n as f64)
        }
        _ => None,
    }
}
