//! Many tabulated densities over the same angles, held compactly: those of a scattering table, one for every
//! incidence.
//!
//! The densities are those of [`super::grid::Grid`], sampled by the same cell equation (METHOD 3). There may
//! be thousands, so of a slice no cells are kept: its nodes as f32 (in units of its largest) and the cells'
//! fractions ([`Shares`]), 16 bytes a node in all. The rest of a cell is made when it is chosen.

use super::angles::{Angles, Located};
use super::cell::{Cell, GridPoint};
use super::choose::Reusable;
use super::coordinates::{Chooser, Purpose};
use super::marginal::unit_masses;
use super::method::{Rejection, Sampling};
use super::rejection::reject;
use super::shares::Shares;
use crate::error::{Diagnostic, Kind, Result};
use crate::math::solve::Solver;

/// Densities on the sphere, the slices of a table, over the same polar angles and azimuths.
#[derive(Debug, Clone)]
pub struct CompactGrids {
    angles: Angles,
    /// Of each row, F(dt) of the edge sums (1, 0) and (0, 1).
    masses: Vec<[f64; 2]>,
    /// `[slice][polar][azimuth]`, in units of the slice's largest.
    nodes: Vec<f32>,
    shares: Shares,
    slices: Vec<Slice>,
}

/// What is kept of a slice beside its nodes and shares.
#[derive(Debug, Clone, Copy)]
struct Slice {
    largest: f64,
    integral: f64,
    proposals: (f64, f64),
}

impl CompactGrids {
    /// No slices yet, over these angles (radians, rising; polar within [0, pi], azimuth spanning at most a
    /// full turn).
    ///
    /// # Errors
    /// Fewer than two angles of either kind, more pairs than a table may have, angles that do not rise or
    /// leave their range.
    pub fn new(polar: &[f64], azimuth: &[f64]) -> Result<Self> {
        let angles = Angles::new(polar, azimuth)?;
        Ok(Self {
            masses: angles.rows.iter().map(unit_masses).collect(),
            shares: Shares::new(&angles),
            angles,
            nodes: Vec::new(),
            slices: Vec::new(),
        })
    }

    /// Makes room for so many slices, which the caller has capped.
    pub fn reserve(&mut self, slices: usize) {
        self.nodes.reserve_exact(slices * self.angles.node_count());
        self.shares.reserve(slices);
        self.slices.reserve_exact(slices);
    }

    /// Adds a slice of values (any unit) at the nodes, `values[i * azimuths + j]`, and returns its index. A
    /// slice of zeros is allowed: it has the integral zero and must not be sampled.
    ///
    /// # Errors
    /// Another number of values than nodes, values that are negative or not finite, an integral that is not
    /// finite.
    pub fn push(&mut self, values: &[f64]) -> Result<usize> {
        let largest = self.angles.largest(values)?;
        let unit = if largest > 0.0 { largest } else { 1.0 };
        let start = self.nodes.len();
        self.nodes.extend(values.iter().map(|v| (v / unit) as f32));
        let (mut fluxes, mut proposals) = (Vec::with_capacity(self.angles.cell_count()), (0.0, 0.0));
        for (i, row) in self.angles.rows.iter().enumerate() {
            for (j, column) in self.angles.columns.iter().enumerate() {
                let corners = self.angles.corners(&self.nodes[start..], i, j);
                fluxes.push(0.5 * column.width * self.mass(i, corners));
                let solid_angle = row.cap() * column.width;
                proposals.0 += corners.into_iter().fold(0.0, f64::max) * solid_angle;
                proposals.1 += solid_angle;
            }
        }
        let sum: f64 = fluxes.iter().sum();
        let integral = largest * sum;
        if !integral.is_finite() {
            self.nodes.truncate(start);
            let found = format!("values up to {largest}, whose integral is {integral}");
            return Err(Diagnostic::new(Kind::Range, found, "a finite integral"));
        }
        let proposals = if sum > 0.0 { (proposals.0 / sum, proposals.1 / sum) } else { (0.0, 0.0) };
        self.slices.push(Slice { largest, integral, proposals });
        self.shares.push(&fluxes);
        Ok(self.slices.len() - 1)
    }

    /// Slices added so far.
    pub fn count(&self) -> usize {
        self.slices.len()
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

    /// Proposals per accepted direction: (inside a cell chosen by flux, over the range of the table); 0 for a
    /// slice of zeros.
    pub fn proposals(&self, slice: usize) -> (f64, f64) {
        self.slices[slice].proposals
    }

    /// Where (theta, phi) lies, phi up to full turns; `None` outside the table.
    #[inline]
    pub fn locate(&self, theta: f64, phi: f64) -> Option<Located> {
        self.angles.locate(theta, phi)
    }

    /// The value of a slice, bilinear.
    #[inline]
    pub fn value(&self, slice: usize, at: &Located) -> f64 {
        self.slices[slice].largest * self.angles.value(self.nodes_of(slice), at)
    }

    /// A direction of a slice, and its place where that is known.
    #[inline(always)]
    pub fn draw<C: Chooser>(&self, slice: usize, chooser: &mut C) -> (GridPoint, Option<Located>) {
        match chooser.sampling() {
            Sampling::Inverse(solver) => self.invert(slice, solver, chooser),
            Sampling::Rejection(rejection) => (self.reject(slice, rejection, chooser), None),
        }
    }

    /// By inverse functions. Where a coordinate goes on after a choice, one serves for the row and theta, the
    /// other for the column and phi: points that are evenly spread over the square are so over the lobe. Else
    /// the cell has a coordinate of its own.
    #[inline(always)]
    fn invert<C: Chooser>(
        &self,
        slice: usize,
        solver: Solver,
        chooser: &mut C,
    ) -> (GridPoint, Option<Located>) {
        let mut u = chooser.reusable(Purpose::Scatter);
        if chooser.reuses() {
            let v = chooser.reusable(Purpose::Scatter);
            let (row, share) = self.shares.row_of(slice, u.bits());
            let u_theta = chooser.left(share.rest(u.bits()), share.probability(), Purpose::Scatter);
            let (column, probability, rest) = self.shares.column_of(slice, row, share, v.bits());
            let u_phi = chooser.left(rest, probability, Purpose::Scatter);
            let (point, at) = self.place(slice, [row, column], [u_theta, u_phi], solver);
            return (point, Some(at));
        }
        let at = self.choose(slice, &mut u, chooser);
        let u_theta = chooser.rest(u, Purpose::Scatter);
        let u_phi = chooser.uniform(Purpose::Scatter);
        (self.place(slice, at, [u_theta, u_phi], solver).0, None)
    }

    #[inline]
    fn place(
        &self,
        slice: usize,
        [row, column]: [usize; 2],
        u: [f64; 2],
        solver: Solver,
    ) -> (GridPoint, Located) {
        let cell = self.cell(slice, row, column);
        let (point, s, x) = cell.place(&self.angles.rows[row], &self.angles.columns[column], u, solver);
        (point, Located { row, column, s, x })
    }

    /// By rejection. A photon on its way cannot go on with another point of the sequence, so of the two ways
    /// against the table's largest value both take the photon's next coordinates.
    #[inline(never)]
    fn reject<C: Chooser>(&self, slice: usize, rejection: Rejection, chooser: &mut C) -> GridPoint {
        let mut u = chooser.reusable(Purpose::Scatter);
        let at = (rejection == Rejection::Cell).then(|| self.choose(slice, &mut u, chooser));
        reject(u, chooser, [Purpose::Scatter; 2], |u| match at {
            Some([row, column]) => {
                let (rows, columns) = (&self.angles.rows, &self.angles.columns);
                self.cell(slice, row, column).propose(&rows[row], &columns[column], u)
            }
            None => {
                let point = self.angles.uniform(u);
                let value = self.locate(point.theta, point.phi).map_or(0.0, |at| self.value(slice, &at));
                (point, value / self.slices[slice].largest)
            }
        })
    }

    #[inline]
    fn choose<C: Chooser>(&self, slice: usize, u: &mut Reusable, chooser: &mut C) -> [usize; 2] {
        if self.shares.is_single(slice) {
            return self.shares.choose(slice, u);
        }
        chooser.choose_by(u, Purpose::Scatter, |u| self.shares.choose(slice, u))
    }

    #[inline]
    fn nodes_of(&self, slice: usize) -> &[f32] {
        let nodes = self.angles.node_count();
        &self.nodes[slice * nodes..(slice + 1) * nodes]
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
        let corners = self.angles.corners(self.nodes_of(slice), row, column);
        Cell::of_mass(self.mass(row, corners), corners)
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.angles.memory_bytes()
            + self.masses.capacity() * size_of::<[f64; 2]>()
            + self.nodes.capacity() * size_of::<f32>()
            + self.shares.memory_bytes()
            + self.slices.capacity() * size_of::<Slice>()
    }
}
