//! Additive recurrences: coordinate c of point i is frac(i alpha_c), alpha_c irrational.
//!
//! The alphas are 128-bit fractions and the product is formed modulo 1 in integers, so the error of a coordinate is that
//! of alpha times the index, below 2^-64 for indices to 2^48 and far beyond; an `f64` product loses a bit for every
//! doubling of the index.

use std::sync::LazyLock;

use super::Points;
use super::independent::UNSEEDED;

/// Coordinates of the R2-type sequence. Its alphas must be chosen for a number of coordinates d: alpha_d = 1 - alpha_(d-1),
/// so there are d of them and no more. Emission and the first events of a photon use about eight; with a larger d all
/// alphas crowd towards 1 and the low coordinates, which matter most, get worse.
pub const ROBERTS_COORDINATES: u32 = 8;

static ROBERTS: LazyLock<Vec<u128>> = LazyLock::new(|| harmonious_powers(ROBERTS_COORDINATES));

/// Points of an additive recurrence. Coordinates past its own come from the counter hash with seed 0.
#[derive(Debug, Clone)]
pub struct KroneckerPoints(pub(super) &'static [u128]);

impl KroneckerPoints {
    /// The R2-type sequence of M. Roberts ("The unreasonable effectiveness of quasirandom sequences", 2018) in
    /// [`ROBERTS_COORDINATES`] dimensions: alpha_c = phi^-(c+1), phi the positive root of x^(d+1) = x + 1.
    pub fn roberts() -> Self {
        Self(&ROBERTS)
    }
}

impl Points for KroneckerPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        match self.0.get(coordinate as usize) {
            Some(alpha) => (alpha.wrapping_mul(u128::from(index)) >> 64) as u64,
            None => UNSEEDED.coordinate(index, coordinate),
        }
    }
}

/// floor(a b / 2^128): the product of two 128-bit fractions, rounded down.
pub(super) fn multiply_fractions(a: u128, b: u128) -> u128 {
    const LOW: u128 = u64::MAX as u128;
    let (a1, a0, b1, b0) = (a >> 64, a & LOW, b >> 64, b & LOW);
    let (cross, other) = (a1 * b0, a0 * b1);
    let carried = ((a0 * b0) >> 64) + (cross & LOW) + (other & LOW);
    a1 * b1 + (cross >> 64) + (other >> 64) + (carried >> 64)
}

/// The greatest 128-bit fraction that is not too large, found bit by bit.
pub(super) fn greatest_fraction(too_large: impl Fn(u128) -> bool) -> u128 {
    (0..128).rev().fold(0, |found, bit| {
        let candidate = found | (1 << bit);
        if too_large(candidate) { found } else { candidate }
    })
}

/// phi^-1 to phi^-d as 128-bit fractions, phi the positive root of x^(d+1) = x + 1: y = 1 / phi solves y^d + y^(d+1) = 1.
/// Each is off by no more than a few d units of 2^-128.
fn harmonious_powers(d: u32) -> Vec<u128> {
    let powers = |y: u128| std::iter::successors(Some(y), move |p| Some(multiply_fractions(*p, y)));
    let y = greatest_fraction(|y| {
        let power = powers(y).nth(d as usize - 1).unwrap_or(y);
        power.checked_add(multiply_fractions(power, y)).is_none()
    });
    powers(y).take(d as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::to_unit_f64;

    const SCALE: f64 = 1.0 / 340_282_366_920_938_463_463_374_607_431_768_211_456.0;

    #[test]
    fn products_of_fractions_are_rounded_down() {
        let half = 1u128 << 127;
        assert_eq!(multiply_fractions(half, half), half >> 1);
        assert_eq!(multiply_fractions(u128::MAX, u128::MAX), u128::MAX - 1);
        assert_eq!(multiply_fractions(u128::MAX, 1), 0);
        assert_eq!(multiply_fractions(3, half), 1);
        let (a, b) = (0x1234_5678_9abc_def0_0fed_cba9_8765_4321, 0xfedc_ba98_7654_3210_0123_4567_89ab_cdef);
        // 0x1234... * 0xfedc... as any bignum calculator gives it, upper half.
        assert_eq!(multiply_fractions(a, b), PRODUCT);
    }

    const PRODUCT: u128 = 0x121f_a00a_d77d_7422_335d_eb75_95e5_ff7a;

    #[test]
    fn harmonious_numbers_are_the_published_ones() {
        // Golden ratio, plastic number and the next ones: 1 / phi_d (M. Roberts; OEIS A001622, A060006, A060007, A160155).
        for (d, phi) in [
            (1, 1.618_033_988_749_895),
            (2, 1.324_717_957_244_746),
            (3, 1.220_744_084_605_759_5),
            (4, 1.167_303_978_261_418_7),
        ] {
            let alphas = harmonious_powers(d);
            for (c, alpha) in alphas.iter().enumerate() {
                let expected = f64::powi(phi, -(c as i32 + 1));
                assert!((*alpha as f64 * SCALE - expected).abs() < 1e-15, "d {d}, coordinate {c}");
            }
        }
    }

    #[test]
    fn the_root_is_good_to_nearly_all_of_128_bits() {
        // The defining equation y^d + y^(d+1) = 1 and the golden ratio's own y^2 = 1 - y, in units of 2^-128.
        let golden = harmonious_powers(1)[0];
        assert!(multiply_fractions(golden, golden).abs_diff(golden.wrapping_neg()) <= 3);
        let alphas = harmonious_powers(ROBERTS_COORDINATES);
        let last = alphas[alphas.len() - 1];
        let sum = last.wrapping_add(multiply_fractions(last, alphas[0]));
        assert!(sum.min(sum.wrapping_neg()) < 64, "{sum}");
    }

    #[test]
    fn far_points_are_reached_without_loss() {
        // frac((i + j) alpha) = frac(i alpha) + frac(j alpha) modulo 1 up to roundings, for indices far apart.
        let points = KroneckerPoints::roberts();
        for c in 0..ROBERTS_COORDINATES {
            for (i, j) in [(1u64 << 47, (1u64 << 46) + 12345), ((1 << 48) - 1, 1)] {
                let sum = points.coordinate(i, c).wrapping_add(points.coordinate(j, c));
                let both = points.coordinate(i + j, c);
                assert!(both.wrapping_sub(sum) <= 1, "{c}: {both} {sum}");
            }
        }
        assert_eq!(points.coordinate(0, 3), 0);
        // 1 / phi_8, phi_8 = 1.085070245491451 (x^9 = x + 1).
        assert!((to_unit_f64(points.coordinate(1, 0)) - 1.0 / 1.085_070_245_491_451).abs() < 1e-15);
    }
}
