//! Where a run of replicates together pauses.
//!
//! The photons of a stage are traced in the order of their first coordinate, so a part of it is a part of the emitter's
//! directions and no sample of them. What is looked at, kept or fallen back on are whole stages. They double what there is: the
//! first 2^m points are a net. With a goal they are an eighth of that, aligned: 2^(m-3) such points are a net too.

use std::time::{Duration, Instant};

use super::goal::Goal;
use super::plan::Plan;
use super::together::Together;

/// Photons of the first stage, over all replicates.
const FIRST_STAGE: u64 = 1 << 13;
/// Stages of a doubling that a goal looks at.
const LOOKS: u64 = 8;
/// An error is looked at from this many photons a counter on: eight looks at a map then take a percent of the time between two
/// doublings; and with fewer no map is good enough for anybody.
const PHOTONS_PER_COUNTER: u64 = 2;
/// A stage that takes longer is divided, so that no more is lost by a power cut.
const LONGEST: Duration = Duration::from_secs(10);
/// The last stage of a run by the clock is not shorter than this part of all of its time.
const SHORTEST_PART: f64 = 0.02;

/// Where to pause next.
#[derive(Debug)]
pub(super) struct Schedule {
    first: u64,
    /// Index from which on an error is looked at.
    looks_from: Option<u64>,
    until: Option<Instant>,
    started: Instant,
    photons_per_s: Option<f64>,
}

impl Schedule {
    pub fn new(run: &Together<'_>, goal: &Goal) -> Self {
        let replicates = u64::from(run.plan().replicates());
        let enough = run.counters().saturating_mul(PHOTONS_PER_COUNTER) / replicates;
        Self {
            first: first_stage(run.plan()),
            looks_from: goal.error.map(|_| enough.max(first_stage(run.plan()))),
            until: goal.until,
            started: Instant::now(),
            photons_per_s: None,
        }
    }

    /// Photons of each replicate in the first stage.
    pub fn first(&self) -> u64 {
        self.first
    }

    /// Photons a second, as measured last.
    pub fn photons_per_s(&self) -> Option<f64> {
        self.photons_per_s
    }

    /// So many photons took so long.
    pub fn measure(&mut self, photons: u64, took: Duration) {
        let seconds = took.as_secs_f64();
        if photons > 0 && seconds > 0.0 {
            self.photons_per_s = Some(photons as f64 / seconds);
        }
    }

    /// The index up to which all replicates are traced next; `None` where the time is over.
    pub fn next(&self, run: &Together<'_>) -> Option<u64> {
        let (done, part) = (run.farthest(), run.part());
        if run.done() < done {
            // Replicates that were added catch up.
            return Some(done);
        }
        let most = self.most_photons(run)?;
        Some(next(done, self.first, self.looks_from, most).min(part.end))
    }

    /// Photons of each replicate for which a stage has time; `None` where there is none left.
    fn most_photons(&self, run: &Together<'_>) -> Option<u64> {
        let Some(speed) = self.photons_per_s else { return Some(u64::MAX) };
        let speed = speed / f64::from(run.plan().replicates());
        let of = |time: Duration| (speed * time.as_secs_f64()) as u64;
        let Some(until) = self.until else { return Some(of(LONGEST).max(self.first)) };
        let left = until.saturating_duration_since(Instant::now());
        let shortest = until.saturating_duration_since(self.started).mul_f64(SHORTEST_PART);
        if left <= shortest && run.photons() > 0 {
            return None;
        }
        Some(of(left.min(LONGEST)).max(self.first / LOOKS))
    }

    /// Whether an error is looked at where a run is.
    pub fn is_look(&self, run: &Together<'_>) -> bool {
        let done = run.done();
        run.is_done() || self.looks_from.is_some_and(|from| done >= from && done.is_multiple_of(step(done)))
    }
}

/// From one look to the next: an eighth of the octave that the index is in.
fn step(done: u64) -> u64 {
    (1 << done.max(1).ilog2()).max(LOOKS) / LOOKS
}

/// The end of a stage that begins at `done`, of at most `most` photons.
fn next(done: u64, first: u64, looks_from: Option<u64>, most: u64) -> u64 {
    let doubled = (done + 1).next_power_of_two().max(first);
    let end = match looks_from {
        Some(from) if done >= from => done - done % step(done) + step(done),
        _ => doubled,
    };
    if end - done <= most {
        return end;
    }
    // The longest aligned stage that there is time for.
    let length = if most.is_power_of_two() { most } else { most.next_power_of_two() / 2 }.max(1);
    end.min((done / length + 1) * length)
}

/// Photons of each replicate in the first stage.
fn first_stage(plan: &Plan) -> u64 {
    let share = FIRST_STAGE.div_ceil(u64::from(plan.replicates())).next_power_of_two().max(32);
    share.min(plan.photons_per_replicate())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::Settings;

    /// All stages up to an end.
    fn stages(end: u64, first: u64, looks_from: Option<u64>, most: u64) -> Vec<u64> {
        let next = |done: &u64| (*done < end).then(|| next(*done, first, looks_from, most).min(end));
        std::iter::successors(next(&0), next).collect()
    }

    #[test]
    fn stages_double_from_a_first_one_that_all_replicates_share() {
        let of = |n: u64, replicates: u32| {
            let photons = Some(n * u64::from(replicates));
            let settings = Settings { photons, replicates: Some(replicates), ..Settings::default() };
            stages(n, first_stage(&Plan::new(&settings).unwrap()), None, u64::MAX)
        };
        assert_eq!(of(1 << 13, 8), [1 << 10, 1 << 11, 1 << 12, 1 << 13]);
        assert_eq!(of(5000, 6), [2048, 4096, 5000]);
        assert_eq!((of(1000, 8), of(1024, 8)), (vec![1000], vec![1024]));
        assert_eq!(of(100, 1 << 12), [32, 64, 100]);
    }

    #[test]
    fn looks_are_eighths_of_a_doubling() {
        let ends = stages(140, 32, Some(64), u64::MAX);
        assert_eq!(ends, [32, 64, 72, 80, 88, 96, 104, 112, 120, 128, 140]);
        assert!(ends.iter().all(|end| *end < 64 || *end == 140 || end % step(*end) == 0));
        // From an odd place, as of a run of other settings, to the next of them.
        assert_eq!(next(67, 32, Some(64), u64::MAX), 72);
        // The smallest are single photons.
        assert_eq!(stages(12, 4, Some(4), u64::MAX), [4, 5, 6, 7, 8, 9, 10, 11, 12]);
    }

    #[test]
    fn stages_that_would_take_too_long_are_divided_where_nets_begin() {
        assert_eq!(stages(256, 32, None, 50), [32, 64, 96, 128, 160, 192, 224, 256]);
        assert_eq!(next(96, 32, None, 5), 100);
        assert_eq!(next(100, 32, None, 1), 101);
        assert_eq!(next(0, 32, None, 8), 8);
        assert_eq!(next(100, 32, None, 0), 101);
    }
}
