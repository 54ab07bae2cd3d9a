//! Errors of the TOML text itself.

use toml::Spanned;
use toml::de::{DeTable, Error};

use crate::error::{Diagnostic, Kind};
use crate::files::scene_toml::document::Document;

/// Most syntax errors that are told: after the first few the rest tend to be their echoes.
const MOST_SYNTAX_ERRORS: usize = 20;

/// Largest text of which more than the first fault is kept: every second byte of a text can be one.
const MANY_FAULTS_LIMIT_BYTES: usize = 1 << 20;

/// The table of a TOML text, or its faults. What the parser's recovery makes of a damaged text is not looked
/// at: it would only add errors that are none.
pub(crate) fn parse(text: &str) -> Result<Spanned<DeTable<'_>>, Vec<Error>> {
    if text.len() > MANY_FAULTS_LIMIT_BYTES {
        return DeTable::parse(text).map_err(|first| vec![first]);
    }
    let (root, faults) = DeTable::parse_recoverable(text);
    if faults.is_empty() { Ok(root) } else { Err(faults) }
}

/// Keep one error for every line with a fault.
pub(crate) fn report(document: &Document<'_>, text: &str, faults: &[Error]) {
    let mut lines = Vec::new();
    for fault in faults {
        let span = fault.span().unwrap_or(text.len()..text.len());
        let place = document.place(span.start);
        if lines.contains(&place.line) {
            continue;
        }
        if lines.len() >= MOST_SYNTAX_ERRORS {
            break;
        }
        let excerpt = document.excerpt(span.clone());
        let (found, required) = if fault.message() == "duplicate key" {
            let first = first_line_of(text, place.line);
            if first.is_none() && !lines.is_empty() {
                // A key that is twice in a table because the table's header is: told already.
                continue;
            }
            let first = first.map(|line| format!(" (first in line {line})")).unwrap_or_default();
            (format!("`{excerpt}` a second time{first}"), String::from("every key and every header once"))
        } else {
            in_words(fault.message(), &excerpt)
        };
        lines.push(place.line);
        document.error(Diagnostic::new(Kind::Syntax, found, required).at(place.line, place.column));
    }
}

/// toml's message is `what is wrong, expected this`.
fn in_words(message: &str, excerpt: &str) -> (String, String) {
    let (wrong, expected) = match message.split_once(", expected ") {
        Some((wrong, "nothing")) => (wrong, required_instead_of(wrong).to_string()),
        Some((wrong, expected)) => (wrong, expected.to_string()),
        None => (message, String::from("a TOML document")),
    };
    let found = match excerpt.trim() {
        "" => format!("{wrong} (TOML)"),
        shown => format!("{wrong} (TOML), at `{}`", shown.escape_debug()),
    };
    (found, expected)
}

/// What is required where toml's parser expects "nothing", that is, where something stands too much: the rule that it
/// breaks, since the removal of the excerpt alone is not always right.
fn required_instead_of(wrong: &str) -> &'static str {
    match wrong {
        "extra `=`" => "one `=` between a key and its value",
        "unexpected leading zero" => "a number without leading zeros",
        "redundant numeric sign" | "unexpected sign" => {
            "a number with at most one sign, before its first digit"
        }
        "integers with a radix cannot be signed" => "a number that begins with 0x, 0o or 0b and has no sign",
        "redundant integer number prefix" => "at most one of 0x, 0o and 0b, before the digits",
        "`_` may only go between digits" => "a digit before and after every `_`",
        _ => "text as TOML 1.0 has it (https://toml.io)",
    }
}

/// The first line of the same table with the same key as line `second`, or the first line with the same
/// header.
fn first_line_of(text: &str, second: usize) -> Option<usize> {
    let bare = |line: &str| line.split('#').next().unwrap_or_default().replace([' ', '\t'], "");
    let lines: Vec<String> = text.lines().take(second).map(bare).collect();
    let (own, before) = lines.split_last()?;
    let is_header = own.starts_with('[');
    let key = own.split('=').next();
    let same = |line: &String| if is_header { line == own } else { line.split('=').next() == key };
    let table = before.iter().rposition(|line| line.starts_with('[')).filter(|_| !is_header).unwrap_or(0);
    before.iter().skip(table).position(same).map(|i| table + i + 1)
}
