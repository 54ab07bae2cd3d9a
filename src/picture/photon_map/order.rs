//! The order that photons are kept in: rows of cells, in a row along the axis.
//!
//! Cells are a power of two of the frame's steps wide, so the cell of a photon is a shift of its own integers
//! and nothing is stored for it. Rows run along the longest extent of the photons; the order is total over
//! all fields of a photon, so it depends neither on the order they came in nor on threads.

use rayon::prelude::*;

use crate::picture::photon_map::record::{Frame, Photon};

/// Rows of cells along one axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Order {
    /// Axis along the rows.
    pub run: usize,
    /// Axis across them.
    pub row: usize,
    /// Axis of the slabs that rows lie in: the shortest extent, so that a floor is one slab.
    pub slab: usize,
    /// Width of a cell across the row, as a power of two of the frame's steps; 32 and more: one cell.
    pub row_shift: u32,
    /// Width of a slab, likewise.
    pub slab_shift: u32,
}

/// A place in the order: the cell (slab, then row) and the integer along the row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Key {
    pub cell: u64,
    pub run: u32,
}

impl Order {
    /// Cells of about `radius_m` or half of it for these photons.
    pub fn new<const C: usize>(photons: &[Photon<C>], frame: &Frame, radius_m: f64) -> Self {
        let steps = frame.steps_m().to_array();
        let length = lengths_m(photons, frame);
        let mut axes = [0, 1, 2];
        axes.sort_by(|&a, &b| length[b].total_cmp(&length[a]));
        let shift = |axis: usize| {
            let cells = radius_m / steps[axis];
            // A radius below one step, an axis without extent, a radius that is no number: whatever the
            // cells, the answer is the same.
            if cells >= 1.0 { libm::log2(cells.min(4_294_967_296.0)) as u32 } else { 0 }
        };
        let [run, row, slab] = axes;
        Self { run, row, slab, row_shift: shift(row), slab_shift: shift(slab) }
    }

    /// Where a photon's integers stand.
    #[inline(always)]
    pub fn key(&self, cell: [u32; 3]) -> Key {
        Key {
            cell: self.pack(self.slab_of(cell[self.slab]), self.row_of(cell[self.row])),
            run: cell[self.run],
        }
    }

    /// The number of a cell from its slab and row.
    #[inline(always)]
    pub fn pack(&self, slab: u32, row: u32) -> u64 {
        u64::from(slab) << 32 | u64::from(row)
    }

    /// The row of an integer across rows.
    #[inline(always)]
    pub fn row_of(&self, integer: u32) -> u32 {
        (u64::from(integer) >> self.row_shift) as u32
    }

    /// The slab of an integer across slabs.
    #[inline(always)]
    pub fn slab_of(&self, integer: u32) -> u32 {
        (u64::from(integer) >> self.slab_shift) as u32
    }

    /// Sorts by [`Key`], then by every other field; in place.
    pub fn sort<const C: usize>(&self, photons: &mut [Photon<C>]) {
        // One integer to compare, without a branch; the few that share it are put in order afterwards.
        photons.par_sort_unstable_by_key(|p| self.integer(p));
        for equal in photons.chunk_by_mut(|a, b| self.integer(a) == self.integer(b)) {
            if equal.len() > 1 {
                equal.par_sort_unstable_by_key(fields);
            }
        }
    }

    /// The key as one integer.
    #[inline(always)]
    fn integer<const C: usize>(&self, photon: &Photon<C>) -> u128 {
        let key = self.key(photon.cell);
        u128::from(key.cell) << 32 | u128::from(key.run)
    }
}

/// All fields, in an order of their own.
fn fields<const C: usize>(p: &Photon<C>) -> ([u32; 3], [u32; 3], [u32; C]) {
    (p.cell, [p.direction, p.primitive, p.tag], p.weight.map(f32::to_bits))
}

/// Extents of the photons along the axes, m.
pub(crate) fn lengths_m<const C: usize>(photons: &[Photon<C>], frame: &Frame) -> [f64; 3] {
    let steps = frame.steps_m().to_array();
    let (low, high) = extent(photons);
    std::array::from_fn(|k| f64::from(high[k].saturating_sub(low[k])) * steps[k])
}

/// Least and greatest integers of photons.
fn extent<const C: usize>(photons: &[Photon<C>]) -> ([u32; 3], [u32; 3]) {
    let join = |a: ([u32; 3], [u32; 3]), b: ([u32; 3], [u32; 3])| {
        (std::array::from_fn(|k| a.0[k].min(b.0[k])), std::array::from_fn(|k| a.1[k].max(b.1[k])))
    };
    let nothing = ([u32::MAX; 3], [0; 3]);
    photons
        .par_chunks(1 << 16)
        .map(|chunk| chunk.iter().fold(nothing, |e, p| join(e, (p.cell, p.cell))))
        .reduce(|| nothing, join)
}
