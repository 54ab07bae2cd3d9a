//! Keyed random orders of 0..N without a table: which stratum point i has.

use std::num::NonZeroU64;

use super::hash::stream_key;

const ROUNDS: usize = 4;
const SALTS: [u64; ROUNDS] = [0x71, 0x72, 0x73, 0x74];
const SALTS_MULTIPLY: [u64; ROUNDS] = [0x75, 0x76, 0x77, 0x78];

/// The numbers 0..N inside the least power of two that holds them.
#[derive(Debug, Clone, Copy)]
pub struct Domain {
    number: u64,
    mask: u64,
    shift: u32,
}

impl Domain {
    /// The domain 0..N.
    pub fn new(number: NonZeroU64) -> Self {
        let last = number.get() - 1;
        let bits = u64::BITS - last.leading_zeros();
        Self {
            number: number.get(),
            mask: if bits == 0 { 0 } else { u64::MAX >> (u64::BITS - bits) },
            shift: bits.div_ceil(2).max(1),
        }
    }
}

/// The key of one permutation.
#[derive(Debug, Clone, Copy)]
pub struct Permutation {
    add: [u64; ROUNDS],
    multiply: [u64; ROUNDS],
}

impl Permutation {
    /// The permutation of this seed, replicate and stream.
    pub fn new(seed: u64, replicate: u32, stream: u32) -> Self {
        Self {
            add: SALTS.map(|salt| stream_key(seed, replicate, stream, salt)),
            multiply: SALTS_MULTIPLY.map(|salt| stream_key(seed, replicate, stream, salt) | 1),
        }
    }

    /// Where `x`, below N, goes: a bijection of 0..N.
    ///
    /// Additions, odd multiplications and shifts to the right that are added without carry permute the numbers of w
    /// bits, 2^(w-1) < N <= 2^w. A value outside 0..N is mapped on until it lies inside (cycle walking: Black and
    /// Rogaway, CT-RSA 2002), fewer than twice in the mean.
    #[inline]
    pub fn apply(&self, domain: &Domain, mut x: u64) -> u64 {
        loop {
            for (add, multiply) in self.add.iter().zip(&self.multiply) {
                x = x.wrapping_add(*add).wrapping_mul(*multiply) & domain.mask;
                x ^= x >> domain.shift;
            }
            if x < domain.number {
                return x;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn domain(number: u64) -> Domain {
        Domain::new(NonZeroU64::new(number).unwrap())
    }

    #[test]
    fn every_number_is_reached_once() {
        for number in (1..70).chain([127, 128, 129, 1000, 1024, 4096, 5000]) {
            for seed in 0..20 {
                let permutation = Permutation::new(seed, 3, 1);
                let mut seen = vec![false; number as usize];
                for i in 0..number {
                    let at = permutation.apply(&domain(number), i) as usize;
                    assert!(!std::mem::replace(&mut seen[at], true), "number {number}, seed {seed}");
                }
            }
        }
    }

    #[test]
    fn large_domains_stay_inside() {
        for number in [(1u64 << 32) + 1, (1 << 48) - 59, 1 << 48, u64::MAX] {
            let permutation = Permutation::new(1, 0, 0);
            for i in (0..100).chain(number - 100..number) {
                assert!(permutation.apply(&domain(number), i) < number);
            }
        }
    }

    #[test]
    fn all_orders_come_equally_often() {
        // Where the first two elements go, over many keys: N (N - 1) equally likely cells. Normal approximation of
        // chi-square; nine of them, so 4.5 sigma is 6e-5 in all.
        for number in [3u64, 4, 5, 8, 11, 16, 20, 33, 64] {
            let keys = 400 * number * (number - 1);
            let mut counts = vec![0u32; (number * number) as usize];
            for seed in 0..keys {
                let permutation = Permutation::new(seed, 0, 0);
                let (a, b) = (permutation.apply(&domain(number), 0), permutation.apply(&domain(number), 1));
                counts[(a * number + b) as usize] += 1;
            }
            let cells: Vec<u32> = (0..number * number)
                .filter(|k| k / number != k % number)
                .map(|k| counts[k as usize])
                .collect();
            let chi: f64 = cells.iter().map(|c| (f64::from(*c) - 400.0).powi(2) / 400.0).sum();
            let degrees = cells.len() as f64 - 1.0;
            let z = (chi - degrees) / (2.0 * degrees).sqrt();
            assert!(z.abs() < 4.5, "N {number}: {z} sigma");
        }
    }
}
