//! A map against its exact values, in units of its own standard errors.
//!
//! In every cell with at least 10 hits a replicate, t = (E - exact) / SE follows Student's distribution with R - 1
//! degrees. Each t becomes a normal deviate z through the two distribution functions; the sum of z^2 is compared with
//! chi-square, the largest |t| with the extreme of as many tests (Sidak). Seeds are fixed, so a test that passes once
//! passes always.

use caustix::run::{Estimate, Outcome};
use caustix::scene::Scene;
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Significance of one judgement. All tests together make fewer than 200: 2 % in all.
pub const SIGNIFICANCE: f64 = 1e-4;

/// Two-sided p-value of t with this many degrees.
pub fn student_p(t: f64, degrees: u32) -> f64 {
    let student = StudentsT::new(0.0, 1.0, f64::from(degrees)).unwrap();
    2.0 * student.sf(t.abs())
}

/// p-value of the smallest of n independent p-values.
pub fn sidak(p: f64, n: usize) -> f64 {
    -(n as f64 * (-p).ln_1p()).exp_m1()
}

/// t of an estimate. A spread of exactly zero is no standard error: it passes only where the value is exact.
pub fn t_of(estimate: Estimate, exact: f64) -> f64 {
    let error = estimate.standard_error.expect("replicates");
    if error == 0.0 && (estimate.value - exact).abs() <= 1e-12 * exact.abs() {
        return 0.0;
    }
    (estimate.value - exact) / error
}

/// What the cells of a map say.
#[derive(Debug)]
pub struct Verdict {
    /// Cells with at least 10 hits a replicate.
    pub cells: usize,
    /// Sum of z^2 over them, divided by their number: 1 on average.
    pub mean_z2: f64,
    /// Two-sided p-value of that sum.
    pub p_chi2: f64,
    /// p-value of the largest |t|, corrected for the number of cells.
    pub p_extreme: f64,
    /// The largest |t|.
    pub t_extreme: f64,
}

/// Judges the t of many cells with this many degrees.
pub fn judge(ts: &[f64], degrees: u32) -> Verdict {
    let normal = Normal::standard();
    let n = ts.len();
    let mut sum = 0.0;
    let (mut smallest, mut t_extreme) = (1.0f64, 0.0f64);
    for &t in ts {
        assert!(!t.is_nan());
        let p = student_p(t, degrees);
        sum += normal.inverse_cdf((0.5 * p).max(1e-300)).powi(2);
        smallest = smallest.min(p);
        t_extreme = t_extreme.max(t.abs());
    }
    let chi2 = ChiSquared::new(n as f64).unwrap();
    let p_chi2 = (2.0 * chi2.sf(sum).min(chi2.cdf(sum))).min(1.0);
    Verdict { cells: n, mean_z2: sum / n as f64, p_chi2, p_extreme: sidak(smallest, n), t_extreme }
}

/// Judges a receiver's cells against their exact illuminances [lx] and fails where they disagree. Cells that are exactly
/// dark must be empty.
pub fn assert_cells(
    label: &str,
    scene: &Scene,
    outcome: &Outcome,
    receiver: usize,
    exact_lx: &[f64],
) -> Verdict {
    let r = &scene.receivers[receiver];
    assert_eq!(r.cells.len(), exact_lx.len());
    let moments = &outcome.cells()[receiver];
    let enough = 10 * u64::from(outcome.replicates);
    let mut ts = Vec::new();
    for (cell, &exact) in exact_lx.iter().enumerate() {
        if exact == 0.0 {
            assert_eq!(moments.sum[cell], 0, "{label}: light in the dark cell {cell}");
        }
        if moments.sum[cell] >= enough {
            ts.push(t_of(outcome.illuminance_lx(receiver, cell, r.area_m2(cell)), exact));
        }
    }
    assert!(
        2 * ts.len() > exact_lx.iter().filter(|e| **e > 0.0).count(),
        "{label}: {} cells are lit",
        ts.len()
    );
    let verdict = judge(&ts, outcome.replicates - 1);
    println!(
        "{label}: {} cells, z^2/n = {:.3} (p {:.3}), extreme t {:.2} (p {:.3})",
        verdict.cells, verdict.mean_z2, verdict.p_chi2, verdict.t_extreme, verdict.p_extreme
    );
    assert!(verdict.p_chi2 > SIGNIFICANCE, "{label}: {verdict:?}");
    assert!(verdict.p_extreme > SIGNIFICANCE, "{label}: {verdict:?}");
    verdict
}

/// Judges one number.
pub fn assert_total(label: &str, outcome: &Outcome, estimate: Estimate, exact: f64) {
    let t = t_of(estimate, exact);
    let p = student_p(t, outcome.replicates - 1);
    println!(
        "{label}: {:.6} +- {:.2e}, exact {exact:.6}, t = {t:.2} (p {p:.3})",
        estimate.value,
        estimate.standard_error.unwrap()
    );
    assert!(p > SIGNIFICANCE, "{label}: t = {t}");
}
