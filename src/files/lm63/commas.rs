//! Decimal commas: in LM-63 a comma parts two numbers, but some programs write 298,8584 for 298.8584.

use crate::error::{Diagnostic, Kind};
use crate::files::excerpt::{line_column, quoted};

/// Numbers from the lamps to the watts.
const BEFORE_ANGLES: usize = 13;
/// Places of the counts of angles among them.
const COUNTS: [usize; 2] = [3, 4];

/// The refusal of a text from byte `body` on whose numbers are what its counts ask for only if blanks alone part them, and
/// commas stand within numbers. Only asked of a text that does not read as it stands, or has numbers left over.
pub(crate) fn refusal(text: &str, body: usize, has_tilt_table: bool) -> Option<Diagnostic> {
    let words = || text[body..].split_ascii_whitespace().map(|word| word.trim_matches(','));
    let number = |i: usize| words().nth(i).and_then(value);
    let skipped = if has_tilt_table { 2 + 2 * count(number(1)?)? } else { 0 };
    let [n_v, n_h] = COUNTS.map(|i| number(skipped + i).and_then(count));
    let (n_v, n_h) = (n_v?, n_h?);
    let needed = n_v.checked_mul(n_h)?.checked_add(skipped + BEFORE_ANGLES + n_v + n_h)?;
    let numbers = words().take(needed).take_while(|word| value(word).is_some());
    let (mut have, mut first) = (0, None);
    for word in numbers {
        have += 1;
        first = first.or(word.contains(',').then_some(word));
    }
    let word = first.filter(|_| have == needed)?;
    let (line, column) = line_column(text, word.as_ptr() as usize - text.as_ptr() as usize);
    let found = format!("{} among numbers that are parted by blanks", quoted(word));
    let required = "decimal points: in LM-63 a comma parts two numbers";
    let hint = "a decimal comma? write 12.5 for 12,5 (and 1250 for 1,250) in the whole file";
    Some(Diagnostic::new(Kind::Syntax, found, required).at(line, column).hint(hint))
}

/// The value of a word whose commas are part of its number: one for the decimal point, or between groups of digits.
fn value(word: &str) -> Option<f64> {
    let digits = |c: Option<u8>| c.is_some_and(|c| c.is_ascii_digit());
    let bytes = word.as_bytes();
    let within = |(i, _)| digits(bytes.get(i + 1).copied()) && i > 0 && digits(bytes.get(i - 1).copied());
    if !word.match_indices(',').all(within) {
        return None;
    }
    let as_point =
        if word.matches(',').count() == 1 { word.replace(',', ".") } else { word.replace(',', "") };
    let number = as_point.parse().or_else(|_| word.replace(',', "").parse::<f64>()).ok()?;
    number.is_finite().then_some(number)
}

/// A whole number that some file could have so many of.
fn count(number: f64) -> Option<usize> {
    (number >= 1.0 && number.fract() == 0.0 && number < 1e9).then_some(number as usize)
}
