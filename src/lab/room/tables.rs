//! What follows from the measurements: the paper's tables, and errors against a reference.
//!
//! The reference of a sequence is the mean of the largest measurements (the masters) of the *other* low-discrepancy
//! sequences, so that nothing is compared with itself. Their spread tells its own error: an indication, not a statistical
//! one, because none of them is random.

use std::f64::consts::PI;

use crate::lab::room::deviation::deviation;
use crate::lab::room::{RoomStudy, SEQUENCES};
use crate::lab::study::fit::{Law, Level};
use crate::lab::study::norms::{Errors, nrms_of_mean};
use crate::surface::reflectance::luminance;

/// An error closer to the reference's own than this factor is limited by it (METHOD 6).
const LIMITED: f64 = 3.0;

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
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
        Self { mean, spread: (values.len() > 1).then(|| (squares / (n - 1.0)).sqrt()) }
    }
}

/// An entry of the paper's tables 2 to 5: two numbers of photons of one sequence.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Deviation {
    /// Index into [`SEQUENCES`].
    pub sequence: usize,
    /// The fewer photons.
    pub few: u64,
    /// The more photons: the better estimate.
    pub many: u64,
    /// The deviation; of a random sequence over its seeds.
    pub value: Value,
}

/// An entry of the paper's table 6: two sequences with the largest number of photons.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Between {
    /// Index into [`SEQUENCES`].
    pub first: usize,
    /// The same; taken for the better estimate.
    pub second: usize,
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
        self.reference_nrms.is_nan() || self.errors.nrms < LIMITED * self.reference_nrms
    }
}

impl RoomStudy {
    /// The deviation of two numbers of photons, by their places in the ladder, of a sequence.
    pub fn deviation(&self, sequence: usize, few: usize, many: usize) -> Value {
        let of = |ladder: &crate::lab::room::Ladder| {
            deviation(&self.areas_m2, &ladder[few].radiance, &ladder[many].radiance)
        };
        Value::of(&self.runs(sequence).iter().map(of).collect::<Vec<_>>())
    }

    /// Every pair of numbers of photons of every sequence.
    pub fn deviations(&self) -> Vec<Deviation> {
        let ladder = &self.options.ladder;
        let mut all = Vec::new();
        for sequence in 0..SEQUENCES.len() {
            for many in 1..ladder.len() {
                for few in 0..many {
                    let value = self.deviation(sequence, few, many);
                    all.push(Deviation { sequence, few: ladder[few], many: ladder[many], value });
                }
            }
        }
        all
    }

    /// Every pair of sequences at the largest number of photons.
    pub fn between(&self) -> Vec<Between> {
        let master = self.options.ladder.len() - 1;
        let mut all = Vec::new();
        for first in 0..SEQUENCES.len() {
            for second in first + 1..SEQUENCES.len() {
                let mut values = Vec::new();
                for a in self.runs(first) {
                    for b in self.runs(second) {
                        values.push(deviation(&self.areas_m2, &a[master].radiance, &b[master].radiance));
                    }
                }
                all.push(Between { first, second, value: Value::of(&values) });
            }
        }
        all
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
        let mut rows: Vec<Row> = Vec::new();
        let mut random_law = None;
        let mut random_speed = f64::NAN;
        for sequence in 0..SEQUENCES.len() {
            let of_sequence = self.errors_of(sequence);
            let law = law_of(&of_sequence);
            let speed = self.photons_per_s(sequence);
            if sequence == 0 {
                (random_law, random_speed) = (law, speed);
            }
            for (level, mut row) in of_sequence.into_iter().enumerate() {
                let random_nrms = if sequence == 0 { row.errors.nrms } else { rows[level].errors.nrms };
                row.rate = law.map(|l| l.rate);
                row.photons_per_s = speed;
                row.ratio_equal_n = random_nrms / row.errors.nrms;
                let photons = row.photons as f64 * random_speed / speed;
                row.ratio_equal_time = random_law.map(|l| l.error_at(photons).value / row.errors.nrms);
                rows.push(row);
            }
        }
        rows
    }

    /// Rows of a sequence without what is relative to the random one.
    fn errors_of(&self, sequence: usize) -> Vec<Row> {
        let (reference, own) = self.reference(sequence);
        let level = |level: usize| {
            let errors: Vec<Errors> = self
                .runs(sequence)
                .iter()
                .filter_map(|l| Errors::of(&illuminance(&l[level].radiance), &reference, &self.areas_m2).ok())
                .collect();
            let n = errors.len() as f64;
            let rms = |f: fn(&Errors) -> f64| (errors.iter().map(|e| f(e) * f(e)).sum::<f64>() / n).sqrt();
            let first = &self.runs(sequence)[0][level];
            Row {
                sequence,
                photons: first.photons,
                errors: Errors {
                    relative_rms: rms(|e| e.relative_rms),
                    nrms: rms(|e| e.nrms),
                    relative_l1: errors.iter().map(|e| e.relative_l1).sum::<f64>() / n,
                },
                nrms_spread: Value::of(&errors.iter().map(|e| e.nrms).collect::<Vec<_>>()).spread,
                reference_nrms: own,
                photons_per_s: f64::NAN,
                coordinates: first.coordinates.0,
                rate: None,
                ratio_equal_n: f64::NAN,
                ratio_equal_time: None,
            }
        };
        (0..self.options.ladder.len()).map(level).collect()
    }

    /// Mean illuminance of the masters of the other low-discrepancy sequences, and its own nRMS from their spread.
    fn reference(&self, without: usize) -> (Vec<f64>, f64) {
        let masters: Vec<Vec<f64>> = (0..SEQUENCES.len())
            .filter(|s| *s != without && !SEQUENCES[*s].is_randomised())
            .filter_map(|s| self.runs(s).first()?.last().map(|m| illuminance(&m.radiance)))
            .collect();
        let n = masters.len() as f64;
        let sums = |f: fn(f64) -> f64| -> Vec<f64> {
            (0..self.areas_m2.len()).map(|cell| masters.iter().map(|m| f(m[cell])).sum()).collect()
        };
        let sum = sums(|e| e);
        let own = nrms_of_mean(&sum, &sums(|e| e * e), &self.areas_m2, masters.len() as u32);
        (sum.iter().map(|e| e / n).collect(), own.unwrap_or(f64::NAN))
    }

    fn photons_per_s(&self, sequence: usize) -> f64 {
        let mut speeds: Vec<f64> = self
            .runs(sequence)
            .iter()
            .filter_map(|ladder| ladder.last())
            .map(|m| m.photons as f64 / m.trace_s)
            .collect();
        speeds.sort_unstable_by(f64::total_cmp);
        speeds[speeds.len() / 2]
    }
}

/// Illuminance in lx of radiances that arrive from the half space alike.
fn illuminance(radiance: &[[f64; 3]]) -> Vec<f64> {
    radiance.iter().map(|rgb| PI * luminance(*rgb)).collect()
}

/// The law of the errors that the reference does not limit.
fn law_of(rows: &[Row]) -> Option<Law> {
    let levels = rows.iter().filter(|r| !r.is_limited());
    Law::fit(&[levels.map(|r| Level { photons: r.photons, error: r.errors.nrms }).collect()])
}
