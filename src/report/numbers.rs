//! Numbers and words as people read them, and text that is put together from them.

use std::fmt;

pub use crate::error::words::{grouped, names};

/// The text that `write` puts together. Writing to a String cannot fail.
pub fn written(write: impl FnOnce(&mut String) -> fmt::Result) -> String {
    let mut out = String::new();
    let _infallible = write(&mut out);
    out
}

/// A number with its error, rounded to two digits of the error.
pub fn with_error(value: f64, error: Option<f64>, unit: &str) -> String {
    match error {
        // Beyond what a number of lumens means: nine digits, and the error by itself.
        Some(e) if e > 0.0 && e < 1e-9 * value.abs() => {
            format!("{} +- {e:.1e} {unit} ({:.1e} %)", rounded(value, 9), 100.0 * e / value.abs())
        }
        Some(e) if e > 0.0 && value != 0.0 => {
            let magnitude = libm::floor(libm::log10(value.abs().max(e)));
            let is_plain = (-5.0..9.0).contains(&magnitude);
            // Else both numbers are in one power of ten.
            let exponent = if is_plain { 0.0 } else { magnitude };
            let power = libm::exp10(exponent);
            // Decimals so that two digits of the error show.
            let decimals = (1.0 + exponent - libm::floor(libm::log10(e))).clamp(0.0, 12.0) as usize;
            let both = format!("{:.decimals$} +- {:.decimals$}", value / power, e / power);
            let both = if is_plain { both } else { format!("({both})e{magnitude}") };
            format!("{both} {unit} ({} %)", rounded(100.0 * e / value.abs(), 2))
        }
        Some(e) if e > 0.0 => format!("0 +- {} {unit}", rounded(e, 2)),
        Some(_) => format!("{} +- 0 {unit}", digits(value)),
        None => format!("{} {unit}", digits(value)),
    }
}

/// Five significant digits without exponents where a person would write none.
pub fn digits(value: f64) -> String {
    rounded(value, 5)
}

/// So many significant digits, without exponents where a person would write none.
pub fn rounded(value: f64, significant: usize) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    let magnitude = libm::floor(libm::log10(value.abs()));
    if !(-5.0..9.0).contains(&magnitude) {
        return format!("{value:.*e}", significant.saturating_sub(1));
    }
    let decimals = (significant as f64 - 1.0 - magnitude).clamp(0.0, 12.0) as usize;
    let text = format!("{value:.decimals$}");
    if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.').to_string() } else { text }
}

/// A time in words.
pub fn duration(seconds: f64) -> String {
    match seconds {
        s if s >= 5400.0 => format!("{:.1} hours", s / 3600.0),
        s if s >= 90.0 => format!("{:.0} minutes", s / 60.0),
        s => format!("{s:.0} s"),
    }
}

/// A fraction in percent, with three significant digits.
pub fn percent(fraction: f64) -> String {
    rounded(100.0 * fraction, 3)
}

/// A measured value with three significant digits, whole numbers from 1000 on; "-" for NaN.
pub fn three_digits(value: f64) -> String {
    let size = value.abs();
    if value.is_nan() {
        "-".to_owned()
    } else if size == 0.0 {
        "0".to_owned()
    } else if !(1e-3..1e6).contains(&size) {
        format!("{value:.2e}")
    } else {
        // Rounding may carry into the next decade, so its exponent decides.
        let rounded: f64 = format!("{size:.2e}").parse().unwrap_or(size);
        let exponent = libm::floor(libm::log10(rounded)) as i32;
        format!("{value:.*}", usize::try_from(2 - exponent).unwrap_or(0))
    }
}

/// The shortest decimal that reads back as the same number, for CSV; empty where it is unknown or not finite.
pub fn bare(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or(String::new(), |v| v.to_string())
}

/// A text as a field of CSV (RFC 4180).
pub fn quoted(text: &str) -> String {
    if text.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

/// A line of a Markdown table.
pub fn piped(cells: impl IntoIterator<Item = impl AsRef<str>>) -> String {
    let cell = |c: &str| if c.is_empty() { " |".to_owned() } else { format!(" {c} |") };
    cells.into_iter().fold("|".to_owned(), |line, c| line + &cell(c.as_ref())) + "\n"
}

/// Text from a file: control characters must not reach a terminal.
pub fn printable(text: &str) -> String {
    text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_well() {
        assert_eq!(digits(0.0), "0");
        assert_eq!(digits(1234.5678), "1234.6");
        assert_eq!(digits(0.012_345_6), "0.012346");
        assert_eq!(digits(1e-9), "1.0000e-9");
        assert_eq!(digits(4.0), "4");
        assert_eq!(rounded(0.008_836_9, 2), "0.0088");
        assert_eq!(rounded(18.733, 3), "18.7");
        assert_eq!(with_error(123.456, Some(0.0123), "lm"), "123.456 +- 0.012 lm (0.01 %)");
        assert_eq!(with_error(0.0, Some(0.0123), "lm"), "0 +- 0.012 lm");
        assert_eq!(with_error(732.352_722_3, Some(7e-15), "cd"), "732.352722 +- 7.0e-15 cd (9.6e-16 %)");
        assert_eq!(with_error(5.0, None, "lx"), "5 lx");
        assert_eq!(with_error(1.479_27e-10, Some(3.52e-14), "lx"), "(1.47927 +- 0.00035)e-10 lx (0.024 %)");
        assert_eq!(with_error(2.530_35e14, Some(1.26e12), "lx"), "(2.530 +- 0.013)e14 lx (0.5 %)");
    }

    #[test]
    fn measured_values_have_three_digits() {
        for (value, text) in [
            (0.0, "0"),
            (12.345, "12.3"),
            (9.999, "10.0"),
            (1234.5, "1234"),
            (0.012_345, "0.0123"),
            (123_456_789.0, "1.23e8"),
            (-2.5, "-2.50"),
            (1e-5, "1.00e-5"),
        ] {
            assert_eq!(three_digits(value), text);
        }
        assert_eq!(three_digits(f64::NAN), "-");
    }

    #[test]
    fn foreign_text_reads_well() {
        assert_eq!(printable("a\u{1b}[31mb"), "a [31mb");
        assert_eq!(
            (bare(Some(0.25)), bare(Some(f64::NAN)), bare(None)),
            ("0.25".into(), "".into(), "".into())
        );
    }
}
