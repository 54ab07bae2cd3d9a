//! Replicates traced one after another: of pictures, of sequences whose points are made for their number, and where the
//! maps of all replicates do not fit into memory.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::error::Result;
use crate::scene::Scene;
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use super::kept::check_kept;
use super::outcome::{Outcome, StoppedBy};
use super::plan::Plan;
use super::tracer::Tracer;

/// A run whose photons go through other hands, for pictures.
///
/// `stage(tracer, end, receivers)` is called for each range of photons in turn, replicate by replicate
/// ([`Tracer::points`]). It takes the tracer on to photon number `end` ([`Tracer::trace_into`], in as many
/// steps as it likes), adds every arrival to `receivers` once, and gives what the steps traced. Where that is
/// not complete (an interrupt) the run ends without it: of the first replicate the stages before it count, of
/// any other none.
///
/// # Errors
/// Those of [`super::trace`] and of `stage`.
pub fn trace_by(
    scene: &Scene,
    plan: &Plan,
    mut stage: impl FnMut(&mut Tracer<'_>, u64, &Receivers<'_>) -> Result<Traced>,
    interrupt: &AtomicBool,
) -> Result<Outcome> {
    check_kept(scene, plan)?;
    let started = Instant::now();
    let mut receivers = Receivers::of_scene(scene, plan.photons_per_replicate());
    let mut outcome = Outcome::new(scene, plan);
    'run: for replicate in 0..plan.replicates() {
        let mut replica = Traced::new(scene);
        let (seed, n) = (plan.seed(), plan.photons_per_replicate());
        let mut tracer = Tracer::new(scene, plan.algorithm(), seed, replicate, n);
        for end in stages(plan, replicate) {
            let traced = stage(&mut tracer, end, &receivers)?;
            if !traced.complete {
                outcome.stopped_by = StoppedBy::Interrupt;
                break 'run;
            }
            replica.merge(&traced);
            if replicate == 0 {
                outcome.clear();
                outcome.add(&replica, &receivers);
            }
        }
        if replicate > 0 {
            outcome.add(&replica, &receivers);
        }
        receivers.clear();
        if interrupt.load(Ordering::Relaxed) && replicate + 1 < plan.replicates() {
            outcome.stopped_by = StoppedBy::Interrupt;
            break;
        }
    }
    let mut outcome = outcome.finished(scene, first_stage(plan))?;
    outcome.trace_s = started.elapsed().as_secs_f64();
    Ok(outcome)
}

/// Photons of the first stage of the first replicate.
const FIRST_STAGE: u64 = 1 << 10;

/// Photons of the first stage of the first replicate: all of it where the points are made for their number.
fn first_stage(plan: &Plan) -> u64 {
    let n = plan.photons_per_replicate();
    if plan.algorithm().sequence.needs_number() { n } else { n.min(FIRST_STAGE) }
}

/// The numbers of photons at which the tracing of a replicate pauses.
///
/// Within a range the order follows the first coordinate, so a part of it is a part of the emitter's
/// directions, not a sample of them. The first replicate is therefore traced in ranges that double what there
/// is: each end is that of a net of 2^m points, and an interrupted run falls back on the last. Later
/// replicates count only as a whole.
fn stages(plan: &Plan, replicate: u32) -> Vec<u64> {
    let first = if replicate == 0 { first_stage(plan) } else { plan.photons_per_replicate() };
    plan.doublings(first).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::{Algorithm, Settings};
    use crate::sequence::Sequence;

    #[test]
    fn the_first_replicate_doubles_and_the_others_are_traced_whole() {
        let plan = |n: u64, sequence: Sequence| {
            let algorithm = Algorithm { sequence, ..Algorithm::default() };
            let settings = Settings { photons: Some(2 * n), replicates: Some(2), algorithm, seed: 1 };
            Plan::new(&settings).unwrap()
        };
        let of = |n, replicate| stages(&plan(n, Sequence::SobolOwen), replicate);
        assert_eq!(of(1 << 13, 0), [1 << 10, 1 << 11, 1 << 12, 1 << 13]);
        assert_eq!(of(5000, 0), [1024, 2048, 4096, 5000]);
        assert_eq!((of(1000, 0), of(1024, 0)), (vec![1000], vec![1024]));
        assert_eq!(of(5000, 1), [5000]);
        let numbered = Sequence::ALL.into_iter().find(|s| s.needs_number() && s.is_randomised());
        if let Some(sequence) = numbered {
            assert_eq!(stages(&plan(5000, sequence), 0), [5000]);
        }
    }
}
