//! The secant method inside a shrinking bracket.

use super::{OPEN_EVALUATIONS, Root, inside};

/// Root of an increasing function on [low, high] by the secant method, kept inside a shrinking bracket.
///
/// `f` returns its value and a by-product. `start` and `inverse_slope` (an estimate of 1 / f' there; any
/// sign, zero or NaN is harmless) give the first two points. A secant step that leaves the bracket is replaced by
/// bisection, and so is every one after the first twelve evaluations. The function is taken to be negative at `low`
/// and positive at `high`; neither is evaluated.
#[inline]
pub fn bracketed_secant<T>(
    mut low: f64,
    mut high: f64,
    start: f64,
    mut inverse_slope: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> (f64, T),
) -> Root<T> {
    let mut x = if inside(start, low, high) { start } else { low + 0.5 * (high - low) };
    let (mut fx, mut by_product) = f(x);
    let mut evaluations = 1;
    while fx.abs() > tolerance {
        if fx > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let middle = low + 0.5 * (high - low);
        if !inside(middle, low, high) {
            break; // The bracket is one ulp wide.
        }
        let secant = x - fx * inverse_slope;
        let next = if evaluations < OPEN_EVALUATIONS && inside(secant, low, high) { secant } else { middle };
        let (value, extra) = f(next);
        evaluations += 1;
        inverse_slope = (next - x) / (value - fx);
        (x, fx, by_product) = (next, value, extra);
    }
    Root { x, by_product, evaluations }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(low: f64, high: f64, start: f64, inverse_slope: f64, f: impl Fn(f64) -> f64) -> Root<()> {
        bracketed_secant(low, high, start, inverse_slope, 1e-15, |x| (f(x), ()))
    }

    #[test]
    fn finds_roots_whatever_the_slope_says() {
        for slope in [1.0, -1.0, 0.0, f64::NAN, f64::INFINITY, 1e300] {
            let r = root(0.0, 2.0, 0.7, slope, |x| x * x * x - 2.0);
            assert!((r.x - 2f64.cbrt()).abs() < 1e-15, "{slope}: {r:?}");
            assert!(r.evaluations < 80);
        }
    }

    #[test]
    fn flat_pieces_jumps_and_roots_at_the_ends_stay_in_the_bracket() {
        // A triple root, a jump with no root, a flat start, a root at either end.
        let triple = root(-1.0, 1.0, 0.9, 3.0, |x| x * x * x);
        assert!(triple.x.abs() <= 1e-5);
        let jump = root(0.0, 1.0, 0.5, 1.0, |x| if x < 0.3 { -1.0 } else { 1.0 });
        assert!((jump.x - 0.3).abs() < 1e-15);
        let flat = root(0.0, 1.0, 0.5, 1.0, |x| if x < 0.75 { -1e-9 } else { x - 0.75 });
        assert!((flat.x - 0.75).abs() < 1e-14, "{flat:?}");
        for (f, end) in [((|x: f64| x) as fn(f64) -> f64, 0.0), (|x: f64| x - 1.0, 1.0)] {
            let r = root(0.0, 1.0, 0.5, 1.0, f);
            assert!((0.0..=1.0).contains(&r.x) && (r.x - end).abs() <= 2e-15, "{r:?}");
        }
    }

    #[test]
    fn evaluations_are_bounded_on_hostile_functions() {
        for power in [5, 21, 101] {
            let r = root(0.0, 1.0, 0.999, 1e-9, |x: f64| x.powi(power) - 1e-30);
            assert!(r.evaluations <= OPEN_EVALUATIONS + 70, "{power}: {r:?}");
        }
    }
}
