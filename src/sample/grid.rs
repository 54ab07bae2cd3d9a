//! A tabulated density on the sphere, bilinear on a grid of polar angle and azimuth: sample, pdf, invert, integral.
//!
//! Measure: solid angle, sin(theta) dtheta dphi, theta from the pole at which that weight vanishes. Photometry of type
//! C is such a grid as it stands; types A and B are after a relabelling of axes ([`crate::photometry`], `full_grid`).
//! Coordinate 1 chooses the cell by its flux (row by row) and, renormalised, theta by the cell's marginal; coordinate
//! 2 gives phi by the conditional (METHOD 3).

use std::f64::consts::PI;

use glam::DVec3;

use super::cell::{Cell, Column, Row};
use super::choose::{Reusable, TWO_TO_64};
use super::coordinates::{Coordinates, Purpose};
use super::discrete::Discrete;
use super::marginal::Polar;
use super::method::Sampling;
use crate::error::{Diagnostic, Kind, Result};
use crate::math::solve::Solver;
use crate::sequence::{Points, to_unit_f64};

/// Nodes a grid may have: 16 times the largest table seen in the wild (721 x 361).
pub const MAX_NODES: usize = 1 << 22;

/// A density on the sphere given by a table.
#[derive(Debug, Clone)]
pub struct Grid {
    rows: Vec<Row>,
    columns: Vec<Column>,
    /// Cells of positive flux, row by row.
    cells: Vec<Cell>,
    choice: Discrete,
    /// Values at the nodes, `[row * (columns + 1) + column]`, in units of the largest.
    nodes: Vec<f64>,
    largest: f64,
    integral: f64,
}

/// A point of the sphere sampled from a grid.
#[derive(Debug, Clone, Copy)]
pub struct GridPoint {
    /// Unit vector: polar axis z, azimuth from x towards y.
    pub direction: DVec3,
    /// Polar angle.
    pub theta: f64,
    /// Azimuth, within the grid's range.
    pub phi: f64,
    /// Evaluations of the cell equation that the solver used.
    pub evaluations: u32,
}

impl GridPoint {
    /// The point of a cell for the continuous coordinates of theta and phi, by inverse functions: (point, theta less that of the
    /// near edge, fraction of the column).
    #[inline]
    pub(super) fn in_cell(
        cell: &Cell,
        row: &Row,
        column: &Column,
        [u_theta, u_phi]: [f64; 2],
        solver: Solver,
    ) -> (Self, f64, f64) {
        let Polar { s, sin, cos, evaluations } = cell.sample_theta(row, u_theta, solver);
        let x = cell.sample_phi(row, s, u_phi);
        let (sin_phi, cos_phi) = column.azimuth(x);
        let point = Self {
            direction: DVec3::new(sin * cos_phi, sin * sin_phi, cos),
            theta: row.theta + s,
            phi: column.phi + x * column.width,
            evaluations,
        };
        (point, s, x)
    }
}

impl Grid {
    /// A grid of values (any unit) at `polar` x `azimuth` (radians, rising; polar within [0, pi], azimuth spanning at
    /// most a full turn), `values[i * azimuth.len() + j]`.
    ///
    /// # Errors
    /// Fewer than two angles of either kind, angles that do not rise or leave their range, values that are negative
    /// or not finite, more than [`MAX_NODES`], and tables whose integral is zero.
    pub fn new(polar: &[f64], azimuth: &[f64], values: &[f64]) -> Result<Self> {
        check(polar, azimuth, values)?;
        let largest = values.iter().copied().fold(0.0, f64::max);
        let nodes: Vec<f64> =
            if largest > 0.0 { values.iter().map(|v| v / largest).collect() } else { values.to_vec() };
        let rows: Vec<Row> = polar.windows(2).map(|w| Row::new(w[0], w[1])).collect();
        let columns: Vec<Column> = azimuth.windows(2).map(|w| Column::new(w[0], w[1])).collect();
        let stride = azimuth.len();
        let mut cells = Vec::new();
        for (i, row) in rows.iter().enumerate() {
            for j in 0..columns.len() {
                let at = i * stride + j;
                let corners = [nodes[at], nodes[at + 1], nodes[at + stride], nodes[at + stride + 1]];
                cells.extend(Cell::new(row, i as u32, j as u32, corners));
            }
        }
        let fluxes: Vec<f64> = cells.iter().map(|c| c.flux(&columns[c.column as usize])).collect();
        let integral = largest * fluxes.iter().sum::<f64>();
        match Discrete::new(&fluxes) {
            Some(choice) if integral.is_finite() => {
                Ok(Self { rows, columns, cells, choice, nodes, largest, integral })
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

    /// The table of cells to choose from with coordinate 1.
    #[inline]
    pub fn choice(&self) -> &Discrete {
        &self.choice
    }

    /// A chosen cell with its row and column.
    pub(super) fn cell(&self, cell: usize) -> (&Cell, &Row, &Column) {
        let cell = &self.cells[cell];
        (cell, &self.rows[cell.row as usize], &self.columns[cell.column as usize])
    }

    /// Cells of positive flux.
    pub(super) fn cell_count(&self) -> usize {
        self.cells.len()
    }

    /// The largest value at a node.
    pub fn largest(&self) -> f64 {
        self.largest
    }

    /// First and last polar angle, first and last azimuth, in radians.
    pub fn range(&self) -> ([f64; 2], [f64; 2]) {
        let (first, last) = (&self.rows[0], &self.rows[self.rows.len() - 1]);
        let (left, right) = (&self.columns[0], &self.columns[self.columns.len() - 1]);
        ([first.theta, (last.theta + last.width).min(PI)], [left.phi, right.phi + right.width])
    }

    /// The point of a chosen cell for the continuous coordinates of theta and phi.
    #[inline]
    pub fn place(&self, cell: usize, u_theta: f64, u_phi: f64, solver: Solver) -> GridPoint {
        let (cell, row, column) = self.cell(cell);
        GridPoint::in_cell(cell, row, column, [u_theta, u_phi], solver).0
    }

    /// A photon's point by inverse functions or by rejection, or `None` where this point of the sequence gives none.
    ///
    /// `u` is what is left of the coordinate that chose the emitter.
    #[inline]
    pub fn draw<P: Points>(
        &self,
        sampling: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<GridPoint> {
        match sampling {
            Sampling::Inverse(solver) => Some(self.draw_inverse(u, coordinates, solver)),
            Sampling::Rejection(rejection) => self.reject(u, coordinates, rejection),
        }
    }

    /// A photon's point by inverse functions: the cell by its flux, then theta and phi.
    #[inline]
    pub fn draw_inverse<P: Points>(
        &self,
        mut u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
        solver: Solver,
    ) -> GridPoint {
        let cell = coordinates.choose(&self.choice, &mut u, Purpose::Emission);
        let u_theta = coordinates.remainder(u, Purpose::EmissionTheta);
        let u_phi = to_unit_f64(coordinates.draw(Purpose::EmissionPhi));
        self.place(cell, u_theta, u_phi, solver)
    }

    /// The point for two coordinates, the first a 64-bit fraction that also chooses the cell.
    #[inline]
    pub fn sample(&self, u1: u64, u2: f64, solver: Solver) -> GridPoint {
        let mut u = Reusable::fresh(u1);
        let (cell, _) = self.choice.choose(&mut u);
        self.place(cell, to_unit_f64(u.bits()), u2, solver)
    }

    /// The coordinates whose sample is (theta, phi): the inverse of [`Self::sample`]; `None` outside the grid and where
    /// the density is zero all over the cell.
    pub fn invert(&self, theta: f64, phi: f64) -> Option<(u64, f64)> {
        let (i, j, s, x) = self.locate(theta, phi)?;
        let at = self.cells.binary_search_by_key(&(i as u32, j as u32), |c| (c.row, c.column)).ok()?;
        let (cell, row) = (&self.cells[at], &self.rows[i]);
        let u_theta = cell.theta_cdf(row, s);
        let remainder = if u_theta < 1.0 { (u_theta * TWO_TO_64) as u64 } else { u64::MAX };
        Some((self.choice.invert(at, remainder)?, cell.phi_cdf(row, s, x)))
    }

    /// The table's value at (theta, phi), bilinear; 0 outside the grid.
    pub fn value(&self, theta: f64, phi: f64) -> f64 {
        self.locate(theta, phi).map_or(0.0, |(i, j, s, x)| {
            let stride = self.columns.len() + 1;
            let at = i * stride + j;
            let t = s / self.rows[i].width;
            let near = self.nodes[at] * (1.0 - x) + self.nodes[at + 1] * x;
            let far = self.nodes[at + stride] * (1.0 - x) + self.nodes[at + stride + 1] * x;
            self.largest * (near * (1.0 - t) + far * t)
        })
    }

    /// Density of [`Self::sample`] in solid angle at (theta, phi), 1/sr.
    pub fn pdf_omega(&self, theta: f64, phi: f64) -> f64 {
        self.value(theta, phi) / self.integral
    }

    /// Probability that a sample falls into the cell of row `i` and column `j` of the grid.
    pub fn cell_probability(&self, i: usize, j: usize) -> f64 {
        match self.cells.binary_search_by_key(&(i as u32, j as u32), |c| (c.row, c.column)) {
            Ok(at) => self.choice.probability(at),
            Err(_) => 0.0,
        }
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.rows.capacity() * size_of::<Row>()
            + self.columns.capacity() * size_of::<Column>()
            + self.cells.capacity() * size_of::<Cell>()
            + self.nodes.capacity() * size_of::<f64>()
            + self.choice.memory_bytes()
    }

    /// (row, column, s, fraction of the column) of a point.
    fn locate(&self, theta: f64, phi: f64) -> Option<(usize, usize, f64, f64)> {
        let i = self.rows.partition_point(|r| r.theta <= theta).checked_sub(1)?;
        let j = self.columns.partition_point(|c| c.phi <= phi).checked_sub(1)?;
        let (s, t) = (theta - self.rows[i].theta, phi - self.columns[j].phi);
        let (row, column) = (&self.rows[i], &self.columns[j]);
        // The far edge belongs to the last row and column only; sums of in-cell variable and edge may round past it.
        let last = (i + 1 == self.rows.len(), j + 1 == self.columns.len());
        let over =
            |over: f64, edge: f64, is_last: bool| over > 0.0 && is_last && over > 2.0 * f64::EPSILON * edge;
        if over(s - row.width, theta, last.0) || over(t - column.width, phi, last.1) {
            return None;
        }
        Some((i, j, s.min(row.width), (t / column.width).min(1.0)))
    }
}

fn check(polar: &[f64], azimuth: &[f64], values: &[f64]) -> Result<()> {
    let rising = |a: &[f64]| a.windows(2).all(|w| w[0] < w[1]);
    let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
    if polar.len() < 2 || azimuth.len() < 2 {
        return fail(
            format!("{} polar and {} azimuth angles", polar.len(), azimuth.len()),
            "at least two of each",
        );
    }
    match polar.len().checked_mul(azimuth.len()) {
        Some(n) if n <= MAX_NODES && n == values.len() => {}
        _ => {
            return fail(
                format!("{} values for {} x {} angles", values.len(), polar.len(), azimuth.len()),
                "one value for each pair of angles, at most 2^22",
            );
        }
    }
    if !rising(polar) || !rising(azimuth) {
        return fail("angles that do not rise".into(), "strictly rising polar angles and azimuths");
    }
    // A full turn in radians is only known to rounding.
    let turn = azimuth[azimuth.len() - 1] - azimuth[0];
    if polar[0] < 0.0 || polar[polar.len() - 1] > PI || turn > 2.0 * PI * (1.0 + 4.0 * f64::EPSILON) {
        return fail(
            format!("polar {} to {}, azimuth over {turn}", polar[0], polar[polar.len() - 1]),
            "polar angles within [0, pi] and azimuths within one turn",
        );
    }
    match values.iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
        Some(bad) => fail(bad.to_string(), "finite values that are not negative"),
        None => Ok(()),
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
