//! Replicates traced one after another: of pictures, of sequences whose points are made for their number, and where the
//! maps of all replicates do not fit into memory.

use std::io::{self, Read, Write};
use std::sync::atomic::Ordering;
use std::time::Instant;

use crate::error::Result;
use crate::math::varint::{damaged, put, take, take_up_to};
use crate::scene::Scene;
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use super::kept::check_kept;
use super::outcome::{Outcome, StoppedBy};
use super::plan::Plan;
use super::together::Watched;
use super::tracer::Tracer;

/// A run of replicates in turn, as far as it is.
#[derive(Debug)]
pub struct Turns<'s> {
    scene: &'s Scene,
    plan: Plan,
    /// The finished replicates; of the first the stages that it has.
    outcome: Outcome,
    replicate: u32,
    /// What the replicate at hand did beside its arrivals.
    pub replica: Traced,
    /// What it counted.
    pub receivers: Receivers<'s>,
    /// Its points.
    pub tracer: Tracer<'s>,
    earlier_s: f64,
    started: Instant,
    /// Time of tracing, once it is over, s.
    ended_s: Option<f64>,
}

/// Through whose hands the photons of a run go.
pub trait Stage {
    /// Takes the tracer of the replicate at hand on to photon number `end` ([`Tracer::trace_into`], in as many steps as it
    /// likes), adds every arrival to the receivers once, and what the steps traced to the replica. False where that is not
    /// complete (an interrupt): then the run ends without it: of the first replicate the stages before it count, of any other
    /// none.
    ///
    /// # Errors
    /// Those of tracing.
    fn stage(&mut self, turns: &mut Turns<'_>, end: u64) -> Result<bool>;

    /// Told after each replicate but the last, when the next stands at its first photon.
    fn turned(&mut self, turns: &Turns<'_>);
}

/// Keeps what there is of such a run, where somebody asks for it.
pub trait KeepTurns: Sync {
    /// Whether it is time to.
    fn is_due(&self) -> bool;

    /// Keeps the run, and after it what `more` writes.
    fn keep(&self, turns: &Turns<'_>, more: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>);
}

/// Nothing is kept.
#[derive(Debug)]
pub struct Unkept;

impl KeepTurns for Unkept {
    fn is_due(&self) -> bool {
        false
    }

    fn keep(&self, _: &Turns<'_>, _: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) {}
}

/// Photons that go to receivers and nowhere else.
pub struct ToReceivers<'a> {
    /// How it is watched.
    pub watched: Watched<'a>,
    /// How it is kept.
    pub keep: &'a dyn KeepTurns,
}

impl Stage for ToReceivers<'_> {
    fn stage(&mut self, turns: &mut Turns<'_>, end: u64) -> Result<bool> {
        let Watched { interrupt, progress } = self.watched;
        let traced = turns.tracer.trace(end, &turns.receivers, interrupt, progress)?;
        turns.replica.merge(&traced);
        Ok(traced.complete)
    }

    fn turned(&mut self, turns: &Turns<'_>) {
        if self.keep.is_due() {
            self.keep.keep(turns, &mut |_| Ok(()));
        }
    }
}

impl<'s> Turns<'s> {
    /// At the first photon.
    ///
    /// # Errors
    /// Far fields and spots of more replicates than there is room for.
    pub fn new(scene: &'s Scene, plan: &Plan) -> Result<Self> {
        check_kept(scene, plan)?;
        Ok(Self {
            scene,
            plan: *plan,
            outcome: Outcome::new(scene, plan),
            replicate: 0,
            replica: Traced::new(scene),
            receivers: Receivers::of_scene(scene, plan.photons_per_replicate()),
            tracer: tracer(scene, plan, 0),
            earlier_s: 0.0,
            started: Instant::now(),
            ended_s: None,
        })
    }

    /// The scene.
    pub fn scene(&self) -> &'s Scene {
        self.scene
    }

    /// The plan.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Photons traced so far.
    pub fn photons(&self) -> u64 {
        u64::from(self.replicate) * self.plan.photons_per_replicate() + self.tracer.photons
    }

    /// Time of tracing, earlier runs that it goes on from included, s.
    pub fn trace_s(&self) -> f64 {
        self.ended_s.unwrap_or_else(|| self.earlier_s + self.started.elapsed().as_secs_f64())
    }

    /// It goes on from a run that took so long.
    pub fn after(&mut self, earlier_s: f64) {
        self.earlier_s = earlier_s;
    }

    /// Runs to the end.
    ///
    /// # Errors
    /// Those of the stages.
    pub fn run(&mut self, watched: Watched<'_>, by: &mut impl Stage) -> Result<()> {
        let run = self.all_stages(watched, by);
        self.ended_s = Some(self.trace_s());
        run
    }

    fn all_stages(&mut self, watched: Watched<'_>, by: &mut impl Stage) -> Result<()> {
        let interrupt = watched.interrupt;
        while self.replicate < self.plan.replicates() {
            for end in stages(&self.plan, self.replicate) {
                // A run that goes on may stand within a stage.
                if end < self.tracer.photons {
                    continue;
                }
                if !by.stage(self, end)? {
                    self.outcome.stopped_by = StoppedBy::Interrupt;
                    return Ok(());
                }
                if self.replicate == 0 {
                    self.outcome.clear();
                    self.outcome.add(&self.replica, &self.receivers);
                }
            }
            if self.replicate > 0 {
                self.outcome.add(&self.replica, &self.receivers);
            }
            self.receivers.clear();
            self.replicate += 1;
            self.replica = Traced::new(self.scene);
            if self.replicate == self.plan.replicates() {
                break;
            }
            self.tracer = tracer(self.scene, &self.plan, self.replicate);
            if interrupt.load(Ordering::Relaxed) {
                self.outcome.stopped_by = StoppedBy::Interrupt;
                break;
            }
            by.turned(self);
        }
        Ok(())
    }

    /// What came of it.
    ///
    /// # Errors
    /// Interrupted before there was a result.
    pub fn finish(self) -> Result<Outcome> {
        let trace_s = self.trace_s();
        let mut outcome = self.outcome.finished(first_stage(&self.plan))?;
        outcome.trace_s = trace_s;
        Ok(outcome)
    }

    /// Writes how far it is, and everything that was counted.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [self.replicate.into(), self.tracer.photons, self.tracer.attempts()])?;
        self.outcome.write(out)?;
        self.replica.write(out)?;
        self.receivers.write(out)
    }

    /// Goes on from what was written, of the same scene and plan.
    ///
    /// # Errors
    /// Those of the reader; what is of another run.
    pub fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        self.replicate = take_up_to(from, self.plan.replicates().into(), "replicates")? as u32;
        let (photons, attempts) = (take(from)?, take(from)?);
        if photons > self.plan.photons_per_replicate() || attempts < photons {
            return Err(damaged(&format!("photons to number {photons}")));
        }
        self.outcome.read(self.scene, from)?;
        self.replica.add_from(from)?;
        self.receivers.add_from(from)?;
        self.tracer = tracer(self.scene, &self.plan, self.replicate);
        self.tracer.move_to(photons, attempts);
        Ok(())
    }
}

fn tracer<'s>(scene: &'s Scene, plan: &Plan, replicate: u32) -> Tracer<'s> {
    Tracer::new(scene, plan.algorithm(), plan.seed(), replicate, plan.photons_per_replicate())
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
