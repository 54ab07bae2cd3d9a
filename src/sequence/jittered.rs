//! Jittered points: one point in each stratum of every pair of coordinates.
//!
//! Coordinates 2j and 2j + 1 lie on a grid of a x b equal rectangles, a b = N, a the largest divisor of N not above its
//! square root: one point a rectangle, uniform inside. Each pair visits the rectangles in a random order of its own. A
//! number of points that has no divisor near its root has a grid that is as bad as that; a prime N jitters the odd
//! coordinate of each pair only.

use std::num::NonZeroU64;

use super::fraction::Parts;
use super::independent::IndependentPoints;
use super::permutation::{Domain, Permutation};
use super::{LOW_DISCREPANCY_COORDINATES, Points};

/// Jittered points of one replicate, N known. From index N on every rectangle is visited again, at another place.
/// Coordinates from the 64th on come from the counter hash.
#[derive(Debug, Clone)]
pub struct JitteredPoints {
    domain: Domain,
    all: Parts,
    columns: Parts,
    rows: Parts,
    orders: Vec<Permutation>,
    uniform: IndependentPoints,
}

impl JitteredPoints {
    /// The points of this seed and replicate, in this number of strata. Finding the grid takes up to sqrt(N) divisions.
    pub fn new(seed: u64, replicate: u32, number: NonZeroU64) -> Self {
        let columns = largest_divisor_up_to_root(number);
        // The quotient by a divisor is not zero.
        let rows = NonZeroU64::new(number.get() / columns.get()).unwrap_or(NonZeroU64::MIN);
        let pairs = LOW_DISCREPANCY_COORDINATES / 2;
        Self {
            domain: Domain::new(number),
            all: Parts::new(number),
            columns: Parts::new(columns),
            rows: Parts::new(rows),
            orders: (0..pairs).map(|pair| Permutation::new(seed, replicate, pair)).collect(),
            uniform: IndependentPoints::new(seed, replicate),
        }
    }
}

impl Points for JitteredPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        let u = self.uniform.coordinate(index, coordinate);
        let Some(order) = self.orders.get(coordinate as usize / 2) else {
            return u;
        };
        let rectangle = order.apply(&self.domain, self.all.wrap(index));
        let columns = self.columns.number();
        if coordinate.is_multiple_of(2) {
            self.columns.within(rectangle % columns, u)
        } else {
            self.rows.within(rectangle / columns, u)
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

    /// Columns and rows of the grid that each pair of coordinates has.
    fn grid(points: &JitteredPoints) -> (u64, u64) {
        (points.columns.number(), points.rows.number())
    }

    #[test]
    fn one_point_a_rectangle_in_every_pair() {
        for number in [1u64, 2, 7, 12, 36, 100, 210, 1024, 1000] {
            let points = JitteredPoints::new(5, 2, NonZeroU64::new(number).unwrap());
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
            assert_eq!(self::grid(&JitteredPoints::new(1, 0, NonZeroU64::new(number).unwrap())), grid);
        }
    }
}
