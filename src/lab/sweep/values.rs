//! The values that a swept key takes: `FROM:TO:STEP`, or a list `a,b,c`.
//!
//! Numbers are decimals, not doubles: 0:1:0.1 has eleven values, the fourth is 0.3, and a scene that says 0.3 is the same scene.

use crate::error::{Diagnostic, Kind, Result};

/// Most points of a sweep.
pub const MOST_POINTS: usize = 10_000;

const REQUIRED: &str = "FROM:TO:STEP such as 1:3:0.5, or a list such as 1,1.5,3";

/// A value.
#[derive(Debug, Clone, PartialEq)]
pub struct Value {
    /// As TOML has it: a number, true or false, a text in quotes.
    pub toml: String,
    /// As tables have it: without the quotes.
    pub shown: String,
    /// Its number, where it is one.
    pub number: Option<f64>,
}

/// The values that a text says.
///
/// # Errors
/// A text of neither form; a step that is 0 or leads away from the end; a value twice; more than [`MOST_POINTS`].
pub fn parse(text: &str) -> Result<Vec<Value>> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    // A path of Windows is no range.
    let is_range = parts.len() > 1 && (parts[0].is_empty() || parts[0].starts_with(is_numeric));
    if is_range {
        return range(&parts);
    }
    let values: Vec<Value> = text.split(',').map(|item| value(item.trim())).collect::<Result<_>>()?;
    match (1..values.len()).find(|i| values[..*i].contains(&values[*i])) {
        Some(again) => {
            let found = format!("the value {} twice", values[again].shown);
            Err(Diagnostic::new(Kind::Range, found, "every value once"))
        }
        None if values.len() > MOST_POINTS => Err(too_many(values.len() as i128)),
        None => Ok(values),
    }
}

/// That there are this many points.
pub(super) fn too_many(points: i128) -> Diagnostic {
    let found = format!("{points} points");
    Diagnostic::new(Kind::Limit, found, format!("at most {MOST_POINTS} points in all"))
}

fn is_numeric(c: char) -> bool {
    c.is_ascii_digit() || "+-.".contains(c)
}

fn value(item: &str) -> Result<Value> {
    if item.is_empty() {
        return Err(Diagnostic::new(Kind::Syntax, "an empty value", REQUIRED));
    }
    Ok(match (Decimal::parse(item), item) {
        (Some(number), _) => number.value(),
        (None, "true" | "false") => Value { toml: item.into(), shown: item.into(), number: None },
        (None, _) => Value { toml: quoted(item), shown: item.into(), number: None },
    })
}

/// A text as TOML writes it.
fn quoted(text: &str) -> String {
    let escaped = |c: char| match c {
        '"' | '\\' => format!("\\{c}"),
        c if c.is_control() => format!("\\u{:04X}", c as u32),
        c => c.to_string(),
    };
    format!("\"{}\"", text.chars().map(escaped).collect::<String>())
}

fn range(parts: &[&str]) -> Result<Vec<Value>> {
    let &[from, to, step] = parts else {
        return Err(Diagnostic::new(Kind::Syntax, format!("a range of {} numbers", parts.len()), REQUIRED));
    };
    let number = |text: &str| {
        let found = format!("`{text}`, which is no decimal number");
        Decimal::parse(text).ok_or_else(|| Diagnostic::new(Kind::Syntax, found, REQUIRED))
    };
    let numbers = [number(from)?, number(to)?, number(step)?];
    let exponent = numbers.iter().map(|n| n.exponent).min().unwrap_or(0);
    let scaled = |n: &Decimal| {
        let found = "numbers of too different sizes for exact steps";
        n.at(exponent).ok_or_else(|| {
            Diagnostic::new(Kind::Range, found, "at most 38 digits from the first to the last")
        })
    };
    let [from, to, step] = [scaled(&numbers[0])?, scaled(&numbers[1])?, scaled(&numbers[2])?];
    let span = to - from;
    let wrong = |found: &str| Err(Diagnostic::new(Kind::Range, found, "a step that leads from FROM to TO"));
    if step == 0 {
        return wrong("a step of 0");
    }
    if span.signum() * step.signum() < 0 {
        return wrong("a step that leads away from the end");
    }
    let count = span / step + 1;
    if count > MOST_POINTS as i128 {
        return Err(too_many(count));
    }
    Ok((0..count).map(|i| Decimal { digits: from + i * step, exponent }.value()).collect())
}

/// digits times a power of ten.
#[derive(Debug, Clone, Copy)]
struct Decimal {
    digits: i128,
    exponent: i32,
}

impl Decimal {
    /// A number as people and TOML write it; `None` for another text, and for more digits than a double tells apart twice over.
    fn parse(text: &str) -> Option<Self> {
        const MOST_DIGITS: usize = 34;
        const LARGEST_EXPONENT: i32 = 300;
        let (mantissa, exponent) = match text.split_once(['e', 'E']) {
            Some((mantissa, exponent)) => (mantissa, exponent.parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (whole, part) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let unsigned = whole.strip_prefix(['+', '-']).unwrap_or(whole);
        let digits = format!("{unsigned}{part}");
        let is_good = !digits.is_empty()
            && digits.len() <= MOST_DIGITS
            && digits.bytes().all(|b| b.is_ascii_digit())
            && exponent.abs() <= LARGEST_EXPONENT;
        let number: i128 = is_good.then(|| digits.parse().ok())??;
        let digits = if whole.starts_with('-') { -number } else { number };
        Some(Self { digits, exponent: exponent - part.len() as i32 })
    }

    /// The digits at another exponent, which is not larger.
    fn at(&self, exponent: i32) -> Option<i128> {
        if self.digits == 0 {
            return Some(0);
        }
        let power = 10_i128.checked_pow(u32::try_from(self.exponent - exponent).ok()?)?;
        // A factor of four of room: differences and sums of two must not overflow.
        self.digits.checked_mul(power).filter(|scaled| scaled.unsigned_abs() < 1 << 125)
    }

    fn value(self) -> Value {
        let shown = self.written();
        Value { toml: shown.clone(), number: shown.parse().ok(), shown }
    }

    /// Without zeros at its end, and without an exponent where a person would write none.
    fn written(self) -> String {
        const PLAIN: std::ops::RangeInclusive<i32> = -12..=15;
        let Self { mut digits, mut exponent } = self;
        if digits == 0 {
            return "0".to_string();
        }
        while digits % 10 == 0 {
            (digits, exponent) = (digits / 10, exponent + 1);
        }
        let sign = if digits < 0 { "-" } else { "" };
        let all = digits.unsigned_abs().to_string();
        if !PLAIN.contains(&exponent) {
            return format!("{sign}{all}e{exponent}");
        }
        if exponent >= 0 {
            return format!("{sign}{all}{}", "0".repeat(exponent as usize));
        }
        let places = exponent.unsigned_abs() as usize;
        let padded = format!("{all:0>width$}", width = places + 1);
        let (whole, part) = padded.split_at(padded.len() - places);
        format!("{sign}{whole}.{part}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shown(text: &str) -> Vec<String> {
        parse(text).unwrap().into_iter().map(|value| value.shown).collect()
    }

    #[test]
    fn steps_are_exact_and_the_end_is_among_them() {
        for (text, values) in [
            ("1:3:0.5", &["1", "1.5", "2", "2.5", "3"][..]),
            ("3:1:-1", &["3", "2", "1"]),
            ("0:0.3:0.1", &["0", "0.1", "0.2", "0.3"]),
            ("-0.01:0.01:0.01", &["-0.01", "0", "0.01"]),
            ("1:2:0.4", &["1", "1.4", "1.8"]),
            ("5:5:1", &["5"]),
            ("1e-3:2e-3:.5e-3", &["0.001", "0.0015", "0.002"]),
            ("1e20:3e20:1e20", &["1e20", "2e20", "3e20"]),
            ("10:1000:495", &["10", "505", "1000"]),
        ] {
            assert_eq!(shown(text), values, "{text}");
        }
        // A sum of ten tenths in doubles misses 1.
        assert_eq!(shown("0:1:0.1").len(), 11);
        assert_eq!(parse("0:1:0.1").unwrap()[3].number, Some(0.3));
        assert_eq!(shown("1:10000:1").len(), 10_000);
    }

    #[test]
    fn lists_are_numbers_and_words() {
        let of = |text: &str| parse(text).unwrap().into_iter().map(|v| v.toml).collect::<Vec<_>>();
        assert_eq!(of("1, 1.50,-.5,2e3"), ["1", "1.5", "-0.5", "2000"]);
        assert_eq!(of("glass,true,a\"b\\"), ["\"glass\"", "true", "\"a\\\"b\\\\\""]);
        assert_eq!(of("2^20"), ["\"2^20\""]);
        assert_eq!(of("C:/a.ies,nan"), ["\"C:/a.ies\"", "\"nan\""]);
        assert_eq!(parse("glass").unwrap()[0].number, None);
    }

    #[test]
    fn what_is_no_range_and_no_list_is_refused() {
        for (text, found) in [
            ("", "an empty value"),
            ("1,,2", "an empty value"),
            ("1:3", "a range of 2 numbers"),
            ("1:2:3:4", "a range of 4 numbers"),
            ("1:x:1", "`x`, which is no decimal number"),
            ("1:inf:1", "`inf`"),
            ("1:3:nan", "`nan`"),
            (":3:1", "``"),
            ("1:3:0", "a step of 0"),
            ("1:3:-1", "leads away"),
            ("3:1:1", "leads away"),
            ("0:1:1e-4", "10001 points"),
            ("0:1e30:1e-20", "too different sizes"),
            ("1,2,1.0", "the value 1 twice"),
            ("a,b,a", "the value a twice"),
        ] {
            let error = parse(text).unwrap_err();
            assert!(error.found().contains(found), "{text}: {error}");
        }
    }
}
