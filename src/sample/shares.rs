//! Which cell of a table a coordinate chooses, for many tables over the same angles.
//!
//! A cell owns 64-bit fractions in proportion to its flux, row by row. Kept is the first of them only, 8
//! bytes a cell, and a guide: for the leading bits of a fraction, the cell that owns the first fraction with
//! those bits. A cell of zero flux, or of less than 2^-64 of all, owns nothing and has the first fraction of the next one, so of equal first
//! fractions the last is the owner's.

use super::angles::Angles;
use super::choose::{Reusable, Share, integer_widths};
use crate::sequence::to_unit_f64;

/// The fractions of the cells of many slices.
#[derive(Debug, Clone)]
pub struct Shares {
    rows: usize,
    columns: usize,
    /// `[slice][row][column]`: the first fraction of the cell.
    low: Vec<u64>,
    /// `[slice][row]`: the first fraction of the row.
    row_low: Vec<u64>,
    row_guide: Vec<u32>,
    row_guide_bits: u32,
    /// One more a slice than leading bits have values: the last cell that owns a fraction.
    guide: Vec<u32>,
    guide_bits: u32,
    lasts: Vec<Last>,
}

/// The last cell of a slice that owns a fraction; the first cell where there is none.
#[derive(Debug, Clone, Copy)]
struct Last {
    cell: u32,
    row: u32,
    /// Whether more than one cell has positive flux.
    is_choice: bool,
}

impl Shares {
    pub(super) fn new(angles: &Angles) -> Self {
        let (rows, columns) = (angles.rows.len(), angles.columns.len());
        Self {
            rows,
            columns,
            low: Vec::new(),
            row_low: Vec::new(),
            row_guide: Vec::new(),
            row_guide_bits: rows.ilog2() + 1,
            guide: Vec::new(),
            guide_bits: (rows * columns).ilog2(),
            lasts: Vec::new(),
        }
    }

    /// Makes room for so many slices.
    pub(super) fn reserve(&mut self, slices: usize) {
        self.low.reserve_exact(slices * self.rows * self.columns);
        self.row_low.reserve_exact(slices * self.rows);
        self.row_guide.reserve_exact(slices << self.row_guide_bits);
        self.guide.reserve_exact(slices * self.guide_count());
        self.lasts.reserve_exact(slices);
    }

    /// Adds a slice whose cells have these fluxes.
    pub(super) fn push(&mut self, fluxes: &[f64]) {
        let widths = integer_widths(fluxes);
        // A faint cell may own no fraction at all: of several, the last is the last that owns one.
        let owns = |k: &usize| widths.as_ref().map_or(fluxes[*k] > 0.0, |widths| widths[*k] > 0);
        let last = (0..fluxes.len()).rev().find(owns).unwrap_or(0);
        let row = last / self.columns;
        self.lasts.push(Last { cell: last as u32, row: row as u32, is_choice: widths.is_some() });
        let (start, first_row) = (self.low.len(), self.row_low.len());
        // One cell or none owns all: there is nothing to choose, and what is kept is not looked at.
        let mut sum = 0u64;
        self.low.extend(widths.unwrap_or_else(|| vec![0; fluxes.len()]).into_iter().map(|width| {
            let low = sum;
            sum = sum.wrapping_add(width);
            low
        }));
        self.row_low.extend(self.low[start..].iter().step_by(self.columns));
        guide(&mut self.row_guide, &self.row_low[first_row..=first_row + row], self.row_guide_bits);
        guide(&mut self.guide, &self.low[start..=start + last], self.guide_bits);
        self.guide.push(last as u32);
    }

    /// Whether a slice has at most one cell of positive flux, so that none is chosen.
    #[inline]
    pub fn is_single(&self, slice: usize) -> bool {
        !self.lasts[slice].is_choice
    }

    /// Chooses a cell of a slice by its flux with what is left of `u`, and renormalises it: (row, column).
    /// The only cell leaves `u` as it is.
    #[inline]
    pub fn choose(&self, slice: usize, u: &mut Reusable) -> [usize; 2] {
        let last = self.lasts[slice];
        let mut cell = last.cell as usize;
        if last.is_choice {
            cell = self.cell_of(slice, u.bits());
            u.take(self.share(slice, cell));
        }
        [cell / self.columns, cell % self.columns]
    }

    /// The cell that owns a fraction, in a slice with more than one of positive flux.
    #[inline]
    fn cell_of(&self, slice: usize, bits: u64) -> usize {
        let guide = &self.guide[slice * self.guide_count()..];
        let slot = if self.guide_bits == 0 { 0 } else { (bits >> (64 - self.guide_bits)) as usize };
        let (from, to) = (guide[slot] as usize, guide[slot + 1] as usize);
        from + self.low_of(slice)[from..=to].partition_point(|l| *l <= bits) - 1
    }

    /// The row that owns a fraction, and what it owns. In a slice with one cell, that has all.
    #[inline]
    pub fn row_of(&self, slice: usize, bits: u64) -> (usize, Share) {
        let last = self.lasts[slice];
        if !last.is_choice {
            return (last.row as usize, Share::ALL);
        }
        // Rows beyond the last cell that owns a fraction own nothing.
        let low = &self.row_low[slice * self.rows..][..=last.row as usize];
        let guide = &self.row_guide[slice << self.row_guide_bits..][..1 << self.row_guide_bits];
        let mut row = guide[(bits >> (64 - self.row_guide_bits)) as usize] as usize;
        let mut end = low.get(row + 1).copied();
        while end.is_some_and(|end| end <= bits) {
            row += 1;
            end = low.get(row + 1).copied();
        }
        (row, Share { low: low[row], width: end.unwrap_or(0).wrapping_sub(low[row]) })
    }

    /// A column of a row by the flux of its cells on a second coordinate: (column, its probability in the
    /// row, what is left of the coordinate for the azimuth).
    #[inline]
    pub fn column_of(&self, slice: usize, row: usize, share: Share, bits: u64) -> (usize, f64, f64) {
        let last = self.lasts[slice];
        if !last.is_choice {
            return (last.cell as usize - row * self.columns, 1.0, to_unit_f64(bits));
        }
        share.choose_part(bits, |at| {
            let cell = self.cell_of(slice, at);
            (cell - row * self.columns, self.share(slice, cell))
        })
    }

    /// What a cell up to the last of positive flux owns, in a slice with more than one.
    #[inline]
    fn share(&self, slice: usize, cell: usize) -> Share {
        let low = self.low_of(slice);
        let end = if cell == self.lasts[slice].cell as usize { 0 } else { low[cell + 1] };
        Share { low: low[cell], width: end.wrapping_sub(low[cell]) }
    }

    #[inline]
    fn low_of(&self, slice: usize) -> &[u64] {
        let cells = self.rows * self.columns;
        &self.low[slice * cells..(slice + 1) * cells]
    }

    fn guide_count(&self) -> usize {
        (1 << self.guide_bits) + 1
    }

    /// Bytes held.
    pub(super) fn memory_bytes(&self) -> usize {
        (self.low.capacity() + self.row_low.capacity()) * size_of::<u64>()
            + (self.row_guide.capacity() + self.guide.capacity()) * size_of::<u32>()
            + self.lasts.capacity() * size_of::<Last>()
    }
}

/// Adds to a guide: for each value of the leading bits, which of `low` is the last that is not above the
/// first such fraction.
fn guide(guide: &mut Vec<u32>, low: &[u64], bits: u32) {
    guide.extend((0..1u64 << bits).map(|slot| {
        let first = if bits == 0 { 0 } else { slot << (64 - bits) };
        low.partition_point(|l| *l <= first) as u32 - 1
    }));
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Shares with a slice of these fluxes after one of equal ones.
    fn shares(rows: usize, columns: usize, fluxes: &[f64]) -> Shares {
        let angles = |n: usize, step: f64| (0..=n).map(|k| k as f64 * step).collect::<Vec<f64>>();
        let mut shares = Shares::new(&Angles::new(&angles(rows, 0.1), &angles(columns, 0.2)).unwrap());
        shares.push(&vec![1.0; rows * columns]);
        shares.push(fluxes);
        shares
    }

    /// Tables with rows and cells of zero flux in all places, rare cells, and as few rows or columns as there
    /// can be.
    fn tables() -> Vec<(usize, usize, Vec<f64>)> {
        let of = |rows: usize, columns: usize, f: fn(usize, usize) -> f64| {
            (rows, columns, (0..rows * columns).map(|k| f(k / columns, k % columns)).collect())
        };
        vec![
            of(6, 4, |_, _| 1.0),
            of(7, 5, |i, j| if i % 3 == 0 || j == 2 { 0.0 } else { (1 + i * j) as f64 }),
            of(8, 3, |i, j| if (2..6).contains(&i) { 0.0 } else { 1e-12f64.powi(((i + j) % 2) as i32) }),
            of(5, 6, |i, j| if (i, j) == (1, 2) || (i, j) == (1, 3) { 1.0 } else { 0.0 }),
            of(1, 9, |_, j| (j % 4) as f64),
            of(9, 1, |i, _| (i % 4) as f64),
            of(2, 1, |i, _| if i == 0 { 1.0 } else { 1e-30 }),
            // Faint tails, of which no cell owns a fraction.
            of(6, 2, |i, _| 1e-12f64.powi(i as i32)),
            of(3, 4, |i, j| if (i, j) < (1, 1) { 1.0 } else { 1e-25 }),
        ]
    }

    /// What each of these widths owns: (first fraction, number of fractions).
    fn owned(widths: &[u64]) -> Vec<(u128, u128)> {
        let mut low = 0;
        let all = widths.iter().map(|w| {
            low += u128::from(*w);
            (low - u128::from(*w), u128::from(*w))
        });
        all.collect()
    }

    /// Fractions at which something begins or ends, those beside them, and some others.
    fn fractions(owned: &[(u128, u128)]) -> Vec<u64> {
        let edges = owned.iter().flat_map(|(low, width)| [*low, low + width, low + width / 2]);
        let beside = edges.flat_map(|e| [e.saturating_sub(1), e, e + 1]);
        beside.chain([0, 1, 1 << 63]).filter_map(|e| u64::try_from(e).ok()).chain([u64::MAX]).collect()
    }

    #[test]
    fn every_fraction_belongs_to_the_cell_that_owns_it() {
        for (rows, columns, fluxes) in tables() {
            let shares = shares(rows, columns, &fluxes);
            let cells = owned(&integer_widths(&fluxes).unwrap());
            for bits in fractions(&cells) {
                let expected =
                    cells.iter().position(|(low, width)| u128::from(bits).wrapping_sub(*low) < *width);
                let mut u = Reusable::fresh(bits);
                let [row, column] = shares.choose(1, &mut u);
                assert_eq!(Some(row * columns + column), expected, "{rows} x {columns}: {bits}");
                let (low, width) = cells[row * columns + column];
                assert_eq!(u128::from(u.bits()), ((u128::from(bits) - low) << 64) / width);
            }
        }
    }

    #[test]
    fn every_fraction_belongs_to_the_row_that_owns_it() {
        for (rows, columns, fluxes) in tables() {
            let shares = shares(rows, columns, &fluxes);
            let cells = owned(&integer_widths(&fluxes).unwrap());
            let row = |r: &[(u128, u128)]| (r[0].0, r.iter().map(|(_, width)| width).sum::<u128>());
            let by_row: Vec<(u128, u128)> = cells.chunks(columns).map(row).collect();
            for bits in fractions(&by_row) {
                let expected =
                    by_row.iter().position(|(low, width)| u128::from(bits).wrapping_sub(*low) < *width);
                let (row, share) = shares.row_of(1, bits);
                assert_eq!(Some(row), expected, "{rows} x {columns}: {bits}");
                let (low, width) = by_row[row];
                assert_eq!((u128::from(share.low), u128::from(share.width)), (low, width % (1 << 64)));
                // Columns: at the fractions of the second coordinate at which a cell of the row begins, and
                // just before.
                for (column, (begin, part)) in cells[row * columns..][..columns].iter().enumerate() {
                    let first = (((begin - low) << 64).div_ceil(width)) as u64;
                    for second in [first.wrapping_sub(1), first] {
                        let at = low + ((u128::from(second) * width) >> 64);
                        let inside = |(low, part): &(u128, u128)| at.wrapping_sub(*low) < *part;
                        let (found, probability, rest) = shares.column_of(1, row, share, second);
                        let expected = cells[row * columns..][..columns].iter().position(inside);
                        assert_eq!(Some(found), expected, "{rows} x {columns}: {row} {column} {second}");
                        let of_row = cells[row * columns + found].1 as f64 / width as f64;
                        assert!((probability / of_row - 1.0).abs() < 1e-15 && (0.0..1.0).contains(&rest));
                        assert!(*part == 0 || second != first || rest * *part as f64 <= 1.0, "{rest}");
                    }
                }
            }
        }
    }

    #[test]
    fn one_cell_or_none_has_all_fractions() {
        let mut fluxes = vec![0.0; 12];
        for lit in [None, Some(0), Some(5), Some(11)] {
            fluxes.fill(0.0);
            lit.into_iter().for_each(|k: usize| fluxes[k] = 2.0);
            let shares = shares(4, 3, &fluxes);
            assert!(shares.is_single(1) && !shares.is_single(0));
            let cell = lit.unwrap_or(0);
            for bits in [0, 5 << 60, u64::MAX] {
                let mut u = Reusable::fresh(bits);
                assert_eq!((shares.choose(1, &mut u), u.bits()), ([cell / 3, cell % 3], bits));
                let (row, share) = shares.row_of(1, bits);
                assert_eq!((row, share), (cell / 3, Share::ALL));
                assert_eq!(shares.column_of(1, row, share, bits), (cell % 3, 1.0, to_unit_f64(bits)));
            }
        }
    }
}
