//! The polar angle within a cell: eq. (8) of the paper about the cell's own edge, and its root by each
//! solver.
//!
//! With a = A1 + A2, b = B1 + B2 and the in-cell variable s = theta - theta1 the integral of the theta
//! marginal is
//!
//! ```text
//! F(s) = a (S sin s + C (1 - cos s)) + (b - a)/dt (S (s sin s - (1 - cos s)) + C (sin s - s cos s)),
//! ```
//!
//! S = sin theta1, C = cos theta1. Every term is of the order of the result, so nothing cancels in narrow
//! cells or at a pole, where eq. (8) in absolute angles loses all digits.

use super::angles::Row;
use crate::math::solve::{
    Expansion, Solver, bisection_step, bracketed, bracketed_series, ridder, secant_step,
};
use crate::math::trig::InCell;

/// Residual |F(s)/F(dt) - u| at which a solver stops: 2^-46, a few times the rounding of F itself.
const TOLERANCE: f64 = 1.0 / (1u64 << 46) as f64;

/// A polar angle inside a row, as sine and cosine.
#[derive(Debug, Clone, Copy)]
pub struct Polar {
    /// theta - theta1, in [0, dt].
    pub s: f64,
    /// sin theta.
    pub sin: f64,
    /// cos theta.
    pub cos: f64,
    /// Evaluations of F that the solver used: what tests and benches compare solvers by.
    #[cfg_attr(not(feature = "internals"), expect(dead_code))]
    pub evaluations: u32,
}

/// The theta marginal of a cell.
#[derive(Debug, Clone, Copy)]
pub(super) struct Marginal<'r> {
    row: &'r Row,
    /// a and b as given.
    edges: (f64, f64),
    scale: f64,
    /// a times the scale.
    level: f64,
    /// (b - a) / dt times the scale.
    rise: f64,
}

impl<'r> Marginal<'r> {
    /// The marginal of the edge sums a and b in a row, F multiplied by `scale`.
    #[inline]
    pub(super) fn new(row: &'r Row, (a, b): (f64, f64), scale: f64) -> Self {
        Self { row, edges: (a, b), scale, level: a * scale, rise: (b - a) * row.inverse_width * scale }
    }

    /// F(s), and the trigonometry that it needed.
    #[inline]
    pub(super) fn mass_to(&self, s: f64) -> (f64, InCell) {
        let t = InCell::at(s);
        let constant = self.row.sin * t.sin + self.row.cos * t.versine;
        let linear = self.row.sin * t.moment_cos + self.row.cos * t.moment_sin;
        (self.level * constant + self.rise * linear, t)
    }

    /// (sin theta, cos theta) at theta1 + s.
    #[inline]
    fn sin_cos(&self, t: &InCell) -> (f64, f64) {
        let cos_s = 1.0 - t.versine;
        ((self.row.sin * cos_s + self.row.cos * t.sin).max(0.0), self.row.cos * cos_s - self.row.sin * t.sin)
    }

    /// The s at which F is u, for a marginal whose F(dt) is 1.
    #[inline]
    pub(super) fn solve(&self, u: f64, solver: Solver) -> Polar {
        if solver == Solver::QuadraticNewton {
            self.quadratic_newton(u)
        } else {
            self.solve_otherwise(u, solver)
        }
    }

    /// By a solver other than the default, kept out of its way.
    #[inline(never)]
    fn solve_otherwise(&self, u: f64, solver: Solver) -> Polar {
        let w = self.row.width;
        let residual = |s: f64| {
            let (mass, t) = self.mass_to(s);
            (mass - u, t)
        };
        let root = match solver {
            Solver::Secant => {
                let (start, inverse_slope) = self.linear_start(u);
                bracketed([0.0, w], start, TOLERANCE, residual, secant_step(inverse_slope))
            }
            Solver::Newton => bracketed([0.0, w], u * w, TOLERANCE, residual, |s, value, t| {
                s - value / ((self.level + self.rise * s) * self.sin_cos(t).0)
            }),
            Solver::QuadraticNewton => return self.quadratic_newton(u),
            Solver::Ridder => ridder([(0.0, -u), (w, 1.0 - u)], TOLERANCE, residual),
            Solver::Bisection => bracketed([0.0, w], f64::NAN, TOLERANCE, residual, bisection_step),
        };
        let (sin, cos) = self.sin_cos(&root.by_product);
        Polar { s: root.x, sin, cos, evaluations: root.evaluations }
    }

    /// A bound of the fifth Taylor coefficient of F anywhere in the cell. Derivative k of the density
    /// g(s) sin(theta), g = level + rise s, is g times a sine or cosine and k rise times another, and so at
    /// most max g + k |rise|.
    #[inline]
    fn fifth_coefficient(&self, far: f64) -> f64 {
        (1.0 / 120.0) * (self.level.max(far) + 4.0 * self.rise.abs())
    }

    /// From the quantile of a linear density by the Taylor series of F, whose every coefficient is at hand once
    /// F is.
    #[inline]
    fn quadratic_newton(&self, u: f64) -> Polar {
        let w = self.row.width;
        let far = self.edges.1 * self.scale;
        // As in linear_start, with one division. Where both end densities vanish a parabola serves.
        let (g0, g1) = (self.level * self.row.sin, far * self.row.sin_end);
        let denominator = g0 + (g0 * g0 * (1.0 - u) + g1 * g1 * u).sqrt();
        let x = if denominator > 0.0 { u * (g0 + g1) / denominator } else { parabola_quantile(u) };
        let remainder = self.fifth_coefficient(far);
        let root = bracketed_series(0.0, w, x * w, TOLERANCE, |s| {
            let (mass, t) = self.mass_to(s);
            let (sin, cos) = self.sin_cos(&t);
            let g = self.level + self.rise * s;
            let (g_sin, g_cos) = (g * sin, g * cos);
            let (rise_sin, rise_cos) = (self.rise * sin, self.rise * cos);
            Expansion {
                value: mass - u,
                series: [
                    g_sin,
                    (1.0 / 2.0) * (rise_sin + g_cos),
                    (1.0 / 3.0) * rise_cos - (1.0 / 6.0) * g_sin,
                    -(1.0 / 8.0) * rise_sin - (1.0 / 24.0) * g_cos,
                ],
                remainder,
                by_product: (s, sin, cos),
            }
        });
        let (s, sin, cos) = root.by_product;
        let (sin_step, versine_step) = short_turn(root.x - s);
        Polar {
            s: root.x,
            sin: (sin - sin * versine_step + cos * sin_step).max(0.0),
            cos: cos - cos * versine_step - sin * sin_step,
            evaluations: root.evaluations,
        }
    }

    /// The root and the inverse slope there of the distribution function whose density is linear between the
    /// end values a sin theta1 and b sin theta2. Where both vanish (a cell from pole to pole, a pole with a
    /// zero edge) it has none, and u itself serves.
    #[inline]
    fn linear_start(&self, u: f64) -> (f64, f64) {
        let w = self.row.width;
        let (g0, g1) = (self.edges.0 * self.row.sin, self.edges.1 * self.row.sin_end);
        let near = g0 / (g0 + g1);
        if near.is_finite() {
            let x = linear_quantile(near, u);
            (x * w, 0.5 * w / (near + (1.0 - 2.0 * near) * x))
        } else {
            (u * w, w)
        }
    }
}

/// F(dt) of the edge sums (1, 0) and (0, 1): that of any others is linear in them.
pub(super) fn unit_masses(row: &Row) -> [f64; 2] {
    [(1.0, 0.0), (0.0, 1.0)].map(|edges| Marginal::new(row, edges, 1.0).mass_to(row.width).0)
}

/// sin t and 1 - cos t of a step beyond the last evaluation: max g is at least 1/2 where F(dt) = 1, so the
/// tolerance allows |t|^5 / 240 <= 2^-46 at most, |t| <= 5.1e-3, and the terms left out are below 2^-55.
#[inline]
fn short_turn(t: f64) -> (f64, f64) {
    let square = t * t;
    (t * (1.0 - square * (1.0 / 6.0 - square * (1.0 / 120.0))), square * (0.5 - square * (1.0 / 24.0)))
}

/// Quantile u of the density 6 x (1 - x) on [0, 1], to 2 %: the root of x^2 (3 - 2 x) = u by two rounds of
/// iteration from either end.
#[inline(never)]
fn parabola_quantile(u: f64) -> f64 {
    let near = u.min(1.0 - u);
    let x = (near / (3.0 - 2.0 * (near / 3.0).sqrt())).sqrt();
    let x = (near / (3.0 - 2.0 * x)).sqrt();
    if u < 0.5 { x } else { 1.0 - x }
}

/// Quantile u of a density on [0, 1] that is linear from `near` to 1 - `near` (in units of their sum): the
/// root of (1 - 2 near) x^2 + 2 near x = u in the form that does not cancel.
#[inline]
pub(super) fn linear_quantile(near: f64, u: f64) -> f64 {
    let far = 1.0 - near;
    let denominator = near + (near * near * (1.0 - u) + far * far * u).sqrt();
    if denominator > 0.0 { (u / denominator).min(1.0) } else { u }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// On the bound rests the promise of steps that are taken unseen. The fourth derivative of the density, which is the fifth of F, by
    /// central differences of the density as METHOD 3 defines it.
    #[test]
    fn the_fifth_coefficient_is_bounded_and_the_bound_is_near() {
        for (theta, width) in
            [(0.0, 0.3), (0.7, 0.2), (PI - 0.4, 0.4), (0.1, 1.3), (PI / 2.0, PI / 2.0), (0.0, PI)]
        {
            let row = Row::new(theta, theta + width);
            for (a, b) in [(1.0, 1.0), (0.0, 1.0), (1.0, 0.0), (1.0, 0.3), (2.1, 2.0)] {
                let marginal = Marginal::new(&row, (a, b), 1.0);
                let density = |s: f64| (a + (b - a) * s / width) * (theta + s).sin();
                let h = 0.02;
                let mut largest = 0.0f64;
                for k in 0..=100 {
                    let s = width * f64::from(k) / 100.0;
                    let (near, far) =
                        (density(s - h) + density(s + h), density(s - 2.0 * h) + density(s + 2.0 * h));
                    largest = largest.max(((far - 4.0 * near + 6.0 * density(s)) / h.powi(4)).abs() / 120.0);
                }
                let bound = marginal.fifth_coefficient(b);
                assert!(largest <= 1.001 * bound, "{theta} {width} {a} {b}: {largest} {bound}");
                assert!(bound <= 6.0 * largest, "{theta} {width} {a} {b}: {largest} {bound}");
            }
        }
    }

    #[test]
    fn quantile_of_a_parabola_is_close_from_either_end() {
        for k in 0..=1000 {
            let u = f64::from(k) / 1000.0;
            let x = parabola_quantile(u);
            // Smoothstep: its inverse in closed form.
            let exact = 0.5 - ((1.0 - 2.0 * u).asin() / 3.0).sin();
            assert!((x - exact).abs() <= 0.02 * exact.min(1.0 - exact) + 1e-15, "{u}: {x} {exact}");
        }
    }
}
