//! What a message tells of a text that a file brought in: a piece of it, and where it stands.

/// At most 40 characters, quoted.
pub(crate) fn quoted(text: &str) -> String {
    const MOST: usize = 40;
    match text.char_indices().nth(MOST) {
        None => format!("{text:?}"),
        Some((end, _)) => format!("{:?}...", &text[..end]),
    }
}

/// The text with its control characters escaped, those that turn the direction of writing, too; quotes and backslashes stand as
/// they are.
pub(crate) fn visible(text: &str) -> String {
    let turns =
        |c: char| matches!(c, '\u{200e}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2066}'..='\u{2069}');
    let escaped =
        |c: char| if c.is_control() || turns(c) { c.escape_debug().to_string() } else { c.to_string() };
    text.chars().map(escaped).collect()
}

/// At most 200 characters, escaped: of texts that caustix wrote, if the file is what it says it is.
pub(crate) fn cut(text: &str) -> String {
    const MOST: usize = 200;
    let short: String = text.chars().take(MOST).collect();
    let more = if short.len() < text.len() { "..." } else { "" };
    visible(&short) + more
}

/// Line and column, both from 1, of a byte in the text; the column counts characters. CR LF, LF and CR end lines.
pub(crate) fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let (mut line, mut column) = (1, 1);
    let mut after_cr = false;
    for (_, c) in text.char_indices().take_while(|(i, _)| *i < offset) {
        match c {
            '\n' if after_cr => {}
            '\n' | '\r' => (line, column) = (line + 1, 1),
            _ => column += 1,
        }
        after_cr = c == '\r';
    }
    (line, column)
}
