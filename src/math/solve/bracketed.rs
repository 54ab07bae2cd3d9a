//! Bisection, Newton's and the secant method inside a shrinking bracket: one loop, each with its own steps.

use super::{OPEN_EVALUATIONS, Root, inside};

/// Root of an increasing function, kept inside a shrinking bracket.
///
/// `f` returns its value and a by-product, `step(x, value, by-product)` where the method goes on from there. A place
/// outside the bracket, or that is no number, is replaced by the bracket's middle, and so is the start and every one
/// after the first twelve evaluations. The function is taken to be negative at the low end and positive at the high
/// one; neither is evaluated.
#[inline]
pub fn bracketed<T>(
    [low, high]: [f64; 2],
    start: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> (f64, T),
    mut step: impl FnMut(f64, f64, &T) -> f64,
) -> Root<T> {
    let x = if inside(start, low, high) { start } else { low + 0.5 * (high - low) };
    let at = f(x);
    shrink([low, high], (x, at), tolerance, f, |x, value, t| (step(x, value, t), f64::INFINITY))
}

/// The same from a point where `f` has been evaluated. A step tells too how much it leaves at most of the value where it
/// ends: where that is within the tolerance it is taken unseen, without an evaluation.
#[inline]
pub(super) fn shrink<T>(
    [mut low, mut high]: [f64; 2],
    (mut x, (mut value, mut by_product)): (f64, (f64, T)),
    tolerance: f64,
    mut f: impl FnMut(f64) -> (f64, T),
    mut step: impl FnMut(f64, f64, &T) -> (f64, f64),
) -> Root<T> {
    let mut evaluations = 1;
    while value.abs() > tolerance {
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let (next, left) = step(x, value, &by_product);
        let is_inside = inside(next, low, high);
        if is_inside && left <= tolerance {
            x = next;
            break;
        }
        let middle = low + 0.5 * (high - low);
        if !inside(middle, low, high) {
            break; // The bracket is one ulp wide.
        }
        x = if is_inside && evaluations < OPEN_EVALUATIONS { next } else { middle };
        (value, by_product) = f(x);
        evaluations += 1;
    }
    Root { x, by_product, evaluations }
}

/// The steps of the secant method. `inverse_slope` is an estimate of 1 / f' at the start; any sign, zero or NaN is
/// harmless.
pub fn secant_step<T>(mut inverse_slope: f64) -> impl FnMut(f64, f64, &T) -> f64 {
    let mut last = None;
    move |x, value, _| {
        if let Some((last_x, last_value)) = last {
            inverse_slope = (x - last_x) / (value - last_value);
        }
        last = Some((x, value));
        x - value * inverse_slope
    }
}

/// The steps of bisection, which asks for the middle always; it starts anywhere outside the bracket.
pub fn bisection_step<T>(_: f64, _: f64, _: &T) -> f64 {
    f64::NAN
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bisection(f: impl Fn(f64) -> f64, tolerance: f64) -> Root<()> {
        bracketed([0.0, 1.0], f64::NAN, tolerance, |x| (f(x), ()), bisection_step)
    }

    #[test]
    fn every_evaluation_of_bisection_gives_a_bit() {
        for k in 0..1000 {
            let root = (f64::from(k) + 0.37) / 1000.0;
            let r = bisection(|x| x - root, 1e-9);
            assert!((r.x - root).abs() <= 1e-9 && r.evaluations <= 30, "{r:?}");
        }
    }

    #[test]
    fn bisection_stays_in_the_bracket_at_jumps_and_nan() {
        let jump = bisection(|x| if x < 0.3 { -1.0 } else { 1.0 }, 1e-15);
        assert!((jump.x - 0.3).abs() < 1e-15 && jump.evaluations < 60);
        let nothing = bisection(|_| f64::NAN, 1e-15);
        assert_eq!((nothing.x, nothing.evaluations), (0.5, 1));
    }

    fn newton([low, high]: [f64; 2], start: f64, f: impl Fn(f64) -> (f64, f64)) -> Root<f64> {
        bracketed([low, high], start, 1e-15, f, |x, value, slope| x - value / slope)
    }

    #[test]
    fn newton_converges_quadratically_to_a_simple_root() {
        let r = newton([0.0, 2.0], 1.2, |x| (x * x * x - 2.0, 3.0 * x * x));
        assert!((r.x - 2f64.cbrt()).abs() < 1e-15 && r.evaluations <= 6, "{r:?}");
    }

    #[test]
    fn newton_with_wrong_slopes_jumps_and_roots_at_the_ends_stay_in_the_bracket() {
        for slope in [1.0, -1.0, 0.0, f64::NAN, f64::INFINITY, 1e300] {
            let r = newton([0.0, 2.0], 0.7, |x| (x * x * x - 2.0, slope));
            assert!((r.x - 2f64.cbrt()).abs() < 1e-15 && r.evaluations < 80, "{slope}: {r:?}");
        }
        let triple = newton([-1.0, 1.0], 0.9, |x| (x * x * x, 3.0 * x * x));
        assert!(triple.x.abs() <= 1e-5);
        for end in [0.0, 1.0] {
            let r = newton([0.0, 1.0], 0.5, |x| (x - end, 1.0));
            assert!((0.0..=1.0).contains(&r.x) && (r.x - end).abs() <= 2e-15, "{r:?}");
        }
        let nothing = newton([0.0, 1.0], f64::NAN, |_| (f64::NAN, f64::NAN));
        assert_eq!(nothing.x, 0.5);
    }

    fn secant(low: f64, high: f64, start: f64, inverse_slope: f64, f: impl Fn(f64) -> f64) -> Root<()> {
        bracketed([low, high], start, 1e-15, |x| (f(x), ()), secant_step(inverse_slope))
    }

    #[test]
    fn secants_find_roots_whatever_the_slope_says() {
        for slope in [1.0, -1.0, 0.0, f64::NAN, f64::INFINITY, 1e300] {
            let r = secant(0.0, 2.0, 0.7, slope, |x| x * x * x - 2.0);
            assert!((r.x - 2f64.cbrt()).abs() < 1e-15, "{slope}: {r:?}");
            assert!(r.evaluations < 80);
        }
    }

    #[test]
    fn flat_pieces_jumps_and_roots_at_the_ends_stay_in_the_bracket() {
        // A triple root, a jump with no root, a flat start, a root at either end.
        let triple = secant(-1.0, 1.0, 0.9, 3.0, |x| x * x * x);
        assert!(triple.x.abs() <= 1e-5);
        let jump = secant(0.0, 1.0, 0.5, 1.0, |x| if x < 0.3 { -1.0 } else { 1.0 });
        assert!((jump.x - 0.3).abs() < 1e-15);
        let flat = secant(0.0, 1.0, 0.5, 1.0, |x| if x < 0.75 { -1e-9 } else { x - 0.75 });
        assert!((flat.x - 0.75).abs() < 1e-14, "{flat:?}");
        for (f, end) in [((|x: f64| x) as fn(f64) -> f64, 0.0), (|x: f64| x - 1.0, 1.0)] {
            let r = secant(0.0, 1.0, 0.5, 1.0, f);
            assert!((0.0..=1.0).contains(&r.x) && (r.x - end).abs() <= 2e-15, "{r:?}");
        }
    }

    #[test]
    fn evaluations_are_bounded_on_hostile_functions() {
        for power in [5, 21, 101] {
            let r = secant(0.0, 1.0, 0.999, 1e-9, |x: f64| x.powi(power) - 1e-30);
            assert!(r.evaluations <= OPEN_EVALUATIONS + 70, "{power}: {r:?}");
        }
    }
}
