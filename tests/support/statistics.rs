//! Tests of distributions: chi-square, Kolmogorov-Smirnov, z; and the correction for doing many of them.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use std::f64::consts::{PI, SQRT_2};

/// Counts below which the chi-square approximation of a cell is not used: it is pooled with its neighbours.
const LEAST_EXPECTED: f64 = 5.0;

/// The outcome of a chi-square goodness-of-fit test.
#[derive(Debug, Clone, Copy)]
pub struct ChiSquare {
    /// Sum of (observed - expected)^2 / expected over the pooled cells.
    pub statistic: f64,
    /// Pooled cells less one.
    pub degrees: usize,
    /// Hits in cells of probability zero; one is enough to refute the density.
    pub forbidden: u64,
    /// Chance of so large a statistic; 0 where there are forbidden hits.
    pub p_value: f64,
}

/// Chi-square of counts against weights (any positive sum). Neighbouring cells are pooled until they expect at least
/// five; what is left at the end joins the last pool. Cells of weight zero must be empty.
pub fn chi_square(observed: &[u64], weights: &[f64]) -> ChiSquare {
    assert_eq!(observed.len(), weights.len());
    let hits: u64 = observed.iter().sum();
    let total: f64 = weights.iter().sum();
    assert!(total > 0.0 && weights.iter().all(|w| *w >= 0.0));
    let mut pools: Vec<(f64, f64)> = Vec::new();
    let (mut forbidden, mut count, mut expected) = (0, 0.0, 0.0);
    for (&o, &w) in observed.iter().zip(weights) {
        if w == 0.0 {
            forbidden += o;
            continue;
        }
        count += o as f64;
        expected += w / total * hits as f64;
        if expected >= LEAST_EXPECTED {
            pools.push((count, expected));
            (count, expected) = (0.0, 0.0);
        }
    }
    match pools.last_mut() {
        Some(last) => {
            last.0 += count;
            last.1 += expected;
        }
        None => pools.push((count, expected)),
    }
    let statistic = pools.iter().map(|(o, e)| (o - e).powi(2) / e).sum();
    let degrees = pools.len() - 1;
    let p_value = match (forbidden, degrees) {
        (1.., _) => 0.0,
        (_, 0) => 1.0,
        _ => ChiSquared::new(degrees as f64).unwrap().sf(statistic),
    };
    ChiSquare { statistic, degrees, forbidden, p_value }
}

/// The outcome of a Kolmogorov-Smirnov test.
#[derive(Debug, Clone, Copy)]
pub struct KolmogorovSmirnov {
    /// Largest distance between the empirical and the given distribution function.
    pub distance: f64,
    /// Chance of so large a distance (asymptotic, with Stephens' correction for finite n).
    pub p_value: f64,
}

/// Kolmogorov-Smirnov against the uniform distribution on [0, 1]; the values are F(x) of the samples, in any order.
pub fn kolmogorov_smirnov(mut values: Vec<f64>) -> KolmogorovSmirnov {
    assert!(!values.is_empty() && values.iter().all(|v| v.is_finite()));
    values.sort_by(f64::total_cmp);
    let n = values.len() as f64;
    let distance = values
        .iter()
        .enumerate()
        .map(|(i, v)| (v - i as f64 / n).max((i as f64 + 1.0) / n - v))
        .fold(0.0, f64::max);
    let lambda = distance * (n.sqrt() + 0.12 + 0.11 / n.sqrt());
    KolmogorovSmirnov { distance, p_value: kolmogorov_tail(lambda) }
}

/// Q(lambda) = P(K > lambda) of the Kolmogorov distribution: 2 sum (-1)^(k-1) exp(-2 k^2 lambda^2), and its theta-function
/// twin where that series converges slowly.
pub fn kolmogorov_tail(lambda: f64) -> f64 {
    if lambda <= 0.0 {
        return 1.0;
    }
    if lambda < 1.18 {
        let x = -PI * PI / (8.0 * lambda * lambda);
        let sum: f64 = (0..6).map(|k| (f64::from(2 * k + 1).powi(2) * x).exp()).sum();
        1.0 - (2.0 * PI).sqrt() / lambda * sum
    } else {
        let term =
            |k: i32| (-2.0 * f64::from(k * k) * lambda * lambda).exp() * if k % 2 == 1 { 2.0 } else { -2.0 };
        (1..8).map(term).sum()
    }
}

/// Two-sided p-value of a standard normal z.
pub fn z_test(z: f64) -> f64 {
    libm::erfc(z.abs() / SQRT_2)
}

/// Level of each of `tests` independent tests at which the chance of any false alarm is `family`:
/// 1 - (1 - family)^(1 / tests) (Sidak 1967).
pub fn sidak(family: f64, tests: usize) -> f64 {
    -((-family).ln_1p() / tests as f64).exp_m1()
}
