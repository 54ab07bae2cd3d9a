//! Owen-scrambled Sobol' points: nested uniform scrambling by a hash.
//!
//! A. B. Owen (1995) flips the k-th digit of a coordinate by a random bit that depends on the k - 1 digits before it.
//! Laine and Karras (2011) get all flips at once from a hash in which information moves only upwards, applied to the
//! bit-reversed fraction; this is such a hash for 64 bits, keyed by three words per (seed, replicate, coordinate).
//! Every step is one of: addition of a key, multiplication by an odd key, x ^= x * even. In each, bit k of the result
//! is bit k of x changed by lower bits only, so the map is a nested scrambling whatever its constants are; the tests
//! measure how random its flips are.

use super::hash::stream_key;
use super::independent::IndependentPoints;
use super::sobol::sobol_reversed;
use super::{LOW_DISCREPANCY_COORDINATES, Points};

const SALTS: [u64; 3] = [0x51, 0x52, 0x53];

/// Keys of the scrambling of one coordinate.
#[derive(Debug, Clone, Copy)]
struct Scramble {
    add: u64,
    multiply: u64,
    add_last: u64,
}

impl Scramble {
    fn new(seed: u64, replicate: u32, coordinate: u32) -> Self {
        let key = |salt| stream_key(seed, replicate, coordinate, salt);
        Self { add: key(SALTS[0]), multiply: key(SALTS[1]) | 1, add_last: key(SALTS[2]) }
    }

    /// The scrambled fraction of a bit-reversed fraction; both reversed.
    #[inline]
    fn apply_reversed(&self, mut x: u64) -> u64 {
        x = x.wrapping_add(self.add);
        x ^= x.wrapping_mul(0x6c50_b47c_3d20_adea);
        x = x.wrapping_mul(self.multiply);
        x ^= x.wrapping_mul(0x9e5c_28cb_0552_6c56);
        x = x.wrapping_add(self.add_last);
        x ^= x.wrapping_mul(0xb82f_1e53_53a2_2866);
        x ^ x.wrapping_mul(0xc7af_e638_89e1_36b2)
    }
}

/// Owen-scrambled Sobol' points of one replicate.
#[derive(Debug, Clone)]
pub struct OwenPoints {
    scrambles: Vec<Scramble>,
    beyond: IndependentPoints,
}

impl OwenPoints {
    /// The points of this seed and replicate.
    pub fn new(seed: u64, replicate: u32) -> Self {
        Self::with_coordinates(seed, replicate, LOW_DISCREPANCY_COORDINATES)
    }

    /// The same points in their first few coordinates, those beyond from the counter hash: keys cost time where a set has
    /// only a handful of points.
    pub fn with_coordinates(seed: u64, replicate: u32, coordinates: u32) -> Self {
        let low_discrepancy = 0..coordinates.min(LOW_DISCREPANCY_COORDINATES);
        let scrambles = low_discrepancy.map(|c| Scramble::new(seed, replicate, c)).collect();
        Self { scrambles, beyond: IndependentPoints::new(seed, replicate) }
    }
}

impl Points for OwenPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        match self.scrambles.get(coordinate as usize) {
            Some(scramble) => scramble.apply_reversed(sobol_reversed(index, coordinate)).reverse_bits(),
            None => self.beyond.coordinate(index, coordinate),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::to_unit_f64;

    #[test]
    fn scrambling_keeps_the_net() {
        for (seed, replicate) in [(0, 0), (1, 0), (1, 7), (u64::MAX, 3)] {
            let points = OwenPoints::new(seed, replicate);
            let m = 10u32;
            for a in 0..=m {
                let mut count = vec![0u32; 1 << m];
                for i in 0..1u64 << m {
                    let x = points.coordinate(i, 0).checked_shr(64 - a).unwrap_or(0);
                    let y = points.coordinate(i, 1).checked_shr(64 - (m - a)).unwrap_or(0);
                    count[((x << (m - a)) | y) as usize] += 1;
                }
                assert!(count.iter().all(|&c| c == 1), "seed {seed}, replicate {replicate}, a {a}");
            }
        }
    }

    /// Flip of digit `level` for a prefix of `level` digits.
    fn flip(scramble: &Scramble, level: u32, prefix: u64) -> bool {
        let x = prefix & ((1u64 << level) - 1);
        (scramble.apply_reversed(x) >> level) & 1 == 1
    }

    #[test]
    fn flips_are_fair_and_uncorrelated_between_prefixes_and_levels() {
        // For true Owen scrambling every flip is an independent fair bit. Over 4096 keys count agreement of flips of
        // prefixes that differ in one digit, and of successive levels: each a binomial(4096, 1/2), 32 per sigma.
        let keys: Vec<Scramble> = (0..4096).map(|s| Scramble::new(s, 0, 5)).collect();
        let mut worst: f64 = 0.0;
        let mut tests = 0;
        let mut z = |count: usize| {
            let z = (count as f64 - 2048.0) / 32.0;
            worst = worst.max(z.abs());
            tests += 1;
        };
        for level in [0u32, 1, 2, 3, 4, 5, 7, 10, 15, 20, 31, 40, 52] {
            for prefix in [0u64, 1, 0x5555_5555_5555_5555, 0x1234_5678_9abc_def1, 0xfedc_ba98_7654_3211] {
                z(keys.iter().filter(|k| flip(k, level, prefix)).count());
                z(keys.iter().filter(|k| flip(k, level, prefix) == flip(k, level + 1, prefix)).count());
                for digit in 0..level {
                    let other = prefix ^ (1 << digit);
                    z(keys.iter().filter(|k| flip(k, level, prefix) == flip(k, level, other)).count());
                }
            }
        }
        // About 1100 tests: 5.2 sigma has 2e-7 each, 2e-4 in all.
        assert!(worst < 5.2, "worst {worst} sigma in {tests} tests");
    }

    #[test]
    fn variance_of_the_mean_falls_as_owen_says() {
        // f = u v over the unit square: for a scrambled (0, m, 2) net the variance of the mean is far below 1/n of
        // Monte Carlo and its mean over replicates is 1/4: a z-test with the replicates' own spread.
        let n = 256u64;
        let means: Vec<f64> = (0..400)
            .map(|replicate| {
                let points = OwenPoints::new(11, replicate);
                (0..n)
                    .map(|i| to_unit_f64(points.coordinate(i, 0)) * to_unit_f64(points.coordinate(i, 1)))
                    .sum::<f64>()
                    / n as f64
            })
            .collect();
        let mean = means.iter().sum::<f64>() / 400.0;
        let variance = means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / 399.0;
        assert!(((mean - 0.25) / (variance / 400.0).sqrt()).abs() < 4.0);
        let monte_carlo = (1.0 / 9.0 - 1.0 / 16.0) / n as f64;
        assert!(variance < monte_carlo / 100.0, "{variance} against {monte_carlo}");
    }

    #[test]
    fn seeds_replicates_and_coordinates_share_no_stream() {
        let stream = |seed, replicate, coordinate| {
            let points = OwenPoints::new(seed, replicate);
            (0..8).map(|i| points.coordinate(i, coordinate)).collect::<Vec<_>>()
        };
        let mut seen = std::collections::HashSet::new();
        for seed in 0..10 {
            for replicate in 0..8 {
                for coordinate in 0..70 {
                    for value in stream(seed, replicate, coordinate) {
                        assert!(seen.insert(value));
                    }
                }
            }
        }
    }
}
