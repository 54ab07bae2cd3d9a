//! Tests of how many draws fall into each cell of the table.

use crate::lab::certificate::statistics::{binomial_tails, chi_square_tail, sidak, student_tails};
use crate::lab::certificate::{Test, TestName};

/// Expected counts below which the chi-square approximation of a cell is not used: it is pooled with its
/// neighbours.
const LEAST_EXPECTED: f64 = 5.0;

/// A statistic with its chance.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    statistic: f64,
    degrees: Option<usize>,
    p_value: f64,
    /// Cells, or pools of cells, compared.
    pub(crate) pools: usize,
}

impl Found {
    pub(crate) fn test(&self, name: TestName) -> Test {
        Test::new(name, self.statistic, self.degrees, self.p_value)
    }
}

/// Chi-square of counts against probabilities: neighbouring cells are pooled, row by row, until they expect
/// at least five; what is left at the end joins the last pool. Cells of probability zero are left out: they
/// are judged apart.
pub(crate) fn chi_square(counts: &[u64], probabilities: &[f64]) -> Found {
    let cells = || counts.iter().zip(probabilities).filter(|(_, p)| **p > 0.0);
    let draws: u64 = cells().map(|(n, _)| n).sum();
    let mut pools: Vec<(f64, f64)> = Vec::new();
    let (mut count, mut expected) = (0.0, 0.0);
    for (n, p) in cells() {
        count += *n as f64;
        expected += p * draws as f64;
        if expected >= LEAST_EXPECTED {
            pools.push((count, expected));
            (count, expected) = (0.0, 0.0);
        }
    }
    match pools.last_mut() {
        Some(last) => {
            last.0 += count;
            last.1 += expected;
        }
        None => pools.push((count, expected)),
    }
    let degrees = pools.len() - 1;
    let statistic = if draws == 0 { 0.0 } else { pools.iter().map(|(n, e)| (n - e) * (n - e) / e).sum() };
    Found {
        statistic,
        degrees: Some(degrees),
        p_value: chi_square_tail(statistic, degrees),
        pools: pools.len(),
    }
}

/// The count that is least likely for its binomial, corrected for the number of cells (Sidak). One wrong cell
/// shows here where chi-square spreads it over all.
pub(crate) fn largest_cell(counts: &[u64], probabilities: &[f64]) -> Found {
    let draws: u64 = counts.iter().sum();
    let (mut least, mut deviation, mut cells) = (1.0, 0.0, 0);
    for (n, p) in counts.iter().zip(probabilities).filter(|(_, p)| **p > 0.0) {
        cells += 1;
        let tails = binomial_tails(*n, draws, *p);
        if tails < least {
            (least, deviation) = (tails, 100.0 * (*n as f64 / (draws as f64 * p) - 1.0));
        }
    }
    Found { statistic: deviation, degrees: None, p_value: sidak(least, cells), pools: cells }
}

/// Sums over randomisations of every cell's count less its expectation.
#[derive(Debug, Clone, Default)]
pub(crate) struct CellMeans {
    sum: Vec<f64>,
    square: Vec<f64>,
    pub(crate) replicates: u32,
    pub(crate) draws: u64,
    pub(crate) draws_in_zero_cells: u64,
}

impl CellMeans {
    pub(crate) fn add(&mut self, counts: &[u64], draws: u64, probabilities: &[f64]) {
        self.sum.resize(counts.len(), 0.0);
        self.square.resize(counts.len(), 0.0);
        for (cell, (n, p)) in counts.iter().zip(probabilities).enumerate() {
            let deviation = *n as f64 - draws as f64 * p;
            self.sum[cell] += deviation;
            self.square[cell] += deviation * deviation;
            if *p == 0.0 {
                self.draws_in_zero_cells += n;
            }
        }
        self.replicates += 1;
        self.draws += draws;
    }

    /// Student's t of the cell whose mean is least likely, corrected for the number of cells (Sidak); nothing
    /// from fewer than two randomisations.
    ///
    /// Each randomisation is an independent estimate of n p without bias, whatever the points are, so the
    /// spread between them is the null. It has a floor: a whole number with mean n p has a variance of at
    /// least f (1 - f), f the fraction of n p. Without it a cell whose stratified counts happen to agree
    /// would have no spread at all.
    pub(crate) fn judge(&self, probabilities: &[f64]) -> Option<Found> {
        if self.replicates < 2 {
            return None;
        }
        let r = f64::from(self.replicates);
        let each = self.draws as f64 / r;
        let (mut largest, mut cells) = (0.0f64, 0);
        for (cell, p) in probabilities.iter().enumerate().filter(|(_, p)| **p > 0.0) {
            cells += 1;
            let mean = self.sum[cell] / r;
            let spread = (self.square[cell] - self.sum[cell] * mean) / (r - 1.0);
            let fraction = (each * p).fract();
            let variance = spread.max(fraction * (1.0 - fraction));
            let t = mean / libm::sqrt(variance / r);
            if t.abs() > largest.abs() {
                largest = t;
            }
        }
        Some(Found {
            statistic: largest,
            degrees: Some(self.replicates as usize - 1),
            p_value: sidak(student_tails(largest, r - 1.0), cells),
            pools: cells,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn chi_square_pools_leaves_out_and_counts() {
        // Expectations 10, 0, 2, 3, 85: pools 10 | 2 + 3 | 85.
        let p = [0.1, 0.0, 0.02, 0.03, 0.85];
        let found = chi_square(&[13, 9, 4, 2, 81], &p);
        assert_eq!((found.pools, found.degrees), (3, Some(2)));
        let by_hand = 9.0 / 10.0 + 1.0 / 5.0 + 16.0 / 85.0;
        assert!((found.statistic - by_hand).abs() < 1e-12, "{}", found.statistic);
        assert!((found.p_value - (-0.5 * by_hand).exp()).abs() < 1e-12);
        // What is left over at the end joins the last pool; few draws leave one pool and no test.
        assert_eq!(chi_square(&[80, 20, 0], &[0.8, 0.18, 0.02]).pools, 2);
        assert_eq!(chi_square(&[1, 0], &[0.5, 0.5]).p_value, 1.0);
        assert_eq!(chi_square(&[0, 0], &[0.5, 0.5]).p_value, 1.0);
    }

    #[test]
    fn the_largest_cell_is_found() {
        let found = largest_cell(&[50_500, 49_500, 900_000], &[0.05, 0.05, 0.9]);
        assert!((found.statistic.abs() - 1.0).abs() < 1e-9 && found.p_value > 0.01, "{found:?}");
        let found = largest_cell(&[51_500, 50_000, 898_500], &[0.05, 0.05, 0.9]);
        assert!((found.statistic - 3.0).abs() < 1e-9 && found.p_value < 1e-8, "{found:?}");
    }

    #[test]
    fn means_are_judged_by_their_own_spread_or_its_floor() {
        let p = [0.25, 0.75];
        let mut exact = CellMeans::default();
        let mut off = CellMeans::default();
        for r in 0..16u64 {
            exact.add(&[100 + r % 2, 301 - r % 2], 401, &p);
            off.add(&[103, 298], 401, &p);
        }
        // n p = 100.25: 16 replicates of 100 and 101 in turn are 0.25 off, t = 0.25 / (0.516 / 4).
        let found = exact.judge(&p).unwrap();
        assert!((found.statistic.abs() - 0.25 * 4.0 / (4.0f64 / 15.0).sqrt()).abs() < 1e-9, "{found:?}");
        // 103 throughout: the floor 0.25 x 0.75 stands for the spread.
        let found = off.judge(&p).unwrap();
        assert!((found.statistic.abs() - 2.75 * 4.0 / 0.1875f64.sqrt()).abs() < 1e-9, "{found:?}");
        assert!(found.p_value < 1e-10);
        assert!(CellMeans::default().judge(&p).is_none());
        // An expectation that is whole with counts that are always right: 0 / 0 is no alarm.
        let mut whole = CellMeans::default();
        (0..4).for_each(|_| whole.add(&[100, 300], 400, &p));
        assert_eq!(whole.judge(&p).unwrap().p_value, 1.0);
    }
}
