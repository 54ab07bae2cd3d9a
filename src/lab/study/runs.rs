//! One point set of one algorithm: its errors and costs at every number of photons of a ladder.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use crate::error::Result;
use crate::run::Algorithm;
use crate::run::tracer::Tracer;
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use super::reference::Reference;
use super::results::Run;

/// Photons that a ladder starts with where none is named: 256 below the largest, a square of the noise's
/// fall.
pub const LADDER_OCTAVES: u32 = 8;

/// The numbers of photons at which errors are taken: powers of two from `from` to `until`, and `until`
/// itself.
pub fn ladder(from: u64, until: u64) -> Vec<u64> {
    let mut rungs: Vec<u64> = (0..64).map(|m| 1u64 << m).filter(|n| (from..until).contains(n)).collect();
    rungs.push(until);
    rungs
}

/// Tells the time by which costs are compared, from any start: that of the process's processors, which other
/// programs don't take from.
pub type Clock = fn() -> Result<Duration>;

impl Reference<'_> {
    /// Traces one point set (R = 1: one set of N points, METHOD 7) and takes its errors against this
    /// reference at every rung of the ladder, which rises; `None` after an interrupt.
    ///
    /// The first N points of a sequence are a set of their own, so that one pass serves every rung; a
    /// sequence that must know N is traced anew for each.
    ///
    /// # Errors
    /// A sequence that cannot have this many points; a clock that cannot be read.
    pub fn measure(
        &self,
        algorithm: Algorithm,
        seed: u64,
        ladder: &[u64],
        clock: Clock,
        interrupt: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Option<Vec<Run>>> {
        let scene = self.grids.scene;
        let mut receivers = Receivers::new(&scene.geometry, &self.grids.receivers);
        let longest = ladder.last().copied().unwrap_or(0);
        let mut tracer = Tracer::new(scene, algorithm, seed, 0, longest);
        let (mut so_far, mut cpu_s) = (Traced::new(scene), 0.0);
        let mut runs = Vec::new();
        for &photons in ladder {
            if algorithm.sequence.needs_number() {
                receivers.clear();
                (so_far, cpu_s) = (Traced::new(scene), 0.0);
                tracer = Tracer::new(scene, algorithm, seed, 0, photons);
            }
            let started = clock()?;
            let traced = tracer.trace(photons, &receivers, interrupt, progress)?;
            cpu_s += clock()?.saturating_sub(started).as_secs_f64();
            so_far.merge(&traced);
            if !so_far.complete {
                return Ok(None);
            }
            let counts = (0..self.grids.receivers.len()).flat_map(|i| receivers.counts(i).iter());
            runs.push(Run {
                seed,
                photons,
                cpu_s,
                coordinates_mean: so_far.census.dimension_mean(),
                coordinates_max: u64::from(so_far.census.dimension_max),
                errors: self.errors(counts, scene.emitters.flux_lm() / photons as f64)?,
            });
        }
        Ok(Some(runs))
    }
}
