//! How far one map of illuminance is from another (METHOD 6): three norms over cells, and the reference's own
//! error.
//!
//! E is the estimated, E* the reference illuminance of a cell, A its area; sums go over all cells of all
//! receivers.

use serde::{Deserialize, Serialize};

use crate::error::{Diagnostic, Kind, Result};

/// The error of one map in three norms, as fractions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// sqrt( sum A (E - E*)^2 / sum A E*^2 ).
    pub relative_rms: f64,
    /// Root mean square of E - E* over the mean of E*, both means weighted by area.
    pub nrms: f64,
    /// sum A |E - E*| / sum A E*.
    pub relative_l1: f64,
}

impl Errors {
    /// All three norms of an estimate against the reference, lx and m2, cell by cell.
    ///
    /// # Errors
    /// [`Kind::Range`] when the numbers of cells differ, or the reference has no light or none that is
    /// finite.
    pub fn of(estimate_lx: &[f64], reference_lx: &[f64], areas_m2: &[f64]) -> Result<Self> {
        let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
        let (estimates, references) = (estimate_lx.len(), reference_lx.len());
        if estimates != references || areas_m2.len() != references {
            let found = format!("{estimates} cells against {references} of the reference");
            return fail(found, "maps of the same cells");
        }
        let area_m2 = areas_m2.iter().sum::<f64>();
        let light = weighted_sum(reference_lx, areas_m2, |e| e);
        let mean = light / area_m2;
        if !(mean > 0.0 && mean.is_finite()) {
            let found = format!("a reference of {mean} lx on average");
            return fail(found, "light on the receivers: errors are relative to it");
        }
        let cells = || estimate_lx.iter().zip(reference_lx).zip(areas_m2);
        let squares: f64 = cells().map(|((e, r), a)| a * (e - r) * (e - r)).sum();
        let sizes: f64 = cells().map(|((e, r), a)| a * (e - r).abs()).sum();
        Ok(Self {
            relative_rms: (squares / weighted_sum(reference_lx, areas_m2, |e| e * e)).sqrt(),
            nrms: (squares / area_m2).sqrt() / mean,
            relative_l1: sizes / light,
        })
    }

    /// Over seeds: root mean square of `relative_rms` and `nrms`, mean of `relative_l1`; beside them the
    /// standard deviation of `nrms`.
    pub fn over_seeds(seeds: &[Self]) -> (Self, Option<f64>) {
        let of = |norm: fn(&Self) -> f64| seeds.iter().map(norm).collect::<Vec<f64>>();
        let nrms = of(|e| e.nrms);
        let errors = Self {
            relative_rms: root_mean_square(&of(|e| e.relative_rms)),
            nrms: root_mean_square(&nrms),
            relative_l1: of(|e| e.relative_l1).iter().sum::<f64>() / seeds.len() as f64,
        };
        (errors, mean_and_variance(&nrms).1.map(f64::sqrt))
    }
}

/// nRMS to expect of the mean of R replicates against the truth: sqrt( sum A s^2 / R / sum A ) over the mean,
/// s^2 the variance of a cell over the replicates with R - 1 degrees of freedom.
///
/// `sum_lx` and `square_lx2` hold a cell's sum and sum of squares over the replicates ([`moments`]). `None`
/// for fewer than two replicates or without light.
pub(crate) fn nrms_of_mean(
    sum_lx: &[f64],
    square_lx2: &[f64],
    areas_m2: &[f64],
    replicates: usize,
) -> Option<f64> {
    let r = replicates as f64;
    let area_m2 = areas_m2.iter().sum::<f64>();
    let mean = weighted_sum(sum_lx, areas_m2, |e| e) / area_m2 / r;
    let variance: f64 = sum_lx
        .iter()
        .zip(square_lx2)
        .zip(areas_m2)
        // Where all replicates agree, rounding may leave less than nothing.
        .map(|((sum, square), area)| area * (square - sum * sum / r).max(0.0) / (r - 1.0) / r)
        .sum();
    let error = (variance / area_m2).sqrt() / mean;
    (replicates > 1 && error.is_finite()).then_some(error)
}

/// Sums over maps of each cell's value and of its square; `value` of a map and a cell.
pub(crate) fn moments(cells: usize, maps: usize, value: impl Fn(usize, usize) -> f64) -> [Vec<f64>; 2] {
    let sums = |of: fn(f64) -> f64| {
        (0..cells).map(|cell| (0..maps).map(|map| of(value(map, cell))).sum::<f64>()).collect()
    };
    [sums(|e| e), sums(|e| e * e)]
}

/// Mean, and variance with n - 1 degrees of freedom where there are two values or more.
pub(crate) fn mean_and_variance(values: &[f64]) -> (f64, Option<f64>) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let squares: f64 = values.iter().map(|v| (v - mean) * (v - mean)).sum();
    (mean, (values.len() > 1).then(|| squares / (n - 1.0)))
}

/// sqrt of the mean of the squares; NaN of nothing.
pub(crate) fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len() as f64).sqrt()
}

fn weighted_sum(illuminance_lx: &[f64], areas_m2: &[f64], of: impl Fn(f64) -> f64) -> f64 {
    illuminance_lx.iter().zip(areas_m2).map(|(e, a)| a * of(*e)).sum()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn norms_are_those_computed_by_hand() {
        // Differences 1, -2, 3 on areas 1, 1, 2: A d^2 = 1 + 4 + 18 = 23, A E*^2 = 100 + 400 + 1800 = 2300,
        // A |d| = 1 + 2 + 6 = 9, A E* = 10 + 20 + 60 = 90, mean 22.5.
        let (reference, areas) = ([10.0, 20.0, 30.0], [1.0, 1.0, 2.0]);
        let errors = Errors::of(&[11.0, 18.0, 33.0], &reference, &areas).unwrap();
        assert!((errors.relative_rms - 0.1).abs() < 1e-15);
        assert!((errors.nrms - 5.75_f64.sqrt() / 22.5).abs() < 1e-15);
        assert!((errors.relative_l1 - 0.1).abs() < 1e-15);
        let same = Errors::of(&reference, &reference, &areas).unwrap();
        assert_eq!(same, Errors { relative_rms: 0.0, nrms: 0.0, relative_l1: 0.0 });
    }

    #[test]
    fn the_error_of_a_mean_of_replicates_is_that_of_the_textbook() {
        // Two cells, three replicates: 1 2 3 and 4 4 7. Variances 1 and 3, of the means 1/3 and 1; means 2
        // and 5.
        let (sums, squares) = ([6.0, 15.0], [14.0, 81.0]);
        let error = nrms_of_mean(&sums, &squares, &[1.0, 3.0], 3).unwrap();
        let by_hand = ((1.0 / 3.0 + 3.0 * 1.0) / 4.0_f64).sqrt() / ((2.0 + 15.0) / 4.0);
        assert!((error - by_hand).abs() < 1e-15, "{error} {by_hand}");
        assert_eq!(nrms_of_mean(&sums, &squares, &[1.0, 3.0], 1), None);
        assert_eq!(nrms_of_mean(&[0.0], &[0.0], &[1.0], 4), None);
        // 0.1 three times: the squares' rounding must not give the root of a negative number.
        let equal = nrms_of_mean(&[0.1 + 0.1 + 0.1], &[3.0 * (0.1 * 0.1)], &[1.0], 3).unwrap();
        assert!((0.0..1e-7).contains(&equal), "{equal}");
    }

    #[test]
    fn deviations_are_those_computed_by_hand() {
        assert_eq!(mean_and_variance(&[1.0, 3.0]), (2.0, Some(2.0)));
        assert_eq!(mean_and_variance(&[1.0]), (1.0, None));
        let seed = |e: f64| Errors { relative_rms: 2.0 * e, nrms: e, relative_l1: 3.0 * e };
        let (errors, spread) = Errors::over_seeds(&[seed(3.0), seed(4.0)]);
        let expected = Errors { relative_rms: 50.0_f64.sqrt(), nrms: 12.5_f64.sqrt(), relative_l1: 10.5 };
        assert_eq!((errors, spread), (expected, Some(0.5_f64.sqrt())));
        assert_eq!(
            moments(2, 3, |map, cell| (map * 10 + cell) as f64),
            [vec![30.0, 33.0], vec![500.0, 563.0]]
        );
    }

    #[test]
    fn without_light_or_with_other_cells_there_is_a_message() {
        for (estimate, reference) in [(&[1.0, 2.0][..], &[0.0, 0.0][..]), (&[1.0], &[1.0, 2.0])] {
            let error = Errors::of(estimate, reference, &[1.0, 1.0]).unwrap_err();
            assert_eq!(error.kind(), Kind::Range);
        }
        assert!(Errors::of(&[1.0], &[f64::NAN], &[1.0]).is_err());
        assert!(Errors::of(&[], &[], &[]).is_err());
    }
}
