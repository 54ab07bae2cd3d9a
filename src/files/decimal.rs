//! Numbers as photometric files have them: decimals without exponents.

/// Significant digits that are written.
pub const DIGITS: usize = 9;

/// Values below this part of the largest are written as 0.
pub const LEAST_PART: f64 = 1e-12;

/// The number that is left of a value when it is written in [`DIGITS`] significant digits.
pub fn rounded(value: f64) -> f64 {
    format!("{value:.*e}", DIGITS - 1).parse().unwrap_or(value)
}

/// The values of a table as they are written.
pub fn rounded_table(values: &[f64]) -> Vec<f64> {
    let least = LEAST_PART * values.iter().copied().fold(0.0, f64::max);
    values.iter().map(|&value| if value < least { 0.0 } else { rounded(value) }).collect()
}

/// A rounded number as text, which reads back as the same number.
pub fn text(value: f64) -> String {
    // Rust writes the shortest decimal that reads back, never an exponent; plus zero: no -0.
    format!("{}", rounded(value) + 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nine_digits_and_no_exponents() {
        for (value, expected) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1071.874, "1071.874"),
            (1.0 / 3.0, "0.333333333"),
            (2e6 / 3.0, "666666.667"),
            (1.23456789876e12, "1234567900000"),
            (1.5e-9, "0.0000000015"),
            (-0.1 - 0.2, "-0.3"),
            (1e30, "1000000000000000000000000000000"),
        ] {
            assert_eq!(text(value), expected);
            assert_eq!(text(value).parse::<f64>().unwrap(), rounded(value));
            assert!((rounded(value) - value).abs() <= 5e-9 * value.abs());
        }
        assert_eq!(rounded_table(&[1.0, 2e-12, 0.5e-12]), [1.0, 2e-12, 0.0]);
    }
}
