//! Newton's method inside a shrinking bracket.

use super::{OPEN_EVALUATIONS, Root, inside};

/// Root of an increasing function on [low, high] by Newton's method, kept inside a shrinking bracket.
///
/// `f` returns its value, its derivative and a by-product. A step that leaves the bracket is replaced by bisection, and
/// so is every one after the first twelve evaluations. The function is taken to be negative at `low` and positive at
/// `high`; neither is evaluated.
#[inline]
pub fn bracketed_newton<T>(
    mut low: f64,
    mut high: f64,
    start: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> (f64, f64, T),
) -> Root<T> {
    let mut x = if inside(start, low, high) { start } else { low + 0.5 * (high - low) };
    let (mut fx, mut slope, mut by_product) = f(x);
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
        let newton = x - fx / slope;
        x = if evaluations < OPEN_EVALUATIONS && inside(newton, low, high) { newton } else { middle };
        (fx, slope, by_product) = f(x);
        evaluations += 1;
    }
    Root { x, by_product, evaluations }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn converges_quadratically_to_a_simple_root() {
        let r = bracketed_newton(0.0, 2.0, 1.2, 1e-15, |x| (x * x * x - 2.0, 3.0 * x * x, ()));
        assert!((r.x - 2f64.cbrt()).abs() < 1e-15 && r.evaluations <= 6, "{r:?}");
    }

    #[test]
    fn wrong_slopes_jumps_and_roots_at_the_ends_stay_in_the_bracket() {
        for slope in [1.0, -1.0, 0.0, f64::NAN, f64::INFINITY, 1e300] {
            let r = bracketed_newton(0.0, 2.0, 0.7, 1e-15, |x| (x * x * x - 2.0, slope, ()));
            assert!((r.x - 2f64.cbrt()).abs() < 1e-15 && r.evaluations < 80, "{slope}: {r:?}");
        }
        let triple = bracketed_newton(-1.0, 1.0, 0.9, 1e-15, |x| (x * x * x, 3.0 * x * x, ()));
        assert!(triple.x.abs() <= 1e-5);
        for end in [0.0, 1.0] {
            let r = bracketed_newton(0.0, 1.0, 0.5, 1e-15, |x| (x - end, 1.0, ()));
            assert!((0.0..=1.0).contains(&r.x) && (r.x - end).abs() <= 2e-15, "{r:?}");
        }
        let nothing = bracketed_newton(0.0, 1.0, f64::NAN, 1e-15, |_| (f64::NAN, f64::NAN, ()));
        assert_eq!(nothing.x, 0.5);
    }
}
