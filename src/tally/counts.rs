//! Shared counters of one replicate, and the sums over replicates.

use std::sync::atomic::{AtomicU64, Ordering};

/// Counters that any number of threads add to. Integer addition commutes, so the order does not matter.
#[derive(Debug, Default)]
pub struct Counts(Vec<AtomicU64>);

impl Counts {
    /// This many zeros.
    pub fn new(cells: usize) -> Self {
        Self((0..cells).map(|_| AtomicU64::new(0)).collect())
    }

    /// One more photon in a cell.
    #[inline]
    pub fn add(&self, cell: usize) {
        self.0[cell].fetch_add(1, Ordering::Relaxed);
    }

    /// This much more in a cell.
    #[inline]
    pub fn add_amount(&self, cell: usize, amount: u64) {
        self.0[cell].fetch_add(amount, Ordering::Relaxed);
    }

    /// Count of a cell.
    pub fn get(&self, cell: usize) -> u64 {
        self.0[cell].load(Ordering::Relaxed)
    }

    /// All counts.
    pub fn iter(&self) -> impl ExactSizeIterator<Item = u64> + '_ {
        self.0.iter().map(|c| c.load(Ordering::Relaxed))
    }

    /// Adds the counts of another tally of the same cells.
    pub fn merge(&mut self, other: &Self) {
        for (a, b) in self.0.iter_mut().zip(other.iter()) {
            *a.get_mut() += b;
        }
    }

    /// Sets every counter to zero.
    pub fn clear(&mut self) {
        for c in &mut self.0 {
            *c.get_mut() = 0;
        }
    }
}

/// Sum and sum of squares of a count over replicates, cell by cell: all that a standard error needs, whatever the
/// number of replicates.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Moments {
    /// Sum of the counts.
    pub sum: Vec<u64>,
    /// Sum of their squares; 128 bits, so that no number of photons below 2^64 overflows it.
    pub square: Vec<u128>,
}

impl Moments {
    /// Zeros.
    pub fn new(cells: usize) -> Self {
        Self { sum: vec![0; cells], square: vec![0; cells] }
    }

    /// Starts again with the counts of the first replicate, as far as it is.
    pub fn restart(&mut self, counts: impl Iterator<Item = u64>) {
        for ((sum, square), count) in self.sum.iter_mut().zip(&mut self.square).zip(counts) {
            *sum = count;
            *square = u128::from(count) * u128::from(count);
        }
    }

    /// Takes in the counts of a finished replicate.
    pub fn absorb(&mut self, counts: impl Iterator<Item = u64>) {
        for ((sum, square), count) in self.sum.iter_mut().zip(&mut self.square).zip(counts) {
            *sum += count;
            *square += u128::from(count) * u128::from(count);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_exact_beyond_64_bits() {
        let mut moments = Moments::new(1);
        for _ in 0..3 {
            moments.absorb([1u64 << 60].into_iter());
        }
        assert_eq!((moments.sum[0], moments.square[0]), (3 << 60, 3 << 120));
    }

    #[test]
    fn counts_merge_and_clear() {
        let (mut a, b) = (Counts::new(2), Counts::new(2));
        a.add(0);
        b.add(0);
        b.add(1);
        a.merge(&b);
        assert_eq!(a.iter().collect::<Vec<_>>(), [2, 1]);
        a.clear();
        assert_eq!(a.get(0), 0);
    }
}
