//! Many tabulated densities on one grid of the sphere, held compactly: sample, pdf, invert, integral of each.
//!
//! The densities are those of [`super::grid::Grid`]: bilinear between the nodes, in the measure sin(theta) dtheta dphi,
//! sampled by the same cell equation (METHOD 3). A scattering table has one for every incidence, thousands perhaps, so a
//! slice keeps no record of a cell: its nodes as f32 (in units of its largest), the first of the 64-bit fractions that
//! each cell owns, and a guide; 16 bytes a node at most. The rest of a cell is made when it is chosen.

use std::f64::consts::PI;

use glam::DVec3;

use super::cell::{Cell, Column, Row};
use super::choose::{Reusable, Share, TWO_TO_64, integer_widths};
use super::grid::GridPoint;
use super::rejection::{Reached, reach};
use crate::error::{Diagnostic, Kind, Result};
use crate::math::solve::Solver;
use crate::math::trig::sin_cos;
use crate::sequence::to_unit_f64;

/// Nodes of one slice: 16 times the largest grid seen in the wild.
pub const MAX_NODES: usize = 1 << 22;

/// Densities on the sphere, the slices of a table, over the same polar angles and azimuths.
#[derive(Debug, Clone)]
pub struct CompactGrids {
    rows: Vec<Row>,
    /// Of each row, F(dt) of the edge sums (1, 0) and (0, 1).
    masses: Vec<[f64; 2]>,
    columns: Vec<Column>,
    /// `[slice][polar][azimuth]`, in units of the slice's largest.
    nodes: Vec<f32>,
    /// `[slice][row][column]`: the first fraction that belongs to the cell. One of zero flux has that of the next.
    low: Vec<u64>,
    /// `[slice][row]`: the first fraction that belongs to the row.
    row_low: Vec<u64>,
    /// `[slice][slot]`: for each leading bits of u, the row that owns the first fraction with those bits.
    row_guide: Vec<u32>,
    row_guide_bits: u32,
    /// `[slice][slot]`: for each leading bits of u, the cell that owns the first fraction with those bits; one more.
    guide: Vec<u32>,
    guide_bits: u32,
    slices: Vec<Slice>,
}

/// What is kept of a slice beside its nodes and cells.
#[derive(Debug, Clone, Copy)]
struct Slice {
    largest: f64,
    integral: f64,
    /// The last cell of positive flux; 0 where there is none.
    last: u32,
    /// The row of that cell.
    last_row: u32,
    /// Cells of positive flux: none, one, or more.
    cells: Cells,
    proposals: (f64, f64),
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Cells {
    None,
    One,
    Many,
}

/// A point of the grid: its row and column, theta less that of the row's near edge, and the fraction of the column.
#[derive(Debug, Clone, Copy)]
pub struct Located {
    row: usize,
    column: usize,
    s: f64,
    x: f64,
}

impl CompactGrids {
    /// No slices yet, over these angles (radians, rising; polar within [0, pi], azimuth spanning at most a full turn).
    ///
    /// # Errors
    /// Fewer than two angles of either kind, more than [`MAX_NODES`] pairs, angles that do not rise or leave their range.
    pub fn new(polar: &[f64], azimuth: &[f64]) -> Result<Self> {
        check_angles(polar, azimuth)?;
        let rows: Vec<Row> = polar.windows(2).map(|w| Row::new(w[0], w[1])).collect();
        let columns: Vec<Column> = azimuth.windows(2).map(|w| Column::new(w[0], w[1])).collect();
        let guide_bits = (rows.len() * columns.len()).ilog2();
        let row_guide_bits = rows.len().ilog2() + 1;
        Ok(Self {
            masses: rows.iter().map(Row::masses).collect(),
            rows,
            columns,
            nodes: Vec::new(),
            low: Vec::new(),
            row_low: Vec::new(),
            row_guide: Vec::new(),
            row_guide_bits,
            guide: Vec::new(),
            guide_bits,
            slices: Vec::new(),
        })
    }

    /// Makes room for so many slices, which the caller has capped.
    pub fn reserve(&mut self, slices: usize) {
        self.nodes.reserve_exact(slices * self.node_count());
        self.low.reserve_exact(slices * self.cell_count());
        self.row_low.reserve_exact(slices * self.rows.len());
        self.row_guide.reserve_exact(slices << self.row_guide_bits);
        self.guide.reserve_exact(slices * self.guide_count());
        self.slices.reserve_exact(slices);
    }

    /// Adds a slice of values (any unit) at the nodes, `values[i * azimuths + j]`, and returns its index. A slice of zeros
    /// is allowed: it has the integral zero and must not be sampled.
    ///
    /// # Errors
    /// Another number of values than nodes, values that are negative or not finite, an integral that is not finite.
    pub fn push(&mut self, values: &[f64]) -> Result<usize> {
        if values.len() != self.node_count() {
            let found = format!("{} values for {} nodes", values.len(), self.node_count());
            return Err(Diagnostic::new(Kind::Range, found, "one value for each node"));
        }
        if let Some(bad) = values.iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
            let required = "finite values that are not negative";
            return Err(Diagnostic::new(Kind::Range, bad.to_string(), required));
        }
        let largest = values.iter().copied().fold(0.0, f64::max);
        let start = self.nodes.len();
        let unit = if largest > 0.0 { largest } else { 1.0 };
        self.nodes.extend(values.iter().map(|v| (v / unit) as f32));
        let fluxes = self.fluxes(&self.nodes[start..]);
        let sum: f64 = fluxes.iter().sum();
        let integral = largest * sum;
        if !integral.is_finite() {
            self.nodes.truncate(start);
            let found = format!("values up to {largest}, whose integral is {integral}");
            return Err(Diagnostic::new(Kind::Range, found, "a finite integral"));
        }
        let last = fluxes.iter().rposition(|f| *f > 0.0);
        let cells = match fluxes.iter().filter(|f| **f > 0.0).count() {
            0 => Cells::None,
            1 => Cells::One,
            _ => Cells::Many,
        };
        let last = last.unwrap_or(0);
        let proposals = self.count_proposals(&self.nodes[start..], sum);
        let (last, last_row) = (last as u32, (last / self.columns.len()) as u32);
        self.slices.push(Slice { largest, integral, last, last_row, cells, proposals });
        self.add_choice(&fluxes, last as usize);
        Ok(self.slices.len() - 1)
    }

    /// Fluxes of the cells, in units of the largest node.
    fn fluxes(&self, nodes: &[f32]) -> Vec<f64> {
        let mut fluxes = Vec::with_capacity(self.cell_count());
        for i in 0..self.rows.len() {
            for (j, column) in self.columns.iter().enumerate() {
                fluxes.push(0.5 * column.width * self.mass(i, self.corners(nodes, i, j)));
            }
        }
        fluxes
    }

    /// The fractions of the cells and the guide to them.
    fn add_choice(&mut self, fluxes: &[f64], last: usize) {
        let start = self.low.len();
        let Some(widths) = integer_widths(fluxes) else {
            // One cell or none: there is nothing to choose.
            self.low.resize(start + fluxes.len(), 0);
            self.row_low.resize(self.row_low.len() + self.rows.len(), 0);
            self.row_guide.resize(self.row_guide.len() + (1 << self.row_guide_bits), 0);
            self.guide.resize(self.guide.len() + self.guide_count(), last as u32);
            return;
        };
        let mut sum = 0u64;
        for width in widths {
            self.low.push(sum);
            sum = sum.wrapping_add(width);
        }
        let first_row = self.row_low.len();
        self.row_low.extend(self.low[start..].iter().step_by(self.columns.len()));
        let row_low = &self.row_low[first_row..=first_row + last / self.columns.len()];
        for slot in 0..1u64 << self.row_guide_bits {
            let first = slot << (64 - self.row_guide_bits);
            self.row_guide.push(row_low.partition_point(|l| *l <= first) as u32 - 1);
        }
        let low = &self.low[start..=start + last];
        let shift = 64 - self.guide_bits;
        for slot in 0..1u64 << self.guide_bits {
            let first = if self.guide_bits == 0 { 0 } else { slot << shift };
            self.guide.push(low.partition_point(|l| *l <= first) as u32 - 1);
        }
        self.guide.push(last as u32);
    }

    /// Slices added so far.
    pub fn len(&self) -> usize {
        self.slices.len()
    }

    /// Whether there is no slice.
    pub fn is_empty(&self) -> bool {
        self.slices.is_empty()
    }

    /// Integral of a slice over the sphere.
    #[inline]
    pub fn integral(&self, slice: usize) -> f64 {
        self.slices[slice].integral
    }

    /// Multiplies a slice by a factor.
    pub fn scale(&mut self, slice: usize, factor: f64) {
        self.slices[slice].largest *= factor;
        self.slices[slice].integral *= factor;
    }

    /// Whether a slice has at most one cell of positive flux, so that none is chosen.
    #[inline]
    pub fn is_single(&self, slice: usize) -> bool {
        self.slices[slice].cells != Cells::Many
    }

    /// Chooses a cell of a slice by its flux with what is left of `u`, and renormalises it; the only cell leaves `u` as it
    /// is.
    #[inline]
    pub fn choose(&self, slice: usize, u: &mut Reusable) -> usize {
        let Slice { last, cells, .. } = self.slices[slice];
        if cells != Cells::Many {
            return last as usize;
        }
        let cell = self.cell_of(slice, u.bits());
        u.take(self.share(slice, cell));
        cell
    }

    /// The cell that owns a fraction, in a slice with more than one of positive flux.
    #[inline]
    fn cell_of(&self, slice: usize, bits: u64) -> usize {
        let low = self.low_of(slice);
        let guide = &self.guide[slice * self.guide_count()..];
        let slot = if self.guide_bits == 0 { 0 } else { (bits >> (64 - self.guide_bits)) as usize };
        let (from, to) = (guide[slot] as usize, guide[slot + 1] as usize);
        // Cells of zero flux share their first fraction with the next one, so the last of equals is the owner.
        from + low[from..=to].partition_point(|l| *l <= bits) - 1
    }

    /// The row that owns a fraction, and what it owns. In a slice with one cell, that has all.
    #[inline]
    pub fn row_of(&self, slice: usize, bits: u64) -> (usize, Share) {
        let Slice { last_row, cells, .. } = self.slices[slice];
        if cells != Cells::Many {
            return (last_row as usize, Share::ALL);
        }
        let low = &self.row_low[slice * self.rows.len()..][..=last_row as usize];
        let guide = &self.row_guide[slice << self.row_guide_bits..][..1 << self.row_guide_bits];
        let mut row = guide[(bits >> (64 - self.row_guide_bits)) as usize] as usize;
        // As of cells, the last of equals is the owner; rows beyond the last cell of positive flux own nothing.
        let mut end = low.get(row + 1).copied();
        while end.is_some_and(|end| end <= bits) {
            row += 1;
            end = low.get(row + 1).copied();
        }
        (row, Share { low: low[row], width: end.unwrap_or(0).wrapping_sub(low[row]) })
    }

    /// A column of a row by the flux of its cells on a second coordinate: (column, its probability in the row, what is left of
    /// the coordinate for the azimuth).
    #[inline]
    pub fn column_of(&self, slice: usize, row: usize, share: Share, bits: u64) -> (usize, f64, f64) {
        let Slice { last, cells, .. } = self.slices[slice];
        if cells != Cells::Many {
            return (last as usize - row * self.columns.len(), 1.0, to_unit_f64(bits));
        }
        share.choose_part(bits, |at| {
            let cell = self.cell_of(slice, at);
            (cell - row * self.columns.len(), self.share(slice, cell))
        })
    }

    #[inline]
    fn row_share(&self, slice: usize, row: usize) -> Share {
        let low = &self.row_low[slice * self.rows.len()..(slice + 1) * self.rows.len()];
        let end = low.get(row + 1).copied().unwrap_or(0);
        Share { low: low[row], width: end.wrapping_sub(low[row]) }
    }

    /// What a cell up to the last of positive flux owns, in a slice with more than one.
    #[inline]
    fn share(&self, slice: usize, cell: usize) -> Share {
        let low = self.low_of(slice);
        let end = if cell == self.slices[slice].last as usize { 0 } else { low[cell + 1] };
        Share { low: low[cell], width: end.wrapping_sub(low[cell]) }
    }

    #[inline]
    fn low_of(&self, slice: usize) -> &[u64] {
        let cells = self.cell_count();
        &self.low[slice * cells..(slice + 1) * cells]
    }

    /// Probability that a cell is chosen.
    pub fn cell_probability(&self, slice: usize, row: usize, column: usize) -> f64 {
        let Slice { last, cells, .. } = self.slices[slice];
        let cell = row * self.columns.len() + column;
        match (cells, cell.cmp(&(last as usize))) {
            (Cells::None, _) => 0.0,
            (Cells::One, order) => f64::from(u8::from(order.is_eq())),
            (Cells::Many, std::cmp::Ordering::Greater) => 0.0,
            (Cells::Many, _) => self.share(slice, cell).width as f64 / TWO_TO_64,
        }
    }

    /// The point of a chosen cell for the continuous coordinates of theta and phi.
    #[inline]
    pub fn place(&self, slice: usize, cell: usize, u_theta: f64, u_phi: f64, solver: Solver) -> GridPoint {
        let (i, j) = (cell / self.columns.len(), cell % self.columns.len());
        self.place_at(slice, [i, j], [u_theta, u_phi], solver).0
    }

    /// The same for a cell by its row and column, and where in the cell the point lies.
    #[inline]
    pub fn place_at(
        &self,
        slice: usize,
        [row, column]: [usize; 2],
        u: [f64; 2],
        solver: Solver,
    ) -> (GridPoint, Located) {
        let cell = self.cell(slice, row, column);
        let (point, s, x) = GridPoint::in_cell(&cell, &self.rows[row], &self.columns[column], u, solver);
        (point, Located { row, column, s, x })
    }

    /// The point of a slice for two coordinates, of which the first chooses the row and the second the column: u1 goes with the
    /// polar angle and u2 with the azimuth over the whole slice, so points that are evenly spread in a box of (u1, u2) are so in
    /// a box of angles.
    #[inline]
    pub fn sample_by_row(&self, slice: usize, u1: u64, u2: u64, solver: Solver) -> GridPoint {
        let (row, share) = self.row_of(slice, u1);
        let (column, _, u_phi) = self.column_of(slice, row, share, u2);
        self.place_at(slice, [row, column], [share.rest(u1), u_phi], solver).0
    }

    /// The coordinates whose sample is (theta, phi) by [`Self::sample_by_row`]; `None` outside the grid and in cells of zero
    /// flux.
    pub fn invert_by_row(&self, slice: usize, theta: f64, phi: f64) -> Option<(u64, f64)> {
        let Located { row: i, column: j, s, x } = self.locate(theta, phi)?;
        if self.cell_probability(slice, i, j) == 0.0 {
            return None;
        }
        let (cell, row) = (self.cell(slice, i, j), &self.rows[i]);
        let remainder = to_fraction(cell.theta_cdf(row, s));
        let u_phi = cell.phi_cdf(row, s, x);
        if self.is_single(slice) {
            return Some((remainder, u_phi));
        }
        let share = self.row_share(slice, i);
        let part = self.share(slice, i * self.columns.len() + j);
        Some((share.invert(remainder), share.invert_part(part, u_phi)))
    }

    /// The point of a slice for two coordinates, the first a 64-bit fraction that also chooses the cell.
    #[inline]
    pub fn sample(&self, slice: usize, u1: u64, u2: f64, solver: Solver) -> GridPoint {
        let mut u = Reusable::fresh(u1);
        let cell = self.choose(slice, &mut u);
        self.place(slice, cell, to_unit_f64(u.bits()), u2, solver)
    }

    /// The coordinates whose sample is (theta, phi); `None` outside the grid and in cells of zero flux.
    pub fn invert(&self, slice: usize, theta: f64, phi: f64) -> Option<(u64, f64)> {
        let Located { row: i, column: j, s, x } = self.locate(theta, phi)?;
        if self.cell_probability(slice, i, j) == 0.0 {
            return None;
        }
        let (cell, row) = (self.cell(slice, i, j), &self.rows[i]);
        let u_theta = cell.theta_cdf(row, s);
        let remainder = to_fraction(u_theta);
        let u2 = cell.phi_cdf(row, s, x);
        if self.is_single(slice) {
            return Some((remainder, u2));
        }
        let at = i * self.columns.len() + j;
        Some((self.share(slice, at).invert(remainder), u2))
    }

    /// The value of a slice at (theta, phi), bilinear; 0 outside the grid.
    pub fn value(&self, slice: usize, theta: f64, phi: f64) -> f64 {
        self.locate(theta, phi).map_or(0.0, |at| self.value_at(slice, &at))
    }

    /// The value of a slice at a point that is located already.
    #[inline]
    pub fn value_at(&self, slice: usize, at: &Located) -> f64 {
        let [a1, a2, b1, b2] = self.corners(self.nodes_of(slice), at.row, at.column);
        let t = at.s / self.rows[at.row].width;
        let near = a1 * (1.0 - at.x) + a2 * at.x;
        let far = b1 * (1.0 - at.x) + b2 * at.x;
        self.slices[slice].largest * (near * (1.0 - t) + far * t)
    }

    /// Density of [`Self::sample`] in solid angle at (theta, phi), 1/sr; 0 for a slice of zeros.
    pub fn pdf_omega(&self, slice: usize, theta: f64, phi: f64) -> f64 {
        let value = self.value(slice, theta, phi);
        if value > 0.0 { value / self.integral(slice) } else { 0.0 }
    }

    /// A point uniform in the solid angle of a cell, and the value there in units of the cell's largest corner: the proposal
    /// of a rejection.
    pub fn propose_in_cell(&self, slice: usize, cell: usize, u_theta: f64, u_phi: f64) -> (GridPoint, f64) {
        let (i, j) = (cell / self.columns.len(), cell % self.columns.len());
        let (row, column) = (&self.rows[i], &self.columns[j]);
        let Reached { s, sin, cos } = reach(row.sin(), row.cos(), u_theta * row.cap());
        let s = s.min(row.width);
        let (sin_phi, cos_phi) = column.azimuth(u_phi);
        let cell = self.cell(slice, i, j);
        let largest = cell.corners.iter().copied().fold(0.0, f64::max);
        let point = GridPoint {
            direction: DVec3::new(sin * cos_phi, sin * sin_phi, cos),
            theta: row.theta + s,
            phi: column.phi + u_phi * column.width,
            evaluations: 0,
        };
        (point, cell.value(row, s, u_phi) / largest)
    }

    /// A point uniform in solid angle over the range of the grid, and the value there in units of the slice's largest.
    pub fn propose(&self, slice: usize, u_theta: f64, u_phi: f64) -> (GridPoint, f64) {
        let (first, last) = (&self.rows[0], &self.rows[self.rows.len() - 1]);
        let high = (last.theta + last.width).min(PI);
        let [phi1, turn] = self.turn();
        let h = u_theta * (first.cos() - libm::cos(high));
        let Reached { s, sin, cos } = reach(first.sin(), first.cos(), h);
        let (theta, phi) = ((first.theta + s).min(high), phi1 + u_phi * turn);
        let (sin_phi, cos_phi) = sin_cos(phi);
        let direction = DVec3::new(sin * cos_phi, sin * sin_phi, cos);
        let value = self.value(slice, theta, phi) / self.slices[slice].largest;
        (GridPoint { direction, theta, phi, evaluations: 0 }, value)
    }

    /// Proposals per accepted direction: (inside a cell chosen by flux, over the range of the grid); 0 for a slice of zeros.
    pub fn proposals(&self, slice: usize) -> (f64, f64) {
        self.slices[slice].proposals
    }

    /// The same from the nodes and their integral, both in units of the largest.
    fn count_proposals(&self, nodes: &[f32], integral: f64) -> (f64, f64) {
        if integral == 0.0 {
            return (0.0, 0.0);
        }
        let (mut inside, mut all) = (0.0, 0.0);
        for (i, row) in self.rows.iter().enumerate() {
            for (j, column) in self.columns.iter().enumerate() {
                let solid_angle = row.cap() * column.width;
                inside += self.corners(nodes, i, j).into_iter().fold(0.0, f64::max) * solid_angle;
                all += solid_angle;
            }
        }
        (inside / integral, all / integral)
    }

    /// First azimuth and the extent of all.
    fn turn(&self) -> [f64; 2] {
        let (left, right) = (&self.columns[0], &self.columns[self.columns.len() - 1]);
        [left.phi, right.phi + right.width - left.phi]
    }

    /// Where (theta, phi) lies, phi up to full turns; `None` outside the grid.
    pub fn locate(&self, theta: f64, phi: f64) -> Option<Located> {
        let [first, turn] = self.turn();
        let turns = libm::floor((phi - first) / (2.0 * PI));
        let phi = if (first..=first + turn).contains(&phi) { phi } else { phi - 2.0 * PI * turns };
        // A direction on the first edge has an angle that may round to below it.
        let start = self.rows[0].theta;
        let theta = if theta < start && start - theta <= 4.0 * f64::EPSILON * start { start } else { theta };
        let i = self.rows.partition_point(|r| r.theta <= theta).checked_sub(1)?;
        let j = self.columns.partition_point(|c| c.phi <= phi).checked_sub(1)?;
        let (row, column) = (&self.rows[i], &self.columns[j]);
        let (s, t) = (theta - row.theta, phi - column.phi);
        // The far edge belongs to the last row and column only; sums of in-cell variable and edge may round past it.
        let last = (i + 1 == self.rows.len(), j + 1 == self.columns.len());
        let over =
            |over: f64, edge: f64, is_last: bool| over > 0.0 && is_last && over > 4.0 * f64::EPSILON * edge;
        if over(s - row.width, theta, last.0) || over(t - column.width, phi.abs().max(turn), last.1) {
            return None;
        }
        Some(Located { row: i, column: j, s: s.min(row.width), x: (t / column.width).min(1.0) })
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.rows.capacity() * size_of::<Row>()
            + self.masses.capacity() * size_of::<[f64; 2]>()
            + self.columns.capacity() * size_of::<Column>()
            + self.nodes.capacity() * size_of::<f32>()
            + self.low.capacity() * size_of::<u64>()
            + self.row_low.capacity() * size_of::<u64>()
            + self.row_guide.capacity() * size_of::<u32>()
            + self.guide.capacity() * size_of::<u32>()
            + self.slices.capacity() * size_of::<Slice>()
    }

    fn node_count(&self) -> usize {
        (self.rows.len() + 1) * (self.columns.len() + 1)
    }

    fn cell_count(&self) -> usize {
        self.rows.len() * self.columns.len()
    }

    fn guide_count(&self) -> usize {
        (1 << self.guide_bits) + 1
    }

    #[inline]
    fn nodes_of(&self, slice: usize) -> &[f32] {
        let nodes = self.node_count();
        &self.nodes[slice * nodes..(slice + 1) * nodes]
    }

    /// A1, A2, B1, B2 of a cell.
    #[inline]
    fn corners(&self, nodes: &[f32], row: usize, column: usize) -> [f64; 4] {
        let stride = self.columns.len() + 1;
        let near = &nodes[row * stride + column..][..2];
        let far = &nodes[(row + 1) * stride + column..][..2];
        [near[0], near[1], far[0], far[1]].map(f64::from)
    }

    /// F(dt) of a cell.
    #[inline]
    fn mass(&self, row: usize, [a1, a2, b1, b2]: [f64; 4]) -> f64 {
        let [near, far] = self.masses[row];
        (a1 + a2) * near + (b1 + b2) * far
    }

    /// A cell of positive flux.
    #[inline]
    fn cell(&self, slice: usize, row: usize, column: usize) -> Cell {
        let corners = self.corners(self.nodes_of(slice), row, column);
        Cell::of_mass(self.mass(row, corners), row as u32, column as u32, corners)
    }
}

/// A number in [0, 1] as a 64-bit fraction.
fn to_fraction(u: f64) -> u64 {
    if u < 1.0 { (u * TWO_TO_64) as u64 } else { u64::MAX }
}

fn check_angles(polar: &[f64], azimuth: &[f64]) -> Result<()> {
    let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
    if polar.len() < 2 || azimuth.len() < 2 {
        let found = format!("{} polar and {} azimuth angles", polar.len(), azimuth.len());
        return fail(found, "at least two of each");
    }
    if polar.len().checked_mul(azimuth.len()).is_none_or(|n| n > MAX_NODES) {
        let found = format!("{} x {} angles", polar.len(), azimuth.len());
        return fail(found, "at most 2^22 pairs");
    }
    let rising = |angles: &[f64]| angles.windows(2).all(|w| w[0] < w[1]);
    if !rising(polar) || !rising(azimuth) {
        return fail("angles that do not rise".into(), "strictly rising polar angles and azimuths");
    }
    // A full turn in radians is only known to rounding.
    let turn = azimuth[azimuth.len() - 1] - azimuth[0];
    if polar[0] < 0.0 || polar[polar.len() - 1] > PI || turn > 2.0 * PI * (1.0 + 8.0 * f64::EPSILON) {
        return fail(
            format!("polar {} to {}, azimuth over {turn}", polar[0], polar[polar.len() - 1]),
            "polar angles within [0, pi] and azimuths within one turn",
        );
    }
    Ok(())
}
