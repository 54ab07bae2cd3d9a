//! All replicates of a run, advanced together.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use rayon::prelude::*;

use crate::error::Result;
use crate::scene::Scene;
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use super::in_turn::trace_by;
use super::kept::{are_kept, check_kept, counters};
use super::outcome::{Outcome, StoppedBy};
use super::plan::Plan;
use super::tracer::Tracer;

/// Photons of the first stage, over all replicates.
const FIRST_STAGE: u64 = 1 << 13;

/// A stage is summed up for an interrupt to fall back on when it has this many photons for each counter: a photon
/// takes some hundred times as long as the sum over a counter, so that all sums take about a percent of the time.
const PHOTONS_PER_COUNTER: f64 = 0.125;

/// Traces a scene by a plan, on the current rayon pool. Setting `interrupt` ends the run early; `progress` is
/// told numbers of photons as they are done.
///
/// All replicates advance together, doubling what there is, so that an interrupted run has error bars. They are traced
/// one after another where the maps of all replicates take more than a gibibyte, or where the points are made for their
/// number.
///
/// # Errors
/// Interrupted before there was a result; a ledger that does not balance (a defect of the program, never of the data).
pub fn trace(
    scene: &Scene,
    plan: &Plan,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Outcome> {
    check_kept(scene, plan)?;
    if !together(scene, plan) {
        let stage = |tracer: &mut Tracer<'_>, end, receivers: &Receivers<'_>| {
            tracer.trace(end, receivers, interrupt, progress)
        };
        return trace_by(scene, plan, stage, interrupt);
    }
    let started = Instant::now();
    let mut replicas: Vec<Replica<'_>> =
        (0..plan.replicates()).map(|r| Replica::new(scene, plan, r)).collect();
    let mut outcome = Outcome::new(scene, plan);
    let counters = counters(scene, plan) as f64;
    let stages = stages(plan);
    for (i, &end) in stages.iter().enumerate() {
        // Threads that one replicate leaves idle go on with the next.
        replicas.par_iter_mut().try_for_each(|replica| replica.trace(end, interrupt, progress))?;
        if replicas.iter().any(|replica| !replica.traced.complete) {
            outcome.stopped_by = StoppedBy::Interrupt;
            break;
        }
        let is_last = i + 1 == stages.len();
        let photons = end * u64::from(plan.replicates());
        let is_over = is_last || interrupt.load(Ordering::Relaxed);
        if i == 0 || is_over || photons as f64 >= PHOTONS_PER_COUNTER * counters {
            outcome.replace(replicas.iter().map(|replica| (&replica.traced, &replica.receivers)));
        }
        if is_over && !is_last {
            outcome.stopped_by = StoppedBy::Interrupt;
            break;
        }
    }
    outcome.finished(scene, started, stages[0] * u64::from(plan.replicates()))
}

/// Whether the replicates of a run advance together: unless their maps take more than a gibibyte, or the points are
/// made for their number, so that a first part of them is no sample.
fn together(scene: &Scene, plan: &Plan) -> bool {
    are_kept(scene, plan) && !plan.algorithm().sequence.needs_number()
}

/// A replicate as far as it is traced.
struct Replica<'s> {
    tracer: Tracer<'s>,
    receivers: Receivers<'s>,
    traced: Traced,
}

impl<'s> Replica<'s> {
    fn new(scene: &'s Scene, plan: &Plan, replicate: u32) -> Self {
        let (seed, n) = (plan.seed(), plan.photons_per_replicate());
        Self {
            tracer: Tracer::new(scene, plan.algorithm(), seed, replicate, n),
            receivers: Receivers::of_scene(scene, n),
            traced: Traced::new(scene),
        }
    }

    fn trace(&mut self, end: u64, interrupt: &AtomicBool, progress: &(dyn Fn(u64) + Sync)) -> Result<()> {
        let more = self.tracer.trace(end, &self.receivers, interrupt, progress)?;
        self.traced.merge(&more);
        Ok(())
    }
}

/// The numbers of photons of a replicate at which a run pauses, each twice the one before: a first part of them is a
/// net of 2^m points, while within a stage the order follows the first coordinate, so that a part of it would be a part
/// of the emitter's directions, not a sample of them.
fn stages(plan: &Plan) -> Vec<u64> {
    let share = FIRST_STAGE.div_ceil(u64::from(plan.replicates())).next_power_of_two().max(32);
    plan.doublings(share).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Settings;

    #[test]
    fn stages_double_from_a_first_one_that_all_replicates_share() {
        let of = |n: u64, replicates: u32| {
            let photons = Some(n * u64::from(replicates));
            let settings = Settings { photons, replicates: Some(replicates), ..Settings::default() };
            stages(&Plan::new(&settings).unwrap())
        };
        assert_eq!(of(1 << 13, 8), [1 << 10, 1 << 11, 1 << 12, 1 << 13]);
        assert_eq!(of(5000, 6), [2048, 4096, 5000]);
        assert_eq!((of(1000, 8), of(1024, 8)), (vec![1000], vec![1024]));
        assert_eq!(of(100, 1 << 12), [32, 64, 100]);
    }
}
