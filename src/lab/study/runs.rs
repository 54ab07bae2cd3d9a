//! One point set of one algorithm: its errors and costs at every number of photons of a ladder.

use std::ops::Range;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use crate::error::Result;
use crate::run::Algorithm;
use crate::run::tracer::Tracer;
use crate::scene::Scene;
use crate::tally::Receivers;
use crate::transport::parallel::Traced;

use crate::lab::study::cells::Grids;
use crate::lab::study::norms::Errors;
use crate::lab::study::reference::Reference;
use crate::lab::study::results::Run;

/// Photons that a ladder starts with where none is named: 256 below the largest, a square of the noise's fall.
pub const LADDER_OCTAVES: u32 = 8;

/// The numbers of photons at which errors are taken: powers of two from `from` to `until`, and `until` itself.
pub fn ladder(from: u64, until: u64) -> Vec<u64> {
    let mut rungs: Vec<u64> = (0..64).map(|m| 1u64 << m).filter(|n| (from..=until).contains(n)).collect();
    if rungs.last() != Some(&until) {
        rungs.push(until);
    }
    rungs
}

/// Tells the time by which costs are compared, from any start: that of the process's processors, which other programs don't
/// take from.
pub type Clock = fn() -> Result<Duration>;

/// What runs are measured on.
#[derive(Debug, Clone, Copy)]
pub struct Measure<'a> {
    /// The scene.
    pub scene: &'a Scene,
    /// Its receivers in grids.
    pub grids: &'a Grids,
    /// What errors are against.
    pub reference: &'a Reference,
    /// What costs are measured by.
    pub clock: Clock,
}

impl Measure<'_> {
    /// Traces one point set (R = 1: one set of N points, METHOD 7) and takes its errors at every rung of the ladder; `None`
    /// after an interrupt.
    ///
    /// The first N points of a sequence are a set of their own, so that one pass serves every rung; a sequence that must
    /// know N is traced anew for each.
    ///
    /// # Errors
    /// A sequence that cannot have this many points; a clock that cannot be read.
    pub fn ladder(
        &self,
        algorithm: Algorithm,
        seed: u64,
        ladder: &[u64],
        interrupt: &AtomicBool,
        progress: &(dyn Fn(u64) + Sync),
    ) -> Result<Option<Vec<Run>>> {
        let scene = self.scene;
        let mut receivers = Receivers::new(&scene.geometry, &self.grids.receivers);
        let longest = ladder.last().copied().unwrap_or(0);
        let anew = algorithm.sequence.needs_number();
        let mut tracer = Tracer::new(scene, algorithm, seed, 0, longest);
        let (mut so_far, mut cpu_s) = (Traced::new(scene), 0.0);
        let mut runs = Vec::new();
        for &photons in ladder {
            if anew {
                receivers.clear();
                (so_far, cpu_s) = (Traced::new(scene), 0.0);
                tracer = Tracer::new(scene, algorithm, seed, 0, photons);
            }
            let started = (self.clock)()?;
            let traced = tracer.trace(photons, &receivers, interrupt, progress)?;
            cpu_s += (self.clock)()?.saturating_sub(started).as_secs_f64();
            so_far.merge(&traced);
            if !so_far.complete {
                return Ok(None);
            }
            runs.push(Run {
                seed,
                photons,
                cpu_s,
                coordinates_mean: so_far.census.dimension_mean(),
                coordinates_max: u64::from(so_far.census.dimension_max),
                errors: self.errors(&receivers, photons)?,
            });
        }
        Ok(Some(runs))
    }

    fn errors(&self, receivers: &Receivers<'_>, photons: u64) -> Result<Vec<Errors>> {
        let photon_lm = self.scene.emitters.flux_lm() / photons as f64;
        let areas_m2 = self.grids.areas_m2();
        let reference_lx = &self.reference.illuminance_lx;
        let counts = (0..self.grids.receivers.len()).flat_map(|i| receivers.counts(i).iter());
        let lx: Vec<f64> = counts.zip(&areas_m2).map(|(n, area)| n as f64 * photon_lm / area).collect();
        let of = |cells: Range<usize>| {
            Errors::of(&lx[cells.clone()], &reference_lx[cells.clone()], &areas_m2[cells])
        };
        self.grids.cell_ranges().into_iter().map(of).collect()
    }
}
