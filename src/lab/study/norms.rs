//! How far one map of illuminance is from another (METHOD 6): three norms over cells, and the reference's own error.
//!
//! E is the estimated, E* the reference illuminance of a cell, A its area; sums go over all cells of all receivers.

use serde::{Deserialize, Serialize};

use crate::error::{Diagnostic, Kind, Result};

/// The error of one map in three norms, as fractions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Errors {
    /// See [`relative_rms`].
    pub relative_rms: f64,
    /// See [`nrms`].
    pub nrms: f64,
    /// See [`relative_l1`].
    pub relative_l1: f64,
}

impl Errors {
    /// All three norms of an estimate against the reference, lx and m2, cell by cell.
    ///
    /// # Errors
    /// [`Kind::Range`] when the numbers of cells differ, or the reference has no light or none that is finite.
    pub fn of(estimate_lx: &[f64], reference_lx: &[f64], areas_m2: &[f64]) -> Result<Self> {
        if estimate_lx.len() != reference_lx.len() || areas_m2.len() != reference_lx.len() {
            let found =
                format!("{} cells against {} of the reference", estimate_lx.len(), reference_lx.len());
            return Err(Diagnostic::new(Kind::Range, found, "maps of the same cells"));
        }
        let mean = mean_lx(reference_lx, areas_m2);
        if !(mean > 0.0 && mean.is_finite()) {
            let found = format!("a reference of {mean} lx on average");
            return Err(Diagnostic::new(
                Kind::Range,
                found,
                "light on the receivers: errors are relative to it",
            ));
        }
        Ok(Self {
            relative_rms: relative_rms(estimate_lx, reference_lx, areas_m2),
            nrms: nrms(estimate_lx, reference_lx, areas_m2),
            relative_l1: relative_l1(estimate_lx, reference_lx, areas_m2),
        })
    }
}

/// sqrt( sum A (E - E*)^2 / sum A E*^2 ); NaN without light.
pub fn relative_rms(estimate_lx: &[f64], reference_lx: &[f64], areas_m2: &[f64]) -> f64 {
    let light = sum(reference_lx, areas_m2, |e| e * e);
    (squared_difference(estimate_lx, reference_lx, areas_m2) / light).sqrt()
}

/// Root mean square of E - E* over the mean of E*, both means weighted by area; NaN without light.
pub fn nrms(estimate_lx: &[f64], reference_lx: &[f64], areas_m2: &[f64]) -> f64 {
    let squared = squared_difference(estimate_lx, reference_lx, areas_m2) / areas_m2.iter().sum::<f64>();
    squared.sqrt() / mean_lx(reference_lx, areas_m2)
}

/// sum A |E - E*| / sum A E*; NaN without light.
pub fn relative_l1(estimate_lx: &[f64], reference_lx: &[f64], areas_m2: &[f64]) -> f64 {
    let difference: f64 =
        estimate_lx.iter().zip(reference_lx).zip(areas_m2).map(|((e, r), a)| a * (e - r).abs()).sum();
    difference / sum(reference_lx, areas_m2, |e| e)
}

/// nRMS to expect of the mean of R replicates against the truth: sqrt( sum A s^2 / R / sum A ) over the mean, s^2 the
/// variance of a cell over the replicates with R - 1 degrees of freedom.
///
/// `sum_lx` and `square_lx2` hold a cell's sum and sum of squares over the replicates. `None` for fewer than two
/// replicates or without light.
pub fn nrms_of_mean(sum_lx: &[f64], square_lx2: &[f64], areas_m2: &[f64], replicates: u32) -> Option<f64> {
    if replicates < 2 {
        return None;
    }
    let r = f64::from(replicates);
    let mean = mean_lx(sum_lx, areas_m2) / r;
    let variance: f64 = sum_lx
        .iter()
        .zip(square_lx2)
        .zip(areas_m2)
        // Where all replicates agree, rounding may leave less than nothing.
        .map(|((sum, square), area)| area * (square - sum * sum / r).max(0.0) / (r - 1.0) / r)
        .sum();
    let error = (variance / areas_m2.iter().sum::<f64>()).sqrt() / mean;
    error.is_finite().then_some(error)
}

fn mean_lx(illuminance_lx: &[f64], areas_m2: &[f64]) -> f64 {
    sum(illuminance_lx, areas_m2, |e| e) / areas_m2.iter().sum::<f64>()
}

fn squared_difference(estimate_lx: &[f64], reference_lx: &[f64], areas_m2: &[f64]) -> f64 {
    estimate_lx.iter().zip(reference_lx).zip(areas_m2).map(|((e, r), a)| a * (e - r) * (e - r)).sum()
}

fn sum(illuminance_lx: &[f64], areas_m2: &[f64], of: impl Fn(f64) -> f64) -> f64 {
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
        // Two cells, three replicates: 1 2 3 and 4 4 7. Variances 1 and 3, of the means 1/3 and 1; means 2 and 5.
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
    fn without_light_or_with_other_cells_there_is_a_message() {
        for (estimate, reference) in [(&[1.0, 2.0][..], &[0.0, 0.0][..]), (&[1.0], &[1.0, 2.0])] {
            let error = Errors::of(estimate, reference, &[1.0, 1.0]).unwrap_err();
            assert_eq!(error.kind(), Kind::Range);
        }
        assert!(Errors::of(&[1.0], &[f64::NAN], &[1.0]).is_err());
        assert!(Errors::of(&[], &[], &[]).is_err());
    }
}
