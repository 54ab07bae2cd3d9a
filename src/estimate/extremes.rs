//! The darkest and the brightest cell, and the uniformities of them, with errors (METHOD 7).
//!
//! A minimum over noisy cells is too low: noise chooses the cell and then values it. Here one half of the replicates
//! chooses the cell and the other half values it, both ways; the mean of both has the error of the chosen cells and, where
//! several cells are nearly as dark, is too high by less than that. The interval goes from the plain minimum less t
//! standard errors to this one plus t; of the maximum it is mirrored.
//!
//! Whether cells are good enough for it is decided by the noise that a cell of mean illuminance has, not by the result:
//! the interval of U0 is at most (sqrt(2 ln K) + 2 t) times that wide on average, K the number of cells (the first term
//! is what noise makes of a minimum of equal cells), and [`WIDEST`] is what may come out.

use crate::tally::Moments;

use super::replicates::{FEWEST_HITS, standard_error_of_cell};

/// The widest interval of a U0 that is given.
pub const WIDEST: f64 = 0.1;

/// What a refusal names has a fifth more photons in a cell than the bound takes: the dispersion of few cells is not known
/// better.
const SPARE: f64 = 1.2;

/// A number with its error.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Interval {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// Lower end of the interval of at least 95 %.
    pub low: f64,
    /// Its upper end.
    pub high: f64,
}

impl Interval {
    /// In another unit.
    pub fn times(self, unit: f64) -> Self {
        let Self { value, standard_error, low, high } = self;
        let [value, standard_error, low, high] = [value, standard_error, low, high].map(|x| x * unit);
        Self { value, standard_error, low, high }
    }
}

/// The extremes of a map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Extremes {
    /// Of the darkest cell, photons a square metre.
    pub minimum: Interval,
    /// Of the brightest.
    pub maximum: Interval,
    /// U0 = minimum / mean.
    pub u0: Interval,
    /// Ud = minimum / maximum.
    pub ud: Interval,
}

/// Why there are none.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unknown {
    /// One replicate has no error.
    OneReplicate,
    /// No photon arrived.
    Dark,
    /// One cell is its own mean.
    OneCell,
    /// Cells have too few photons.
    Noisy {
        /// Photons in a cell, on average.
        photons: f64,
        /// Standard error of a cell of mean illuminance, relative.
        error: f64,
        /// What it may be.
        bound: f64,
        /// Cells in all that would do, at least 2; `None` where even these would not.
        cells: Option<u64>,
        /// How many times as many photons would do.
        more: f64,
    },
}

/// Cells of a map, as photons counted in each over replicates.
#[derive(Debug, Clone, Copy)]
pub struct Map<'a> {
    /// Counts of each cell.
    pub cells: &'a Moments,
    /// Area of each cell, or one for all, m2.
    pub areas_m2: &'a [f64],
    /// Standard error of the sum of all counts.
    pub error_of_sum: Option<f64>,
    /// Replicates.
    pub replicates: u32,
}

impl Map<'_> {
    fn area(&self, cell: usize) -> f64 {
        self.areas_m2[if self.areas_m2.len() == 1 { 0 } else { cell }]
    }

    /// Sum of both halves over a cell's area.
    fn plain(&self, cell: usize) -> f64 {
        self.cells.sum[cell] as f64 / self.area(cell)
    }

    /// The same as half of the replicates have it.
    fn half(&self, cell: usize, first: bool) -> f64 {
        let (sum, odd) = (self.cells.sum[cell], self.cells.odd[cell]);
        let of_odd = self.replicates.div_ceil(2);
        let (count, of) = if first { (odd, of_odd) } else { (sum - odd, self.replicates - of_odd) };
        count as f64 * f64::from(self.replicates) / f64::from(of) / self.area(cell)
    }

    /// Of a cell, by its replicates and not below counting's.
    fn error(&self, cell: usize) -> f64 {
        let sum = self.cells.sum[cell];
        let spread = standard_error_of_cell(sum, self.cells.square[cell], self.replicates).unwrap_or(0.0);
        spread.max((sum as f64).sqrt()) / self.area(cell)
    }

    /// The brightest cell alone, whatever the noise of the others: a spot has cells of much light among dark ones. `None` for
    /// one replicate, and where that cell has fewer than ten photons.
    pub fn peak(&self) -> Option<Interval> {
        let most = *self.cells.sum.iter().max()?;
        (self.replicates > 1 && most >= FEWEST_HITS).then(|| self.maximum(student(self.replicates - 1)))
    }

    /// The extremes, or why they are not known.
    ///
    /// # Errors
    /// See [`Unknown`].
    pub fn extremes(&self) -> Result<Extremes, Unknown> {
        let cells = self.cells.sum.len();
        let sum = self.cells.sum.iter().sum::<u64>() as f64;
        let (Some(error_of_sum), 2..) = (self.error_of_sum, self.replicates) else {
            return Err(Unknown::OneReplicate);
        };
        if sum == 0.0 {
            return Err(Unknown::Dark);
        }
        if cells < 2 {
            return Err(Unknown::OneCell);
        }
        let t = student(self.replicates - 1);
        let dispersion = self.dispersion(sum);
        let area: f64 = (0..cells).map(|cell| self.area(cell)).sum();
        // Noise chooses among the smallest cells.
        let smallest = self.areas_m2.iter().copied().fold(f64::INFINITY, f64::min);
        let error = |photons: f64| (dispersion * area / smallest / photons / cells as f64).sqrt();
        let photons = sum / cells as f64;
        let noisy = |error: f64, bound: f64| {
            let cells = coarser(cells, t, error, bound);
            Unknown::Noisy { photons, error, bound, cells, more: SPARE * (error / bound).powi(2) }
        };
        let bound = bound(cells as f64, t);
        if error(photons) > bound {
            return Err(noisy(error(photons), bound));
        }
        let mean = sum / area;
        let of_mean = error_of_sum / sum;
        let minimum = self.minimum(t);
        let maximum = self.maximum(t);
        let u0 =
            ratio(minimum, Interval { value: mean, standard_error: of_mean * mean, low: 0.0, high: 0.0 });
        // No minimum is above the mean.
        let u0 = Interval {
            value: u0.value.min(1.0),
            low: (minimum.low / mean * (1.0 - t * of_mean)).clamp(0.0, 1.0),
            high: (minimum.high / mean * (1.0 + t * of_mean)).min(1.0),
            ..u0
        };
        let width = u0.high - u0.low;
        if width > WIDEST {
            return Err(noisy(bound * width / WIDEST, bound));
        }
        let ud = ratio(minimum, maximum);
        let ud = Interval {
            value: ud.value.min(1.0),
            low: minimum.low / maximum.high,
            high: (minimum.high / maximum.low).min(1.0),
            ..ud
        };
        Ok(Extremes { minimum, maximum, u0, ud })
    }

    /// Variance over mean of the cells' counts, all together: 1 for numbers of independent photons, and not below.
    fn dispersion(&self, sum: f64) -> f64 {
        let r = f64::from(self.replicates);
        let variance = |(sum, square): (&u64, &u128)| {
            (r * *square as f64 - *sum as f64 * *sum as f64).max(0.0) / (r - 1.0)
        };
        (self.cells.sum.iter().zip(&self.cells.square).map(variance).sum::<f64>() / sum).max(1.0)
    }

    fn minimum(&self, t: f64) -> Interval {
        let (plain, value, error) = self.chosen(|x| x);
        let low = (self.plain(plain) - t * self.error(plain)).max(0.0);
        Interval { value, standard_error: error, low, high: value + t * error }
    }

    fn maximum(&self, t: f64) -> Interval {
        let (plain, value, error) = self.chosen(|x| -x);
        let low = (value - t * error).max(0.0);
        Interval { value, standard_error: error, low, high: self.plain(plain) + t * self.error(plain) }
    }

    /// The cell that all replicates choose as the least by a key; the mean of those that each half chooses, valued by the
    /// other, and its error.
    fn chosen(&self, key: impl Fn(f64) -> f64) -> (usize, f64, f64) {
        let least = |value: &dyn Fn(usize) -> f64| {
            let cells = 0..self.cells.sum.len();
            cells.min_by(|a, b| key(value(*a)).total_cmp(&key(value(*b)))).unwrap_or(0)
        };
        let plain = least(&|cell| self.plain(cell));
        let [a, b] = [true, false].map(|first| least(&|cell| self.half(cell, first)));
        let value = 0.5 * (self.half(a, false) + self.half(b, true));
        let error = (0.5 * (self.error(a).powi(2) + self.error(b).powi(2))).sqrt();
        (plain, value, error)
    }
}

/// What the relative error of a cell may be, for so many cells.
fn bound(cells: f64, t: f64) -> f64 {
    WIDEST / (libm::sqrt(2.0 * libm::log(cells)) + 2.0 * t)
}

/// How many cells of the same light would do, where this many have this error.
fn coarser(cells: usize, t: f64, error: f64, least: f64) -> Option<u64> {
    // A cell of k times the area has an error sqrt(k) times smaller, and the bound grows as cells get fewer.
    let mut fewer = cells as f64 * (least / error).powi(2);
    for _ in 0..8 {
        fewer = cells as f64 / SPARE * (bound(fewer.max(2.0), t) / error).powi(2);
    }
    (fewer >= 2.0).then_some(fewer as u64)
}

/// A quotient: the relative errors are added, which is never too little, however the two hang together.
fn ratio(a: Interval, b: Interval) -> Interval {
    let value = a.value / b.value;
    let standard_error = a.standard_error / b.value + value * b.standard_error / b.value;
    Interval { value, standard_error, low: 0.0, high: 0.0 }
}

/// Student's t of 95 %, two-sided; from 7 degrees of freedom on by Fisher and Cornish's expansion, to 5e-5.
pub fn student(degrees: u32) -> f64 {
    const FIRST: [f64; 6] = [12.706_205, 4.302_653, 3.182_446, 2.776_445, 2.570_582, 2.446_912];
    if let Some(t) = degrees.checked_sub(1).and_then(|i| FIRST.get(i as usize)) {
        return *t;
    }
    let z = 1.959_963_985;
    let s = z * z;
    let n = f64::from(degrees.max(1));
    let g1 = z * (s + 1.0) / 4.0;
    let g2 = z * ((5.0 * s + 16.0) * s + 3.0) / 96.0;
    let g3 = z * (((3.0 * s + 19.0) * s + 17.0) * s - 15.0) / 384.0;
    let g4 = z * ((((79.0 * s + 776.0) * s + 1482.0) * s - 1920.0) * s - 945.0) / 92_160.0;
    z + (g1 + (g2 + (g3 + g4 / n) / n) / n) / n
}

#[cfg(test)]
#[path = "tests_of_extremes.rs"]
mod tests;
