//! Errors of the TOML text itself.

use toml::Spanned;
use toml::de::{DeTable, Error};

use super::document::{Document, cut};
use crate::error::Kind;
use crate::files::excerpt::visible;

/// Most syntax errors that are told: after the first few the rest tend to be their echoes.
const MOST_SYNTAX_ERRORS: usize = 20;

/// Largest text of which more than the first fault is kept: every second byte of a text can be one.
const MANY_FAULTS_LIMIT_BYTES: usize = 1 << 20;

/// The table of a TOML text, or its faults. What the parser's recovery makes of a damaged text is not looked
/// at: it would only add errors that are none.
pub(super) fn parse(text: &str) -> Result<Spanned<DeTable<'_>>, Vec<Error>> {
    if text.len() > MANY_FAULTS_LIMIT_BYTES {
        return DeTable::parse(text).map_err(|first| vec![first]);
    }
    let (root, faults) = DeTable::parse_recoverable(text);
    if faults.is_empty() { Ok(root) } else { Err(faults) }
}

/// Keep one error for every line with a fault: what stands where the parser stopped, the line, and the rule that it breaks, by
/// our own look at it: the parser's words are not used.
pub(super) fn report(document: &Document<'_>, text: &str, faults: &[Error]) {
    let mut told = Vec::new();
    for fault in faults {
        let span = fault.span().unwrap_or(text.len()..text.len());
        let place = document.place(span.start);
        if told.contains(&place.line) {
            continue;
        }
        if told.len() >= MOST_SYNTAX_ERRORS {
            break;
        }
        let excerpt = document.excerpt(span);
        let (found, required) = match repeated(text, place.line, excerpt.trim()) {
            Some(Repeated::Since(line)) => (
                format!("`{excerpt}` a second time (first in line {line})"),
                "every key and every header once",
            ),
            // A key that is twice in a table because the table's header is: told already.
            Some(Repeated::Below(header)) if told.contains(&header) => continue,
            _ => (not_toml(text, place.line, excerpt.trim()), rule_of(text, place.line)),
        };
        told.push(place.line);
        document.error_at(place, Kind::Syntax, found, required);
    }
}

const REQUIRED: &str = "TOML (https://toml.io): key = value, [table] or [[table]], and values such as 1.5, \"text\", true, [1, 2]";

/// The rule that a line with a fault breaks, where one of those that people trip over is seen in it.
fn rule_of(text: &str, number: usize) -> &'static str {
    let line = text.lines().nth(number - 1).unwrap_or_default();
    if line.contains(['“', '”', '„', '‘', '’']) {
        return "straight quotes, \"text\"; those that a word processor makes are others";
    }
    let line = line.split(" #").next().unwrap_or_default().trim();
    match line.split_once('=') {
        Some((_, value)) => rule_of_value(value.trim()),
        None if line.starts_with('[') => {
            "a header such as [camera], or [[surface]] with two brackets, the same before each surface"
        }
        None if line.contains(':') => "key = value, with `=` in place of `:`",
        None => REQUIRED,
    }
}

fn rule_of_value(value: &str) -> &'static str {
    let is_bare = |text: &str| text.chars().all(|c| c.is_alphanumeric() || "_-./ ".contains(c));
    if value.is_empty() {
        return "a value after the `=`";
    }
    if value.starts_with('=') {
        return "one `=` between a key and its value";
    }
    if value.starts_with('"') && value.contains('\\') {
        return BACKSLASH;
    }
    if value.strip_suffix(',').is_some_and(|value| is_whole(value.trim_end())) {
        return "no comma after a value: every key stands in a line of its own";
    }
    if value.starts_with(['"', '\'']) && value.matches(&value[..1]).count() == 1 {
        return "a text with a quote at its end, too";
    }
    if value.starts_with('(') {
        return "a list in square brackets, as in [0.0, 0.0, 1.0]";
    }
    if let Some(list) = value.strip_prefix('[') {
        let items = list.trim_end_matches(']').trim().split(',');
        let is_apart = |item: &str| item.split_whitespace().count() > 1;
        return match list.ends_with(']') {
            false => "a list with a bracket ] at its end",
            true if items.into_iter().any(is_apart) => {
                "a comma between the values of a list, as in [0.0, 0.0, 1.0]"
            }
            true => REQUIRED,
        };
    }
    if is_number(value) && value.contains(',') {
        return "a decimal point, as in 1.5, instead of the comma";
    }
    match value.to_ascii_lowercase().as_str() {
        "true" | "false" => return "true or false in small letters",
        "nan" | "infinity" => return "a number",
        _ => {}
    }
    rule_of_number(value).unwrap_or(match value.starts_with(char::is_alphabetic) && is_bare(value) {
        true => "a text in quotes, as in \"glass\"",
        false => REQUIRED,
    })
}

fn rule_of_number(value: &str) -> Option<&'static str> {
    let unsigned = value.trim_start_matches(['+', '-']);
    let signs = value.len() - unsigned.len();
    let behind = unsigned.trim_start_matches(|c: char| c.is_ascii_digit() || "._".contains(c)).trim_start();
    Some(match unsigned.as_bytes() {
        [b'0'..=b'9', ..] if signs > 1 => "a number with at most one sign, before its first digit",
        [b'0', b'x' | b'o' | b'b', ..] if signs == 1 => {
            "a number that begins with 0x, 0o or 0b and has no sign"
        }
        [b'0', b'0'..=b'9', ..] => "a number without leading zeros",
        [b'0'..=b'9', ..] if unsigned.contains("__") => "a digit before and after every `_`",
        [b'0'..=b'9', ..] if behind.starts_with('^') => "a number, or a power in quotes, as in \"2^22\"",
        [b'0'..=b'9', ..] if behind.starts_with(|c: char| c.is_alphabetic() || "%°µ".contains(c)) => {
            "a number without a unit (metres, degrees, lumens), or a text in quotes"
        }
        _ => return None,
    })
}

/// What to write instead of a backslash that is part of a path.
pub(super) const BACKSLASH: &str = "a path with / or in single quotes ('C:\\ies\\spot.ies'): in double quotes a backslash begins an escape such as \\t";

/// Whether it is a number, but for a decimal comma; a comment may follow.
fn is_number(value: &str) -> bool {
    let value = value.split('#').next().unwrap_or_default().trim_end();
    value.matches(',').count() <= 1 && value.replace([',', '_'], ".").parse::<f64>().is_ok()
}

/// Whether a value is complete.
fn is_whole(value: &str) -> bool {
    let between = |open, close| value.len() > 1 && value.starts_with(open) && value.ends_with(close);
    let pairs = [('"', '"'), ('\'', '\''), ('[', ']'), ('{', '}')];
    is_number(value) || ["true", "false"].contains(&value) || pairs.iter().any(|(a, b)| between(*a, *b))
}

fn not_toml(text: &str, number: usize, excerpt: &str) -> String {
    let shown = visible(&cut(text.lines().nth(number - 1).unwrap_or_default().trim()));
    match excerpt {
        "" if shown.is_empty() => "the end of the text, which is too early".into(),
        "" => format!("`{shown}`, which is not complete"),
        _ if excerpt == shown => format!("`{shown}`, which is not TOML"),
        _ => format!("`{excerpt}` in `{shown}`, which is not TOML there"),
    }
}

/// What a fault at a key or header may be.
enum Repeated {
    /// The same key of the same table, or the same header, stands in this line.
    Since(usize),
    /// It does not, and the header of the table is in this line.
    Below(usize),
}

/// How line `second` repeats an earlier one, where `excerpt` is its key or the end of its header.
fn repeated(text: &str, second: usize, excerpt: &str) -> Option<Repeated> {
    let bare = |line: &str| line.split('#').next().unwrap_or_default().replace([' ', '\t'], "");
    let lines: Vec<String> = text.lines().take(second).map(bare).collect();
    let (own, before) = lines.split_last()?;
    let is_header = own.starts_with('[');
    let key = if is_header { own.trim_matches(['[', ']']) } else { own.split('=').next()? };
    if excerpt.is_empty() || !key.ends_with(excerpt) {
        return None;
    }
    let header = before.iter().rposition(|line| line.starts_with('['));
    let same = |line: &String| if is_header { line == own } else { line.split('=').next() == Some(key) };
    let table = header.filter(|_| !is_header).unwrap_or(0);
    match before.iter().skip(table).position(same) {
        Some(i) => Some(Repeated::Since(table + i + 1)),
        None => Some(Repeated::Below(header? + 1)),
    }
}
