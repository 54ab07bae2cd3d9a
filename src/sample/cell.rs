//! One cell of a table on the sphere: its flux, and sampling by inverse functions (METHOD 3; paper eqs. 7 and
//! 8).
//!
//! A cell is [theta1, theta1 + dt] x [phi1, phi1 + dp] with values A1, A2 at theta1 (at phi1 and phi2) and
//! B1, B2 at the far theta, bilinear between, in the solid-angle measure sin(theta) dtheta dphi. The marginal
//! of theta is in [`super::marginal`]; the conditional of phi is a quadratic.
//!
//! The equation of a cell, (8), is solved in [`super::marginal`].

use glam::DVec3;

use super::angles::{Column, Row};
use super::marginal::{Marginal, Polar, linear_quantile};
use crate::math::solve::Solver;

/// The corner values of a cell and what is derived from them once.
#[derive(Debug, Clone, Copy)]
pub struct Cell {
    /// A1, A2, B1, B2.
    pub corners: [f64; 4],
    inverse_mass: f64,
}

/// A direction drawn from a table.
#[derive(Debug, Clone, Copy)]
pub struct GridPoint {
    /// Unit vector: polar axis z, azimuth from x towards y.
    pub direction: DVec3,
    /// Polar angle, radians.
    pub theta: f64,
    /// Azimuth, radians, within the table's range.
    pub phi: f64,
}

impl Cell {
    /// A cell, or `None` where its flux is zero (or too small to be told from zero).
    pub fn new(row: &Row, corners: [f64; 4]) -> Option<Self> {
        let [a1, a2, b1, b2] = corners;
        let (mass, _) = Marginal::new(row, (a1 + a2, b1 + b2), 1.0).mass_to(row.width);
        let cell = Self::of_mass(mass, corners);
        (cell.inverse_mass > 0.0 && cell.inverse_mass.is_finite()).then_some(cell)
    }

    /// A cell whose F(dt) is known and positive.
    #[inline]
    pub(super) fn of_mass(mass: f64, corners: [f64; 4]) -> Self {
        Self { corners, inverse_mass: 1.0 / mass }
    }

    /// Integral of the bilinear value over the cell in solid angle: dp/2 F(dt).
    pub fn flux(&self, column: &Column) -> f64 {
        0.5 * column.width / self.inverse_mass
    }

    /// The largest corner.
    pub(super) fn largest(&self) -> f64 {
        self.corners.iter().copied().fold(0.0, f64::max)
    }

    /// The polar angle at which the marginal distribution function is u: the root of eq. (8).
    #[inline]
    pub fn sample_theta(&self, row: &Row, u: f64, solver: Solver) -> Polar {
        let [a1, a2, b1, b2] = self.corners;
        Marginal::new(row, (a1 + a2, b1 + b2), self.inverse_mass).solve(u, solver)
    }

    /// Values at phi1 and phi2 at the polar position s.
    #[inline]
    fn ends_at(&self, row: &Row, s: f64) -> (f64, f64) {
        let [a1, a2, b1, b2] = self.corners;
        let t = s * row.inverse_width;
        (a1 * (1.0 - t) + b1 * t, a2 * (1.0 - t) + b2 * t)
    }

    /// The fraction x of the column at which the conditional distribution function of phi at s is u.
    #[inline]
    pub fn sample_phi(&self, row: &Row, s: f64, u: f64) -> f64 {
        let (l, r) = self.ends_at(row, s);
        let near = l / (l + r);
        if near.is_finite() { linear_quantile(near, u) } else { u }
    }

    /// The bilinear value (7) at s and the fraction x of the column.
    #[inline]
    pub(super) fn value(&self, row: &Row, s: f64, x: f64) -> f64 {
        let (l, r) = self.ends_at(row, s);
        l * (1.0 - x) + r * x
    }

    /// The point for the coordinates of theta and phi, by inverse functions: (point, theta - theta1, fraction
    /// of the column).
    #[inline]
    pub(super) fn place(
        &self,
        row: &Row,
        column: &Column,
        [u_theta, u_phi]: [f64; 2],
        solver: Solver,
    ) -> (GridPoint, f64, f64) {
        let polar = self.sample_theta(row, u_theta, solver);
        let x = self.sample_phi(row, polar.s, u_phi);
        (GridPoint::new(row, column, &polar, x), polar.s, x)
    }
}

impl GridPoint {
    /// The point at a polar angle inside a row, a fraction x into a column.
    #[inline]
    pub(super) fn new(row: &Row, column: &Column, polar: &Polar, x: f64) -> Self {
        let (sin_phi, cos_phi) = column.azimuth(x);
        Self {
            direction: DVec3::new(polar.sin * cos_phi, polar.sin * sin_phi, polar.cos),
            theta: row.theta + polar.s,
            phi: column.phi + x * column.width,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// The part of pi that an f64 leaves out.
    const PI_LOW: f64 = 1.224_646_799_147_353_2e-16;

    /// F(s) by Gauss-Legendre quadrature of the density itself: shares no formula with the solver. The sine
    /// near the south pole is taken from pi - theta in two parts, so it is right to full relative precision
    /// there.
    fn mass_by_quadrature(theta1: f64, dt: f64, a: f64, b: f64, s: f64) -> f64 {
        const X: [f64; 4] = [
            0.183_434_642_495_649_8,
            0.525_532_409_916_329,
            0.796_666_477_413_626_7,
            0.960_289_856_497_536_3,
        ];
        const W: [f64; 4] = [
            0.362_683_783_378_362,
            0.313_706_645_877_887_3,
            0.222_381_034_453_374_48,
            0.101_228_536_290_376_26,
        ];
        let density = |x: f64| {
            let theta = theta1 + x;
            let sine = if theta > 2.0 {
                ((PI - theta1) - x + PI_LOW).sin()
            } else if theta1 == 0.0 {
                x.sin()
            } else {
                theta1.sin() * x.cos() + theta1.cos() * x.sin()
            };
            (a * (1.0 - x / dt) + b * (x / dt)) * sine
        };
        let panels = 24;
        let h = s / f64::from(panels) / 2.0;
        let mut sum = 0.0;
        for p in 0..panels {
            let middle = h * f64::from(2 * p + 1);
            for k in 0..4 {
                sum += h * W[k] * (density(middle - h * X[k]) + density(middle + h * X[k]));
            }
        }
        sum
    }

    /// Every family of METHOD 3: position x width x corners.
    fn families() -> Vec<(f64, f64, [f64; 4])> {
        let mut all = Vec::new();
        let corners = [
            [1.0, 1.0, 1.0, 1.0],
            [0.0, 0.0, 1.0, 2.0],
            [3.0, 1.0, 0.0, 0.0],
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 1.0, 0.0],
            [0.0, 0.0, 0.0, 1.0],
            [1.0, 1e-12, 1e12, 1.0],
            [1e12, 1.0, 1e-12, 1.0],
            [1e-200, 2e-200, 5e-201, 0.0],
            [1e200, 0.0, 3e200, 1e190],
            [0.3, 0.7, 0.31, 0.69],
        ];
        for width in [1e-12, 1e-9, 1e-6, 1e-3, 0.0436, 0.3, 0.49, 0.51, 1.2, PI / 2.0, PI] {
            let mut starts = vec![0.0, PI - width];
            for at in [1e-9, 0.1, 1.0, PI / 2.0, 2.5, 3.1] {
                if at + width < PI {
                    starts.push(at);
                }
            }
            for theta in starts {
                for c in corners {
                    all.push((theta, width, c));
                }
            }
        }
        all
    }

    fn uniforms() -> Vec<f64> {
        let mut all = vec![0.0, 1e-300, 1e-18, 1e-9, 1e-4, 1.0 - 1e-9, 1.0 - f64::EPSILON / 2.0];
        all.extend((0..41).map(|k| f64::from(k) / 41.0 + 0.003));
        all
    }

    #[test]
    fn inverse_of_the_marginal_holds_to_1e_12_in_every_family() {
        let mut most = 0;
        for (theta, width, corners) in families() {
            let row = Row::new(theta, theta + width);
            let Some(cell) = Cell::new(&row, corners) else {
                panic!("no cell for {theta} {width} {corners:?}");
            };
            let (a, b) = (corners[0] + corners[1], corners[2] + corners[3]);
            let whole = mass_by_quadrature(row.theta, row.width, a, b, row.width);
            for (u, solver) in uniforms().into_iter().flat_map(|u| Solver::ALL.map(|solver| (u, solver))) {
                let polar = cell.sample_theta(&row, u, solver);
                assert!((0.0..=row.width).contains(&polar.s), "{theta} {width} {corners:?} {u}: {polar:?}");
                let back = mass_by_quadrature(row.theta, row.width, a, b, polar.s) / whole;
                let error = (back - u).abs();
                assert!(error <= 1e-12, "{theta} {width} {corners:?} u {u}: error {error:e}, {polar:?}");
                most = most.max(polar.evaluations);
                assert!((polar.sin * polar.sin + polar.cos * polar.cos - 1.0).abs() < 1e-14);
            }
        }
        // 12 secant steps and a bisection of the 53 bits of the bracket: the promise of the solver.
        assert!(most <= 12 + 53, "{most} evaluations");
    }

    #[test]
    fn flux_of_a_cell_is_its_integral() {
        for (theta, width, corners) in families() {
            let row = Row::new(theta, theta + width);
            let column = Column::new(0.3, 0.3 + 0.26);
            let cell = Cell::new(&row, corners).unwrap();
            let (a, b) = (corners[0] + corners[1], corners[2] + corners[3]);
            let expected = 0.5 * column.width * mass_by_quadrature(row.theta, row.width, a, b, row.width);
            assert!((cell.flux(&column) / expected - 1.0).abs() < 1e-12, "{theta} {width} {corners:?}");
        }
    }

    #[test]
    fn a_full_sphere_cell_has_four_pi() {
        let row = Row::new(0.0, PI);
        let column = Column::new(0.0, 2.0 * PI);
        let cell = Cell::new(&row, [1.0; 4]).unwrap();
        assert!((cell.flux(&column) - 4.0 * PI).abs() < 1e-14);
        // Uniform on the sphere: cos theta = 1 - 2 u.
        for u in uniforms() {
            for solver in Solver::ALL {
                assert!((cell.sample_theta(&row, u, solver).cos - (1.0 - 2.0 * u)).abs() < 1e-13);
            }
        }
    }

    #[test]
    fn zero_cells_do_not_exist() {
        let row = Row::new(0.2, 0.3);
        assert!(Cell::new(&row, [0.0; 4]).is_none());
    }

    #[test]
    fn conditional_of_phi_inverts_without_cancelling() {
        let row = Row::new(0.4, 0.5);
        for corners in [
            [1.0, 1.0, 1.0, 1.0],
            [0.0, 1.0, 0.0, 2.0],
            [1.0, 0.0, 3.0, 0.0],
            [1e12, 1.0, 1.0, 1e-12],
            [1.0, 1.0 + 1e-15, 1.0, 1.0],
        ] {
            let cell = Cell::new(&row, corners).unwrap();
            for t in [0.0, 0.3, 1.0] {
                let s = t * row.width;
                for u in uniforms() {
                    let x = cell.sample_phi(&row, s, u);
                    assert!((0.0..=1.0).contains(&x));
                    // Trapezoid of a linear density: exact by hand.
                    let (l, r) =
                        (corners[0] * (1.0 - t) + corners[2] * t, corners[1] * (1.0 - t) + corners[3] * t);
                    let value = l + (r - l) * x;
                    let back = 0.5 * (l + value) * x / (0.5 * (l + r));
                    assert!((back - u).abs() < 1e-14, "{corners:?} {t} {u} {x} {back}");
                }
            }
        }
    }
}
