//! The table of a luminaire on the sphere: a density, bilinear on a grid of polar angle and azimuth, and its
//! sampler.
//!
//! Photometry of type C is such a grid as it stands; types A and B are after a relabelling of axes
//! ([`crate::photometry`], `full_grid`). Coordinate 1 chooses the cell by its flux (row by row) and,
//! renormalised, theta by the cell's marginal; coordinate 2 gives phi by the conditional (METHOD 3).

use super::angles::{Angles, Column, Row};
use super::cell::{Cell, GridPoint};
use super::choose::Reusable;
use super::coordinates::{Chooser, Purpose};
use super::discrete::Discrete;
use super::method::{Rejection, Sampling};
use super::rejection::{Purposes, attempt, reject};
use crate::error::{Diagnostic, Kind, Result};
use crate::math::solve::Solver;

pub use super::angles::MAX_NODES;

/// Purposes of the continuous coordinates of an emission.
const PURPOSES: Purposes = [Purpose::EmissionTheta, Purpose::EmissionPhi];

/// A density on the sphere given by a table.
#[derive(Debug, Clone)]
pub struct Grid {
    angles: Angles,
    /// Cells of positive flux, row by row.
    cells: Vec<GridCell>,
    choice: Discrete,
    /// Values at the nodes, `[row * (columns + 1) + column]`, in units of the largest.
    nodes: Vec<f64>,
    largest: f64,
    integral: f64,
}

/// A cell and where it is.
#[derive(Debug, Clone, Copy)]
struct GridCell {
    cell: Cell,
    row: u32,
    column: u32,
}

impl Grid {
    /// A grid of values (any unit) at `polar` x `azimuth` (radians, rising; polar within [0, pi], azimuth
    /// spanning at most a full turn), `values[i * azimuth.len() + j]`.
    ///
    /// # Errors
    /// Fewer than two angles of either kind, angles that do not rise or leave their range, values that are
    /// negative or not finite, more than [`MAX_NODES`], and tables whose integral is zero or not finite.
    pub fn new(polar: &[f64], azimuth: &[f64], values: &[f64]) -> Result<Self> {
        let angles = Angles::new(polar, azimuth)?;
        let largest = angles.largest(values)?;
        let unit = if largest > 0.0 { largest } else { 1.0 };
        let nodes: Vec<f64> = values.iter().map(|v| v / unit).collect();
        let (mut cells, mut fluxes) = (Vec::new(), Vec::new());
        for (i, row) in angles.rows.iter().enumerate() {
            for (j, column) in angles.columns.iter().enumerate() {
                let Some(cell) = Cell::new(row, angles.corners(&nodes, i, j)) else { continue };
                cells.push(GridCell { cell, row: i as u32, column: j as u32 });
                fluxes.push(cell.flux(column));
            }
        }
        let integral = largest * fluxes.iter().sum::<f64>();
        match Discrete::new(&fluxes) {
            Some(choice) if integral.is_finite() => {
                Ok(Self { angles, cells, choice, nodes, largest, integral })
            }
            _ => Err(Diagnostic::new(
                Kind::Range,
                format!("a table whose integral over the sphere is {integral}"),
                "a positive, finite integral: a table that emits nothing cannot be sampled",
            )),
        }
    }

    /// Integral of the value over the sphere: the flux of a table of candela.
    pub fn integral(&self) -> f64 {
        self.integral
    }

    /// The cells of positive flux, from which coordinate 1 chooses.
    #[inline]
    pub fn choice(&self) -> &Discrete {
        &self.choice
    }

    /// A direction by inverse functions or by rejection, or `None` where this point of the sequence gives
    /// none ([`Rejection::NextPoint`]).
    ///
    /// `u` is what is left of the coordinate that chose the emitter.
    #[inline]
    pub fn draw<C: Chooser>(&self, sampling: Sampling, u: Reusable, chooser: &mut C) -> Option<GridPoint> {
        match sampling {
            Sampling::Inverse(solver) => Some(self.draw_inverse(u, chooser, solver)),
            Sampling::Rejection(rejection) => self.reject(u, chooser, rejection),
        }
    }

    /// A direction by inverse functions: the cell by its flux, then theta and phi.
    #[inline]
    pub fn draw_inverse<C: Chooser>(&self, mut u: Reusable, chooser: &mut C, solver: Solver) -> GridPoint {
        let (cell, row, column) = self.cell(chooser.choose(&self.choice, &mut u, Purpose::Emission));
        let u_theta = chooser.rest(u, PURPOSES[0]);
        let u_phi = chooser.uniform(PURPOSES[1]);
        cell.place(row, column, [u_theta, u_phi], solver).0
    }

    fn reject<C: Chooser>(
        &self,
        mut u: Reusable,
        chooser: &mut C,
        rejection: Rejection,
    ) -> Option<GridPoint> {
        let propose = |u| {
            let point = self.angles.uniform(u);
            (point, self.value(point.theta, point.phi) / self.largest)
        };
        Some(match rejection {
            Rejection::Cell => {
                let (cell, row, column) = self.cell(chooser.choose(&self.choice, &mut u, Purpose::Emission));
                reject(u, chooser, PURPOSES, |u| cell.propose(row, column, u))
            }
            Rejection::Table => reject(u, chooser, PURPOSES, propose),
            Rejection::NextPoint => attempt(chooser.rest(u, PURPOSES[0]), chooser, PURPOSES, propose)?,
        })
    }

    /// A cell of positive flux with its row and column.
    #[inline]
    pub(super) fn cell(&self, index: usize) -> (&Cell, &Row, &Column) {
        let GridCell { cell, row, column } = &self.cells[index];
        (cell, &self.angles.rows[*row as usize], &self.angles.columns[*column as usize])
    }

    /// All of them.
    pub(super) fn cells(&self) -> impl Iterator<Item = (&Cell, &Row, &Column)> {
        (0..self.cells.len()).map(|index| self.cell(index))
    }

    /// The table's value at (theta, phi), phi up to full turns; 0 outside the grid.
    pub fn value(&self, theta: f64, phi: f64) -> f64 {
        self.angles.locate(theta, phi).map_or(0.0, |at| self.largest * self.angles.value(&self.nodes, &at))
    }

    /// Proposals per accepted direction of [`Rejection::Cell`]: the mean over cells, by flux, of largest
    /// corner x solid angle / flux.
    pub fn proposals_of_cells(&self) -> f64 {
        let (mut sum, mut flux) = (0.0, 0.0);
        for (cell, row, column) in self.cells() {
            sum += cell.largest() * row.cap() * column.width;
            flux += cell.flux(column);
        }
        sum / flux
    }

    /// Proposals per accepted direction of [`Rejection::Table`].
    pub fn proposals_of_table(&self) -> f64 {
        let ([low, high], [phi1, phi2]) = self.angles.range();
        let solid_angle = (libm::cos(low) - libm::cos(high)) * (phi2 - phi1);
        self.largest * solid_angle / self.integral
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.angles.memory_bytes()
            + self.cells.capacity() * size_of::<GridCell>()
            + self.nodes.capacity() * size_of::<f64>()
            + self.choice.memory_bytes()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sample::coordinates::Coordinates;
    use crate::sequence::independent::IndependentPoints;
    use std::f64::consts::PI;

    #[test]
    fn integral_of_a_constant() {
        let polar: Vec<f64> = (0..=180).map(|i| PI * f64::from(i) / 180.0).collect();
        let azimuth: Vec<f64> = (0..=36).map(|j| 2.0 * PI * f64::from(j) / 36.0).collect();
        let grid = Grid::new(&polar, &azimuth, &[2.5; 181 * 37]).unwrap();
        assert!((grid.integral() - 10.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn proposals_follow_the_acceptance() {
        // Values 1 at the poles' far ends and 3 between: proposals per direction are solid angle x largest /
        // integral.
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
