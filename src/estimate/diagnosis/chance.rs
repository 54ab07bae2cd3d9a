//! How often chance alone gives as much: tails of the normal, of Student's and of the chi-square distribution.
//!
//! Own formulas on libm's functions, since report.json has the same bits on every machine.

use std::f64::consts::{FRAC_2_PI, FRAC_2_SQRT_PI, SQRT_2};

/// A normal number above `z`.
pub fn above(z: f64) -> f64 {
    0.5 * libm::erfc(z / SQRT_2)
}

/// Student's t with so many degrees of freedom farther from 0 than `t`: the finite series of Abramowitz and Stegun 26.7.3 and
/// 26.7.4. Below 1e-15 it may come out as 0.
pub fn farther(t: f64, degrees: u32) -> f64 {
    let n = f64::from(degrees);
    let theta = libm::atan(t.abs() / n.sqrt());
    let (sine, square) = (libm::sin(theta), n / (n + t * t));
    let is_odd = degrees % 2 == 1;
    let (mut term, mut sum) = if is_odd { (libm::sqrt(square), 0.0) } else { (1.0, 0.0) };
    // Terms up to the power n - 2 of the cosine.
    let mut power = u32::from(is_odd);
    while power + 2 <= degrees {
        sum += term;
        power += 2;
        term *= square * f64::from(power - 1) / f64::from(power);
    }
    let within = if is_odd { FRAC_2_PI * (theta + sine * sum) } else { sine * sum };
    (1.0 - within).clamp(0.0, 1.0)
}

/// Degrees up to which the series is used: exp(-x / 2) is far from underflow where its value is not 0.
const FEW_DEGREES: u32 = 200;

/// A chi-square number of so many degrees of freedom above `x`: the finite series of Abramowitz and Stegun 26.4.4 and 26.4.5; for
/// more than 200 degrees the cube root of Wilson and Hilferty 1931, to 2 % of the chance down to 1e-4.
pub fn chi_square_above(x: f64, degrees: u32) -> f64 {
    if degrees > FEW_DEGREES {
        let v = 2.0 / (9.0 * f64::from(degrees));
        return above((libm::cbrt(x / f64::from(degrees)) - (1.0 - v)) / v.sqrt());
    }
    let half = 0.5 * x;
    // From a to a + 1 the regularised gamma function Q(a, x / 2) grows by (x / 2)^a exp(-x / 2) / gamma(a + 1).
    let (mut a, mut sum, mut term) = if degrees % 2 == 1 {
        (0.5, libm::erfc(half.sqrt()), FRAC_2_SQRT_PI * half.sqrt() * libm::exp(-half))
    } else {
        (1.0, libm::exp(-half), half * libm::exp(-half))
    };
    while a < 0.5 * f64::from(degrees) {
        sum += term;
        a += 1.0;
        term *= half / a;
    }
    sum
}

#[cfg(test)]
mod tests {
    use statrs::distribution::{ChiSquared, ContinuousCDF, StudentsT};

    use super::*;

    #[test]
    fn tails_are_those_of_another_implementation() {
        for degrees in [1, 2, 3, 4, 7, 8, 31, 500] {
            let student = StudentsT::new(0.0, 1.0, f64::from(degrees)).unwrap();
            for t in [0.0, 0.3, -1.0, 2.5, 7.0] {
                let expected = 2.0 * student.sf(f64::abs(t));
                assert!((farther(t, degrees) - expected).abs() < 1e-12, "{t} of {degrees}");
            }
        }
        for degrees in [1, 2, 7, 8, 31, 200, 201, 5000] {
            let of = ChiSquared::new(f64::from(degrees)).unwrap();
            let allowed = if degrees > FEW_DEGREES { 0.02 } else { 1e-9 };
            for chance in [0.5, 0.1, 1e-2, 1e-3, 1e-4] {
                let x = of.inverse_cdf(1.0 - chance);
                let (found, expected) = (chi_square_above(x, degrees), of.sf(x));
                assert!((found / expected - 1.0).abs() < allowed, "{chance} of {degrees}: {found}");
            }
        }
        // The tables of every textbook.
        assert!((above(1.959_963_984_540_054) - 0.025).abs() < 1e-15);
        assert!((farther(2.364_624_251, 7) - 0.05).abs() < 1e-10);
    }
}
