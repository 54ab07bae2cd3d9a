//! Fractions i / N as exact 64-bit numbers, for point sets that know how many points they have.

use std::num::NonZeroU64;

/// The N equal parts of [0, 1), N known.
#[derive(Debug, Clone, Copy)]
pub struct Parts {
    number: u64,
    /// floor((2^128 - 1) / N).
    reciprocal: u128,
}

impl Parts {
    /// [0, 1) in this number of equal parts.
    pub fn new(number: NonZeroU64) -> Self {
        Self { number: number.get(), reciprocal: u128::MAX / u128::from(number.get()) }
    }

    /// N.
    #[inline]
    pub fn number(&self) -> u64 {
        self.number
    }

    /// The index modulo N: an index that is below N already costs a comparison.
    #[inline]
    pub fn wrap(&self, index: u64) -> u64 {
        if index < self.number { index } else { index % self.number }
    }

    /// floor(part 2^64 / N), and whether nothing was cut off; `part` is below N.
    #[inline]
    fn divide(&self, part: u64) -> (u64, bool) {
        debug_assert!(part < self.number);
        // The product with the rounded reciprocal is the quotient or one less.
        let quotient = ((u128::from(part) * self.reciprocal) >> 64) as u64;
        let remainder = (u128::from(part) << 64) - u128::from(quotient) * u128::from(self.number);
        let number = u128::from(self.number);
        if remainder >= number { (quotient + 1, remainder == number) } else { (quotient, remainder == 0) }
    }

    /// part / N rounded down, for `part` below N.
    #[inline]
    pub fn fraction(&self, part: u64) -> u64 {
        self.divide(part).0
    }

    /// The least 64-bit fraction that is not below part / N, in 2^-64; `part` = N gives 2^64.
    #[inline]
    fn first_within(&self, part: u64) -> u128 {
        if part == self.number {
            return 1 << 64;
        }
        let (quotient, exact) = self.divide(part);
        u128::from(quotient) + u128::from(!exact)
    }

    /// The fraction at `u` of the way through part `part` (below N): in [part / N, (part + 1) / N) exactly, whatever
    /// `u`, so that one number a part is one number in each of N equal intervals. N is at most 2^63.
    #[inline]
    pub fn within(&self, part: u64, u: u64) -> u64 {
        let first = self.first_within(part);
        let width = self.first_within(part + 1) - first;
        // The width is 2^64 where there is one part only, so its upper half is a single bit.
        let offset = if width >> 64 == 0 { (u128::from(u) * width) >> 64 } else { u128::from(u) };
        (first + offset) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::hash::mix64;

    const NUMBERS: [u64; 15] = [
        1,
        2,
        3,
        5,
        7,
        1000,
        1 << 20,
        (1 << 20) + 1,
        4_456_448,
        (1 << 32) - 1,
        1 << 32,
        (1 << 32) + 15,
        (1 << 48) - 59,
        1 << 48,
        (1 << 63) - 25,
    ];

    fn some_parts(number: u64) -> impl Iterator<Item = u64> {
        (0..20).chain(number.saturating_sub(20)..number).chain((0..200).map(mix64)).map(move |k| k % number)
    }

    #[test]
    fn quotients_are_those_of_long_division() {
        for number in NUMBERS.into_iter().chain([u64::MAX, u64::MAX - 58]) {
            let parts = Parts::new(NonZeroU64::new(number).unwrap());
            for part in some_parts(number) {
                let exact = (u128::from(part) << 64) / u128::from(number);
                assert_eq!(u128::from(parts.fraction(part)), exact, "{part} / {number}");
            }
        }
    }

    #[test]
    fn numbers_within_a_part_stay_in_it() {
        for number in NUMBERS {
            let parts = Parts::new(NonZeroU64::new(number).unwrap());
            for part in some_parts(number) {
                for u in [0, 1, 1 << 63, u64::MAX - 1, u64::MAX, mix64(part)] {
                    let x = u128::from(parts.within(part, u));
                    let n = u128::from(number);
                    // floor(x N / 2^64) == part, without rounding.
                    assert_eq!((x * n) >> 64, u128::from(part), "{part} of {number}, u {u}");
                }
            }
        }
    }
}
