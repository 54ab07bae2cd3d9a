//! Spots: where on a rectangle photons arrive, as exact sums (METHOD 9).
//!
//! A place is a whole number of 2^-32 of an edge. The sums of u, v and their squares are of 128 bits: no number of photons
//! below 2^64 overflows them, and none depends on the order.

use std::io::{self, Read, Write};

use crate::math::varint;
use crate::scene::spot::Spot;

use super::counts::Counts;
use super::wide_sum::WideSum;

/// Binary digits of a place along an edge.
pub const PLACE_BITS: u32 = 32;

/// Sets of sums, so that threads seldom add to the same.
const SHARDS: usize = 64;

/// The sums of one replicate.
#[derive(Debug)]
pub struct SpotTally {
    spot: Spot,
    cells: Counts,
    shards: Vec<[WideSum; 4]>,
}

/// What a replicate counted.
#[derive(Debug, Clone, Default)]
pub struct SpotCount {
    /// Photons in each fine cell, row by row from v = 0 up.
    pub cells: Vec<u64>,
    /// Photons in all.
    pub photons: u64,
    /// Sums of the places along u and v.
    pub first: [u128; 2],
    /// Sums of their squares.
    pub second: [u128; 2],
}

impl SpotCount {
    /// Writes it.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        let Self { cells, photons, first, second } = self;
        varint::put(out, [cells.len() as u64, *photons])?;
        varint::put(out, cells.iter().copied())?;
        varint::put_wide(out, first.iter().chain(second).copied())
    }

    /// Reads one of a spot.
    ///
    /// # Errors
    /// Those of the reader; one of another spot.
    pub fn read(spot: Spot, from: &mut dyn Read) -> io::Result<Self> {
        varint::expect(from, spot.cells() as u64, "fine cells")?;
        let photons = varint::take(from)?;
        let cells = (0..spot.cells()).map(|_| varint::take(from)).collect::<io::Result<_>>()?;
        let mut wide = || varint::take_wide(from);
        Ok(Self { cells, photons, first: [wide()?, wide()?], second: [wide()?, wide()?] })
    }
}

impl SpotTally {
    /// Zeros.
    pub fn new(spot: Spot) -> Self {
        let shards = (0..SHARDS).map(|_| Default::default()).collect();
        Self { spot, cells: Counts::new(spot.cells()), shards }
    }

    /// A photon at these fractions of the edges.
    #[inline]
    pub fn add(&self, (u, v): (f64, f64)) {
        let places = [u, v].map(place);
        let [column, row] = [(0, self.spot.nu), (1, self.spot.nv)].map(|(axis, n)| cell(places[axis], n));
        let cell = row * self.spot.nu as usize + column;
        self.cells.add(cell, 1);
        let [u, v] = places.map(u128::from);
        let sums = self.shards[cell % SHARDS].iter().zip([u, v, u * u, v * v]);
        sums.for_each(|(sum, amount)| sum.add(amount));
    }

    /// What there is, once nothing is added any more.
    pub fn counted(&self) -> SpotCount {
        let sum = |of: usize| self.shards.iter().map(|shard| shard[of].get()).sum();
        SpotCount {
            cells: self.cells.iter().collect(),
            photons: self.cells.total(),
            first: [sum(0), sum(1)],
            second: [sum(2), sum(3)],
        }
    }

    /// Writes what there is.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        self.cells.write(out)?;
        let SpotCount { first: [u, v], second: [uu, vv], .. } = self.counted();
        varint::put_wide(out, [u, v, uu, vv])
    }

    /// Adds what was written.
    ///
    /// # Errors
    /// Those of the reader; sums of another spot.
    pub fn add_from(&self, from: &mut dyn Read) -> io::Result<()> {
        self.cells.add_from(from)?;
        for sum in &self.shards[0] {
            sum.add(varint::take_wide(from)?);
        }
        Ok(())
    }

    /// Zeros again.
    pub fn clear(&mut self) {
        self.cells.clear();
        self.shards.iter_mut().flatten().for_each(|sum| _ = sum.take());
    }
}

/// A fraction of an edge in units of 2^-32 of it; each unit stands for its middle.
fn place(fraction: f64) -> u64 {
    const UNITS: u64 = 1 << PLACE_BITS;
    ((fraction * UNITS as f64) as u64).min(UNITS - 1)
}

/// The cell of a place, of `count` along the edge.
fn cell(place: u64, count: u32) -> usize {
    ((place * u64::from(count)) >> PLACE_BITS) as usize
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::spot::tests::spot;

    #[test]
    fn sums_are_those_of_the_places_and_cells_hold_the_photons() {
        let mut tally = SpotTally::new(spot([2.0, 1.0], None).unwrap());
        for at in [(0.0, 0.0), (1.0, 1.0), (0.5, 0.25), (0.5, 0.25)] {
            tally.add(at);
        }
        let (most, half, quarter) = ((1u128 << 32) - 1, 1u128 << 31, 1u128 << 30);
        let counted = tally.counted();
        assert_eq!(counted.photons, 4);
        assert_eq!(counted.first, [most + 2 * half, most + 2 * quarter]);
        assert_eq!(counted.second, [most * most + 2 * half * half, most * most + 2 * quarter * quarter]);
        let at = |column: usize, row: usize| counted.cells[row * 1024 + column];
        assert_eq!((at(0, 0), at(1023, 511), at(512, 128)), (1, 1, 2));
        let mut bytes = Vec::new();
        tally.write(&mut bytes).unwrap();
        tally.add_from(&mut &bytes[..]).unwrap();
        let twice = tally.counted();
        assert_eq!((twice.photons, twice.first[0]), (8, 2 * counted.first[0]));
        assert_eq!(twice.second, counted.second.map(|sum| 2 * sum));
        tally.clear();
        let empty = tally.counted();
        assert_eq!((empty.photons, empty.first, empty.second), (0, [0; 2], [0; 2]));
    }
}
