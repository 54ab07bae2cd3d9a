//! The reference that errors are measured against (METHOD 6).
//!
//! It shares as little as possible with what is measured: another sequence (Halton points under a rotation), another
//! emission map (directions uniform in solid angle, weighted by the intensity) and another seed. Its own error comes from
//! independent replicates.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use crate::emitter::{Emits, Emitter, Emitters};
use crate::error::{Diagnostic, Kind, Result};
use crate::run::tracer::PointSet;
use crate::sample::method::Sampling;
use crate::scene::Scene;
use crate::sequence::{Points, Sequence};
use crate::surface::{Grey, Rgb};
use crate::tally::Receivers;
use crate::transport::parallel::{How, trace_range};

use crate::lab::study::cells::Grids;
use crate::lab::study::norms::nrms_of_mean;

/// Replicates of a reference: 7 degrees of freedom for its error.
pub const REPLICATES: u32 = 8;
/// Most photons of one replicate, so that weights in fixed point keep 16 bits behind the point.
pub const MOST_PHOTONS_PER_REPLICATE: u64 = 1 << 32;
/// Headroom of the fixed-point sums: light that comes back to one cell up to 2^16 times.
const HEADROOM_BITS: u32 = 16;

/// What a reference is made of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReferencePlan {
    /// Point sequence; randomised.
    pub sequence: Sequence,
    /// Seed; not one of those measured.
    pub seed: u64,
    /// Photons of each of the [`REPLICATES`].
    pub photons_per_replicate: u64,
}

impl ReferencePlan {
    /// A reference of at least `photons` in all, for runs with these seeds.
    ///
    /// # Errors
    /// No photons, and more than [`MOST_PHOTONS_PER_REPLICATE`] a replicate.
    pub fn new(photons: u64, seeds: &[u64]) -> Result<Self> {
        let share = photons.div_ceil(u64::from(REPLICATES)).max(1);
        let photons_per_replicate = share.checked_next_power_of_two().unwrap_or(u64::MAX);
        if photons == 0 || photons_per_replicate > MOST_PHOTONS_PER_REPLICATE {
            return Err(Diagnostic::new(
                Kind::Range,
                format!("{photons} reference photons"),
                "1 to 2^35 reference photons",
            ));
        }
        // A seed that no run has, the same for the same runs.
        let mut seed = 0x7265_6665_7265_6e63u64;
        while seeds.contains(&seed) {
            seed = seed.wrapping_add(1);
        }
        Ok(Self { sequence: SEQUENCE, seed, photons_per_replicate })
    }

    /// Photons in all.
    pub fn photons(&self) -> u64 {
        self.photons_per_replicate * u64::from(REPLICATES)
    }

    /// Fixed-point units of a photon of weight 1.
    fn units_per_photon(&self) -> f64 {
        let bits = 64 - HEADROOM_BITS - self.photons_per_replicate.next_power_of_two().trailing_zeros();
        (1u64 << bits) as f64
    }
}

/// Most photons of a reference.
pub const MOST_REFERENCE_PHOTONS: u64 = MOST_PHOTONS_PER_REPLICATE * REPLICATES as u64;

/// Emission map of the reference of a scene, in words: only tables have two.
pub fn emission_map(scene: &Scene) -> &'static str {
    let is_table = |e: &Emitter| e.table().is_some();
    let emitters = scene.emitters.as_slice();
    if emitters.iter().all(is_table) {
        "directions uniform in solid angle (over the cells that emit), weighted by the intensity"
    } else if emitters.iter().any(is_table) {
        "of tables: directions uniform in solid angle, weighted by the intensity; of other emitters: the map under test"
    } else {
        "the map under test (no emitter has a table)"
    }
}

/// Sequence of references.
const SEQUENCE: Sequence = Sequence::HaltonRotation;

/// Fixed-point sums of one replicate of a reference, cell by cell over all grids; `None` after an interrupt.
///
/// # Errors
/// A sequence that cannot have this many points.
pub fn trace_replicate(
    scene: &Scene,
    grids: &Grids,
    plan: &ReferencePlan,
    replicate: u32,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Option<Vec<u64>>> {
    let receivers = Receivers::new(&scene.geometry, &grids.receivers);
    let how = How { reuse: true, sampling: Sampling::default(), interrupt, progress };
    let points =
        PointSet { sequence: plan.sequence, seed: plan.seed, replicate, number: plan.photons_per_replicate };
    let complete = Replicate {
        scene,
        emitters: scene.emitters.with_weights()?,
        receivers: &receivers,
        how,
        photons: plan.photons_per_replicate,
        units: plan.units_per_photon(),
    }
    .trace(&points.any()?);
    let counts = (0..grids.receivers.len()).flat_map(|i| receivers.counts(i).iter());
    Ok(complete.then(|| counts.collect()))
}

struct Replicate<'a, 's> {
    scene: &'s Scene,
    emitters: Emitters,
    receivers: &'a Receivers<'s>,
    how: How<'a>,
    photons: u64,
    units: f64,
}

impl Replicate<'_, '_> {
    fn trace<P: Points>(self, points: &P) -> bool {
        let sink = || self.receivers.fixed_point_sink(self.units);
        let Self { scene, emitters, how, .. } = &self;
        if scene.is_coloured() {
            trace_range(scene, emitters, points, 0..self.photons, Rgb::WHITE, *how, sink).complete
        } else {
            trace_range(scene, emitters, points, 0..self.photons, Grey, *how, sink).complete
        }
    }
}

/// The illuminance of every cell of all grids, and what tells its spread over replicates.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Mean over replicates, lx.
    pub illuminance_lx: Vec<f64>,
    /// nRMS to expect of that mean against the truth, grid by grid.
    pub own_nrms: Vec<f64>,
}

impl Reference {
    /// From the fixed-point sums of all replicates.
    pub fn new(scene: &Scene, grids: &Grids, plan: &ReferencePlan, replicates: &[Vec<u64>]) -> Self {
        let photon_lm = scene.emitters.flux_lm() / plan.photons_per_replicate as f64;
        let unit_lm = photon_lm / plan.units_per_photon();
        let areas_m2 = grids.areas_m2();
        let (mut sum_lx, mut square_lx2) = (Vec::new(), Vec::new());
        for (cell, area_m2) in areas_m2.iter().enumerate() {
            let lx = |counts: &Vec<u64>| counts[cell] as f64 * unit_lm / area_m2;
            sum_lx.push(replicates.iter().map(lx).sum::<f64>());
            square_lx2.push(replicates.iter().map(|counts| lx(counts) * lx(counts)).sum::<f64>());
        }
        let r = replicates.len() as u32;
        let own = |cells: Range<usize>| {
            nrms_of_mean(&sum_lx[cells.clone()], &square_lx2[cells.clone()], &areas_m2[cells], r)
        };
        let own_nrms = grids.cell_ranges().into_iter().map(|cells| own(cells).unwrap_or(f64::NAN)).collect();
        Self { illuminance_lx: sum_lx.iter().map(|sum| sum / f64::from(r)).collect(), own_nrms }
    }
}
