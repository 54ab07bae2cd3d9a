//! Random shifts of any point set: what gives a sequence without seed its replicates and a standard error.
//!
//! Both make every single point uniform, so the estimate is unbiased, and keep what is even about the set in its own
//! sense: the digital shift (exclusive-or of the bits) maps elementary intervals in base 2 on such intervals and fits
//! Sobol'; the rotation modulo 1 (R. Cranley and T. N. L. Patterson, 1976) fits lattices and recurrences.

use super::hash::stream_key;
use super::{LOW_DISCREPANCY_COORDINATES, Points};

const SALT_SHIFT: u64 = 0x61;
const SALT_ROTATE: u64 = 0x62;

/// One key a coordinate: the first ones are kept, those of later coordinates are hashed when asked for.
#[derive(Debug, Clone)]
struct Keys {
    kept: Vec<u64>,
    seed: u64,
    replicate: u32,
    salt: u64,
}

impl Keys {
    fn new(seed: u64, replicate: u32, salt: u64) -> Self {
        let kept = (0..LOW_DISCREPANCY_COORDINATES).map(|c| stream_key(seed, replicate, c, salt)).collect();
        Self { kept, seed, replicate, salt }
    }

    #[inline]
    fn of(&self, coordinate: u32) -> u64 {
        match self.kept.get(coordinate as usize) {
            Some(&key) => key,
            None => stream_key(self.seed, self.replicate, coordinate, self.salt),
        }
    }
}

/// Points that are joined, coordinate by coordinate, with random keys.
#[derive(Debug, Clone)]
pub struct Shifted<P> {
    points: P,
    keys: Keys,
    /// Added modulo 1; else the bits are flipped where the key has ones.
    is_rotation: bool,
}

/// These points with their bits flipped where a random key of the coordinate has ones.
pub fn digital_shift<P: Points>(points: P, seed: u64, replicate: u32) -> Shifted<P> {
    Shifted { points, keys: Keys::new(seed, replicate, SALT_SHIFT), is_rotation: false }
}

/// These points moved on a torus by a random vector.
pub fn rotation<P: Points>(points: P, seed: u64, replicate: u32) -> Shifted<P> {
    Shifted { points, keys: Keys::new(seed, replicate, SALT_ROTATE), is_rotation: true }
}

impl<P: Points> Points for Shifted<P> {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        let (bits, key) = (self.points.coordinate(index, coordinate), self.keys.of(coordinate));
        if self.is_rotation { bits.wrapping_add(key) } else { bits ^ key }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::halton::HaltonPoints;
    use crate::sequence::sobol::SobolPoints;
    use crate::sequence::to_unit_f64;

    #[test]
    fn a_digital_shift_keeps_the_net() {
        let m = 8u32;
        for (seed, replicate) in [(0, 0), (1, 5), (u64::MAX, 2)] {
            let points = digital_shift(SobolPoints, seed, replicate);
            for a in 0..=m {
                let mut seen = vec![false; 1 << m];
                for i in 0..1u64 << m {
                    let x = points.coordinate(i, 0).checked_shr(64 - a).unwrap_or(0);
                    let y = points.coordinate(i, 1).checked_shr(64 - (m - a)).unwrap_or(0);
                    assert!(!std::mem::replace(&mut seen[((x << (m - a)) | y) as usize], true));
                }
            }
        }
    }

    #[test]
    fn a_rotation_keeps_differences_modulo_one() {
        let (plain, rotated) = (HaltonPoints::plain(), rotation(HaltonPoints::plain(), 3, 1));
        for c in [0, 1, 63, 64, 100] {
            let by = rotated.coordinate(0, c).wrapping_sub(plain.coordinate(0, c));
            assert_ne!(by, 0);
            for i in 1..50 {
                assert_eq!(rotated.coordinate(i, c).wrapping_sub(plain.coordinate(i, c)), by);
            }
        }
    }

    #[test]
    fn every_single_point_is_uniform_over_replicates() {
        // Mean and variance of one coordinate of one point, and the correlation of two, over 4000 replicates: 32
        // z-values, 4.5 sigma is 2e-4 in all.
        let n = 4000u32;
        for c in [0u32, 1, 63, 70] {
            let values = |rotate: bool, c: u32| -> Vec<f64> {
                (0..n)
                    .map(|replicate| {
                        let u = if rotate {
                            rotation(SobolPoints, 8, replicate).coordinate(5, c)
                        } else {
                            digital_shift(SobolPoints, 8, replicate).coordinate(5, c)
                        };
                        to_unit_f64(u) - 0.5
                    })
                    .collect()
            };
            for rotate in [false, true] {
                let (u, v) = (values(rotate, c), values(rotate, c + 1));
                let n = f64::from(n);
                let sum: f64 = u.iter().sum();
                let square: f64 = u.iter().map(|x| x * x).sum();
                let across: f64 = u.iter().zip(&v).map(|(x, y)| x * y).sum();
                let lag: f64 = u.windows(2).map(|w| w[0] * w[1]).sum();
                assert!((sum / (n / 12.0).sqrt()).abs() < 4.5);
                assert!(((square - n / 12.0) / (n / 180.0).sqrt()).abs() < 4.5);
                assert!((across / (n / 144.0).sqrt()).abs() < 4.5);
                assert!((lag / (n / 144.0).sqrt()).abs() < 4.5);
            }
        }
    }
}
