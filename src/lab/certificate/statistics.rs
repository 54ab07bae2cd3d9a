//! Distributions of the certificate's tests under their null hypotheses.

use std::f64::consts::{FRAC_1_SQRT_2, PI};

use statrs::function::beta::checked_beta_reg;
use statrs::function::gamma::checked_gamma_ur;

/// P(X >= statistic) for chi-square with `degrees` degrees of freedom: Q(degrees / 2, statistic / 2); 1
/// without any.
pub fn chi_square_tail(statistic: f64, degrees: usize) -> f64 {
    if degrees == 0 || statistic <= 0.0 {
        return 1.0;
    }
    // Finite arguments above 0 are all it asks for.
    checked_gamma_ur(0.5 * degrees as f64, 0.5 * statistic).unwrap_or(0.0)
}

/// P(K > lambda) of the Kolmogorov distribution: 2 sum (-1)^(k-1) exp(-2 k^2 lambda^2), and its
/// theta-function twin where that series converges slowly.
pub fn kolmogorov_tail(lambda: f64) -> f64 {
    if lambda <= 0.0 {
        return 1.0;
    }
    if lambda < 1.18 {
        let x = -PI * PI / (8.0 * lambda * lambda);
        let sum: f64 = (0..6).map(|k| libm::exp(f64::from((2 * k + 1) * (2 * k + 1)) * x)).sum();
        1.0 - libm::sqrt(2.0 * PI) / lambda * sum
    } else {
        let term = |k: i32| {
            let magnitude = 2.0 * libm::exp(-2.0 * f64::from(k * k) * lambda * lambda);
            if k % 2 == 1 { magnitude } else { -magnitude }
        };
        (1..8).map(term).sum()
    }
}

/// P(D > distance) of the Kolmogorov-Smirnov distance of n values: the asymptotic law with Stephens' (1970)
/// correction for finite n.
pub fn kolmogorov_smirnov_tail(distance: f64, n: u64) -> f64 {
    let root = libm::sqrt(n as f64);
    kolmogorov_tail(distance * (root + 0.12 + 0.11 / root))
}

/// Chance, two-sided, of a count as far from n p as this one for a binomial of n trials, by the signed root
/// of its deviance, sqrt(2 sum k ln(k / expected)), as a standard normal, the count moved by 1/2 towards the
/// expectation. To a few per cent where n p >= 10, too large (never alarming) where it is small.
pub fn binomial_tails(count: u64, n: u64, p: f64) -> f64 {
    let (count, n) = (count as f64, n as f64);
    let expected = n * p;
    let off = (count - expected).abs() - 0.5;
    if off <= 0.0 {
        return 1.0;
    }
    if p >= 1.0 {
        return 0.0;
    }
    let count = if count > expected { expected + off } else { expected - off };
    let part = |k: f64, e: f64| if k > 0.0 { k * libm::log(k / e) } else { 0.0 };
    let deviance = 2.0 * (part(count, expected) + part(n - count, n - expected));
    normal_tails(libm::sqrt(deviance.max(0.0)))
}

/// P(|Z| > z) of a standard normal.
pub fn normal_tails(z: f64) -> f64 {
    libm::erfc(z.abs() * FRAC_1_SQRT_2)
}

/// P(|T| > t) of Student's t with `degrees` degrees of freedom: I_x(degrees / 2, 1 / 2), x = degrees /
/// (degrees + t^2).
pub fn student_tails(t: f64, degrees: f64) -> f64 {
    checked_beta_reg(0.5 * degrees, 0.5, degrees / (degrees + t * t)).unwrap_or(0.0)
}

/// The chance that the smallest of `tests` independent p-values is as small as this one, 1 - (1 - p)^tests
/// (Sidak 1967).
pub fn sidak(p_value: f64, tests: usize) -> f64 {
    -libm::expm1(tests as f64 * libm::log1p(-p_value.min(1.0)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(got: f64, exact: f64, relative: f64) {
        assert!((got / exact - 1.0).abs() < relative, "{got} {exact}");
    }

    #[test]
    fn published_critical_values() {
        // Chi-square (Abramowitz and Stegun, table 26.8).
        for (degrees, statistic, p) in
            [(1, 3.84146, 0.05), (10, 23.2093, 0.01), (30, 59.7031, 0.001), (100, 149.449, 0.001)]
        {
            near(chi_square_tail(statistic, degrees), p, 1e-4);
        }
        // Kolmogorov (Smirnov 1948).
        for (lambda, p) in [(1.22385, 0.1), (1.35810, 0.05), (1.62762, 0.01), (1.94947, 0.001)] {
            near(kolmogorov_tail(lambda), p, 1e-4);
        }
        // Student (Abramowitz and Stegun, table 26.10), two-sided.
        for (t, degrees, p) in [(12.706, 1.0, 0.05), (4.073, 15.0, 0.001), (2.947, 15.0, 0.01)] {
            near(student_tails(t, degrees), p, 1e-3);
        }
        near(normal_tails(1.959_963_985), 0.05, 1e-8);
    }

    #[test]
    fn both_series_of_kolmogorov_agree_where_they_meet() {
        near(kolmogorov_tail(1.18 - 1e-12), kolmogorov_tail(1.18), 1e-9);
        assert!((kolmogorov_tail(0.2) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn large_chi_squares_are_right() {
        // Wilson-Hilferty for 1e5 degrees, four sigma up: p = 3.2e-5 to a few per cent.
        let degrees = 100_000.0f64;
        let a = 2.0 / (9.0 * degrees);
        let statistic = degrees * (1.0 - a + 4.0 * a.sqrt()).powi(3);
        near(chi_square_tail(statistic, 100_000), 0.5 * normal_tails(4.0), 1e-2);
    }

    /// P(X >= k) of a binomial, by its sum in logarithms.
    fn upper(n: u64, p: f64, k: u64) -> f64 {
        let log = |i: u64| {
            libm::lgamma(n as f64 + 1.0) - libm::lgamma(i as f64 + 1.0) - libm::lgamma((n - i) as f64 + 1.0)
                + i as f64 * p.ln()
                + (n - i) as f64 * (-p).ln_1p()
        };
        (k..=n.min(k + 2000)).map(|i| log(i).exp()).sum()
    }

    #[test]
    fn binomial_tails_match_the_sum() {
        for (n, p, k) in [
            (1_000_000u64, 1e-2, 10_450),
            (1_000_000, 1e-4, 150),
            (1_000_000, 1e-4, 131),
            (2000, 0.3, 700),
            (100_000, 1e-3, 145),
        ] {
            near(binomial_tails(k, n, p), 2.0 * upper(n, p, k), 0.08);
            // Counts below, by the mirrored trial.
            near(binomial_tails(n - k, n, 1.0 - p), 2.0 * upper(n, p, k), 0.08);
        }
        for (n, p, k) in [(1_000_000u64, 1e-8, 1), (1_000_000, 1e-8, 2), (1_000_000, 1e-6, 9)] {
            assert!(binomial_tails(k, n, p) >= 2.0 * upper(n, p, k));
        }
        assert_eq!(binomial_tails(7, 7, 1.0), 1.0);
        assert_eq!(binomial_tails(5, 7, 1.0), 0.0);
    }

    #[test]
    fn sidak_of_one_and_of_many() {
        assert_eq!(sidak(0.0, 100), 0.0);
        near(sidak(0.01, 1), 0.01, 1e-12);
        near(sidak(0.1, 2), 0.19, 1e-12);
        near(sidak(1e-15, 1000), 1e-12, 1e-9);
        assert_eq!(sidak(1.0, 3), 1.0);
    }
}
