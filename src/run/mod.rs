//! A whole run: a scene and settings in, sums and their spread out.
//!
//! R replicates of n photons are traced one after another, each over all threads; of each receiver and account only the
//! sum and the sum of squares over replicates are kept.

pub mod algorithm;
pub mod plan;
pub mod tracer;

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::error::{Diagnostic, Kind, Result};
use crate::estimate::replicates::{standard_error_of_cell, standard_error_of_total};
use crate::scene::Scene;
use crate::tally::{Moments, Receivers};
use crate::transport::parallel::Traced;
use crate::transport::{Census, Ledger};

pub use algorithm::{Algorithm, Variant};
pub use plan::{DEFAULT_PHOTONS, DEFAULT_REPLICATES, MAX_PHOTONS, MAX_REPLICATES, Plan, Settings};
use tracer::Tracer;

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
    trace_by(
        scene,
        plan,
        |tracer, end, receivers| tracer.trace(end, receivers, interrupt, progress),
        interrupt,
    )
}

/// The loop over replicates and their stages. `stage` takes a tracer on to this number of photons and adds what arrives to
/// the receivers.
pub fn trace_by(
    scene: &Scene,
    plan: &Plan,
    mut stage: impl FnMut(&mut Tracer<'_>, u64, &Receivers<'_>) -> Result<Traced>,
    interrupt: &AtomicBool,
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
        let mut tracer = Tracer::new(scene, plan.algorithm, plan.seed, replicate, plan.photons_per_replicate);
        for end in stages(plan, replicate) {
            let traced = stage(&mut tracer, end, &receivers)?;
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

/// Photons of the first stage of the first replicate: all of it where the points are made for their number.
fn first_stage(plan: &Plan) -> u64 {
    let n = plan.photons_per_replicate;
    if plan.algorithm.sequence.needs_number() { n } else { n.min(FIRST_STAGE) }
}

/// The numbers of photons at which the tracing of a replicate pauses.
///
/// Within a range the order follows the first coordinate, so a part of it is a part of the emitter's directions, not a
/// sample of them. The first replicate is therefore traced in ranges that double what there is: each end is that of a
/// net of 2^m points, and an interrupted run falls back on the last. Later replicates count only as a whole.
fn stages(plan: &Plan, replicate: u32) -> Vec<u64> {
    let n = plan.photons_per_replicate;
    let first = if replicate == 0 { first_stage(plan) } else { n };
    std::iter::successors(Some(first), |end| (*end < n).then(|| n.min(2 * end))).collect()
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
