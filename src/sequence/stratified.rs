//! Stratified points: one uniform point in each of N strata, which are visited in random orders.
//!
//! Latin hypercube points (M. D. McKay, R. J. Beckman and W. J. Conover, Technometrics 21 (1979) 239-245): coordinate c of
//! point i is (order_c(i) + u) / N with a random order of its own for each coordinate and u uniform. Each coordinate has
//! exactly one point in each of N intervals; nothing is promised about pairs.
//!
//! Jittered points: coordinates 2j and 2j + 1 lie on a grid of a x b equal rectangles, a b = N, a the largest divisor of N
//! not above its square root: one point a rectangle, uniform inside. Each pair visits the rectangles in a random order of
//! its own. A number of points that has no divisor near its root has a grid that is as bad as that; a prime N jitters the
//! odd coordinate of each pair only.

use std::num::NonZeroU64;

use super::fraction::Parts;
use super::independent::IndependentPoints;
use super::permutation::{Domain, Permutation};
use super::{LOW_DISCREPANCY_COORDINATES, Points};

/// Stratified points of one replicate, N known. From index N on every stratum is visited again, at another place.
/// Coordinates from the 64th on come from the counter hash.
#[derive(Debug, Clone)]
pub struct StratifiedPoints {
    domain: Domain,
    all: Parts,
    /// Columns and rows of each pair of coordinates; none where each coordinate is divided by itself.
    grid: Option<[Parts; 2]>,
    orders: Vec<Permutation>,
    uniform: IndependentPoints,
}

impl StratifiedPoints {
    fn new(seed: u64, replicate: u32, number: NonZeroU64, grid: Option<[Parts; 2]>) -> Self {
        let orders = LOW_DISCREPANCY_COORDINATES / if grid.is_some() { 2 } else { 1 };
        Self {
            domain: Domain::new(number),
            all: Parts::new(number),
            grid,
            orders: (0..orders).map(|stream| Permutation::new(seed, replicate, stream)).collect(),
            uniform: IndependentPoints::new(seed, replicate),
        }
    }

    /// The Latin hypercube points of this seed and replicate, in this number of intervals.
    pub fn latin(seed: u64, replicate: u32, number: NonZeroU64) -> Self {
        Self::new(seed, replicate, number, None)
    }

    /// The jittered points of this seed and replicate, in this number of rectangles. Finding the grid takes up to sqrt(N)
    /// divisions.
    pub fn jittered(seed: u64, replicate: u32, number: NonZeroU64) -> Self {
        let columns = largest_divisor_up_to_root(number);
        // The quotient by a divisor is not zero.
        let rows = NonZeroU64::new(number.get() / columns.get()).unwrap_or(NonZeroU64::MIN);
        Self::new(seed, replicate, number, Some([columns, rows].map(Parts::new)))
    }
}

impl Points for StratifiedPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        let u = self.uniform.coordinate(index, coordinate);
        let order = if self.grid.is_some() { coordinate / 2 } else { coordinate };
        let Some(order) = self.orders.get(order as usize) else {
            return u;
        };
        let stratum = order.apply(&self.domain, self.all.wrap(index));
        match &self.grid {
            None => self.all.within(stratum, u),
            Some([columns, _]) if coordinate.is_multiple_of(2) => {
                columns.within(stratum % columns.number(), u)
            }
            Some([columns, rows]) => rows.within(stratum / columns.number(), u),
        }
    }
}

fn largest_divisor_up_to_root(number: NonZeroU64) -> NonZeroU64 {
    let root = number.get().isqrt();
    let divisor = (1..=root).rev().find(|d| number.get().is_multiple_of(*d));
    divisor.and_then(NonZeroU64::new).unwrap_or(NonZeroU64::MIN)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_point_an_interval_in_every_coordinate() {
        for number in [1u64, 2, 3, 10, 64, 1000] {
            let points = StratifiedPoints::latin(9, 1, NonZeroU64::new(number).unwrap());
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
            let points = StratifiedPoints::latin(seed, 0, NonZeroU64::new(number).unwrap());
            let rank = |i, c| ((u128::from(points.coordinate(i, c)) * u128::from(number)) >> 64) as f64;
            let middle = (number as f64 - 1.0) / 2.0;
            let product: f64 = (0..number).map(|i| (rank(i, 0) - middle) * (rank(i, 1) - middle)).sum();
            let variance = (number as f64).powi(2) / 12.0;
            let z = product / number as f64 / variance * (number as f64).sqrt();
            assert!(z.abs() < 4.2, "seed {seed}: {z} sigma");
        }
    }

    /// Columns and rows of the grid that each pair of coordinates has.
    fn grid(points: &StratifiedPoints) -> (u64, u64) {
        points.grid.map(|[columns, rows]| (columns.number(), rows.number())).unwrap()
    }

    #[test]
    fn one_point_a_rectangle_in_every_pair() {
        for number in [1u64, 2, 7, 12, 36, 100, 210, 1024, 1000] {
            let points = StratifiedPoints::jittered(5, 2, NonZeroU64::new(number).unwrap());
            let (columns, rows) = grid(&points);
            assert!(columns * rows == number && columns <= rows);
            for pair in [0, 1, 15, 31] {
                for start in [0, number, (1 << 50) / number * number] {
                    let mut seen = vec![false; number as usize];
                    for i in start..start + number {
                        let x = (u128::from(points.coordinate(i, 2 * pair)) * u128::from(columns)) >> 64;
                        let y = (u128::from(points.coordinate(i, 2 * pair + 1)) * u128::from(rows)) >> 64;
                        let at = x as usize * rows as usize + y as usize;
                        assert!(!std::mem::replace(&mut seen[at], true), "N {number}, pair {pair}");
                    }
                }
            }
        }
    }

    #[test]
    fn grids_are_as_square_as_the_number_allows() {
        for (number, grid) in
            [(36, (6, 6)), (4_456_448, (2048, 2176)), (13, (1, 13)), (1 << 48, (1 << 24, 1 << 24))]
        {
            assert_eq!(self::grid(&StratifiedPoints::jittered(1, 0, NonZeroU64::new(number).unwrap())), grid);
        }
    }
}
