//! Another value for one key of a scene's text, found by its path: `emitter.lamp.position[2]`.
//!
//! The text is changed where the value stands and nowhere else, so that comments, layout and places stay. What the value may be
//! the scene's reader judges.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::key_path::{Step, parse_path};
use super::table::shown;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::suggest;

/// Tables of a scene that need not be in its text.
const OPTIONAL_TABLES: [&str; 4] = ["run", "ambient", "camera", "compare"];
/// Tables that a scene has.
const TABLES: [&str; 9] =
    ["emitter", "material", "surface", "receiver", "far_field", "camera", "run", "ambient", "compare"];
/// Lists that need not be in a text, and what their other numbers are then.
const OPTIONAL_LISTS: [(&str, &str); 3] = [("translate", "0.0"), ("rotate_deg", "0.0"), ("scale", "1.0")];

/// The text of a scene with this value, as TOML writes it, at the key of this path. A key that is not there yet is added to its
/// table.
///
/// # Errors
/// A path that leads nowhere: no such table, entry, list or place in it.
pub fn with_value(text: &str, path: &str, value: &str) -> Result<String> {
    let steps = parse_path(path)?;
    let start = text.len() - text.trim_start_matches('\u{feff}').len();
    let root = DeTable::parse(&text[start..]).map_err(|_| {
        Diagnostic::new(
            Kind::Syntax,
            "a scene that is no TOML",
            "a scene without mistakes before values are set",
        )
    })?;
    let change = Walk { text: &text[start..], steps: &steps, value }.change(root.get_ref())?;
    let Range { start: from, end } = change.span;
    let (before, after) = (&text[..start + from], &text[start + end..]);
    Ok([before, &change.text, after].concat())
}

/// What is put where.
struct Change {
    span: Range<usize>,
    text: String,
}

/// A path that is walked through a text.
struct Walk<'a> {
    text: &'a str,
    steps: &'a [Step],
    value: &'a str,
}

impl Walk<'_> {
    fn change(&self, root: &DeTable<'_>) -> Result<Change> {
        let Some(Step::Key(first)) = self.steps.first() else { return Err(no_table("")) };
        let Some(mut here) = root.get(first.as_str()) else {
            return match self.steps {
                [_, Step::Key(key)] if OPTIONAL_TABLES.contains(&first.as_str()) && is_bare(key) => {
                    let line = if self.text.ends_with('\n') || self.text.is_empty() { "" } else { "\n" };
                    let text = format!("{line}\n[{first}]\n{key} = {}\n", self.value);
                    Ok(Change { span: self.text.len()..self.text.len(), text })
                }
                _ => Err(no_table(first)),
            };
        };
        for (done, step) in self.steps.iter().enumerate().skip(1) {
            here = match (here.get_ref(), step) {
                (DeValue::Table(table), Step::Key(key)) => match table.get(key.as_str()) {
                    Some(value) => value,
                    None => return self.added(here, table, done),
                },
                (DeValue::Array(items), Step::Index(index)) => items.get(*index).ok_or_else(|| {
                    let found = format!("{}{step}, of which there are {}", self.path(done), items.len());
                    Diagnostic::new(Kind::Range, found, format!("[0] to [{}]", items.len().saturating_sub(1)))
                })?,
                (DeValue::Array(items), Step::Key(name)) => self.entry(items, name, done)?,
                (_, Step::Index(_)) => {
                    let found = format!("{}{step}, where {} is no list", self.path(done), self.path(done));
                    return Err(Diagnostic::new(Kind::Range, found, format!("{} alone", self.path(done))));
                }
                (_, Step::Key(key)) => {
                    let found = format!("{}.{}, where {0} is no table", self.path(done), shown(key));
                    return Err(Diagnostic::new(Kind::Range, found, format!("{} alone", self.path(done))));
                }
            };
        }
        let is_parts = |value: &DeValue<'_>| {
            value.is_table()
                || value.as_array().is_some_and(|a| a.iter().any(|item| item.get_ref().is_table()))
        };
        if is_parts(here.get_ref()) {
            let found = format!("{}, which is a table", self.path(self.steps.len()));
            return Err(
                Diagnostic::new(Kind::Range, found, "the path of a key in it").hint(keys_of(here.get_ref()))
            );
        }
        Ok(Change { span: here.span(), text: self.value.to_owned() })
    }

    /// The path to before step number `done`.
    fn path(&self, done: usize) -> String {
        super::key_path::written(&self.steps[..done])
    }

    /// The entry of this name in an array of tables.
    fn entry<'t>(
        &self,
        items: &'t [Spanned<DeValue<'t>>],
        name: &str,
        done: usize,
    ) -> Result<&'t Spanned<DeValue<'t>>> {
        let path = self.path(done);
        if !items.iter().all(|item| item.get_ref().is_table()) {
            let found = format!("{path}.{}, where {path} is a list", shown(name));
            return Err(Diagnostic::new(
                Kind::Range,
                found,
                format!("{path}[0] to {path}[{}]", items.len().saturating_sub(1)),
            ));
        }
        let named: Vec<Option<&str>> = items.iter().map(|item| name_of(item.get_ref())).collect();
        if let Some(at) = named.iter().position(|known| *known == Some(name)) {
            return Ok(&items[at]);
        }
        let known: Vec<&str> = named.into_iter().flatten().collect();
        let found = format!("no {path} of the name `{}`", shown(name));
        let of_names: Vec<String> = known.iter().map(|name| format!("{path}.{name}")).collect();
        let by_number = match items.len() {
            1 => format!("{path}[0]"),
            many => format!("{path}[0] to {path}[{}]", many - 1),
        };
        let required = of_names.into_iter().chain([by_number]).collect::<Vec<_>>().join(", ");
        Err(suggest::hinted(Diagnostic::new(Kind::Unknown, found, required), name, &known, '`'))
    }

    /// The value under a key that its table has not: step number `at`.
    fn added(&self, here: &Spanned<DeValue<'_>>, table: &DeTable<'_>, at: usize) -> Result<Change> {
        let Step::Key(key) = &self.steps[at] else { return Err(no_table("")) };
        let known: Vec<&str> = table.iter().map(|(key, _)| key.get_ref().as_ref()).collect();
        let unknown = |what: &str| {
            let found = format!("no {what} `{}` in {}", shown(key), self.path(at));
            let error = Diagnostic::new(Kind::Unknown, found, format!("one of: {}", known.join(", ")));
            Err(suggest::hinted(error, key, &known, '`'))
        };
        if self.path(at) == "material" {
            return unknown("material");
        }
        if !is_bare(key) {
            return unknown("key");
        }
        let list = OPTIONAL_LISTS.iter().find(|(name, _)| name == key);
        let value = match (&self.steps[at + 1..], list) {
            ([], _) => self.value.to_owned(),
            ([Step::Index(index @ 0..3)], Some((_, other))) => {
                let item = |i| if i == *index { self.value } else { other };
                format!("[{}, {}, {}]", item(0), item(1), item(2))
            }
            ([step @ Step::Index(_)], Some(_)) => {
                let found = format!("{}.{key}{step}, of which there are 3", self.path(at));
                return Err(Diagnostic::new(Kind::Range, found, "[0] to [2]"));
            }
            ([Step::Index(_)], None) => return unknown("list"),
            _ => return unknown("table"),
        };
        let Range { start, end } = here.span();
        let opening = self.text[start..].chars().next();
        match opening {
            // Behind the line of the header.
            Some('[') => {
                let rest = &self.text[end..];
                let line = rest.split('\n').next().unwrap_or_default().trim_end_matches('\r');
                let at = end + line.len();
                Ok(Change { span: at..at, text: format!("\n{key} = {value}") })
            }
            Some('{') => {
                let comma = if table.iter().next().is_some() { "," } else { "" };
                Ok(Change { span: start + 1..start + 1, text: format!(" {key} = {value}{comma}") })
            }
            _ => {
                let found =
                    format!("no `{}` in {}, whose keys are written with dots", shown(key), self.path(at));
                Err(Diagnostic::new(Kind::Missing, found, "the key in the scene file, with any value"))
            }
        }
    }
}

/// Whether TOML writes it without quotes, as every key that a scene can have.
fn is_bare(key: &str) -> bool {
    key.chars().all(|c| c.is_ascii_alphanumeric() || "_-".contains(c))
}

/// What an entry of an array of tables is called.
fn name_of<'t>(entry: &'t DeValue<'t>) -> Option<&'t str> {
    let table = entry.as_table()?;
    let text = |key| table.get(key)?.get_ref().as_str();
    // A receiver without a name has that of its surface.
    text("name").or_else(|| text("surface"))
}

fn no_table(name: &str) -> Diagnostic {
    let required = format!("a path that begins with one of: {}", TABLES.join(", "));
    let error = Diagnostic::new(Kind::Unknown, format!("no `{}` in the scene", shown(name)), required);
    suggest::hinted(error, name, &TABLES, '`')
}

/// What can be set in a table or in the entries of an array of them.
fn keys_of(value: &DeValue<'_>) -> String {
    let names: Vec<&str> = match (value.as_table(), value.as_array()) {
        (Some(table), _) => table.iter().map(|(key, _)| key.get_ref().as_ref()).collect(),
        (_, Some(items)) => items.iter().filter_map(|item| name_of(item.get_ref())).collect(),
        _ => Vec::new(),
    };
    format!("it has {}", suggest::list(&names).replace(" or ", " and "))
}

#[cfg(test)]
#[path = "tests_of_edit.rs"]
mod tests;
