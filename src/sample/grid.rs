//! The table of a luminaire on the sphere: a density, bilinear on a grid of polar angle and azimuth, and its sampler.
//!
//! Photometry of type C is such a grid as it stands; types A and B are after a relabelling of axes ([`crate::photometry`],
//! `full_grid`). Coordinate 1 chooses the cell by its flux (row by row) and, renormalised, theta by the cell's marginal;
//! coordinate 2 gives phi by the conditional (METHOD 3).

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
    /// A grid of values (any unit) at `polar` x `azimuth` (radians, rising; polar within [0, pi], azimuth spanning at
    /// most a full turn), `values[i * azimuth.len() + j]`.
    ///
    /// # Errors
    /// Fewer than two angles of either kind, angles that do not rise or leave their range, values that are negative
    /// or not finite, more than [`MAX_NODES`], and tables whose integral is zero or not finite.
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

    /// A direction by inverse functions or by rejection, or `None` where this point of the sequence gives none
    /// ([`Rejection::NextPoint`]).
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

    fn reject<C: Chooser>(&self, mut u: Reusable, chooser: &mut C, rejection: Rejection) -> Option<GridPoint> {
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

    /// Proposals per accepted direction of [`Rejection::Cell`]: the mean over cells, by flux, of largest corner x solid
    /// angle / flux.
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
    use crate::sequence::hash::mix64;

    fn table(rows: usize, columns: usize, f: impl Fn(usize, usize) -> f64) -> (Vec<f64>, Vec<f64>, Vec<f64>) {
        let polar = (0..=rows).map(|i| PI * i as f64 / rows as f64).collect();
        let azimuth = (0..=columns).map(|j| 2.0 * PI * j as f64 / columns as f64).collect();
        let values =
            (0..=rows).flat_map(|i| (0..=columns).map(move |j| (i, j))).map(|(i, j)| f(i, j)).collect();
        (polar, azimuth, values)
    }

    fn lumpy(i: usize, j: usize) -> f64 {
        let j = j % 24;
        if (i + 3 * j).is_multiple_of(5) || j == 7 {
            0.0
        } else {
            f64::from(((i * 31 + j * 17) % 23) as u32).powi(3)
        }
    }

    #[test]
    fn sample_then_invert_returns_the_coordinates() {
        let (p, a, v) = table(36, 24, lumpy);
        let grid = Grid::new(&p, &a, &v).unwrap();
        for i in 0..20_000u64 {
            let (u1, u2) = (mix64(2 * i), to_unit_f64(mix64(2 * i + 1)));
            let point = grid.sample(u1, u2, Solver::DEFAULT);
            let (v1, v2) = grid.invert(point.theta, point.phi).unwrap();
            // The remainder resolves theta to 2^-46 of the cell; angles are rounded to 2^-52 of a turn against cells
            // of a tenth, and u inside a cell is worth its probability.
            assert!(v1.abs_diff(u1) as f64 / TWO_TO_64 < 1e-13, "{i}: {v1} {u1}");
            assert!(
                (v2 - u2).abs() < 2e-13 || grid.pdf_omega(point.theta, point.phi) < 1e-6,
                "{i}: {v2} {u2}"
            );
        }
    }

    #[test]
    fn jacobian_is_the_inverse_density_pointwise() {
        // d(omega)/d(u1, u2) by central differences against 1 / pdf: no random numbers, no histogram.
        let (p, a, v) = table(12, 8, lumpy);
        let grid = Grid::new(&p, &a, &v).unwrap();
        let mut checked = 0;
        for i in 0..3000u64 {
            let (u1, u2) = (mix64(i) | 1 << 40, 0.05 + 0.9 * to_unit_f64(mix64(!i)));
            let (h1, h2) = (1u64 << 38, 1e-6);
            // Away from the edges of the cell's share of u1: where a corner is zero the map has a square root there.
            let mut rest = Reusable::fresh(u1);
            grid.choice.choose(&mut rest);
            if !(0.01..0.99).contains(&to_unit_f64(rest.bits())) {
                continue;
            }
            let at = |du: i64, dv: f64| {
                grid.sample(u1.wrapping_add_signed(du * h1 as i64), u2 + dv, Solver::DEFAULT)
            };
            let (here, up, down, right, left) = (at(0, 0.0), at(1, 0.0), at(-1, 0.0), at(0, h2), at(0, -h2));
            let cell = |q: &GridPoint| grid.locate(q.theta, q.phi).map(|(i, j, ..)| (i, j));
            if cell(&up) != cell(&down) || cell(&left) != cell(&right) {
                continue;
            }
            let d1 = (up.direction - down.direction) / (2.0 * h1 as f64 / TWO_TO_64);
            let d2 = (right.direction - left.direction) / (2.0 * h2);
            let jacobian = d1.cross(d2).length();
            let product = jacobian * grid.pdf_omega(here.theta, here.phi);
            assert!((product - 1.0).abs() < 1e-4, "{i}: {product}");
            checked += 1;
        }
        assert!(checked > 2500);
    }

    #[test]
    fn integral_of_a_constant_and_of_a_cosine() {
        let (p, a, v) = table(180, 36, |_, _| 2.5);
        assert!((Grid::new(&p, &a, &v).unwrap().integral() - 10.0 * PI).abs() < 1e-12);
    }

    #[test]
    fn one_cell_and_the_largest_table() {
        let one = Grid::new(&[0.0, 1.0], &[0.0, 1.0], &[1.0, 2.0, 3.0, 4.0]).unwrap();
        assert!(one.choice().is_single());
        let (v1, v2) = one.invert(0.5, 0.5).unwrap();
        let back = one.sample(v1, v2, Solver::DEFAULT);
        assert!((back.theta - 0.5).abs() < 1e-12 && (back.phi - 0.5).abs() < 1e-12);
        let (p, a, v) = table(720, 360, |i, j| f64::from((i * j % 1000) as u32) * 1e-9 + 1.0);
        let large = Grid::new(&p, &a, &v).unwrap();
        assert!(large.memory_bytes() < 40 << 20, "{}", large.memory_bytes());
        assert!((large.sample(u64::MAX, 0.5, Solver::DEFAULT).theta - PI).abs() < 0.01);
    }

    #[test]
    fn cells_of_zero_flux_are_never_chosen_and_rare_cells_are() {
        let (p, a, mut v) = table(6, 8, |_, _| 0.0);
        v[3 * 9 + 4] = 1.0; // One node: four cells around it.
        v[1] = 1e-12;
        let grid = Grid::new(&p, &a, &v).unwrap();
        for i in 0..10_000u64 {
            let q = grid.sample(mix64(i), to_unit_f64(mix64(!i)), Solver::DEFAULT);
            assert!(grid.value(q.theta, q.phi) > 0.0);
        }
        // The very first fraction belongs to the rare cell at the pole.
        let first = grid.sample(0, 0.5, Solver::DEFAULT);
        assert!(first.theta <= p[1]);
        assert!(grid.cell_probability(0, 0) > 0.0 && grid.cell_probability(5, 5) == 0.0);
    }

    #[test]
    fn bad_tables_are_refused() {
        let refused = |p: &[f64], a: &[f64], v: &[f64]| Grid::new(p, a, v).is_err();
        assert!(refused(&[0.0], &[0.0, 1.0], &[1.0, 1.0]));
        assert!(refused(&[0.0, 1.0], &[0.0, 1.0], &[1.0; 3]));
        assert!(refused(&[0.0, 0.0], &[0.0, 1.0], &[1.0; 4]));
        assert!(refused(&[0.0, 4.0], &[0.0, 1.0], &[1.0; 4]));
        assert!(refused(&[0.0, 1.0], &[0.0, 7.0], &[1.0; 4]));
        assert!(refused(&[0.0, 1.0], &[0.0, 1.0], &[0.0; 4]));
        assert!(refused(&[0.0, 1.0], &[0.0, 1.0], &[1.0, f64::NAN, 1.0, 1.0]));
        assert!(refused(&[0.0, 1.0], &[0.0, 1.0], &[1.0, -1.0, 1.0, 1.0]));
        assert!(refused(&[0.0, 1.0], &[0.0, 1.0], &[1e308; 4].map(|v: f64| v * 10.0)));
    }
}
