//! How the numbers of a study are written for people, and the marks that go with them.

use crate::lab::study::fit::{Prediction, Uncertainty};
use crate::lab::study::results::{Study, VariantResult};
use crate::lab::study::table::{Row, Table, Trend};
use crate::report::numbers::three_digits;

/// Marks behind numbers; the footnotes say what they mean.
#[derive(Debug, Clone, Copy)]
pub struct Marks {
    /// An error that the reference limits.
    pub limited: &'static str,
    /// A number from beyond the measured range.
    pub extrapolated: &'static str,
    /// A standard error from the residuals of one seed.
    pub one_seed: &'static str,
}

/// For a terminal.
pub const ASCII: Marks = Marks { limited: "*", extrapolated: "~", one_seed: "^" };

/// For Markdown, where those would be markup.
pub const DAGGERS: Marks = Marks { limited: "†", extrapolated: "‡", one_seed: "§" };

/// What stands where a number is unknown.
pub const UNKNOWN: &str = "-";

impl Marks {
    /// nRMS in per cent, with its spread where that is known, both to two digits of the spread, but no more than four of
    /// the error.
    pub fn error(&self, row: &Row) -> String {
        let mark = if row.limited_by_reference { self.limited } else { "" };
        let error = 100.0 * row.errors.nrms;
        match row.nrms_spread.map(|spread| 100.0 * spread) {
            Some(spread) if spread > 0.0 => {
                let until_digit = |value: f64, digit: f64| digit - 1.0 - libm::floor(libm::log10(value));
                let decimals = until_digit(spread, 2.0).min(until_digit(error, 4.0)).clamp(0.0, 9.0) as usize;
                format!("{error:.decimals$} +- {spread:.decimals$}{mark}")
            }
            _ => format!("{}{mark}", three_digits(error)),
        }
    }

    /// The exponent of N with its standard error.
    pub fn rate(&self, trend: &Trend) -> String {
        let Some(law) = trend.law else { return UNKNOWN.to_owned() };
        let limited = if trend.limited_by_reference { self.limited } else { "" };
        let mark = if law.uncertainty == Uncertainty::Residuals { self.one_seed } else { "" };
        match law.rate_standard_error {
            Some(error) => format!("{:.3} +- {error:.3}{mark}{limited}", law.rate),
            None => format!("{:.3}{limited}", law.rate),
        }
    }

    /// A predicted number, three digits.
    pub fn prediction(&self, prediction: Option<Prediction>) -> String {
        prediction.map_or(UNKNOWN.to_owned(), |p| {
            let mark = if p.extrapolated { self.extrapolated } else { "" };
            format!("{}{mark}", three_digits(p.value))
        })
    }
}

/// What a table says of one variant at one N on one grid.
pub struct Line<'a> {
    /// The variant.
    pub variant: &'a VariantResult,
    /// Its errors.
    pub row: &'a Row,
    /// How they fall.
    pub trend: &'a Trend,
    /// Millions of photons a CPU second.
    pub speed: Option<f64>,
    /// The error of `mc` over its own by the paper.
    pub paper: Option<f64>,
}

/// A column of such a table: its head, and what stands in it.
pub type Column = (&'static str, fn(&Line<'_>) -> String);

/// Heads and entries of a table; columns of the paper only where it says something about the scene.
pub fn filled(
    columns: &[Column],
    study: &Study,
    table: &Table,
    photons: u64,
    grid: usize,
) -> (Vec<&'static str>, Vec<Vec<String>>) {
    let shown = || columns.iter().filter(|(head, _)| study.is_of_paper() || !head.contains("paper"));
    let lines = study.variants.iter().enumerate().filter_map(|(v, variant)| {
        let paper = study.paper_ratio(&variant.name);
        let (trend, speed) = (&table.trends[v][grid], table.photons_per_cpu_s[v].map(|s| s / 1e6));
        table.row(v, photons, grid).map(|row| Line { variant, row, trend, speed, paper })
    });
    let body = lines.map(|line| shown().map(|(_, entry)| entry(&line)).collect()).collect();
    (shown().map(|(head, _)| *head).collect(), body)
}

/// A ratio of the paper, two digits behind the point.
pub fn of_paper(ratio: Option<f64>) -> String {
    ratio.map_or(UNKNOWN.to_owned(), |ratio| format!("{ratio:.2}"))
}

/// Three digits, or [`UNKNOWN`].
pub fn known(value: Option<f64>) -> String {
    value.filter(|v| v.is_finite()).map_or(UNKNOWN.to_owned(), three_digits)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::study::norms::Errors;

    #[test]
    fn numbers_read_well() {
        let errors = Errors { relative_rms: 0.1, nrms: 0.025_134, relative_l1: 0.1 };
        let mut row = Row {
            variant: 0,
            photons: 1,
            grid: 0,
            errors,
            nrms_spread: Some(0.000_213),
            cpu_s: 1.0,
            coordinates: 3.0,
            ratio_equal_n: None,
            ratio_equal_time: None,
            limited_by_reference: false,
        };
        assert_eq!(ASCII.error(&row), "2.513 +- 0.021");
        row.nrms_spread = Some(1e-12);
        assert_eq!(ASCII.error(&row), "2.513 +- 0.000");
        row.limited_by_reference = true;
        row.nrms_spread = None;
        assert_eq!(ASCII.error(&row), "2.51*");
        assert_eq!(DAGGERS.prediction(Some(Prediction { value: 56.12, extrapolated: true })), "56.1‡");
        assert_eq!(
            (known(None), known(Some(f64::NAN)), known(Some(3.0))),
            ("-".into(), "-".into(), "3.00".into())
        );
    }
}
