//! Sampling a table by rejection: the baseline of inverse functions, with the same density and an unbounded
//! number of coordinates (METHOD 3, 8).
//!
//! Proposals are uniform in solid angle. Between theta1 and theta2 that is a uniform h = cos(theta1) -
//! cos(theta); then sin^2(theta) = sin^2(theta1) + h (2 cos(theta1) - h) and tan((theta - theta1) / 2) = h /
//! (sin(theta1) + sin(theta)), in which nothing cancels however narrow the cell is.

use std::f64::consts::PI;

use glam::DVec3;

use super::angles::{Angles, Column, Row};
use super::cell::{Cell, GridPoint};
use super::choose::Reusable;
use super::coordinates::{Chooser, Purpose};
use super::marginal::Polar;
use crate::math::trig::sin_cos;

/// Purposes of the coordinates of theta and phi.
pub(super) type Purposes = [Purpose; 2];

/// Proposals until one is accepted. `propose` makes a point of two coordinates and tells its value, at most
/// 1, which is the chance of acceptance. `u` serves as the first coordinate unless it is spent.
#[inline]
pub(super) fn reject<C: Chooser>(
    u: Reusable,
    chooser: &mut C,
    purposes: Purposes,
    propose: impl Fn([f64; 2]) -> (GridPoint, f64),
) -> GridPoint {
    let mut u_theta = chooser.rest(u, purposes[0]);
    loop {
        if let Some(point) = attempt(u_theta, chooser, purposes, &propose) {
            return point;
        }
        u_theta = chooser.uniform(purposes[0]);
    }
}

/// One proposal, or `None` where it is not accepted.
#[inline]
pub(super) fn attempt<C: Chooser>(
    u_theta: f64,
    chooser: &mut C,
    purposes: Purposes,
    propose: impl Fn([f64; 2]) -> (GridPoint, f64),
) -> Option<GridPoint> {
    let u_phi = chooser.uniform(purposes[1]);
    let (point, value) = propose([u_theta, u_phi]);
    (chooser.uniform(Purpose::Acceptance) < value).then_some(point)
}

/// The polar angle that is reached from theta1 by the difference of cosines h.
fn reach(sin1: f64, cos1: f64, h: f64) -> Polar {
    let sin = (sin1 * sin1 + h * (2.0 * cos1 - h)).max(0.0).sqrt();
    let sum = sin1 + sin;
    // Both sines vanish at a pole reached from the same pole (h = 0) and from the other one (h = 2).
    let s = if sum > 0.0 {
        2.0 * libm::atan(h / sum)
    } else if h > 1.0 {
        PI
    } else {
        0.0
    };
    Polar { s, sin, cos: cos1 - h, evaluations: 0 }
}

impl Cell {
    /// A point uniform in the cell's solid angle, and the value there in units of the largest corner.
    pub(super) fn propose(&self, row: &Row, column: &Column, u: [f64; 2]) -> (GridPoint, f64) {
        let (point, s) = uniform_in_cell(row, column, u);
        (point, self.value(row, s, u[1]) / self.largest())
    }
}

/// A point uniform in the solid angle of a cell, and theta - theta1.
pub(super) fn uniform_in_cell(row: &Row, column: &Column, [u_theta, u_phi]: [f64; 2]) -> (GridPoint, f64) {
    let mut polar = reach(row.sin, row.cos, u_theta * row.cap());
    polar.s = polar.s.min(row.width);
    (GridPoint::new(row, column, &polar, u_phi), polar.s)
}

impl Angles {
    /// A point uniform in solid angle over the whole table.
    pub fn uniform(&self, [u_theta, u_phi]: [f64; 2]) -> GridPoint {
        let ([low, high], [phi1, phi2]) = self.range();
        let first = &self.rows[0];
        let h = u_theta * (first.cos - libm::cos(high));
        let Polar { s, sin, cos, .. } = reach(first.sin, first.cos, h);
        let phi = phi1 + u_phi * (phi2 - phi1);
        let (sin_phi, cos_phi) = sin_cos(phi);
        let direction = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
        GridPoint { direction, theta: (low + s).min(high), phi: phi.min(phi2) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_reached_angle_is_right_in_cells_of_any_width_and_at_both_poles() {
        for theta1 in [0.0, 1e-9, 0.3, 1.5, 2.9, PI - 1e-9] {
            for width in [1e-12, 1e-9, 1e-4, 0.04, PI - theta1] {
                if theta1 + width > PI {
                    continue;
                }
                let row = Row::new(theta1, theta1 + width);
                for u in [0.0, 1e-12, 0.25, 0.5, 0.99, 1.0] {
                    let h = u * row.cap();
                    let Polar { s, sin, cos, .. } = reach(row.sin, row.cos, h);
                    // cos(theta1) - cos(theta1 + s) = 2 sin(theta1 + s/2) sin(s/2), by its own formula.
                    let middle = theta1 + 0.5 * row.width;
                    let back = 2.0 * (middle + 0.5 * (s - row.width)).sin() * (0.5 * s).sin();
                    // Near the south pole sin(theta) is known to an ulp of pi.
                    let slack = 1e-15 * (0.5 * s).sin();
                    assert!((back - h).abs() <= 4e-15 * h + slack, "{theta1} {width} {u}: {back:e} {h:e}");
                    assert!((sin * sin + cos * cos - 1.0).abs() < 1e-15);
                }
            }
        }
    }
}
