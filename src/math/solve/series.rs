//! Newton's method on the Taylor series of a function, inside a shrinking bracket.

use super::Root;
use super::bracketed::shrink;

/// A function about a point where it was evaluated.
#[derive(Debug, Clone, Copy)]
pub struct Expansion<T> {
    /// The function.
    pub value: f64,
    /// Its Taylor coefficients of order 1 to 4: derivative k divided by k!.
    pub series: [f64; 4],
    /// A bound of the coefficient of order 5 anywhere in the bracket.
    pub remainder: f64,
    /// What else the evaluation gives.
    pub by_product: T,
}

impl<T> Expansion<T> {
    /// The step to the root by the reverted series, and a bound of |f| there: the polynomial's value and the remainder
    /// of Taylor's theorem.
    #[inline(always)]
    fn step(&self) -> (f64, f64) {
        let [c1, c2, c3, c4] = self.series;
        let inverse = 1.0 / c1;
        let (q2, q3, q4) = (c2 * inverse, c3 * inverse, c4 * inverse);
        let t = -self.value * inverse;
        let twice = q2 * q2;
        let step = t * (1.0 - t * (q2 - t * (2.0 * twice - q3 - t * (q2 * (5.0 * twice - 5.0 * q3) + q4))));
        let polynomial = self.value + step * (c1 + step * (c2 + step * (c3 + step * c4)));
        let square = step * step;
        (step, polynomial.abs() + self.remainder * (square * square * step).abs())
    }
}

/// Root of an increasing function on [low, high] by Newton's method with the further terms of the series, kept inside
/// a shrinking bracket.
///
/// A step is taken unseen, without an evaluation where it ends, when Taylor's theorem says that the function is within
/// `tolerance` of zero there: so the by-product may belong to a point beside the root, from which the step is short.
/// Otherwise the function is evaluated there; a step that leaves the bracket is replaced by bisection, and so is every
/// one after the first twelve evaluations. `start` may be an end of the bracket. The function is taken to be negative
/// at `low` and positive at `high`.
#[inline]
pub fn bracketed_series<T>(
    low: f64,
    high: f64,
    start: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> Expansion<T>,
) -> Root<T> {
    let x = if start >= low && start <= high { start } else { low + 0.5 * (high - low) };
    let at = f(x);
    let (step, left) = at.step();
    let next = x + step;
    // The common end, kept straight: most starts are that close.
    if left <= tolerance && next >= low && next <= high {
        return Root { x: next, by_product: at.by_product, evaluations: 1 };
    }
    further([low, high], (x, at), tolerance, f)
}

/// What [`bracketed_series`] does after its first evaluation, `at` x, unless that sufficed.
#[inline(never)]
fn further<T>(
    bracket: [f64; 2],
    (x, at): (f64, Expansion<T>),
    tolerance: f64,
    mut f: impl FnMut(f64) -> Expansion<T>,
) -> Root<T> {
    let evaluate = |x: f64| {
        let at = f(x);
        (at.value, at)
    };
    let step = |x: f64, _: f64, at: &Expansion<T>| {
        let (step, left) = at.step();
        (x + step, left)
    };
    let Root { x, by_product, evaluations } = shrink(bracket, (x, (at.value, at)), tolerance, evaluate, step);
    Root { x, by_product: by_product.by_product, evaluations }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// x^3 - 2 and its series; the fifth coefficient is zero.
    fn cubic(x: f64) -> Expansion<f64> {
        Expansion {
            value: x * x * x - 2.0,
            series: [3.0 * x * x, 3.0 * x, 1.0, 0.0],
            remainder: 0.0,
            by_product: x,
        }
    }

    #[test]
    fn a_step_that_the_remainder_allows_costs_no_evaluation() {
        let root = 2f64.cbrt();
        // The reverted series leaves the fifth power of the distance.
        let near = bracketed_series(0.0, 2.0, root + 2e-4, 1e-15, cubic);
        assert_eq!((near.evaluations, near.by_product), (1, root + 2e-4));
        assert!((near.x - root).abs() < 5e-16, "{near:?}");
        // The same step with a remainder that forbids it.
        let doubtful =
            bracketed_series(0.0, 2.0, root + 2e-4, 1e-15, |x| Expansion { remainder: 1e6, ..cubic(x) });
        assert_eq!(doubtful.evaluations, 2);
        assert!((doubtful.by_product - root).abs() < 5e-16, "{doubtful:?}");
    }

    #[test]
    fn what_the_step_leaves_is_bounded() {
        // exp(x) - 1 about 0.3, whose fifth derivative is at most exp(0.3) on the way to 0.
        let e = 0.3f64.exp();
        let at = Expansion {
            value: e - 1.0,
            series: [e, e / 2.0, e / 6.0, e / 24.0],
            remainder: e / 120.0,
            by_product: (),
        };
        let (step, left) = at.step();
        let there = (0.3 + step).exp() - 1.0;
        assert!(there.abs() <= left && left < 1e-3, "{there} {left}");
    }

    #[test]
    fn wrong_series_jumps_and_roots_at_the_ends_stay_in_the_bracket() {
        for wrong in [1.0, -1.0, 0.0, f64::NAN, f64::INFINITY, 1e300] {
            for order in 0..4 {
                let r = bracketed_series(0.0, 2.0, 0.7, 1e-15, |x| {
                    let mut at = Expansion { remainder: f64::INFINITY, ..cubic(x) };
                    at.series[order] = wrong;
                    at
                });
                assert!((r.x - 2f64.cbrt()).abs() < 1e-15, "{wrong} {order}: {r:?}");
                assert!(r.evaluations < 80, "{wrong} {order}: {r:?}");
            }
        }
        let line = |root: f64| {
            move |x: f64| Expansion {
                value: x - root,
                series: [1.0, 0.0, 0.0, 0.0],
                remainder: 0.0,
                by_product: (),
            }
        };
        for end in [0.0, 1.0] {
            for start in [0.0, 0.5, 1.0, -7.0, f64::NAN] {
                let r = bracketed_series(0.0, 1.0, start, 1e-15, line(end));
                assert!((0.0..=1.0).contains(&r.x) && (r.x - end).abs() <= 2e-15, "{start}: {r:?}");
            }
        }
        // A step beyond the bracket is not taken, whatever the remainder says.
        let outside = bracketed_series(0.0, 1.0, 0.5, 1e-15, line(1.5));
        assert!((0.0..=1.0).contains(&outside.x), "{outside:?}");
        let nothing = bracketed_series(0.0, 1.0, 0.5, 1e-15, |_| Expansion {
            value: f64::NAN,
            series: [f64::NAN; 4],
            remainder: f64::NAN,
            by_product: (),
        });
        assert_eq!(nothing.x, 0.5);
    }
}
