//! The exact sign of a 2 x 2 determinant, the one predicate on which watertightness rests.
//!
//! Rounding is monotonic: fl(ab) > fl(cd) implies ab > cd. Only equal rounded products leave the sign open, and those
//! are compared as integers (53-bit mantissas, 106-bit products in `i128`), which neither rounds nor underflows and
//! gives the same bits on every machine.

/// `a b - c d` with the sign of the exact value: the difference of the rounded products, or, where these are equal, the exact
/// difference rounded.
///
/// Zero is returned only for an exact zero. Arguments must be finite and their products must not overflow.
#[inline(always)]
pub(crate) fn signed_difference(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, q) = (a * b, c * d);
    if p != q { p - q } else { exact_difference(a, b, c, d) }
}

/// `a b - c d` rounded once from the exact value (never to zero unless the exact value is zero).
#[cold]
#[inline(never)]
pub(crate) fn exact_difference(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let (p, p_exponent) = product(a, b);
    let (q, q_exponent) = product(c, d);
    if p == 0 {
        return scale(-q, q_exponent);
    }
    if q == 0 {
        return scale(p, p_exponent);
    }
    // Mantissas are normalised to 53 bits, so products lie in [2^104, 2^106): the larger may be shifted by 20 to fit an
    // i128 with the difference. Beyond that the smaller one is shifted the other way.
    let shift = p_exponent - q_exponent;
    if shift >= 0 {
        let room = shift.min(ROOM);
        scale((p << room) - shifted_right(q, shift - room), p_exponent - room)
    } else {
        let room = (-shift).min(ROOM);
        scale(shifted_right(p, -shift - room) - (q << room), q_exponent - room)
    }
}

/// Bits that a product of two mantissas leaves free in an `i128`, less one for a difference.
const ROOM: i32 = 20;

/// `m 2^-by`, rounded to odd where bits are lost: a difference of it, rounded once more to fewer bits, is rounded from
/// the exact value.
fn shifted_right(m: i128, by: i32) -> i128 {
    let by = by.min(127);
    let floor = m >> by;
    floor | i128::from(m & ((1i128 << by).wrapping_sub(1)) != 0)
}

/// The product of two finite numbers as integer times power of two, exactly.
fn product(a: f64, b: f64) -> (i128, i32) {
    let (m, e) = decompose(a);
    let (n, f) = decompose(b);
    (i128::from(m) * i128::from(n), e + f)
}

/// A finite number as a signed 53-bit integer (normalised unless zero) and a power of two.
fn decompose(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let biased = ((bits >> 52) & 0x7ff) as i32;
    let fraction = (bits & ((1 << 52) - 1)) as i64;
    if biased == 0 && fraction == 0 {
        return (0, 0);
    }
    let (mantissa, exponent) = if biased == 0 {
        let shift = fraction.leading_zeros() as i32 - 11;
        (fraction << shift, -1074 - shift)
    } else {
        (fraction | (1 << 52), biased - 1075)
    };
    (if x < 0.0 { -mantissa } else { mantissa }, exponent)
}

/// `m 2^e`, of the sign of `m` even where the value itself would underflow.
fn scale(m: i128, exponent: i32) -> f64 {
    let value = libm::scalbn(m as f64, exponent);
    if value == 0.0 && m != 0 { f64::MIN_POSITIVE.copysign(m as f64) } else { value }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sign_is_exact_where_rounded_products_agree() {
        let e = f64::EPSILON;
        // (1 + e)(1 - e) = 1 - e^2, rounded 1.
        assert_eq!(signed_difference(1.0 + e, 1.0 - e, 1.0, 1.0), -e * e);
        assert_eq!(signed_difference(1.0, 1.0, 1.0 + e, 1.0 - e), e * e);
        assert_eq!(signed_difference(3.0, 7.0, -7.0, -3.0), 0.0);
        assert_eq!(signed_difference(0.0, 5.0, 0.0, -3.0), 0.0);
    }

    #[test]
    fn integers_of_53_bits_agree_with_integer_arithmetic() {
        let mut ties = 0;
        for i in 0..200_000i64 {
            let a = (1i64 << 52) + (i.wrapping_mul(6_364_136_223_846_793_005) >> 14).rem_euclid(1 << 52);
            let b = (1i64 << 52) + (i.wrapping_mul(3_202_034_522_624_059_733) >> 13).rem_euclid(1 << 52);
            // c d = a b + k (b - a) - k^2: close to a b, and often the same when rounded.
            let k = i % 7 - 3;
            let (c, d) = (a + k, b - k);
            let (near_a, near_b) = (a + k * (i % 2), b);
            for (c, d) in [(c, d), (near_b, near_a)] {
                let exact = i128::from(a) * i128::from(b) - i128::from(c) * i128::from(d);
                let [x, y, z, w] = [a, b, c, d].map(|n| n as f64);
                let value = signed_difference(x, y, z, w);
                assert_eq!(value.partial_cmp(&0.0), Some(exact.cmp(&0)));
                assert_eq!(exact_difference(x, y, z, w), exact as f64);
                ties += usize::from(x * y == z * w && exact != 0);
            }
        }
        assert!(ties > 100, "{ties}");
    }

    #[test]
    fn products_that_underflow_keep_their_sign() {
        assert!(signed_difference(1e-200, 1e-200, 0.0, 1.0) > 0.0);
        assert!(signed_difference(1e-200, 1e-200, 1e-200, 2e-200) < 0.0);
        assert!(signed_difference(5e-324, 5e-324, 5e-324, -5e-324) > 0.0);
        assert!(signed_difference(1e-300, 1e-10, 1e-300, -1e-30) > 0.0);
    }

    #[test]
    fn products_of_very_different_size_are_both_kept() {
        // 9 - 2^-k needs k + 4 bits: exact up to k = 49, then rounded to even, to 9 from k = 51 on.
        for k in 0..=1000 {
            let small = libm::scalbn(1.0, -k);
            let exact = 9.0 - small;
            assert_eq!(exact_difference(3.0, 3.0, 1.0, small), exact, "k = {k}");
            assert_eq!(exact_difference(1.0, small, 3.0, 3.0), -exact, "k = {k}");
            assert_eq!(exact_difference(3.0, 3.0, -1.0, small), 9.0 + small, "k = {k}");
        }
        // A tie broken by the last bit of the small product, far below the 53 of the result.
        let half = libm::scalbn(1.0, -53);
        assert_eq!(exact_difference(1.0, 1.0, -half, 1.0), 1.0);
        assert_eq!(exact_difference(1.0, 1.0, -half, 1.0 + f64::EPSILON), 1.0 + f64::EPSILON);
    }
}
