//! Root finding that cannot leave its bracket.
//!
//! Every solver here takes an increasing function on [low, high], negative at `low` and positive at `high`; its answer
//! lies in the bracket whatever the function returns, NaN included, and is reached in a bounded number of evaluations:
//! a step that leaves the shrinking bracket, or one of a method that has had its turn, is replaced by bisection.

mod bracketed;
mod ridder;
mod series;

pub use bracketed::{bisection_step, bracketed, secant_step};
pub use ridder::ridder;
pub use series::{Expansion, bracketed_series};

/// A method for the cell equation (METHOD 3, paper eq. 8).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Solver {
    /// The secant method from the quantile of a linear density, safeguarded: the paper's method.
    Secant,
    /// Newton's method from u times the width, safeguarded.
    Newton,
    /// Ridder's method: exponential fit through three points, bracketed by itself.
    Ridder,
    /// Halving of the bracket.
    Bisection,
    /// Newton's method from the quantile of a linear density, safeguarded.
    QuadraticNewton,
}

impl Solver {
    /// Every solver, in the order of the tables.
    pub const ALL: [Self; 5] =
        [Self::Secant, Self::Newton, Self::Ridder, Self::Bisection, Self::QuadraticNewton];

    /// The fastest of those without a failure (`cargo bench --bench solvers`).
    pub const DEFAULT: Self = Self::QuadraticNewton;

    /// What the paper solves its equation (8) with.
    pub const PAPER: Self = Self::Secant;

    /// The name on the command line and in reports.
    pub const fn name(self) -> &'static str {
        ["secant", "newton", "ridder", "bisection", "quadratic-newton"][self as usize]
    }

    /// The solver of a name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|solver| solver.name() == name)
    }
}

/// A root and what it cost.
#[derive(Debug, Clone, Copy)]
pub struct Root<T> {
    /// Where the function is within the tolerance of zero, or the bracket cannot be divided further.
    pub x: f64,
    /// What the function returned beside its value at the last evaluation.
    pub by_product: T,
    /// Function evaluations used.
    pub evaluations: u32,
}

/// Evaluations after which only bisection steps are taken: a method that stalls cannot keep the loop.
const OPEN_EVALUATIONS: u32 = 12;

#[inline(always)]
fn inside(x: f64, low: f64, high: f64) -> bool {
    x > low && x < high
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_found_again() {
        for solver in Solver::ALL {
            assert_eq!(Solver::from_name(solver.name()), Some(solver));
        }
        assert_eq!(Solver::from_name("Secant"), None);
    }
}
