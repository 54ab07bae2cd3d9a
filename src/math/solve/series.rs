//! Newton's method on the Taylor series of a function, inside a shrinking bracket.

use super::{OPEN_EVALUATIONS, Root, inside};

/// A function about a point where it was evaluated.
#[derive(Debug, Clone, Copy)]
pub struct Expansion<T> {
    /// The function.
    pub value: f64,
    /// Its first four derivatives.
    pub derivatives: [f64; 4],
    /// A bound of its fifth derivative, anywhere in the bracket.
    pub fifth: f64,
    /// What else the evaluation gives.
    pub by_product: T,
}

impl<T> Expansion<T> {
    /// The step to the root by the reverted series, and a bound of |f| there: the polynomial's value and the remainder
    /// of Taylor's theorem.
    #[inline(always)]
    fn step(&self) -> (f64, f64) {
        let [d1, d2, d3, d4] = self.derivatives;
        let inverse = 1.0 / d1;
        let (c2, c3, c4) = (d2 * (1.0 / 2.0), d3 * (1.0 / 6.0), d4 * (1.0 / 24.0));
        let (q2, q3, q4) = (c2 * inverse, c3 * inverse, c4 * inverse);
        let t = -self.value * inverse;
        let twice = q2 * q2;
        let step = t * (1.0 - t * (q2 - t * (2.0 * twice - q3 - t * (q2 * (5.0 * twice - 5.0 * q3) + q4))));
        let polynomial = self.value + step * (d1 + step * (c2 + step * (c3 + step * c4)));
        let square = step * step;
        (step, polynomial.abs() + self.fifth * (1.0 / 120.0) * (square * square * step).abs())
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
    mut low: f64,
    mut high: f64,
    start: f64,
    tolerance: f64,
    mut f: impl FnMut(f64) -> Expansion<T>,
) -> Root<T> {
    let mut x = if start >= low && start <= high { start } else { low + 0.5 * (high - low) };
    let mut at = f(x);
    let mut evaluations = 1;
    while at.value.abs() > tolerance {
        let (step, left) = at.step();
        let next = x + step;
        if at.value > 0.0 {
            high = x;
        } else {
            low = x;
        }
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
        at = f(x);
        evaluations += 1;
    }
    Root { x, by_product: at.by_product, evaluations }
}
