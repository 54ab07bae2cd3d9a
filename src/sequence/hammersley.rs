//! Hammersley point sets: Halton's radical inverses, and i / N before them.
//!
//! J. M. Hammersley, 1960. The number of points N is known beforehand; in exchange the discrepancy loses a factor
//! log N. The first m < N points of the set are no sample: their coordinate 0 ends at m / N.

use std::num::NonZeroU64;

use super::LOW_DISCREPANCY_COORDINATES;
use super::Points;
use super::fraction::Parts;
use super::halton::HaltonPoints;
use super::independent::UNSEEDED;

/// The Hammersley set of N points: coordinate 0 of point i is i / N, coordinate c the radical inverse of i in prime
/// c - 1. From index N on coordinate 0 starts again. Coordinates from the 64th on come from the counter hash, seed 0.
#[derive(Debug, Clone)]
pub struct HammersleyPoints {
    parts: Parts,
    halton: HaltonPoints,
}

impl HammersleyPoints {
    /// The set of this number of points.
    pub fn new(number: NonZeroU64) -> Self {
        Self { parts: Parts::new(number), halton: HaltonPoints::plain() }
    }
}

impl Points for HammersleyPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        match coordinate {
            0 => self.parts.fraction(self.parts.wrap(index)),
            1..LOW_DISCREPANCY_COORDINATES => self.halton.coordinate(index, coordinate - 1),
            _ => UNSEEDED.coordinate(index, coordinate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::to_unit_f64;

    #[test]
    fn first_points_are_those_of_the_definition() {
        let points = HammersleyPoints::new(NonZeroU64::new(10).unwrap());
        for i in 0..10u64 {
            let tenths = ((u128::from(i) << 64) / 10) as u64;
            assert_eq!(points.coordinate(i, 0), tenths);
            assert_eq!(points.coordinate(i, 1), i.reverse_bits());
            assert_eq!(points.coordinate(i, 2), HaltonPoints::plain().coordinate(i, 1));
        }
        assert_eq!(to_unit_f64(points.coordinate(7, 0)), 0.7);
        assert_eq!(points.coordinate(13, 0), points.coordinate(3, 0));
    }

    #[test]
    fn the_set_is_a_net_in_base_2() {
        // i / 2^m and the reversed bits: exactly one point in each elementary interval.
        let m = 9u32;
        let points = HammersleyPoints::new(NonZeroU64::new(1 << m).unwrap());
        for a in 0..=m {
            let mut seen = vec![false; 1 << m];
            for i in 0..1u64 << m {
                let x = points.coordinate(i, 0).checked_shr(64 - a).unwrap_or(0);
                let y = points.coordinate(i, 1).checked_shr(64 - (m - a)).unwrap_or(0);
                assert!(!std::mem::replace(&mut seen[((x << (m - a)) | y) as usize], true), "a {a}");
            }
        }
    }
}
