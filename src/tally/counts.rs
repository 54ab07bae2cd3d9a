//! Counters of one replicate that threads share, and the sums over replicates.

use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicU64, Ordering};

use rayon::prelude::*;

use crate::math::varint;

/// Cells that one task sums: large enough that its bookkeeping costs nothing.
const CHUNK: usize = 1 << 14;

/// Counters that any number of threads add to. Integer addition commutes, so the order does not matter.
#[derive(Debug, Default)]
pub struct Counts(Vec<AtomicU64>);

impl Counts {
    /// This many zeros.
    pub fn new(cells: usize) -> Self {
        Self((0..cells).map(|_| AtomicU64::new(0)).collect())
    }

    /// This much more in a cell.
    #[inline]
    pub fn add(&self, cell: usize, amount: u64) {
        self.0[cell].fetch_add(amount, Ordering::Relaxed);
    }

    /// All counts.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = u64> + '_ {
        self.0.iter().map(|c| c.load(Ordering::Relaxed))
    }

    /// The count of a cell.
    pub fn get(&self, cell: usize) -> u64 {
        self.0[cell].load(Ordering::Relaxed)
    }

    /// Sum of all counts.
    pub fn total(&self) -> u64 {
        self.0.par_chunks(CHUNK).map(|part| part.iter().map(|c| c.load(Ordering::Relaxed)).sum::<u64>()).sum()
    }

    /// Sets every counter to zero.
    pub fn clear(&mut self) {
        for c in &mut self.0 {
            *c.get_mut() = 0;
        }
    }

    /// Writes all counts.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        varint::put(out, [self.0.len() as u64])?;
        varint::put(out, self.iter())
    }

    /// Adds counts that were written.
    ///
    /// # Errors
    /// Those of the reader; another number of counters; counts that no run has.
    pub fn add_from(&self, from: &mut dyn Read) -> io::Result<()> {
        varint::expect(from, self.0.len() as u64, "counters")?;
        for counter in &self.0 {
            let more = varint::take(from)?;
            if counter.fetch_add(more, Ordering::Relaxed).checked_add(more).is_none() {
                return Err(varint::damaged("a count of more than 64 bits"));
            }
        }
        Ok(())
    }
}

/// Sum and sum of squares of a count over replicates, cell by cell: all that a standard error needs, whatever
/// the number of replicates; and the sum over half of them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Moments {
    /// Sum of the counts.
    pub sum: Vec<u64>,
    /// Sum of their squares; 128 bits, so that no number of photons below 2^64 overflows it.
    pub square: Vec<u128>,
    /// Sum of the counts of the first, third, fifth ... replicate: what the others choose is valued by these.
    pub odd: Vec<u64>,
    /// Replicates taken in.
    replicates: u32,
}

impl Moments {
    /// Zeros.
    pub fn new(cells: usize) -> Self {
        Self { sum: vec![0; cells], square: vec![0; cells], odd: vec![0; cells], replicates: 0 }
    }

    /// Takes in the counts of a finished replicate.
    pub fn absorb(&mut self, counts: impl Iterator<Item = u64>) {
        let is_odd = self.replicates.is_multiple_of(2);
        let sums = self.sum.iter_mut().zip(&mut self.square).zip(&mut self.odd);
        for (((sum, square), odd), count) in sums.zip(counts) {
            *sum += count;
            *square += u128::from(count) * u128::from(count);
            if is_odd {
                *odd += count;
            }
        }
        self.replicates += 1;
    }

    /// Takes the counts of these replicates in the place of what there was.
    pub fn replace(&mut self, replicates: &[&Counts]) {
        let sums = self.sum.par_chunks_mut(CHUNK).zip(self.square.par_chunks_mut(CHUNK));
        sums.zip(self.odd.par_chunks_mut(CHUNK)).enumerate().for_each(|(chunk, ((sums, squares), odds))| {
            let first = chunk * CHUNK;
            for (i, ((sum, square), odd)) in sums.iter_mut().zip(squares).zip(odds).enumerate() {
                (*sum, *square, *odd) = (0, 0, 0);
                for (replicate, counts) in replicates.iter().enumerate() {
                    let count = counts.0[first + i].load(Ordering::Relaxed);
                    *sum += count;
                    *square += u128::from(count) * u128::from(count);
                    if replicate % 2 == 0 {
                        *odd += count;
                    }
                }
            }
        });
        self.replicates = replicates.len() as u32;
    }

    /// Writes the sums.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        varint::put(out, [self.sum.len() as u64, u64::from(self.replicates)])?;
        varint::put(out, self.sum.iter().chain(&self.odd).copied())?;
        varint::put_wide(out, self.square.iter().copied())
    }

    /// Takes sums that were written in the place of these.
    ///
    /// # Errors
    /// Those of the reader; another number of sums.
    pub fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        varint::expect(from, self.sum.len() as u64, "sums")?;
        self.replicates = varint::take_up_to(from, u32::MAX.into(), "replicates")? as u32;
        for sum in self.sum.iter_mut().chain(&mut self.odd) {
            *sum = varint::take(from)?;
        }
        for square in &mut self.square {
            *square = varint::take_wide(from)?;
        }
        Ok(())
    }

    /// Zeros again.
    pub fn clear(&mut self) {
        self.sum.fill(0);
        self.square.fill(0);
        self.odd.fill(0);
        self.replicates = 0;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_sums_and_sums_of_squares_exact_beyond_64_bits() {
        let mut moments = Moments::new(3);
        moments.absorb([1u64 << 60, 3, 0].into_iter());
        moments.absorb([1u64 << 60, 5, 0].into_iter());
        moments.absorb([1u64 << 60, 0, 7].into_iter());
        assert_eq!(moments.sum, [3 << 60, 8, 7]);
        assert_eq!(moments.square, [3 << 120, 34, 49]);
        assert_eq!(moments.odd, [2 << 60, 3, 7]);
        let mut bytes = Vec::new();
        moments.write(&mut bytes).unwrap();
        let mut read = Moments::new(3);
        read.read(&mut &bytes[..]).unwrap();
        assert_eq!(read, moments);
        assert!(Moments::new(4).read(&mut &bytes[..]).is_err());
        moments.clear();
        assert_eq!(moments, Moments::new(3));
    }

    #[test]
    fn moments_of_replicates_are_those_of_one_after_another() {
        let cells = CHUNK + 5;
        let replicates: Vec<Counts> = (0..3).map(|_| Counts::new(cells)).collect();
        for (r, counts) in replicates.iter().enumerate() {
            (0..cells).for_each(|cell| counts.add(cell, ((cell * 7 + r * 13) % 31) as u64));
        }
        let (mut at_once, mut in_turn) = (Moments::new(cells), Moments::new(cells));
        at_once.sum.fill(9);
        at_once.replace(&replicates.iter().collect::<Vec<_>>());
        replicates.iter().for_each(|counts| in_turn.absorb(counts.iter()));
        assert_eq!(at_once, in_turn);
        assert_eq!(replicates[1].total(), replicates[1].iter().sum::<u64>());
    }

    #[test]
    fn what_is_written_is_added() {
        let counts = Counts::new(3);
        [(0, 5), (2, 1 << 40)].into_iter().for_each(|(cell, n)| counts.add(cell, n));
        let mut bytes = Vec::new();
        counts.write(&mut bytes).unwrap();
        let sum = Counts::new(3);
        sum.add_from(&mut &bytes[..]).unwrap();
        sum.add_from(&mut &bytes[..]).unwrap();
        assert_eq!(sum.iter().collect::<Vec<_>>(), [10, 0, 2 << 40]);
        // Of another map, cut short, and beyond 64 bits.
        assert!(Counts::new(4).add_from(&mut &bytes[..]).is_err());
        assert!(sum.add_from(&mut &bytes[..bytes.len() - 1]).is_err());
        sum.add(0, u64::MAX - sum.get(0));
        assert!(sum.add_from(&mut &bytes[..]).is_err());
    }

    #[test]
    fn counts_add_from_any_thread_and_clear() {
        let mut counts = Counts::new(3);
        std::thread::scope(|scope| {
            for thread in 0..4 {
                let counts = &counts;
                scope.spawn(move || (0..1000).for_each(|_| counts.add(thread % 2, 1)));
            }
        });
        counts.add(2, 5);
        counts.add(2, 6);
        assert_eq!(counts.iter().collect::<Vec<_>>(), [2000, 2000, 11]);
        counts.clear();
        assert_eq!(counts.iter().collect::<Vec<_>>(), [0; 3]);
    }
}
