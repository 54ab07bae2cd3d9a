//! Sampling a table by rejection: the baseline of inverse functions, with the same density and an unbounded number of
//! coordinates (METHOD 3, 8).
//!
//! Proposals are uniform in solid angle. Between theta1 and theta2 that is a uniform h = cos(theta1) - cos(theta); then
//! sin^2(theta) = sin^2(theta1) + h (2 cos(theta1) - h) and tan((theta - theta1) / 2) = h / (sin(theta1) + sin(theta)),
//! in which nothing cancels however narrow the cell is.

use std::f64::consts::PI;

use glam::DVec3;

use super::cell::Row;
use super::choose::Reusable;
use super::coordinates::{Coordinates, Purpose};
use super::discrete::Discrete;
use super::grid::{Grid, GridPoint};
use super::method::Rejection;
use crate::error::{Diagnostic, Kind, Result};
use crate::math::trig::{InCell, sin_cos};
use crate::sequence::{Points, to_unit_f64};

/// A proposal and the value of the table there.
struct Proposal {
    point: GridPoint,
    value: f64,
}

/// A polar angle reached from another one by the difference of cosines h.
pub(super) struct Reached {
    pub(super) s: f64,
    pub(super) sin: f64,
    pub(super) cos: f64,
}

pub(super) fn reach(sin1: f64, cos1: f64, h: f64) -> Reached {
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
    Reached { s, sin, cos: cos1 - h }
}

impl Row {
    /// cos(theta1) - cos(theta2).
    pub(super) fn cap(&self) -> f64 {
        let t = InCell::at(self.width);
        self.sin() * t.sin + self.cos() * t.versine
    }
}

impl Grid {
    /// A direction by rejection, or `None` where the point of the sequence gives none ([`Rejection::NextPoint`]).
    ///
    /// `u` is what is left of the coordinate that chose the emitter; it serves as the first coordinate here unless it is
    /// spent.
    pub fn reject<P: Points>(
        &self,
        mut u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
        rejection: Rejection,
    ) -> Option<GridPoint> {
        let cell = match rejection {
            Rejection::Cell => Some(coordinates.choose(self.choice(), &mut u, Purpose::Emission)),
            Rejection::Table | Rejection::NextPoint => None,
        };
        let mut u_theta = coordinates.remainder(u, Purpose::EmissionTheta);
        loop {
            let u_phi = to_unit_f64(coordinates.draw(Purpose::EmissionPhi));
            let Proposal { point, value } = match cell {
                Some(cell) => self.propose_in_cell(cell, u_theta, u_phi),
                None => self.propose(u_theta, u_phi),
            };
            let accepted = to_unit_f64(coordinates.draw(Purpose::Acceptance)) < value;
            if accepted {
                return Some(point);
            }
            if rejection == Rejection::NextPoint {
                return None;
            }
            u_theta = to_unit_f64(coordinates.draw(Purpose::EmissionTheta));
        }
    }

    /// A point uniform in the solid angle of a cell; the value in units of the cell's largest corner.
    fn propose_in_cell(&self, index: usize, u_theta: f64, u_phi: f64) -> Proposal {
        let (cell, row, _) = self.cell(index);
        let point = self.uniform_in_cell(index, u_theta, u_phi);
        let largest = cell.corners.iter().copied().fold(0.0, f64::max);
        let s = (point.theta - row.theta).clamp(0.0, row.width);
        Proposal { point, value: cell.value(row, s, u_phi) / largest }
    }

    /// A point uniform in the solid angle of a cell.
    fn uniform_in_cell(&self, cell: usize, u_theta: f64, u_phi: f64) -> GridPoint {
        let (_, row, column) = self.cell(cell);
        let Reached { s, sin, cos } = reach(row.sin(), row.cos(), u_theta * row.cap());
        let (sin_phi, cos_phi) = column.azimuth(u_phi);
        GridPoint {
            direction: DVec3::new(sin * cos_phi, sin * sin_phi, cos),
            theta: row.theta + s.min(row.width),
            phi: column.phi + u_phi * column.width,
            evaluations: 0,
        }
    }

    /// A point uniform in the solid angle of the whole grid; the value in units of its largest.
    fn propose(&self, u_theta: f64, u_phi: f64) -> Proposal {
        let point = self.uniform(u_theta, u_phi);
        Proposal { point, value: self.value(point.theta, point.phi) / self.largest() }
    }

    /// A point uniform in solid angle over the range of the grid.
    fn uniform(&self, u_theta: f64, u_phi: f64) -> GridPoint {
        let ([low, high], [phi1, phi2]) = self.range();
        let (sin1, cos1) = libm::sincos(low);
        let h = u_theta * (cos1 - libm::cos(high));
        let Reached { s, sin, cos } = reach(sin1.max(0.0), cos1, h);
        let phi = phi1 + u_phi * (phi2 - phi1);
        let (sin_phi, cos_phi) = sin_cos(phi);
        GridPoint {
            direction: DVec3::new(sin * cos_phi, sin * sin_phi, cos),
            theta: (low + s).min(high),
            phi: phi.min(phi2),
            evaluations: 0,
        }
    }

    /// Solid angle of the range of the grid, sr.
    fn solid_angle(&self) -> f64 {
        let ([low, high], [phi1, phi2]) = self.range();
        (libm::cos(low) - libm::cos(high)) * (phi2 - phi1)
    }

    /// Proposals per accepted direction of [`Rejection::Cell`]: the mean over cells, by flux, of largest corner x solid
    /// angle / flux.
    pub fn proposals_of_cells(&self) -> f64 {
        let mut sum = 0.0;
        let mut flux = 0.0;
        for index in 0..self.cell_count() {
            let (cell, row, column) = self.cell(index);
            let largest = cell.corners.iter().copied().fold(0.0, f64::max);
            sum += largest * row.cap() * column.width;
            flux += cell.flux(column);
        }
        sum / flux
    }

    /// Proposals per accepted direction of [`Rejection::Table`].
    pub fn proposals_of_table(&self) -> f64 {
        self.largest() * self.solid_angle() / self.integral()
    }
}

/// Directions uniform in solid angle over the cells of a grid that have a positive value somewhere: an emission map that
/// shares neither the cells' flux nor the cell equation with the sampler. A direction's weight makes it the table's.
#[derive(Debug, Clone)]
pub struct UniformMap {
    choice: Discrete,
    solid_angle: f64,
}

impl UniformMap {
    /// The map of a grid.
    ///
    /// # Errors
    /// None for a grid, which has a cell of positive flux.
    pub fn new(grid: &Grid) -> Result<Self> {
        let solid_angles: Vec<f64> = (0..grid.cell_count())
            .map(|index| {
                let (_, row, column) = grid.cell(index);
                row.cap() * column.width
            })
            .collect();
        let choice = Discrete::new(&solid_angles).ok_or_else(|| {
            Diagnostic::new(Kind::Range, "a table without cells", "a cell of positive solid angle")
        })?;
        Ok(Self { choice, solid_angle: solid_angles.iter().sum() })
    }

    /// A direction and its weight, 1 on average; `u` is what is left of the coordinate that chose the emitter.
    pub fn sample<P: Points>(
        &self,
        grid: &Grid,
        mut u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> (GridPoint, f64) {
        let cell = coordinates.choose(&self.choice, &mut u, Purpose::Emission);
        let u_theta = coordinates.remainder(u, Purpose::EmissionTheta);
        let u_phi = to_unit_f64(coordinates.draw(Purpose::EmissionPhi));
        let point = grid.uniform_in_cell(cell, u_theta, u_phi);
        (point, grid.value(point.theta, point.phi) * self.solid_angle / grid.integral())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::independent::IndependentPoints;
    use crate::sequence::owen::OwenPoints;

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
                    let Reached { s, sin, cos } = reach(row.sin(), row.cos(), h);
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

    #[test]
    fn weights_of_the_uniform_map_average_to_one_and_to_the_table() {
        // A cell of zeros, one bright corner: mean weight 1, and the weighted share of a cell is its share of the flux.
        let polar = [0.0, 0.7, 1.5, PI];
        let azimuth = [0.0, 2.0, 2.0 * PI];
        let values = [0.0, 0.0, 0.0, 0.0, 0.0, 3.0, 0.0, 0.0, 9.0, 1.0, 1.0, 1.0];
        let grid = Grid::new(&polar, &azimuth, &values).unwrap();
        let map = UniformMap::new(&grid).unwrap();
        let points = OwenPoints::new(3, 0);
        let n = 1u64 << 16;
        let mut shares = [[0.0; 2]; 3];
        for i in 0..n {
            let mut c = Coordinates::new(&points, i, true);
            let u = c.draw_reusable(Purpose::Emission);
            let (point, weight) = map.sample(&grid, u, &mut c);
            assert_eq!(c.drawn(), 2);
            let at = |edges: &[f64], x: f64| edges[1..edges.len() - 1].iter().filter(|e| x >= **e).count();
            shares[at(&polar, point.theta)][at(&azimuth, point.phi)] += weight / n as f64;
        }
        let sum: f64 = shares.iter().flatten().sum();
        assert!((sum - 1.0).abs() < 1e-4, "{sum}");
        for (i, row) in shares.iter().enumerate() {
            for (j, share) in row.iter().enumerate() {
                assert!((share - grid.cell_probability(i, j)).abs() < 1e-4, "{i} {j}: {share}");
            }
        }
        assert_eq!(shares[0][0], 0.0);
    }

    #[test]
    fn proposals_follow_the_acceptance() {
        // Values 1 at the poles' far ends and 3 between: proposals per direction are solid angle x largest / integral.
        let polar = [0.0, 1.0, 2.0, PI];
        let azimuth = [0.0, 2.0, 2.0 * PI];
        let values = [1.0, 1.0, 1.0, 3.0, 2.0, 3.0, 3.0, 0.5, 3.0, 1.0, 1.0, 1.0];
        let grid = Grid::new(&polar, &azimuth, &values).unwrap();
        let points = IndependentPoints::new(1, 0);
        let n = 100_000u64;
        let mut drawn = 0;
        for i in 0..n {
            let mut c = Coordinates::new(&points, i, true);
            let u = c.draw_reusable(Purpose::Emission);
            assert!(grid.reject(u, &mut c, Rejection::Table).is_some());
            drawn += u64::from(c.drawn());
        }
        // 3 coordinates a proposal; the number of proposals is geometric with mean 1/p, variance (1 - p)/p^2.
        let expected = grid.proposals_of_table();
        let (mean, n) = (drawn as f64 / 3.0 / n as f64, n as f64);
        let z = (mean - expected) / (expected * (expected - 1.0) / n).sqrt();
        assert!(z.abs() < 4.0, "{mean} proposals, {expected} expected");
    }
}
