//! Latin hypercube points: every coordinate by itself is stratified.
//!
//! M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21 (1979) 239-245: coordinate c of point i is
//! (order_c(i) + u) / N with a random order of its own for each coordinate and u uniform. Each coordinate has exactly one
//! point in each of N intervals; nothing is promised about pairs.

use std::num::NonZeroU64;

use super::fraction::Parts;
use super::independent::IndependentPoints;
use super::permutation::{Domain, Permutation};
use super::{LOW_DISCREPANCY_COORDINATES, Points};

/// Latin hypercube points of one replicate, N known. From index N on every interval is visited again, at another place.
/// Coordinates from the 64th on come from the counter hash.
#[derive(Debug, Clone)]
pub struct LatinPoints {
    domain: Domain,
    parts: Parts,
    orders: Vec<Permutation>,
    uniform: IndependentPoints,
}

impl LatinPoints {
    /// The points of this seed and replicate, in this number of intervals.
    pub fn new(seed: u64, replicate: u32, number: NonZeroU64) -> Self {
        let coordinates = 0..LOW_DISCREPANCY_COORDINATES;
        Self {
            domain: Domain::new(number),
            parts: Parts::new(number),
            orders: coordinates.map(|c| Permutation::new(seed, replicate, c)).collect(),
            uniform: IndependentPoints::new(seed, replicate),
        }
    }
}

impl Points for LatinPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        let u = self.uniform.coordinate(index, coordinate);
        match self.orders.get(coordinate as usize) {
            Some(order) => self.parts.within(order.apply(&self.domain, self.parts.wrap(index)), u),
            None => u,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_point_an_interval_in_every_coordinate() {
        for number in [1u64, 2, 3, 10, 64, 1000] {
            let points = LatinPoints::new(9, 1, NonZeroU64::new(number).unwrap());
            for c in [0, 1, 2, 31, 63] {
                for start in [0, (1 << 50) / number * number] {
                    let mut seen = vec![false; number as usize];
                    for i in start..start + number {
                        let cell = (u128::from(points.coordinate(i, c)) * u128::from(number)) >> 64;
                        assert!(
                            !std::mem::replace(&mut seen[cell as usize], true),
                            "N {number}, coordinate {c}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn coordinates_have_orders_of_their_own() {
        // Spearman's rank correlation of two coordinates: mean 0, variance 1 / (N - 1).
        let number = 2000u64;
        for seed in 0..20 {
            let points = LatinPoints::new(seed, 0, NonZeroU64::new(number).unwrap());
            let rank = |i, c| (u128::from(points.coordinate(i, c)) * u128::from(number) >> 64) as f64;
            let middle = (number as f64 - 1.0) / 2.0;
            let product: f64 = (0..number).map(|i| (rank(i, 0) - middle) * (rank(i, 1) - middle)).sum();
            let variance = (number as f64).powi(2) / 12.0;
            let z = product / number as f64 / variance * (number as f64).sqrt();
            assert!(z.abs() < 4.2, "seed {seed}: {z} sigma");
        }
    }
}
