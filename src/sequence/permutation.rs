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
    passes: u32,
}

/// Bits of a domain up to which the rounds are passed more than once, each time with other bits of the keys: there few
/// rounds reach some orders more often than others, and time is no matter.
const SMALL: u32 = 16;

impl Domain {
    /// The domain 0..N.
    pub fn new(number: NonZeroU64) -> Self {
        let last = number.get() - 1;
        let bits = u64::BITS - last.leading_zeros();
        Self {
            number: number.get(),
            mask: if bits == 0 { 0 } else { u64::MAX >> (u64::BITS - bits) },
            shift: bits.div_ceil(2).max(1),
            passes: if bits <= SMALL { u64::BITS / SMALL } else { 1 },
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
            multiply: SALTS_MULTIPLY.map(|salt| stream_key(seed, replicate, stream, salt)),
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
            for pass in 0..domain.passes {
                for (add, multiply) in self.add.iter().zip(&self.multiply) {
                    let (add, multiply) = (add >> (SMALL * pass), multiply >> (SMALL * pass) | 1);
                    x = x.wrapping_add(add).wrapping_mul(multiply) & domain.mask;
                    x ^= x >> domain.shift;
                }
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

    #[test]
    fn neighbours_go_to_unrelated_places() {
        // Where i and i + 1, and i and i + N / 2, go, in 16 x 16 boxes over one order: chi-square against even boxes. 48 of
        // them, so 4.8 sigma is 8e-5 in all.
        for number in [1u64 << 12, 10_007, 1 << 17, 100_003, (1 << 40) + 7, 1 << 48] {
            for seed in 0..4 {
                let permutation = Permutation::new(seed, 1, 2);
                let place = |i| {
                    (u128::from(permutation.apply(&domain(number), i)) * 16 / u128::from(number)) as usize
                };
                for far in [1, number / 2] {
                    let count = 4000.min(number / 2);
                    let mut boxes = [0u32; 256];
                    for i in 0..count {
                        boxes[16 * place(i) + place(i + far)] += 1;
                    }
                    let expected = count as f64 / 256.0;
                    let chi: f64 = boxes.iter().map(|b| (f64::from(*b) - expected).powi(2) / expected).sum();
                    let z = (chi - 255.0) / 510f64.sqrt();
                    assert!(z.abs() < 4.8, "N {number}, seed {seed}, {far} apart: {z} sigma");
                }
            }
        }
    }
}
