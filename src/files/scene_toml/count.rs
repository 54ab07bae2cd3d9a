//! Counts as people write them: `4_456_448`, `4.5e6`, `2^22`.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::visible;

/// Largest count that is accepted: 2^48, about 2.8e14. At a million photons a second that is nine years.
pub const LARGEST_COUNT: u64 = 1 << 48;

/// What [`parse_count`] accepts, as a clause for a message.
pub const COUNT_REQUIRED: &str = "a whole number from 1 to 2^48, written like 4_456_448, 4.5e6 or 2^22";

/// Read a count of at least 1 and at most [`LARGEST_COUNT`], in one of three forms.
///
/// * digits, with `_` between digits: `4_456_448`;
/// * a decimal number whose value is whole: `4.5e6`, `1e3`, `250.0`;
/// * a power of whole numbers: `2^22`, `10^6`.
///
/// The value is exact: nothing is rounded.
///
/// # Errors
/// [`Kind::Syntax`] for text of no such form, [`Kind::Range`] for 0, a fraction or a negative number,
/// [`Kind::Limit`] above the cap. The diagnostic has no place.
pub fn parse_count(text: &str) -> Result<u64> {
    value(text.trim()).map_err(|(kind, why)| {
        let shown: String = text.chars().take(40).collect();
        let error = Diagnostic::new(kind, format!("`{}`{why}", visible(&shown)), COUNT_REQUIRED);
        match meant(text.trim()) {
            Some(meant) => error.hint(format!("write {meant}")),
            None => error,
        }
    })
}

/// The count that people mean by `4M`, or by `1,000,000` and `1 000 000`.
fn meant(text: &str) -> Option<String> {
    const LETTERS: [(char, u32); 6] = [('k', 3), ('K', 3), ('M', 6), ('m', 6), ('G', 9), ('T', 12)];
    let suffixed =
        LETTERS.iter().find_map(|(letter, zeros)| Some((text.strip_suffix(*letter)?.trim_end(), zeros)));
    let meant = match suffixed {
        Some((number, zeros)) if number.ends_with(|c: char| c.is_ascii_digit()) => {
            format!("{number}e{zeros}")
        }
        Some(_) => return None,
        None => {
            let groups: Vec<&str> = text.split([',', ' ', '\'', '\u{a0}', '\u{202f}']).collect();
            let of_three = groups.iter().skip(1).all(|group| group.len() == 3);
            (groups.len() > 1 && of_three).then(|| groups.join("_"))?
        }
    };
    value(&meant).is_ok().then_some(meant)
}

/// Why a text is no count: the class of the error, and what is said behind the text.
type Fault = (Kind, &'static str);

const NO_NUMBER: Fault = (Kind::Syntax, "");
const BELOW_ONE: Fault = (Kind::Range, "");
const FRACTION: Fault = (Kind::Range, ", which is not whole");
const HUGE: Fault = (Kind::Limit, ", which is more than 2^48");
const MISPLACED: Fault = (Kind::Syntax, ", where _ does not stand between two digits");

fn value(text: &str) -> Result<u64, Fault> {
    let pieces: Vec<&str> = text.split('_').collect();
    let digit = |c: char| c.is_ascii_digit();
    if pieces.windows(2).any(|w| !w[0].ends_with(digit) || !w[1].starts_with(digit)) {
        return Err(MISPLACED);
    }
    let plain = pieces.concat();
    if let Some(positive) = plain.strip_prefix('-') {
        return Err(if decimal(positive) == Err(NO_NUMBER) { NO_NUMBER } else { BELOW_ONE });
    }
    let value = match plain.split_once('^') {
        Some((base, exponent)) => power(base, exponent)?,
        None => decimal(plain.strip_prefix('+').unwrap_or(&plain))?,
    };
    match value {
        0 => Err(BELOW_ONE),
        1..=LARGEST_COUNT => Ok(value),
        _ => Err(HUGE),
    }
}

fn is_digits(text: &str) -> bool {
    !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit())
}

fn power(base: &str, exponent: &str) -> Result<u64, Fault> {
    if !is_digits(base) || !is_digits(exponent) {
        return Err(NO_NUMBER);
    }
    let base = base.parse::<u64>().map_err(|_| HUGE)?;
    if base <= 1 {
        let is_one = base == 1 || exponent.bytes().all(|b| b == b'0');
        return Ok(u64::from(is_one));
    }
    exponent.parse::<u32>().ok().and_then(|e| base.checked_pow(e)).ok_or(HUGE)
}

/// Digits, an optional fraction and an optional exponent; in integers, so that 1e15 + 1 stays itself.
fn decimal(text: &str) -> Result<u64, Fault> {
    let (mantissa, exponent) = text.split_once(['e', 'E']).unwrap_or((text, "0"));
    let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
    let digits = format!("{whole}{fraction}");
    let unsigned = exponent.strip_prefix(['+', '-']).unwrap_or(exponent);
    if !is_digits(&digits) || !is_digits(unsigned) {
        return Err(NO_NUMBER);
    }
    let significant = digits.trim_start_matches('0').trim_end_matches('0');
    if significant.is_empty() {
        return Ok(0);
    }
    let trailing = digits.len() - digits.trim_end_matches('0').len();
    let magnitude = unsigned.parse::<i64>().unwrap_or(i64::MAX / 4).min(i64::MAX / 4);
    let exponent = if exponent.starts_with('-') { -magnitude } else { magnitude };
    let zeros = exponent + trailing as i64 - fraction.len() as i64;
    if zeros < 0 {
        return Err(FRACTION);
    }
    let scale = u32::try_from(zeros).ok().and_then(|z| 10u64.checked_pow(z));
    significant.parse::<u64>().ok().zip(scale).and_then(|(s, f)| s.checked_mul(f)).ok_or(HUGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn accepted() {
        for (text, value) in [
            ("1", 1),
            ("4456448", 4_456_448),
            ("4_456_448", 4_456_448),
            (" 7 ", 7),
            ("+7", 7),
            ("007", 7),
            ("4.5e6", 4_500_000),
            ("4.5E+6", 4_500_000),
            ("4_500.0e3", 4_500_000),
            ("1000e-3", 1),
            ("250.0", 250),
            (".5e1", 5),
            ("5.", 5),
            ("2^22", 1 << 22),
            ("2^0", 1),
            ("10^6", 1_000_000),
            ("1^99999999999999999999", 1),
            ("2^48", 1 << 48),
            ("281474976710656", 1 << 48),
            ("100000000000001e0", 100_000_000_000_001),
        ] {
            assert_eq!(parse_count(text), Ok(value), "{text}");
        }
    }

    #[test]
    fn what_is_meant_is_told() {
        for (text, meant) in [
            ("4M", Some("write 4e6")),
            ("4.5 k", Some("write 4.5e3")),
            ("1,000,000", Some("write 1_000_000")),
            ("1 000", Some("write 1_000")),
            ("1,5", None),
            ("M", None),
            ("many", None),
            ("1e9T", None),
        ] {
            assert_eq!(parse_count(text).unwrap_err().advice(), meant, "{text}");
        }
    }

    #[test]
    fn refused() {
        let huge = "9".repeat(400);
        for (text, kind) in [
            ("", Kind::Syntax),
            ("many", Kind::Syntax),
            ("0x10", Kind::Syntax),
            ("nan", Kind::Syntax),
            ("inf", Kind::Syntax),
            ("-inf", Kind::Syntax),
            ("1e", Kind::Syntax),
            ("e5", Kind::Syntax),
            (".", Kind::Syntax),
            ("1.5.2", Kind::Syntax),
            ("2^", Kind::Syntax),
            ("^2", Kind::Syntax),
            ("2^-1", Kind::Syntax),
            ("2^2^2", Kind::Syntax),
            ("_1", Kind::Syntax),
            ("1_", Kind::Syntax),
            ("1__0", Kind::Syntax),
            ("1 000", Kind::Syntax),
            ("１", Kind::Syntax),
            ("0", Kind::Range),
            ("0e9", Kind::Range),
            ("0^5", Kind::Range),
            ("-3", Kind::Range),
            ("1.5", Kind::Range),
            ("1e-3", Kind::Range),
            ("1e-99999999999999999999", Kind::Range),
            ("2^49", Kind::Limit),
            ("281474976710657", Kind::Limit),
            ("1e15", Kind::Limit),
            ("1e99999999999999999999", Kind::Limit),
            ("3^99999999999999999999", Kind::Limit),
            (huge.as_str(), Kind::Limit),
        ] {
            let error = parse_count(text).expect_err(text);
            assert_eq!(error.kind(), kind, "{text}: {error}");
            assert_eq!(error.required(), COUNT_REQUIRED);
            assert!(error.found().chars().count() < 100, "{error}");
        }
    }
}
