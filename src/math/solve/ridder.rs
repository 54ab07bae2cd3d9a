//! Ridder's method (C. Ridders, IEEE Trans. Circuits and Systems 26, 1979, 979-980).

use super::{Root, inside};

/// Root of an increasing function on [low, high] by Ridder's method.
///
/// `f` returns its value and a by-product; `ends` are low and high with its values there, <= 0 and >= 0. Each round
/// evaluates the middle, and the point where the line through the three values, straightened by an exponential, crosses
/// zero. The middle alone halves the bracket, so the number of evaluations is at most twice that of bisection.
#[inline]
pub fn ridder<T>(mut ends: [(f64, f64); 2], tolerance: f64, mut f: impl FnMut(f64) -> (f64, T)) -> Root<T> {
    let is_off = |value: f64| value.abs() > tolerance;
    let mut evaluations = 0;
    // A root within the tolerance of an end is that end; the exponential could not find it from inside.
    for (end, value) in ends {
        if !is_off(value) {
            return Root { x: end, by_product: f(end).1, evaluations: 1 };
        }
    }
    loop {
        let [(low, f_low), (high, f_high)] = ends;
        let middle = low + 0.5 * (high - low);
        let (value, by_product) = f(middle);
        evaluations += 1;
        if !is_off(value) || !inside(middle, low, high) {
            return Root { x: middle, by_product, evaluations };
        }
        let x = middle - (middle - low) * value / (value * value - f_low * f_high).sqrt();
        // The end whose value has the same sign is replaced.
        ends[usize::from(value > 0.0)] = (middle, value);
        if !inside(x, ends[0].0, ends[1].0) {
            continue;
        }
        let (value, by_product) = f(x);
        evaluations += 1;
        if !is_off(value) {
            return Root { x, by_product, evaluations };
        }
        ends[usize::from(value > 0.0)] = (x, value);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(low: f64, high: f64, f: impl Fn(f64) -> f64) -> Root<()> {
        ridder([(low, f(low)), (high, f(high))], 1e-15, |x| (f(x), ()))
    }

    #[test]
    fn an_exponential_is_straightened_at_once() {
        // exp(c x) - k is not of the form that one round solves; exp(c x) (x - r) is: Ridder's own derivation.
        let r = root(0.0, 1.0, |x| (2.0 * x).exp() * (x - 0.37));
        assert!((r.x - 0.37).abs() < 1e-15 && r.evaluations <= 4, "{r:?}");
    }

    #[test]
    fn bends_jumps_and_roots_at_the_ends_stay_in_the_bracket() {
        let cubic = root(0.0, 2.0, |x| x * x * x - 2.0);
        assert!((cubic.x - 2f64.cbrt()).abs() < 1e-15 && cubic.evaluations < 20, "{cubic:?}");
        let jump = root(0.0, 1.0, |x| if x < 0.3 { -1.0 } else { 1.0 });
        assert!((jump.x - 0.3).abs() < 1e-15 && jump.evaluations < 120, "{jump:?}");
        for power in [5, 21, 101] {
            let r = root(0.0, 1.0, |x: f64| x.powi(power) - 0.5);
            assert!((r.x.powi(power) - 0.5).abs() < 1e-12 && r.evaluations < 120, "{power}: {r:?}");
        }
        assert_eq!(root(0.0, 1.0, |x| x).x, 0.0);
        assert_eq!(root(0.0, 1.0, |x| x - 1.0).x, 1.0);
        let nothing = ridder([(0.0, -0.5), (1.0, 0.5)], 1e-15, |_| (f64::NAN, ()));
        assert_eq!(nothing.x, 0.5);
    }
}
