//! Sobol' points (LP-tau) with 64-bit coordinates.
//!
//! Point i, coordinate j is the exclusive-or of the direction numbers v_jk over the set bits k of i (I. M. Sobol',
//! 1967; no Gray code, so that point i is a function of i alone). Direction numbers are those of [`super::joe_kuo`],
//! continued to 64 bits by their own recurrence, so indices up to 2^64 - 1 and 2^64 points are distinct.
//! The first point is the origin and is kept: powers of two from index 0 are nets.

use super::independent::UNSEEDED;
use super::joe_kuo::ROWS;
use super::{LOW_DISCREPANCY_COORDINATES, Points};

const NIBBLES: usize = 16;

/// XOR of direction numbers for every value of every 4-bit digit of the index, digits reversed: bit 0 of an entry is
/// the digit of weight 1/2. The reversed form is what scrambling works on.
type NibbleTable = [[u64; 16]; NIBBLES];

static TABLES: [NibbleTable; LOW_DISCREPANCY_COORDINATES as usize] = nibble_tables();

/// Coordinate `coordinate` (< 64) of Sobol' point `index` with its bits reversed: bit 0 has weight 1/2.
#[inline]
pub fn sobol_reversed(index: u64, coordinate: u32) -> u64 {
    let table = &TABLES[coordinate as usize];
    let (mut rest, mut digit, mut bits) = (index, 0, 0);
    while rest != 0 {
        bits ^= table[digit & (NIBBLES - 1)][(rest & 15) as usize];
        rest >>= 4;
        digit += 1;
    }
    bits
}

/// Plain Sobol' points. Coordinates from the 64th on come from the counter hash with seed 0: plain Sobol' has no seed.
#[derive(Debug, Clone)]
pub struct SobolPoints;

impl Points for SobolPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        if coordinate < LOW_DISCREPANCY_COORDINATES {
            sobol_reversed(index, coordinate).reverse_bits()
        } else {
            UNSEEDED.coordinate(index, coordinate)
        }
    }
}

/// Direction numbers of one coordinate, v_k = m_k / 2^(k+1) as 64-bit fractions, k = 0..63.
const fn directions(coordinate: usize) -> [u64; 64] {
    let mut v = [0u64; 64];
    let mut k = 0;
    let (degree, coefficients, initial) = ROWS[coordinate];
    let s = degree as usize;
    while k < 64 {
        if k < s {
            v[k] = (initial[k] as u64) << (63 - k);
        } else {
            // Bratley and Fox (1988): v_k = a_1 v_{k-1} + ... + a_{s-1} v_{k-s+1} + v_{k-s} + v_{k-s} / 2^s.
            let mut value = v[k - s] ^ (v[k - s] >> s);
            let mut i = 1;
            while i < s {
                if (coefficients >> (s - 1 - i)) & 1 == 1 {
                    value ^= v[k - i];
                }
                i += 1;
            }
            v[k] = value;
        }
        k += 1;
    }
    v
}

const fn nibble_tables() -> [NibbleTable; LOW_DISCREPANCY_COORDINATES as usize] {
    let mut tables = [[[0u64; 16]; NIBBLES]; LOW_DISCREPANCY_COORDINATES as usize];
    let mut coordinate = 0;
    while coordinate < tables.len() {
        let v = directions(coordinate);
        let mut digit = 0;
        while digit < NIBBLES {
            let mut value = 1usize;
            while value < 16 {
                // One bit more than a value that stands before it in the table.
                let (others, bit) = (value & (value - 1), value.trailing_zeros() as usize);
                let added = v[4 * digit + bit].reverse_bits();
                tables[coordinate][digit][value] = tables[coordinate][digit][others] ^ added;
                value += 1;
            }
            digit += 1;
        }
        coordinate += 1;
    }
    tables
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::to_unit_f64;

    #[test]
    fn first_points_are_the_published_ones() {
        // Joe and Kuo's own programme prints these for d = 1..4 in Gray-code order; here in natural order.
        let expected = [
            [0.0, 0.0, 0.0, 0.0],
            [0.5, 0.5, 0.5, 0.5],
            [0.25, 0.75, 0.75, 0.75],
            [0.75, 0.25, 0.25, 0.25],
            [0.125, 0.625, 0.375, 0.125],
            [0.625, 0.125, 0.875, 0.625],
        ];
        let points = SobolPoints;
        for (i, row) in expected.iter().enumerate() {
            for (j, &u) in row.iter().enumerate() {
                assert_eq!(
                    to_unit_f64(points.coordinate(i as u64, j as u32)),
                    u,
                    "point {i}, coordinate {j}"
                );
            }
        }
    }

    #[test]
    fn the_last_coordinates_agree_with_an_independent_implementation() {
        // Coordinates 60 to 63 of points 2, 4 and 6 as the crate `sobol` 1.0.2 gives them (JoeKuoD6).
        let expected = [
            (2, [0.75, 0.25, 0.25, 0.25]),
            (4, [0.875, 0.125, 0.625, 0.375]),
            (6, [0.125, 0.375, 0.875, 0.125]),
        ];
        let points = SobolPoints;
        for (i, row) in expected {
            for (j, u) in row.into_iter().enumerate() {
                assert_eq!(
                    to_unit_f64(points.coordinate(i, 60 + j as u32)),
                    u,
                    "point {i}, coordinate {}",
                    60 + j
                );
            }
        }
    }

    #[test]
    fn every_coordinate_is_a_permutation_of_the_dyadic_fractions() {
        let points = SobolPoints;
        for coordinate in 0..LOW_DISCREPANCY_COORDINATES {
            let mut seen = vec![false; 1 << 12];
            for i in 0..1 << 12 {
                let cell = (points.coordinate(i, coordinate) >> 52) as usize;
                assert!(!std::mem::replace(&mut seen[cell], true), "coordinate {coordinate}");
            }
        }
    }

    #[test]
    fn the_first_two_coordinates_are_a_zero_net() {
        // Every elementary interval 2^-a x 2^-(m-a) holds exactly one of the 2^m points; also in a block far beyond
        // 2^32.
        let points = SobolPoints;
        let m = 10u32;
        for start in [0u64, 1 << 40, 5 << 33] {
            for a in 0..=m {
                let mut count = vec![0u32; 1 << m];
                for i in start..start + (1 << m) {
                    let x = points.coordinate(i, 0).checked_shr(64 - a).unwrap_or(0);
                    let y = points.coordinate(i, 1).checked_shr(64 - (m - a)).unwrap_or(0);
                    count[((x << (m - a)) | y) as usize] += 1;
                }
                assert!(count.iter().all(|&c| c == 1), "start {start}, a {a}");
            }
        }
    }

    #[test]
    fn points_beyond_two_to_the_32_differ_from_all_before_in_every_coordinate() {
        let points = SobolPoints;
        for coordinate in 0..LOW_DISCREPANCY_COORDINATES {
            let low = points.coordinate(3, coordinate);
            for far in [(1u64 << 32) + 3, (1 << 45) + 3, (1 << 63) + 3] {
                assert_ne!(points.coordinate(far, coordinate), low);
            }
        }
    }
}
