//! The radical inverse of an index, exact to the last of 64 bits.
//!
//! phi_b(i) = sum d_k b^-(k+1) over the digits d_k of i in base b: the digits mirrored at the point. The result is
//! floor(phi 2^64) for every 64-bit index, computed in integers: nothing accumulates, whatever the base and however large
//! the index.
//!
//! The index is cut into chunks of as many digits as a small table can mirror at once. Each chunk adds its mirrored
//! value times a 128-bit weight that is rounded down; the sum is too small by less than a known number of units 2^-128.
//! Only where that could change one of the upper 64 bits, the quotient is formed by long division.

/// Most entries of the table that mirrors a chunk of digits.
const CHUNK: u64 = 4096;

/// Radical inverses in one base, with or without a permutation of the digits.
#[derive(Debug, Clone)]
pub struct Radix {
    base: u64,
    permutation: Vec<u64>,
    /// base^k, the values that a chunk of k digits takes.
    chunk: u64,
    /// floor(2^64 / chunk).
    reciprocal: u64,
    /// Mirrored and permuted digits of every chunk.
    mirrored: Vec<u16>,
    /// floor(2^128 / chunk^(j+1)) for chunk j, as many as a 64-bit index has.
    weights: Vec<u128>,
    /// More than what the sum of all chunks can be short of, in units of 2^-128.
    slack: u64,
}

impl Radix {
    /// Radical inverses in an odd base below 4096 whose digit d counts as `permutation[d]`; `permutation` has one entry
    /// a digit and keeps 0.
    pub(super) fn new(base: u64, permutation: Vec<u64>) -> Self {
        debug_assert!(base % 2 == 1 && base > 2 && base < CHUNK);
        debug_assert!(permutation.len() as u64 == base && permutation[0] == 0);
        let mut mirrored: Vec<u16> = permutation.iter().map(|&s| s as u16).collect();
        let mut chunk = base;
        while chunk * base <= CHUNK {
            // One more digit: the new one, the most significant of the index, counts least.
            mirrored = (0..chunk * base)
                .map(|i| {
                    mirrored[(i % chunk) as usize] * base as u16 + permutation[(i / chunk) as usize] as u16
                })
                .collect();
            chunk *= base;
        }
        // An odd number above 1 does not divide 2^64 or 2^128, so the quotient of one less is the same.
        let reciprocal = u64::MAX / chunk;
        let mut weights = vec![u128::MAX / u128::from(chunk)];
        let mut reach = u128::from(chunk);
        while reach <= u128::from(u64::MAX) {
            reach *= u128::from(chunk);
            weights.push(weights[weights.len() - 1] / u128::from(chunk));
        }
        let slack = weights.len() as u64 * chunk;
        Self { base, permutation, chunk, reciprocal, mirrored, weights, slack }
    }

    /// floor(phi_b(index) 2^64).
    #[inline]
    pub fn inverse(&self, index: u64) -> u64 {
        let (mut rest, mut sum) = (index, 0u128);
        for weight in &self.weights {
            if rest == 0 {
                break;
            }
            // The product with the rounded reciprocal is the quotient or one less.
            let mut quotient = ((u128::from(rest) * u128::from(self.reciprocal)) >> 64) as u64;
            let mut digits = rest - quotient * self.chunk;
            if digits >= self.chunk {
                digits -= self.chunk;
                quotient += 1;
            }
            sum += u128::from(self.mirrored[digits as usize]) * weight;
            rest = quotient;
        }
        if (sum as u64).checked_add(self.slack).is_none() {
            return self.inverse_by_division(index);
        }
        (sum >> 64) as u64
    }

    /// The same by long division of the mirrored index by the power of the base: two steps of 32 bits.
    #[cold]
    fn inverse_by_division(&self, index: u64) -> u64 {
        let base = u128::from(self.base);
        let (mut rest, mut numerator, mut denominator) = (index, 0u128, 1u128);
        while rest != 0 {
            numerator = numerator * base + u128::from(self.permutation[(rest % self.base) as usize]);
            denominator *= base;
            rest /= self.base;
        }
        // The denominator is at most 4095 2^64, so 32 more bits fit.
        let high = (numerator << 32) / denominator;
        let low = (((numerator << 32) % denominator) << 32) / denominator;
        ((high << 32) | low) as u64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::faure::faure_permutation;
    use crate::sequence::hash::mix64;
    use crate::sequence::primes::PRIMES;

    fn plain(base: u64) -> Radix {
        Radix::new(base, (0..base).collect())
    }

    /// The mirrored digits as a fraction numerator / base^digits.
    fn fraction(base: u64, permutation: &[u64], index: u64) -> (u128, u128) {
        let (mut numerator, mut denominator, mut rest) = (0, 1, index);
        while rest > 0 {
            numerator = numerator * u128::from(base) + u128::from(permutation[(rest % base) as usize]);
            denominator *= u128::from(base);
            rest /= base;
        }
        (numerator, denominator)
    }

    /// The first 64 binary digits of a fraction below 1, one by one.
    fn binary(numerator: u128, denominator: u128) -> u64 {
        let (mut rest, mut bits) = (numerator, 0);
        for _ in 0..64 {
            rest *= 2;
            bits = 2 * bits + u64::from(rest >= denominator);
            if rest >= denominator {
                rest -= denominator;
            }
        }
        bits
    }

    fn check(radix: &Radix, permutation: &[u64], index: u64) {
        let (numerator, denominator) = fraction(radix.base, permutation, index);
        assert_eq!(
            radix.inverse(index),
            binary(numerator, denominator),
            "base {}, index {index}",
            radix.base
        );
    }

    #[test]
    fn every_bit_is_that_of_the_rational_number() {
        for &base in &PRIMES[1..] {
            for permutation in [(0..base).collect(), faure_permutation(base)] {
                let radix = Radix::new(base, permutation.clone());
                let mut power = 1u64;
                while let Some(next) = power.checked_mul(base) {
                    power = next;
                    for index in [power - 2, power - 1, power, power + 1, power.wrapping_neg()] {
                        check(&radix, &permutation, index);
                    }
                }
                for index in (0..300).chain(u64::MAX - 20..=u64::MAX).chain([7_971_615, (1 << 34) + 5]) {
                    check(&radix, &permutation, index);
                }
                for k in 0..400 {
                    check(&radix, &permutation, mix64(k) >> (k % 64));
                }
            }
        }
    }

    #[test]
    fn a_known_large_index_in_base_3() {
        // 7 971 615 = 3^14 + 2 3^13, so its radical inverse is 2 3^-14 + 3^-15 = 7 / 3^15.
        assert_eq!(plain(3).inverse(7_971_615), ((7u128 << 64) / 3u128.pow(15)) as u64);
        // Beyond 2^34: 3^25 = 847 288 609 443, and with all 25 digits below it 2.
        assert_eq!(plain(3).inverse(847_288_609_443), ((1u128 << 64) / 3u128.pow(26)) as u64);
        assert_eq!(plain(3).inverse(847_288_609_442), (((3u128.pow(25) - 1) << 64) / 3u128.pow(25)) as u64);
    }

    #[test]
    fn fractions_next_to_a_64_bit_number_fall_on_their_side_of_it() {
        // The worst case: a mirrored index R with R 2^64 = k modulo b^m, k a small number of either sign, so that phi lies
        // k b^-m 2^-64 beside a 64-bit fraction. Without the long division those just above come out one too small.
        for &base in &PRIMES[1..] {
            let radix = plain(base);
            let mut power = u128::from(base);
            let mut digits = 1;
            while power * u128::from(base) <= u128::from(u64::MAX) {
                power *= u128::from(base);
                digits += 1;
            }
            for k in [1u128, 2, 3, 4, 5, 6, 7, 10, 100].into_iter().flat_map(|k| [k, power - k]) {
                let mut mirrored = k;
                for _ in 0..64 {
                    mirrored = if mirrored % 2 == 0 { mirrored / 2 } else { (mirrored + power) / 2 };
                }
                let index = (0..digits).fold((0u128, mirrored), |(index, rest), _| {
                    (index * u128::from(base) + rest % u128::from(base), rest / u128::from(base))
                });
                check(&radix, &(0..base).collect::<Vec<_>>(), index.0 as u64);
            }
        }
    }
}
