//! Rank-1 lattice points with a published generating vector.
//!
//! Coordinate c of point i is frac(i z_c / N), N the number of points, formed in integers. The vector z is
//! "exod2_base2_m20" of R. Cools, F. Y. Kuo and D. Nuyens, "Constructing embedded lattice rules for multivariate
//! integration", SIAM J. Sci. Comput. 28 (2006) 2162-2188, from D. Nuyens' Magic Point Shop. It was constructed for N =
//! 2^m, m up to 20, minimising the worst-case error over all two-dimensional projections. Other N give a lattice too, but
//! nobody searched for a good vector there: with N = 16 000, z_1 / N is 2e-5 from 5 / 12 and the plane is filled in twelve
//! lines, and a component that shares a factor with N takes fewer than N values. Above 2^20 the published search says
//! nothing.

use std::num::NonZeroU64;

use super::Points;
use super::fraction::Parts;
use super::independent::UNSEEDED;

/// The first 64 of the 250 published components.
const GENERATING_VECTOR: [u64; 64] = [
    1, 182_667, 469_891, 498_753, 110_745, 446_247, 250_185, 118_627, //
    245_333, 283_199, 408_519, 391_023, 246_327, 126_539, 399_185, 461_527, //
    300_343, 69_681, 516_695, 436_179, 106_383, 238_523, 413_283, 70_841, //
    47_719, 300_129, 113_029, 123_925, 410_745, 211_325, 17_489, 511_893, //
    40_767, 186_077, 519_471, 255_369, 101_819, 243_573, 66_189, 152_143, //
    503_455, 113_217, 132_603, 463_967, 297_717, 157_383, 224_015, 502_917, //
    36_237, 94_049, 170_665, 79_397, 123_963, 223_451, 323_871, 303_633, //
    98_567, 318_855, 494_245, 477_137, 177_975, 64_483, 26_695, 88_779,
];

/// The rank-1 lattice of N points. From index N on it starts again, which is what a lattice does; coordinates from the
/// 64th on come from the counter hash with seed 0.
#[derive(Debug, Clone)]
pub struct LatticePoints {
    parts: Parts,
}

impl LatticePoints {
    /// The lattice of this number of points.
    pub fn new(number: NonZeroU64) -> Self {
        Self { parts: Parts::new(number) }
    }
}

impl Points for LatticePoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        let Some(&z) = GENERATING_VECTOR.get(coordinate as usize) else {
            return UNSEEDED.coordinate(index, coordinate);
        };
        let number = self.parts.number();
        let product = u128::from(self.parts.wrap(index)) * u128::from(z);
        let part = match u64::try_from(product) {
            Ok(product) => product % number,
            Err(_) => (product % u128::from(number)) as u64,
        };
        self.parts.fraction(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::LOW_DISCREPANCY_COORDINATES;

    fn lattice(number: u64) -> LatticePoints {
        LatticePoints::new(NonZeroU64::new(number).unwrap())
    }

    #[test]
    fn the_vector_fits_its_construction() {
        assert_eq!(GENERATING_VECTOR.len(), LOW_DISCREPANCY_COORDINATES as usize);
        // Odd, so that every coordinate of 2^m points takes every multiple of 2^-m, and of the half of 2^20 that is
        // searched (z and -z give mirror images).
        assert!(GENERATING_VECTOR.iter().all(|z| z % 2 == 1 && *z < 1 << 19));
        // Digest against slips of the keyboard: sums over the components as published.
        let weighted: u64 = GENERATING_VECTOR.iter().enumerate().map(|(k, z)| (k as u64 + 1) * z).sum();
        assert_eq!((GENERATING_VECTOR.iter().sum::<u64>(), weighted), (SUM, WEIGHTED));
    }

    const SUM: u64 = 15_589_634;
    const WEIGHTED: u64 = 476_991_462;

    #[test]
    fn points_are_multiples_of_the_vector_modulo_one() {
        // Point 1 of 2^20 points is z / 2^20; point 3 of 1000 points is 3 z / 1000 modulo 1.
        assert_eq!(lattice(1 << 20).coordinate(1, 1), 182_667 << 44);
        let thousandths = |t: u64| ((u128::from(t) << 64) / 1000) as u64;
        let third: Vec<u64> = (0..4).map(|c| lattice(1000).coordinate(3, c)).collect();
        assert_eq!(third, [thousandths(3), thousandths(1), thousandths(673), thousandths(259)]);
    }

    #[test]
    fn large_numbers_of_points_need_no_more_than_integers() {
        for number in [(1u64 << 40) + 15, (1 << 48) - 59, 1 << 48] {
            for index in [number - 1, number / 3, (1 << 40) - 7] {
                for (c, z) in GENERATING_VECTOR.iter().enumerate() {
                    let part = u128::from(index) * u128::from(*z) % u128::from(number);
                    let exact = ((part << 64) / u128::from(number)) as u64;
                    assert_eq!(lattice(number).coordinate(index, c as u32), exact);
                }
            }
        }
    }

    #[test]
    fn every_coordinate_of_a_power_of_two_takes_every_multiple_once() {
        let points = lattice(1 << 10);
        for c in 0..LOW_DISCREPANCY_COORDINATES {
            let mut seen = vec![false; 1 << 10];
            for i in 0..1 << 10 {
                let u = points.coordinate(i, c);
                assert_eq!(u << 10, 0);
                assert!(!std::mem::replace(&mut seen[(u >> 54) as usize], true));
            }
        }
    }
}
