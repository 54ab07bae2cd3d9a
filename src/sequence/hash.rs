//! Integer hashes: keys for (seed, replicate, coordinate) and the counter hash.

/// A bijective 64-bit mixer ("variant 13" of D. Stafford, the finaliser of SplitMix64; Steele, Lea, Flood 2014).
#[inline]
pub const fn mix64(mut x: u64) -> u64 {
    x ^= x >> 30;
    x = x.wrapping_mul(0xbf58_476d_1ce4_e5b9);
    x ^= x >> 27;
    x = x.wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

/// The odd number nearest 2^64 / golden ratio: successive multiples fill 64 bits evenly.
pub const GOLDEN: u64 = 0x9e37_79b9_7f4a_7c15;

/// A key for the stream (seed, replicate, coordinate, salt). Each part is mixed before the next is added, so that
/// neighbouring seeds, replicates and coordinates have unrelated keys.
#[inline]
pub const fn stream_key(seed: u64, replicate: u32, coordinate: u32, salt: u64) -> u64 {
    let a = mix64(seed.wrapping_add(GOLDEN).wrapping_add(mix64(salt)));
    let b = mix64(a ^ (replicate as u64).wrapping_mul(GOLDEN).wrapping_add(0x2545_f491_4f6c_dd1d));
    mix64(b.wrapping_add((coordinate as u64 + 1).wrapping_mul(0xd1b5_4a32_d192_ed03)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn splitmix64_reference_values() {
        // First outputs of SplitMix64 from state 0 (Vigna's reference code): mix64 of the multiples of GOLDEN.
        assert_eq!(mix64(GOLDEN), 0xe220_a839_7b1d_cdaf);
        assert_eq!(mix64(GOLDEN.wrapping_mul(2)), 0x6e78_9e6a_a1b9_65f4);
    }

    #[test]
    fn keys_of_neighbours_never_collide() {
        let mut seen = HashSet::new();
        for seed in 0..40 {
            for replicate in 0..20 {
                for coordinate in 0..70 {
                    for salt in 0..3 {
                        assert!(seen.insert(stream_key(seed, replicate, coordinate, salt)));
                    }
                }
            }
        }
    }
}
