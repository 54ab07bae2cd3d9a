//! A run of replicates together, from block to block: until its photons are traced, its error is reached, its time is over, or
//! somebody stops it.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

use crate::error::Result;
use crate::scene::Scene;

use super::goal::{ErrorGoal, Goal, Looks};
use super::kept::is_together;
use super::outcome::{Outcome, Reached, StoppedBy};
use super::pace::Pace;
use super::plan::Plan;
use super::schedule::Schedule;
use super::together::{COUNTERS_PER_PHOTON, Together, Watched};
use super::turns::{self, ToReceivers, Turns};

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
    let watched = Watched { interrupt, progress };
    if !is_together(scene, plan) {
        let mut turns = Turns::new(scene, plan)?;
        turns.run(watched, &mut ToReceivers { watched, keep: &turns::Unkept })?;
        return turns.finish();
    }
    Course::new(Together::new(scene, plan)?).run(Goal::default(), watched, &mut Unkept)
}

/// The same until an error is reached or a time is over, whichever comes first, with the plan's photons as the most.
///
/// # Errors
/// Those of [`trace`] and of [`Goal::check`].
pub fn trace_until(
    scene: &Scene,
    plan: &Plan,
    goal: Goal,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Outcome> {
    goal.check(scene, plan)?;
    let watched = Watched { interrupt, progress };
    Course::new(Together::new(scene, plan)?).run(goal, watched, &mut Unkept)
}

/// A run on its way.
#[derive(Debug)]
pub struct Course<'s> {
    /// What is traced.
    pub run: Together<'s>,
    /// The looks at its error.
    pub looks: Looks,
    /// Time of tracing, earlier runs that it goes on from included, s.
    pub trace_s: f64,
}

/// What traces a run from pause to pause, and keeps and tells what there is in between.
pub trait Keep {
    /// Keeps what there is; a run asks for it so seldom that it costs no more than a percent of its time.
    fn keep(&mut self, course: &Course<'_>);

    /// Takes a run on to this index.
    ///
    /// # Errors
    /// Those of tracing.
    fn trace(&mut self, run: &mut Together<'_>, end: u64, watched: Watched<'_>) -> Result<bool> {
        run.trace(end, watched)
    }

    /// Does a sum that takes many threads.
    fn install<R: Send>(&self, sum: impl FnOnce() -> R + Send) -> R {
        sum()
    }

    /// Told after every look: the error, what is asked for, and how long it may take, s.
    fn look(&mut self, _error: f64, _asked: f64, _left_s: Option<f64>) {}
}

/// Nothing is kept.
#[derive(Debug)]
pub struct Unkept;

impl Keep for Unkept {
    fn keep(&mut self, _: &Course<'_>) {}
}

impl<'s> Course<'s> {
    /// From the first photon, or from where `run` is.
    pub fn new(run: Together<'s>) -> Self {
        Self { run, looks: Looks::default(), trace_s: 0.0 }
    }

    /// Runs to the end.
    ///
    /// # Errors
    /// Interrupted before there was a result; a ledger that does not balance.
    pub fn run(mut self, goal: Goal, watched: Watched<'_>, keep: &mut impl Keep) -> Result<Outcome> {
        let (started, earlier_s) = (Instant::now(), self.trace_s);
        let mut outcome = Outcome::new(self.run.scene(), self.run.plan());
        let replicates = u64::from(self.run.plan().replicates());
        let mut schedule = Schedule::new(&self.run, &goal);
        let mut pace = Pace::new();
        if self.run.photons() > 0 && self.run.done() == self.run.farthest() {
            keep.install(|| self.run.sum_up(&mut outcome));
        }
        let stopped_by = loop {
            if self.has_reached(goal.error) {
                break StoppedBy::Error;
            }
            if self.run.is_done() {
                break StoppedBy::Photons;
            }
            let Some(end) = schedule.next(&self.run) else { break StoppedBy::Time };
            let (before, block) = (self.run.photons(), Instant::now());
            if !keep.trace(&mut self.run, end, watched)? {
                break StoppedBy::Interrupt;
            }
            schedule.measure(self.run.photons() - before, block.elapsed());
            self.trace_s = earlier_s + started.elapsed().as_secs_f64();
            let is_over = self.run.is_done() || watched.interrupt.load(Ordering::Relaxed);
            let is_look = goal.error.is_some() && schedule.is_look(&self.run);
            // A sum over all counters for each that takes a percent of the time of the photons since the last.
            let news = (self.run.photons() - outcome.photons).saturating_mul(COUNTERS_PER_PHOTON);
            if is_over || is_look || outcome.photons == 0 || news >= self.run.counters() {
                keep.install(|| self.run.sum_up(&mut outcome));
            }
            if let Some(goal) = goal.error.filter(|_| is_look) {
                self.look(&goal, &outcome, &schedule, keep);
            }
            if is_over && !self.run.is_done() {
                keep.keep(&self);
                break StoppedBy::Interrupt;
            }
            if pace.is_due() && !self.run.is_done() {
                pace.keep(|| keep.keep(&self));
            }
        };
        if stopped_by != StoppedBy::Interrupt {
            if outcome.photons < self.run.photons() {
                keep.install(|| self.run.sum_up(&mut outcome));
            }
            keep.keep(&self);
        }
        outcome.stopped_by = stopped_by;
        outcome.doublings = self.run.doublings();
        outcome.reached = goal.error.map(|goal| Reached {
            of: goal.of(),
            asked: goal.relative(),
            error: goal.measured(self.run.scene(), &outcome),
        });
        let mut outcome = outcome.finished(schedule.first() * replicates)?;
        outcome.trace_s = self.trace_s;
        Ok(outcome)
    }

    fn has_reached(&self, error: Option<ErrorGoal>) -> bool {
        error.is_some_and(|goal| self.looks.are_enough(goal.relative()))
    }

    fn look(&mut self, goal: &ErrorGoal, outcome: &Outcome, schedule: &Schedule, keep: &mut impl Keep) {
        let error = goal.measured(self.run.scene(), outcome).unwrap_or(f64::INFINITY);
        self.looks.take(self.run.done(), error);
        let photons = self.looks.expected(goal.relative());
        let each = photons.map(|n| n.saturating_sub(self.run.done()) as f64);
        let all = each.map(|n| n * f64::from(self.run.plan().replicates()));
        keep.look(error, goal.relative(), all.and_then(|n| Some(n / schedule.photons_per_s()?)));
    }
}
