//! A whole run: a scene and settings in, sums and their spread out.
//!
//! R replicates of n photons are traced one after another, each over all threads; of each receiver and account only the
//! sum and the sum of squares over replicates are kept.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::error::{Diagnostic, Kind, Result};
use crate::estimate::replicates::{standard_error_of_cell, standard_error_of_total};
use crate::scene::Scene;
use crate::sequence::Sequence;
use crate::sequence::independent::IndependentPoints;
use crate::sequence::other::OtherPoints;
use crate::sequence::owen::OwenPoints;
use crate::sequence::sobol::SobolPoints;
use crate::tally::{Moments, Receivers};
use crate::transport::parallel::{How, Traced, trace_range};
use crate::transport::{Census, Ledger};

/// Photons of a run that names no number.
pub const DEFAULT_PHOTONS: u64 = 1 << 22;
/// Replicates of a run that names no number.
pub const DEFAULT_REPLICATES: u32 = 8;
/// Most photons of a run: 2^48, so that counts and their products have room.
pub const MAX_PHOTONS: u64 = 1 << 48;
/// Most replicates.
pub const MAX_REPLICATES: u32 = 1 << 16;

/// The algorithm variants that a run can use; the paper's names, cumulative.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// Sobol' points and inverse functions; every choice draws its own coordinate.
    QmcInverse,
    /// The same with renormalisation: discrete events share a coordinate. The default.
    QmcInverseReuse,
}

impl Variant {
    /// Every variant that can be run.
    pub const ALL: [Self; 2] = [Self::QmcInverse, Self::QmcInverseReuse];

    /// The name in commands and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::QmcInverse => "qmc-inverse",
            Self::QmcInverseReuse => "qmc-inverse-reuse",
        }
    }

    const fn reuses(self) -> bool {
        matches!(self, Self::QmcInverseReuse)
    }
}

/// What a run is asked to do.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Photons in all; `None`: [`DEFAULT_PHOTONS`], rounded up to R 2^m.
    pub photons: Option<u64>,
    /// Independent randomisations R; `None`: [`DEFAULT_REPLICATES`] (1 for a sequence without a seed).
    pub replicates: Option<u32>,
    /// Seed of the randomisation.
    pub seed: u64,
    /// Point sequence.
    pub sequence: Sequence,
    /// Algorithm variant.
    pub variant: Variant,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            photons: None,
            replicates: None,
            seed: 1,
            sequence: Sequence::SobolOwen,
            variant: Variant::QmcInverseReuse,
        }
    }
}

/// What a run does: settings made definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    /// Photons of one replicate, n.
    pub photons_per_replicate: u64,
    /// Replicates, R.
    pub replicates: u32,
    /// Seed of the randomisation.
    pub seed: u64,
    /// Point sequence.
    pub sequence: Sequence,
    /// Algorithm variant.
    pub variant: Variant,
}

impl Plan {
    /// The plan for these settings: n = 2^m where no number of photons is asked for, else N / R rounded up.
    ///
    /// # Errors
    /// No photons, no replicates, more than [`MAX_PHOTONS`] or [`MAX_REPLICATES`], and several replicates of a sequence
    /// that has no seed.
    pub fn new(settings: &Settings) -> Result<Self> {
        let Settings { photons, replicates, seed, sequence, variant } = *settings;
        let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
        let default = if sequence.is_randomised() { DEFAULT_REPLICATES } else { 1 };
        let replicates = replicates.unwrap_or(default);
        if replicates == 0 || replicates > MAX_REPLICATES {
            return fail(format!("{replicates} replicates"), "1 to 65536 replicates");
        }
        if replicates > 1 && !sequence.is_randomised() {
            return fail(
                format!("{replicates} replicates of the sequence \"{}\"", sequence.name()),
                "one replicate: this sequence has no seed, so all replicates would be the same points",
            );
        }
        if photons.is_some_and(|n| n == 0 || n > MAX_PHOTONS) {
            return fail(format!("{} photons", photons.unwrap_or(0)), "1 to 2^48 photons");
        }
        let share = photons.unwrap_or(DEFAULT_PHOTONS).div_ceil(u64::from(replicates));
        let photons_per_replicate = if photons.is_some() { share } else { share.next_power_of_two() };
        Ok(Self { photons_per_replicate, replicates, seed, sequence, variant })
    }

    /// Photons in all.
    pub fn photons(&self) -> u64 {
        self.photons_per_replicate * u64::from(self.replicates)
    }
}

/// Why a run ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// All photons are traced.
    Photons,
    /// It was interrupted; what is here are the replicates finished by then, or, before the first was, the first 2^m
    /// photons of it.
    Interrupt,
}

/// What a run found.
#[derive(Debug, Clone)]
pub struct Outcome {
    /// What was asked for.
    pub plan: Plan,
    /// Photons that the sums stand for.
    pub photons: u64,
    /// Replicates that the sums stand for.
    pub replicates: u32,
    /// Flux of one photon, lm.
    pub photon_lm: f64,
    /// Where photons began and ended.
    pub ledger: Ledger,
    /// Sums over replicates of the accounts, in the order of [`Outcome::accounts`].
    pub accounts: Moments,
    /// Sums over replicates of every cell, by receiver.
    pub cells: Vec<Moments>,
    /// Sums over replicates of each receiver's total: one entry a receiver.
    pub totals: Moments,
    /// Coordinates and exceptions.
    pub census: Census,
    /// Time of tracing in seconds.
    pub trace_s: f64,
    /// Why it ended.
    pub stopped_by: StoppedBy,
}

/// A number and its standard error; `None` where one replicate leaves it unknown.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// The number.
    pub value: f64,
    /// Its standard error.
    pub standard_error: Option<f64>,
}

impl Outcome {
    /// Illuminance in a cell of a receiver with this cell area, lx.
    pub fn illuminance_lx(&self, receiver: usize, cell: usize, area_m2: f64) -> Estimate {
        let moments = &self.cells[receiver];
        let (sum, square) = (moments.sum[cell], moments.square[cell]);
        let lx = self.photon_lm / area_m2;
        Estimate {
            value: sum as f64 * lx,
            standard_error: standard_error_of_cell(sum, square, self.replicates).map(|e| e * lx),
        }
    }

    /// Flux that arrived at a receiver, lm.
    pub fn receiver_flux_lm(&self, receiver: usize) -> Estimate {
        self.total(&self.totals, receiver)
    }

    /// Flux absorbed by a surface, lm.
    pub fn absorbed_lm(&self, surface: usize) -> Estimate {
        self.total(&self.accounts, surface)
    }

    /// Flux that left the scene, lm.
    pub fn escaped_lm(&self) -> Estimate {
        self.total(&self.accounts, self.ledger.absorbed.len())
    }

    /// Flux of photons ended by the guard, lm.
    pub fn killed_lm(&self) -> Estimate {
        self.total(&self.accounts, self.ledger.absorbed.len() + 1)
    }

    fn total(&self, moments: &Moments, at: usize) -> Estimate {
        let (sum, square) = (moments.sum[at], moments.square[at]);
        Estimate {
            value: sum as f64 * self.photon_lm,
            standard_error: standard_error_of_total(sum, square, self.replicates).map(|e| e * self.photon_lm),
        }
    }

    /// Bytes held by sums: what a run needs beside the scene, whatever the number of photons.
    pub fn memory_bytes(&self) -> usize {
        let cells: usize = self.cells.iter().map(|m| m.sum.len()).sum();
        cells * (size_of::<u64>() + size_of::<u128>())
    }
}

/// Accounts of a ledger in the order of the sums: absorbed by surface, escaped, killed.
fn accounts(ledger: &Ledger) -> impl Iterator<Item = u64> + '_ {
    ledger.absorbed.iter().copied().chain([ledger.escaped, ledger.killed])
}

/// Traces a scene by a plan, on the current rayon pool. Setting `interrupt` ends the run early; `progress` is told
/// numbers of photons as they are done.
///
/// # Errors
/// Interrupted before any photon was traced; a ledger that does not balance (a defect of the program, never of the
/// data).
pub fn trace(
    scene: &Scene,
    plan: &Plan,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Outcome> {
    let started = Instant::now();
    let surfaces = scene.geometry.surfaces().len();
    let mut receivers = Receivers::new(&scene.geometry, &scene.receivers);
    let mut outcome = Outcome {
        plan: *plan,
        photons: 0,
        replicates: 0,
        photon_lm: 0.0,
        ledger: Ledger::new(scene.emitters.as_slice().len(), surfaces),
        accounts: Moments::new(surfaces + 2),
        cells: scene.receivers.iter().map(|r| Moments::new(r.cells.len())).collect(),
        totals: Moments::new(scene.receivers.len()),
        census: Census::default(),
        trace_s: 0.0,
        stopped_by: StoppedBy::Photons,
    };
    'run: for replicate in 0..plan.replicates {
        let mut replica = Traced::new(scene);
        for stage in stages(plan, replicate) {
            let how = How { reuse: plan.variant.reuses(), interrupt, progress };
            let traced = trace_stage(scene, plan, replicate, stage, how, &receivers)?;
            check_balance(&traced.ledger)?;
            if !traced.complete {
                outcome.stopped_by = StoppedBy::Interrupt;
                break 'run;
            }
            replica.merge(&traced);
            if replicate == 0 {
                outcome.start_with(&replica, &receivers);
            }
        }
        if replicate > 0 {
            outcome.absorb(&replica, &receivers);
        }
        receivers.clear();
        if interrupt.load(Ordering::Relaxed) && replicate + 1 < plan.replicates {
            outcome.stopped_by = StoppedBy::Interrupt;
            break;
        }
    }
    if outcome.photons == 0 {
        return Err(Diagnostic::new(
            Kind::Interrupted,
            format!("an interrupt before the first {} photons were traced", first_stage(plan)),
            "at least these for a result",
        ));
    }
    outcome.photon_lm = scene.emitters.flux_lm() / outcome.photons as f64;
    outcome.trace_s = started.elapsed().as_secs_f64();
    Ok(outcome)
}

/// Photons of the first stage of the first replicate.
const FIRST_STAGE: u64 = 1 << 10;

fn first_stage(plan: &Plan) -> u64 {
    let n = plan.photons_per_replicate;
    if plan.sequence.needs_number() { n } else { n.min(FIRST_STAGE) }
}

/// The ranges of indices that a replicate is traced in, one after another.
///
/// Within a range the order follows the first coordinate, so a part of it is a part of the emitter's directions, not a
/// sample of them. The first replicate is therefore traced in ranges that double what there is: each end is that of a
/// net of 2^m points, and an interrupted run falls back on the last. Later replicates count only as a whole, and so does
/// the first of a sequence that is a set of n points: its first part is no sample either.
fn stages(plan: &Plan, replicate: u32) -> Vec<Range<u64>> {
    let n = plan.photons_per_replicate;
    let (mut start, mut end) = (0, if replicate == 0 { first_stage(plan) } else { n });
    let mut stages = Vec::new();
    while start < n {
        stages.push(start..end);
        (start, end) = (end, n.min(2 * end));
    }
    stages
}

fn check_balance(ledger: &Ledger) -> Result<()> {
    if ledger.is_balanced() {
        return Ok(());
    }
    Err(Diagnostic::new(
        Kind::Geometry,
        format!("{} photons begun, {} ended", ledger.total_emitted(), ledger.total_ended()),
        "every photon to end exactly once: this is a defect of caustix, please report it with the scene",
    ))
}

impl Outcome {
    /// Takes the first replicate, as far as it is, for all there is.
    fn start_with(&mut self, traced: &Traced, receivers: &Receivers<'_>) {
        self.photons = traced.ledger.total_emitted();
        self.replicates = 1;
        self.accounts.restart(accounts(&traced.ledger));
        self.ledger = traced.ledger.clone();
        self.census = traced.census.clone();
        for (receiver, moments) in self.cells.iter_mut().enumerate() {
            moments.restart(receivers.counts(receiver).iter());
        }
        let totals: Vec<u64> = (0..self.cells.len()).map(|r| receivers.counts(r).iter().sum()).collect();
        self.totals.restart(totals.into_iter());
    }

    fn absorb(&mut self, traced: &Traced, receivers: &Receivers<'_>) {
        self.photons += traced.ledger.total_emitted();
        self.replicates += 1;
        self.accounts.absorb(accounts(&traced.ledger));
        self.ledger.merge(&traced.ledger);
        self.census.merge(&traced.census);
        for (receiver, moments) in self.cells.iter_mut().enumerate() {
            moments.absorb(receivers.counts(receiver).iter());
        }
        let totals: Vec<u64> = (0..self.cells.len()).map(|r| receivers.counts(r).iter().sum()).collect();
        self.totals.absorb(totals.into_iter());
    }
}

/// A range of one replicate: the sequence is matched here, once, so that the walk is compiled for it.
fn trace_stage(
    scene: &Scene,
    plan: &Plan,
    replicate: u32,
    stage: Range<u64>,
    how: How<'_>,
    receivers: &Receivers<'_>,
) -> Result<Traced> {
    let sink = || receivers.sink();
    Ok(match plan.sequence {
        Sequence::Independent => {
            trace_range(scene, &IndependentPoints::new(plan.seed, replicate), stage, how, sink)
        }
        Sequence::Sobol => trace_range(scene, &SobolPoints::new(), stage, how, sink),
        Sequence::SobolOwen => trace_range(scene, &OwenPoints::new(plan.seed, replicate), stage, how, sink),
        other => {
            let points = OtherPoints::new(other, plan.seed, replicate, Some(plan.photons_per_replicate))?;
            trace_range(scene, &points, stage, how, sink)
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plan(photons: Option<u64>, replicates: Option<u32>, sequence: Sequence) -> Result<Plan> {
        Plan::new(&Settings { photons, replicates, sequence, ..Settings::default() })
    }

    #[test]
    fn photons_are_rounded_up_to_powers_of_two_only_when_not_asked_for() {
        let default = plan(None, None, Sequence::SobolOwen).unwrap();
        assert_eq!((default.photons(), default.photons_per_replicate), (1 << 22, 1 << 19));
        let six = plan(None, Some(6), Sequence::SobolOwen).unwrap();
        assert_eq!(six.photons(), 6 << 20);
        let asked = plan(Some(4_456_448), None, Sequence::SobolOwen).unwrap();
        assert_eq!(asked.photons(), 4_456_448);
        let odd = plan(Some(1_000_001), None, Sequence::SobolOwen).unwrap();
        assert_eq!(odd.photons(), 1_000_008);
    }

    #[test]
    fn a_sequence_without_seed_has_one_replicate() {
        assert_eq!(plan(None, None, Sequence::Sobol).unwrap().replicates, 1);
        assert!(plan(None, Some(8), Sequence::Sobol).is_err());
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(plan(Some(0), None, Sequence::SobolOwen).is_err());
        assert!(plan(Some(u64::MAX), None, Sequence::SobolOwen).is_err());
        assert!(plan(None, Some(0), Sequence::SobolOwen).is_err());
        assert!(plan(None, Some(1 << 17), Sequence::SobolOwen).is_err());
    }
}
