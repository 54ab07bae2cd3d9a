//! Weyl points: frac(i sqrt(p_c)) for the first primes.
//!
//! H. Weyl (1916): multiples of numbers that are independent over the rationals are uniform modulo 1, and square roots
//! of different primes are. The fractional parts are exact to 128 bits; see [`super::kronecker`] for the rest.

use std::sync::LazyLock;

use super::kronecker::{KroneckerPoints, greatest_fraction, multiply_fractions};
use super::primes::PRIMES;

static ROOTS: LazyLock<Vec<u128>> = LazyLock::new(|| PRIMES.iter().map(|&p| fraction_of_root(p)).collect());

impl KroneckerPoints {
    /// Weyl's points with the square roots of the first 64 primes.
    pub fn weyl() -> Self {
        Self(&ROOTS)
    }
}

/// The fractional part of sqrt(p), p below 2^60 and not a square, rounded down to 128 bits.
///
/// With a = floor(sqrt(p)), f is the greatest fraction with 2 a f + f^2 < p - a^2, all of it in integers of 2^-128; the
/// part of f^2 that is cut off is below one such unit and cannot turn the comparison with a whole number.
fn fraction_of_root(p: u64) -> u128 {
    const LOW: u128 = u64::MAX as u128;
    let whole = p.isqrt();
    let (twice, rest) = (2 * u128::from(whole), u128::from(p - whole * whole));
    greatest_fraction(|f| {
        let square = multiply_fractions(f, f);
        let low = twice * (f & LOW) + (square & LOW);
        let high = twice * (f >> 64) + (square >> 64) + (low >> 64);
        high >> 64 >= rest
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::Points;
    use crate::sequence::independent::IndependentPoints;

    #[test]
    fn the_first_points_are_the_constants_of_the_secure_hash_standard() {
        // FIPS 180-4: the initial values of SHA-512 and SHA-384 are the first 64 bits of the fractional parts of the
        // square roots of the first eight, and of the ninth to sixteenth, primes.
        let published: [u64; 16] = [
            0x6a09_e667_f3bc_c908,
            0xbb67_ae85_84ca_a73b,
            0x3c6e_f372_fe94_f82b,
            0xa54f_f53a_5f1d_36f1,
            0x510e_527f_ade6_82d1,
            0x9b05_688c_2b3e_6c1f,
            0x1f83_d9ab_fb41_bd6b,
            0x5be0_cd19_137e_2179,
            0xcbbb_9d5d_c105_9ed8,
            0x629a_292a_367c_d507,
            0x9159_015a_3070_dd17,
            0x152f_ecd8_f70e_5939,
            0x6733_2667_ffc0_0b31,
            0x8eb4_4a87_6858_1511,
            0xdb0c_2e0d_64f9_8fa7,
            0x47b5_481d_befa_4fa4,
        ];
        let points = KroneckerPoints::weyl();
        for (c, &bits) in published.iter().enumerate() {
            assert_eq!(points.coordinate(1, c as u32), bits, "coordinate {c}");
        }
        assert_eq!(points.coordinate(0, 5), 0);
        // 64 coordinates are its own; those beyond are independent.
        let independent = IndependentPoints::new(0, 0);
        let is_independent = [63, 64].map(|c| points.coordinate(1, c) == independent.coordinate(1, c));
        assert_eq!(is_independent, [false, true]);
    }

    #[test]
    fn roots_are_exact_to_the_last_of_128_bits() {
        // (a + f)^2 <= p < (a + f + 2^-128)^2 with 32-bit limbs and schoolbook multiplication.
        for &p in &PRIMES {
            let f = fraction_of_root(p);
            for (fraction, above) in [(f, false), (f + 1, true)] {
                let digits: Vec<u64> = (0..5)
                    .map(|k| if k < 4 { (fraction >> (32 * k)) as u64 & 0xffff_ffff } else { p.isqrt() })
                    .collect();
                let mut square = [0u64; 11];
                for (i, x) in digits.iter().enumerate() {
                    let mut carry = 0u64;
                    for (j, y) in digits.iter().enumerate() {
                        let sum = square[i + j] + x * y + carry;
                        (square[i + j], carry) = (sum & 0xffff_ffff, sum >> 32);
                    }
                    square[i + 5] += carry;
                }
                let whole = square[8] + (square[9] << 32);
                assert_eq!(whole >= p, above, "sqrt({p})");
            }
        }
    }

    #[test]
    fn a_product_in_f64_would_have_lost_what_this_keeps() {
        // frac(2^47 sqrt 2) is bits 47 to 110 of the root: 0x6a09e667f3bcc908b2fb1366ea957d3e from the first 128.
        let root = 0x6a09_e667_f3bc_c908_b2fb_1366_ea95_7d3e_u128;
        assert_eq!(fraction_of_root(2), root);
        assert_eq!(KroneckerPoints::weyl().coordinate(1 << 47, 0), (root >> 17) as u64);
    }
}
