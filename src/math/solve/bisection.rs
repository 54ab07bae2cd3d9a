//! Halving of the bracket.

use super::{Root, inside};

/// Root of an increasing function on [low, high] by bisection: one bit an evaluation, until the value is within
/// `tolerance` of zero or the bracket cannot be divided. `f` returns its value and a by-product.
#[inline]
pub fn bisection<T>(
    mut low: f64,
    mut high: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> (f64, T),
) -> Root<T> {
    let mut evaluations = 0;
    loop {
        let x = low + 0.5 * (high - low);
        let (fx, by_product) = f(x);
        evaluations += 1;
        if fx > tolerance {
            high = x;
        } else if fx < -tolerance {
            low = x;
        } else {
            return Root { x, by_product, evaluations };
        }
        if !inside(low + 0.5 * (high - low), low, high) {
            return Root { x, by_product, evaluations };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_evaluation_gives_a_bit() {
        for k in 0..1000 {
            let root = (f64::from(k) + 0.37) / 1000.0;
            let r = bisection(0.0, 1.0, 1e-9, |x| (x - root, ()));
            assert!((r.x - root).abs() <= 1e-9 && r.evaluations <= 30, "{r:?}");
        }
    }

    #[test]
    fn jumps_and_nan_stay_in_the_bracket() {
        let jump = bisection(0.0, 1.0, 1e-15, |x| (if x < 0.3 { -1.0 } else { 1.0 }, ()));
        assert!((jump.x - 0.3).abs() < 1e-15 && jump.evaluations < 60);
        let nothing = bisection(0.0, 1.0, 1e-15, |_| (f64::NAN, ()));
        assert_eq!((nothing.x, nothing.evaluations), (0.5, 1));
    }
}
