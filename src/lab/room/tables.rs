//! What follows from the measurements: the paper's tables, and errors against a reference.
//!
//! The reference of a sequence is the mean of the largest measurements (the masters) of the *other*
//! low-discrepancy sequences, so that nothing is compared with itself. Their spread tells its own error: an
//! indication, not a statistical one, because none of them is random.

use std::f64::consts::PI;

use crate::lab::study::fit::{Law, Level};
use crate::lab::study::norms::{Errors, mean_and_variance, moments, nrms_of_mean};
use crate::lab::study::table::REFERENCE_MARGIN;
use crate::surface::reflectance::luminance;

use super::{Ladder, Measurement, RoomStudy, SEQUENCES};

/// A mean over seeds and their standard deviation; `None` for a single one.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Value {
    /// Mean.
    pub mean: f64,
    /// Standard deviation over seeds.
    pub spread: Option<f64>,
}

impl Value {
    fn of(values: &[f64]) -> Self {
        let (mean, variance) = mean_and_variance(values);
        Self { mean, spread: variance.map(f64::sqrt) }
    }
}

/// An entry of the paper's tables 2 to 5 (two numbers of photons of one sequence) or 6 (two sequences with
/// the largest number of photons).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Indices into [`SEQUENCES`].
    pub sequences: [usize; 2],
    /// Photons; the second is taken for the better estimate.
    pub photons: [u64; 2],
    /// The deviation; where the first is random over its seeds.
    pub value: Value,
}

/// The error of a sequence at a number of photons against its reference, of the luminance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Index into [`SEQUENCES`].
    pub sequence: usize,
    /// Photons.
    pub photons: u64,
    /// Errors; with several seeds the root mean square of the first two and the mean of the third.
    pub errors: Errors,
    /// Standard deviation of the nRMS over seeds.
    pub nrms_spread: Option<f64>,
    /// nRMS that the reference is expected to have itself.
    pub reference_nrms: f64,
    /// Photons a second of tracing at the largest number of photons, median over the seeds.
    pub photons_per_s: f64,
    /// Mean coordinates of a photon.
    pub coordinates: f64,
    /// Exponent of N, from the numbers of photons that the reference does not limit.
    pub rate: Option<f64>,
    /// The random sequence's nRMS over this one at equal N.
    pub ratio_equal_n: f64,
    /// The random sequence's nRMS, by its own law, after the time that this took, over this one.
    pub ratio_equal_time: Option<f64>,
}

impl Row {
    /// Whether the reference is not good enough for this error.
    pub fn is_limited(&self) -> bool {
        // An unknown error of the reference limits everything.
        self.reference_nrms.is_nan() || self.errors.nrms < REFERENCE_MARGIN * self.reference_nrms
    }
}

impl RoomStudy {
    /// The deviation of two numbers of photons, by their places in the ladder, of a sequence.
    pub fn deviation(&self, sequence: usize, few: usize, many: usize) -> Value {
        let of = |ladder: &Ladder| self.distance(&ladder[few], &ladder[many]);
        Value::of(&self.runs(sequence).iter().map(of).collect::<Vec<_>>())
    }

    fn distance(&self, estimate: &Measurement, better: &Measurement) -> f64 {
        deviation(&self.areas_m2, &estimate.radiance, &better.radiance)
    }

    /// Every pair of numbers of photons of every sequence.
    pub fn deviations(&self) -> Vec<Deviation> {
        let ladder = &self.options.ladder;
        let of = |sequence: usize, few: usize, many: usize| Deviation {
            sequences: [sequence; 2],
            photons: [ladder[few], ladder[many]],
            value: self.deviation(sequence, few, many),
        };
        let pairs = || (1..ladder.len()).flat_map(|many| (0..many).map(move |few| (few, many)));
        (0..SEQUENCES.len()).flat_map(|s| pairs().map(move |(few, many)| of(s, few, many))).collect()
    }

    /// Every pair of sequences at the largest number of photons.
    pub fn between(&self) -> Vec<Deviation> {
        let (n, master) = (SEQUENCES.len(), self.options.ladder.len() - 1);
        let photons = [self.options.ladder[master]; 2];
        let of = |first: usize, second: usize| {
            let pairs = self.runs(first).iter().flat_map(|a| self.runs(second).iter().map(move |b| (a, b)));
            let values = pairs.map(|(a, b)| self.distance(&a[master], &b[master]));
            let value = Value::of(&values.collect::<Vec<_>>());
            Deviation { sequences: [first, second], photons, value }
        };
        let pairs = (0..n).flat_map(|first| (first + 1..n).map(move |second| (first, second)));
        pairs.map(|(first, second)| of(first, second)).collect()
    }

    /// The deviation of the random sequence over that of another, with the last two numbers of photons. The
    /// spread is that of the random one's seeds.
    pub fn ratio_to_random(&self, sequence: usize) -> Value {
        let many = self.options.ladder.len() - 1;
        let random = self.deviation(0, many - 1, many);
        let other = self.deviation(sequence, many - 1, many).mean;
        Value { mean: random.mean / other, spread: random.spread.map(|s| s / other) }
    }

    /// Errors of every sequence and number of photons.
    pub fn rows(&self) -> Vec<Row> {
        let levels = self.options.ladder.len();
        let mut rows: Vec<Row> = (0..SEQUENCES.len()).flat_map(|s| self.errors_of(s)).collect();
        let random = rows[..levels].to_vec();
        let random_law = law_of(&random);
        for of_sequence in rows.chunks_mut(levels) {
            let rate = law_of(of_sequence).map(|law| law.rate);
            for (row, random) in of_sequence.iter_mut().zip(&random) {
                let photons = row.photons as f64 * random.photons_per_s / row.photons_per_s;
                row.rate = rate;
                row.ratio_equal_n = random.errors.nrms / row.errors.nrms;
                row.ratio_equal_time = random_law.map(|l| l.error_at(photons).value / row.errors.nrms);
            }
        }
        rows
    }

    /// Rows of a sequence without a rate and ratios.
    fn errors_of(&self, sequence: usize) -> Vec<Row> {
        let (reference, reference_nrms) = self.reference(sequence);
        let photons_per_s = self.photons_per_s(sequence);
        let level = |level: usize| {
            let of = |l: &Ladder| Errors::of(&illuminance(&l[level]), &reference, &self.areas_m2).ok();
            let seeds: Vec<Errors> = self.runs(sequence).iter().filter_map(of).collect();
            let (errors, nrms_spread) = Errors::over_seeds(&seeds);
            let first = &self.runs(sequence)[0][level];
            Row {
                sequence,
                photons: first.photons,
                errors,
                nrms_spread,
                reference_nrms,
                photons_per_s,
                coordinates: first.coordinates.0,
                rate: None,
                ratio_equal_n: f64::NAN,
                ratio_equal_time: None,
            }
        };
        (0..self.options.ladder.len()).map(level).collect()
    }

    /// Mean illuminance of the masters of the other low-discrepancy sequences, and its own nRMS from their
    /// spread.
    fn reference(&self, without: usize) -> (Vec<f64>, f64) {
        let masters: Vec<Vec<f64>> = (0..SEQUENCES.len())
            .filter(|s| *s != without && !SEQUENCES[*s].is_randomised())
            .filter_map(|s| self.runs(s).first()?.last().map(illuminance))
            .collect();
        let n = masters.len();
        let [sum, square] = moments(self.areas_m2.len(), n, |master, cell| masters[master][cell]);
        let own = nrms_of_mean(&sum, &square, &self.areas_m2, n).unwrap_or(f64::NAN);
        (sum.iter().map(|e| e / n as f64).collect(), own)
    }

    fn photons_per_s(&self, sequence: usize) -> f64 {
        let last = self.runs(sequence).iter().filter_map(|ladder| ladder.last());
        let mut speeds: Vec<f64> = last.map(|m| m.photons as f64 / m.trace_s).collect();
        speeds.sort_unstable_by(f64::total_cmp);
        speeds[speeds.len() / 2]
    }
}

/// The paper's norm: sqrt( sum A d^2 / sum A ), d the Euclidean distance of two radiances [r, g, b] of a cell
/// of area A, both in units of the greatest channel of any cell of `better`, so that this lies in [0, 1] as
/// the paper's do. NaN without light.
fn deviation(areas_m2: &[f64], estimate: &[[f64; 3]], better: &[[f64; 3]]) -> f64 {
    let greatest = better.iter().flatten().copied().fold(0.0, f64::max);
    let mut squares = 0.0;
    for ((area, a), b) in areas_m2.iter().zip(estimate).zip(better) {
        let d2: f64 = a.iter().zip(b).map(|(x, y)| (x - y) * (x - y)).sum();
        squares += area * d2;
    }
    (squares / areas_m2.iter().sum::<f64>()).sqrt() / greatest
}

/// Illuminance of the cells, lx: their radiance arrives from the half space alike.
fn illuminance(measured: &Measurement) -> Vec<f64> {
    measured.radiance.iter().map(|rgb| PI * luminance(*rgb)).collect()
}

/// The law of the errors that the reference does not limit.
fn law_of(rows: &[Row]) -> Option<Law> {
    let levels = rows.iter().filter(|r| !r.is_limited());
    Law::fit(&[levels.map(|r| Level { photons: r.photons, error: r.errors.nrms }).collect()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn norm_is_the_one_computed_by_hand() {
        // Greatest 10: differences (0.1, 0.2, 0.2) -> d = 0.3 on area 1; (0, 0, 0.4) on area 3.
        let better = [[10.0, 2.0, 3.0], [1.0, 1.0, 1.0]];
        let estimate = [[11.0, 4.0, 1.0], [1.0, 1.0, 5.0]];
        let expected = ((0.09 + 3.0 * 0.16) / 4.0f64).sqrt();
        assert!((deviation(&[1.0, 3.0], &estimate, &better) - expected).abs() < 1e-15);
        // Any unit of radiance and of area gives the same.
        let scaled = |m: &[[f64; 3]]| m.iter().map(|c| c.map(|x| 8.0 * x)).collect::<Vec<_>>();
        let other = deviation(&[0.5, 1.5], &scaled(&estimate), &scaled(&better));
        assert!((other - expected).abs() < 1e-15);
        assert_eq!(deviation(&[1.0, 3.0], &better, &better), 0.0);
    }
}
