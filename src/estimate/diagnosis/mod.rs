//! Whether a run looks as it should: statistics over its replicates and over the doublings of its photons (METHOD 10).
//!
//! After the ten checks that MCNP makes of a tally, made anew for replicates of quasi-random points. Each check has a chance, that
//! with which a healthy run looks as bad; [`level`] is what all checks of a run together are judged by.

mod chance;
mod moments;
mod rate;

pub use moments::Moment;
pub use rate::Rate;

use super::replicates::standard_error_of_total;
use chance::{chi_square_above, farther};

/// How often one or more checks of a healthy run may fail.
const FALSE_ALARMS: f64 = 0.01;
/// Photons on a receiver below which nothing is told of them, and of which a level of the rate has so many.
pub const FEWEST_PHOTONS: u64 = 100;
/// Replicates below which their spread says too little of itself.
pub const FEWEST_REPLICATES: u32 = 4;
/// Skewness of the sum over replicates from which on an end of a 95 % interval misses 3.3 % or 1.7 % instead of 2.5: its first
/// term in Edgeworth's expansion for Student's t is skewness (2 z^2 + 1) phi(z) / 6.
const SKEWED: f64 = 0.1;
/// Excess kurtosis that doubles the variance of a squared standard error.
const HEAVY: f64 = 2.0;
/// How many times as skewed as numbers of independent photons (1 / sqrt(mean), and squared the kurtosis) is too much.
const COUNTED: f64 = 6.0;
/// How many times the variance of independent photons is too much.
const SCATTERED: f64 = 1.25;

/// Photons that the replicates of a run counted on a receiver.
#[derive(Debug, Clone)]
pub struct Counted {
    /// Photons of each replicate.
    pub photons: u64,
    /// Of these, on the receiver.
    pub on_receiver: Vec<u64>,
    /// The same of the first 2^k photons of each replicate alone, the fewest first; empty where these are not known.
    pub first: Vec<(u64, Vec<u64>)>,
    /// Whether a photon arrives at most once, as on what absorbs all.
    pub is_once: bool,
}

/// What a receiver's replicates and doublings say of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnosis {
    /// Photons on the receiver.
    pub arrived: u64,
    /// Replicates.
    pub replicates: u32,
    /// 1 / (relative standard error^2 x photons): figure of merit by photons instead of time; `None` without light.
    pub merit: Option<f64>,
    /// Variance of as many independent photons over that of this run; `None` where a photon may arrive more than once or all
    /// arrive.
    pub against_independent: Option<f64>,
    /// The estimate and its error after each doubling.
    pub trend: Vec<Doubling>,
    /// How the error falls.
    pub rate: Option<Rate>,
    /// Of later photons against earlier ones.
    pub drift: Option<Drift>,
    /// Over replicates.
    pub skewness: Option<Moment>,
    /// Over replicates, excess over a normal distribution's.
    pub kurtosis: Option<Moment>,
    /// What was checked.
    pub checks: Vec<Tested>,
}

/// The estimate after a doubling.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Doubling {
    /// Photons of each replicate.
    pub photons: u64,
    /// Photons on the receiver, of all replicates, over those traced.
    pub share: f64,
    /// Relative standard error; `None` where nothing arrived.
    pub relative_error: Option<f64>,
}

/// The later photons of every replicate against its first ones: in the mean the difference is 0, since every point is uniform.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct Drift {
    /// Photons of each replicate that count as the first ones: half of all, or a third to two thirds where these are no power
    /// of two.
    pub first_photons: u64,
    /// What the later ones give more, relative to all.
    pub relative: f64,
    /// Its standard error.
    pub standard_error: f64,
    /// How often a healthy run has as much.
    pub chance: f64,
}

/// What can be wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Fault {
    /// Later photons give something else than earlier ones.
    Drifts,
    /// The error falls slower than that of independent photons.
    Slow,
    /// Replicates scatter more than independent photons would.
    Scatters,
    /// Few replicates are far to one side.
    Skewed,
    /// Few replicates are far off.
    HeavyTailed,
}

/// One check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tested {
    /// What it looks for.
    pub fault: Fault,
    /// How often a healthy run looks as bad or worse.
    pub chance: f64,
    /// Whether it is large enough to matter; beside chance, which finds the smallest deviation of many replicates.
    pub matters: bool,
}

/// What comes of all checks.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Judgement {
    /// As it should be.
    Sound,
    /// What is not as it should be.
    Doubtful(Vec<Fault>),
    /// Too few photons on the receiver.
    FewPhotons,
    /// Too few replicates.
    FewReplicates,
    /// No check could be made.
    Unchecked,
}

/// The chance below which one of so many checks is failed, so that none of a healthy run is in 99 of 100 (Sidak).
pub fn level(checks: usize) -> f64 {
    -libm::expm1(libm::log1p(-FALSE_ALARMS) / checks.max(1) as f64)
}

impl Counted {
    /// All statistics; `None` for a single replicate.
    pub fn diagnosis(&self) -> Option<Diagnosis> {
        let replicates = self.on_receiver.len() as u32;
        let all = Spread::of(&self.on_receiver);
        let error = all.error()?;
        let arrived = all.sum;
        let photons = self.photons as f64 * f64::from(replicates);
        let merit = (arrived > 0).then(|| (arrived as f64 / error).powi(2) / photons);
        let share = arrived as f64 / photons;
        let independent =
            (self.is_once && arrived > 0 && share < 1.0).then_some(photons * share * (1.0 - share));
        let rate = self.rate(replicates);
        let drift = self.drift(replicates);
        let [skewness, kurtosis] = [moments::skewness, moments::kurtosis].map(|of| of(&self.on_receiver));
        let mut found = Diagnosis {
            arrived,
            replicates,
            merit,
            against_independent: independent.map(|variance| variance / (error * error)),
            trend: self.first.iter().map(|(photons, on)| Doubling::new(*photons, on)).collect(),
            rate,
            drift,
            skewness,
            kurtosis,
            checks: Vec::new(),
        };
        found.checks = found.checks(independent, &all);
        Some(found)
    }

    /// From the first level of enough photons on.
    fn rate(&self, replicates: u32) -> Option<Rate> {
        let enough = |(_, on): &&(u64, Vec<u64>)| on.iter().sum::<u64>() < FEWEST_PHOTONS;
        let levels = self.first.iter().skip_while(enough);
        let error = |(n, on): &(u64, Vec<u64>)| Some((*n, Spread::of(on).error()? / *n as f64));
        rate::rate(&levels.filter_map(error).collect::<Vec<_>>(), replicates)
    }

    fn drift(&self, replicates: u32) -> Option<Drift> {
        let n = self.photons;
        let (first, of_first) =
            self.first.iter().rev().find(|(m, _)| u128::from(*m) * 3 <= u128::from(n) * 2)?;
        let all = self.on_receiver.iter().sum::<u64>() as f64;
        if all == 0.0 || of_first.len() != self.on_receiver.len() {
            return None;
        }
        let (m, rest) = (i128::from(*first), i128::from(n - first));
        let difference = |(all, on): (&u64, &u64)| (i128::from(all - on) * m - i128::from(*on) * rest) as f64;
        let differences: Vec<f64> = self.on_receiver.iter().zip(of_first).map(difference).collect();
        let r = f64::from(replicates);
        let mean = differences.iter().sum::<f64>() / r;
        let square = differences.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / (r - 1.0);
        // Counts are whole: a replicate's difference is not surer than one photon, of those that stand for more.
        let spread = square.sqrt().max(m.max(rest) as f64);
        let error = spread / r.sqrt();
        // A difference d = later m - first (n - m) is one of d / (m (n - m)) photons of one.
        let unit = n as f64 * r / (m as f64 * rest as f64 * all);
        Some(Drift {
            first_photons: *first,
            relative: mean * unit,
            standard_error: error * unit,
            chance: farther(mean / error, replicates - 1),
        })
    }
}

impl Diagnosis {
    fn checks(&self, independent: Option<f64>, all: &Spread) -> Vec<Tested> {
        if self.replicates < FEWEST_REPLICATES || self.arrived < FEWEST_PHOTONS {
            return Vec::new();
        }
        let r = f64::from(self.replicates);
        let drift = self.drift.map(|of| Tested { fault: Fault::Drifts, chance: of.chance, matters: true });
        let rate = self.rate.map(|of| Tested { fault: Fault::Slow, chance: of.chance, matters: true });
        let scatter = independent.map(|variance| {
            let ratio = all.square / variance;
            let chance = chi_square_above(ratio * (r - 1.0), self.replicates - 1);
            Tested { fault: Fault::Scatters, chance, matters: ratio > SCATTERED }
        });
        // Where counts differ by single photons, their shape is that of rounding; few photons have the shape of counting.
        let shaped = |of: Option<Moment>| of.filter(|_| all.square >= r);
        let mean = all.sum as f64 / r;
        let skewness = shaped(self.skewness).and_then(|of| {
            let matters = of.value.abs() > (SKEWED * r.sqrt()).max(COUNTED * (1.0 / mean).sqrt());
            Some(Tested { fault: Fault::Skewed, chance: of.chance?, matters })
        });
        let kurtosis = shaped(self.kurtosis).and_then(|of| {
            let matters = of.value > HEAVY.max(COUNTED * COUNTED / mean);
            Some(Tested { fault: Fault::HeavyTailed, chance: of.chance?, matters })
        });
        [drift, rate, scatter, skewness, kurtosis].into_iter().flatten().collect()
    }

    /// What comes of the checks, each judged by this [`level`].
    pub fn judgement(&self, level: f64) -> Judgement {
        let failed = self.checks.iter().filter(|check| check.matters && check.chance < level);
        let faults: Vec<Fault> = failed.map(|check| check.fault).collect();
        if self.replicates < FEWEST_REPLICATES {
            Judgement::FewReplicates
        } else if self.arrived < FEWEST_PHOTONS {
            Judgement::FewPhotons
        } else if self.checks.is_empty() {
            Judgement::Unchecked
        } else if faults.is_empty() {
            Judgement::Sound
        } else {
            Judgement::Doubtful(faults)
        }
    }
}

impl Doubling {
    fn new(photons: u64, on: &[u64]) -> Self {
        let all = Spread::of(on);
        let traced = photons as f64 * on.len() as f64;
        let relative_error = all.error().filter(|_| all.sum > 0).map(|error| error / all.sum as f64);
        Self { photons, share: all.sum as f64 / traced, relative_error }
    }
}

/// Counts of replicates, added up.
struct Spread {
    replicates: u32,
    sum: u64,
    of_squares: u128,
    /// Variance of the sum, as the replicates have it.
    square: f64,
}

impl Spread {
    fn of(counts: &[u64]) -> Self {
        let sum: u64 = counts.iter().sum();
        let of_squares = counts.iter().map(|n| u128::from(*n) * u128::from(*n)).sum();
        let r = counts.len() as u128;
        // Exact, as in the standard errors of a run.
        let spread = r.saturating_mul(of_squares).saturating_sub(u128::from(sum) * u128::from(sum));
        let square = spread as f64 / (r.max(2) - 1) as f64;
        Self { replicates: counts.len() as u32, sum, of_squares, square }
    }

    /// Standard error of the sum as a run gives it.
    fn error(&self) -> Option<f64> {
        standard_error_of_total(self.sum, self.of_squares, self.replicates)
    }
}

#[cfg(test)]
#[path = "../tests_of_diagnosis.rs"]
mod tests;
