//! The difference of two scenes that were traced by the same points.
//!
//! Replicate r of both has the same randomisation, so its difference d_r is one draw of the difference, and the R of them are
//! independent: the sum has the standard error sqrt(R s^2), s^2 the variance of the d_r with R - 1 degrees of freedom (METHOD 7).
//! Nothing is assumed of how alike the scenes are; the more alike, the smaller s.

use crate::estimate::replicates::FEWEST_HITS;

use super::figures::{Counted, Figure};

/// A figure less that of the neighbour.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// The difference.
    pub value: f64,
    /// Its standard error from the replicates' differences; `None` where the figure is no count (an extreme), for one replicate and
    /// for different numbers of them.
    pub standard_error: Option<f64>,
    /// The standard error that it would have if the two runs were independent.
    pub independent: Option<f64>,
}

impl Difference {
    /// Of the same figure of two scenes; `None` where one of them is not known.
    pub fn new(figure: &Figure, before: &Figure) -> Option<Self> {
        let errors = figure.standard_error.zip(before.standard_error);
        let paired =
            figure.counted.as_ref().zip(before.counted.as_ref()).and_then(|(a, b)| paired_error(a, b));
        Some(Self {
            value: figure.value? - before.value?,
            standard_error: paired,
            independent: errors.map(|(a, b)| libm::hypot(a, b)),
        })
    }

    /// How many times the error of independent runs is as large.
    pub fn ratio(&self) -> Option<f64> {
        Some(self.independent? / self.standard_error?)
    }
}

/// From the spread of the replicates' differences, but no less than one photon, as of a total; where fewer than ten photons are
/// counted in one scene and not in the other, no less than counting's.
fn paired_error(a: &Counted, b: &Counted) -> Option<f64> {
    let replicates = a.by_replicate.len();
    if replicates < 2 || b.by_replicate.len() != replicates {
        return None;
    }
    let pairs = || a.by_replicate.iter().zip(&b.by_replicate);
    // The integers first: of two scenes of equal flux the difference of the counts is exact.
    let differences: Vec<f64> = if a.photon == b.photon {
        pairs().map(|(a, b)| *a as f64 - *b as f64).map(|d| a.photon * d).collect()
    } else {
        pairs().map(|(n, m)| a.photon * *n as f64 - b.photon * *m as f64).collect()
    };
    let r = replicates as f64;
    let mean = differences.iter().sum::<f64>() / r;
    let squares: f64 = differences.iter().map(|d| (d - mean).powi(2)).sum();
    let changed: u64 = pairs().map(|(a, b)| a.abs_diff(*b)).sum();
    let least = if changed < FEWEST_HITS { libm::sqrt((changed + 1) as f64) } else { 1.0 };
    Some(libm::sqrt(r / (r - 1.0) * squares).max(least * a.photon.max(b.photon)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figure(photon: f64, by_replicate: &[u64], standard_error: f64) -> Figure {
        let value = Some(photon * by_replicate.iter().sum::<u64>() as f64);
        let counted = Some(Counted { photon, by_replicate: by_replicate.to_vec() });
        Figure { name: "f".into(), value, standard_error: Some(standard_error), counted }
    }

    #[test]
    fn errors_by_hand() {
        // Differences 20, 24, 22, 30: mean 24, squares 16 + 0 + 4 + 36 = 56; 4/3 of 56 is 224/3.
        let a = figure(0.5, &[120, 224, 322, 430], 3.0);
        let b = figure(0.5, &[100, 200, 300, 400], 4.0);
        let d = Difference::new(&a, &b).unwrap();
        assert_eq!((d.value, d.independent), (48.0, Some(5.0)));
        let expected = 0.5 * (224.0f64 / 3.0).sqrt();
        assert!((d.standard_error.unwrap() - expected).abs() < 1e-12, "{d:?}");
        assert!((d.ratio().unwrap() - 5.0 / expected).abs() < 1e-12);
        // Of another flux: 0.5 a - 0.25 b = 35, 62, 86, 115 about 74.5; squares 1560.25 + 156.25 + 132.25 + 1640.25.
        let d = Difference::new(&a, &figure(0.25, &[100, 200, 300, 400], 4.0)).unwrap();
        assert!((d.standard_error.unwrap() - (4.0f64 / 3.0 * 3489.0).sqrt()).abs() < 1e-9, "{d:?}");
    }

    #[test]
    fn nothing_is_certain_and_what_is_no_pair_has_no_paired_error() {
        let same = figure(0.5, &[100, 200], 3.0);
        assert_eq!(Difference::new(&same, &same).unwrap().standard_error, Some(0.5));
        // Three photons counted in one scene alone: sqrt(3 + 1) of them.
        let few = Difference::new(&figure(0.5, &[102, 199], 3.0), &same).unwrap();
        assert_eq!((few.value, few.standard_error), (0.5, Some(0.5 * (2.0 * 4.5f64).sqrt())));
        let few = Difference::new(&figure(0.5, &[102, 201], 3.0), &same).unwrap();
        assert_eq!((few.value, few.standard_error), (1.5, Some(1.0)));
        let shifted = Difference::new(&figure(0.5, &[110, 210], 3.0), &same).unwrap();
        assert_eq!((shifted.value, shifted.standard_error), (10.0, Some(0.5)));
        for other in
            [figure(0.5, &[100], 3.0), figure(0.5, &[1, 2, 3], 3.0), Figure { counted: None, ..same.clone() }]
        {
            let d = Difference::new(&same, &other).unwrap();
            assert_eq!((d.standard_error, d.ratio()), (None, None));
            assert!(d.independent.is_some());
        }
        assert_eq!(Difference::new(&same, &Figure { value: None, ..same.clone() }), None);
    }
}
