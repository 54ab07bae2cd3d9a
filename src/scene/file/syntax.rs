//! Errors of the TOML text itself.

use crate::error::{Diagnostic, Kind};
use crate::scene::toml_table::Document;

/// Most syntax errors that are told: after the first few the rest tend to be their echoes.
const MOST_SYNTAX_ERRORS: usize = 20;

/// Keep one error for every line with a fault.
pub(super) fn report(document: &Document<'_>, text: &str, faults: &[toml::de::Error]) {
    let mut lines = Vec::new();
    for fault in faults {
        let span = fault.span().unwrap_or(text.len()..text.len());
        let place = document.place(span.start);
        if lines.contains(&place.line) || lines.len() >= MOST_SYNTAX_ERRORS {
            continue;
        }
        lines.push(place.line);
        let excerpt = document.excerpt(span.clone());
        let (found, required) = if fault.message() == "duplicate key" {
            duplicate(document, text, span.start, &excerpt)
        } else {
            in_words(fault.message(), &excerpt)
        };
        document.error(Diagnostic::new(Kind::Syntax, found, required).at(place.line, place.column));
    }
}

/// toml's message is `what is wrong, expected this`.
fn in_words(message: &str, excerpt: &str) -> (String, String) {
    let (wrong, expected) = match message.split_once(", expected ") {
        Some((wrong, expected)) => (wrong, expected.to_string()),
        None => (message, String::from("a TOML document")),
    };
    let found = match excerpt.trim() {
        "" => format!("{wrong} (TOML)"),
        shown => format!("{wrong} (TOML), at `{}`", shown.escape_debug()),
    };
    (found, expected)
}

/// A key or header for the second time, and where the first one is.
fn duplicate(document: &Document<'_>, text: &str, byte: usize, excerpt: &str) -> (String, String) {
    let line_of = |line: &str| line.split('#').next().unwrap_or_default().trim().replace([' ', '\t'], "");
    let second = document.place(byte).line;
    let lines: Vec<String> = text.lines().take(second).map(line_of).collect();
    let own = lines.get(second - 1).cloned().unwrap_or_default();
    let is_header = own.starts_with('[');
    let key = own.split('=').next().unwrap_or_default();
    let mut first = None;
    for (i, line) in lines.iter().enumerate().take(second - 1).rev() {
        let same = if is_header { *line == own } else { line.split('=').next() == Some(key) };
        if same {
            first = Some(i + 1);
        } else if !is_header && line.starts_with('[') {
            break;
        }
    }
    let first = first.map(|line| format!(" (first in line {line})")).unwrap_or_default();
    (format!("`{excerpt}` a second time{first}"), String::from("every key and every header once"))
}
