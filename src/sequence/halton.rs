//! Halton points, plain and with Faure's permutations of the digits.
//!
//! Coordinate c of point i is the radical inverse of i in the c-th prime (J. H. Halton, 1960); the first point is the
//! origin and is kept. The bases of late coordinates are large and neighbours in size, so their plain radical inverses
//! run side by side for hundreds of points; Faure's permutations ([`super::faure`]) break that.

use std::sync::LazyLock;

use super::faure::faure_permutation;
use super::independent::UNSEEDED;
use super::primes::PRIMES;
use super::radical::Radix;
use super::{LOW_DISCREPANCY_COORDINATES, Points};

/// Radical inverses in the second to the last of the primes; base 2 is the reversal of bits.
static PLAIN: LazyLock<Vec<Radix>> =
    LazyLock::new(|| PRIMES[1..].iter().map(|&base| Radix::new(base, (0..base).collect())).collect());
static FAURE: LazyLock<Vec<Radix>> =
    LazyLock::new(|| PRIMES[1..].iter().map(|&base| Radix::new(base, faure_permutation(base))).collect());

/// Halton points. Coordinates from the 64th on come from the counter hash with seed 0: a Halton sequence has no seed.
#[derive(Debug, Clone)]
pub struct HaltonPoints {
    odd: &'static [Radix],
}

impl HaltonPoints {
    /// The plain Halton points.
    pub fn plain() -> Self {
        Self { odd: &PLAIN }
    }

    /// Halton points with Faure's permutation of the digits of each base.
    pub fn faure() -> Self {
        Self { odd: &FAURE }
    }
}

impl Points for HaltonPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        match coordinate {
            // sigma_2 is the identity, so base 2 is the same with and without permutations.
            0 => index.reverse_bits(),
            1..LOW_DISCREPANCY_COORDINATES => self.odd[coordinate as usize - 1].inverse(index),
            _ => UNSEEDED.coordinate(index, coordinate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::to_unit_f64;

    /// floor(2^64 numerator / denominator).
    fn bits(numerator: u64, denominator: u64) -> u64 {
        ((u128::from(numerator) << 64) / u128::from(denominator)) as u64
    }

    #[test]
    fn first_points_are_the_published_ones() {
        // Van der Corput in bases 2, 3, 5 as every textbook prints it.
        let points = HaltonPoints::plain();
        let two = [(0, 1), (1, 2), (1, 4), (3, 4), (1, 8), (5, 8), (3, 8), (7, 8), (1, 16)];
        let three = [(0, 1), (1, 3), (2, 3), (1, 9), (4, 9), (7, 9), (2, 9), (5, 9), (8, 9), (1, 27)];
        let five = [(0, 1), (1, 5), (2, 5), (3, 5), (4, 5), (1, 25), (6, 25), (11, 25), (16, 25), (21, 25)];
        for (coordinate, values) in [(0, &two[..]), (1, &three), (2, &five)] {
            for (i, &(a, b)) in values.iter().enumerate() {
                assert_eq!(points.coordinate(i as u64, coordinate), bits(a, b), "{coordinate}, {i}");
            }
        }
    }

    #[test]
    fn faure_points_count_permuted_digits() {
        // sigma_5 = (0 3 2 1 4), sigma_7 = (0 2 5 3 1 4 6): i = 1, 2, 3, 4, 5 and, in base 5, 6 = 11, 7 = 12.
        let points = HaltonPoints::faure();
        let five = [(0, 1), (3, 5), (2, 5), (1, 5), (4, 5), (3, 25), (18, 25), (13, 25)];
        let seven = [(0, 1), (2, 7), (5, 7), (3, 7), (1, 7), (4, 7), (6, 7), (2, 49), (16, 49)];
        for (coordinate, values) in [(2, &five[..]), (3, &seven)] {
            for (i, &(a, b)) in values.iter().enumerate() {
                assert_eq!(points.coordinate(i as u64, coordinate), bits(a, b), "{coordinate}, {i}");
            }
        }
    }

    #[test]
    fn blocks_of_powers_of_the_base_fill_every_interval_once() {
        // b^m points from any multiple of b^m on: one in each [k b^-m, (k + 1) b^-m); also far beyond 2^32.
        for points in [HaltonPoints::plain(), HaltonPoints::faure()] {
            for (coordinate, &base) in PRIMES.iter().enumerate() {
                let block = if base < 32 { base * base } else { base };
                for start in [0, block, (1 << 40) / block * block, (1 << 60) / block * block] {
                    let mut seen = vec![false; block as usize];
                    for i in start..start + block {
                        // The fraction is rounded down: the number lies below the next one.
                        let above = u128::from(points.coordinate(i, coordinate as u32)) + 1;
                        let cell = ((above * u128::from(block) - 1) >> 64) as usize;
                        assert!(!std::mem::replace(&mut seen[cell], true), "base {base}, start {start}");
                    }
                }
            }
        }
    }

    #[test]
    fn coordinates_beyond_the_last_base_come_from_the_hash() {
        let (points, hash) = (HaltonPoints::plain(), &UNSEEDED);
        assert_eq!(points.coordinate(5, 64), hash.coordinate(5, 64));
        assert_eq!(to_unit_f64(points.coordinate(1, 63)), to_unit_f64(bits(1, 311)));
    }
}
