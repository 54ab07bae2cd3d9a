//! The reference that errors are measured against (METHOD 6).
//!
//! It shares as little as possible with what is measured: another sequence (Halton points under a rotation),
//! another emission map (directions uniform in solid angle, weighted by the intensity) and another seed. Its
//! own error comes from independent replicates.

use std::ops::Range;
use std::sync::atomic::AtomicBool;

use crate::emitter::{Emits, Emitter};
use crate::error::{Diagnostic, Kind, Result};
use crate::run::tracer::PointSet;
use crate::sample::method::Sampling;
use crate::scene::Scene;
use crate::sequence::Sequence;
use crate::surface::{Grey, Rgb};
use crate::tally::Receivers;
use crate::transport::parallel::{How, trace_range};

use super::cells::{Grids, areas_m2};
use super::norms::{Errors, moments, nrms_of_mean};

/// Replicates of a reference: 7 degrees of freedom for its error.
pub const REPLICATES: u32 = 8;
/// Most photons of a reference: 2^32 in a replicate, so that weights in fixed point keep 16 bits behind the
/// point.
pub const MOST_REFERENCE_PHOTONS: u64 = REPLICATES as u64 * (1 << 32);
/// Headroom of the fixed-point sums: light that comes back to one cell up to 2^16 times.
const HEADROOM_BITS: u32 = 16;
/// Point sequence of references.
pub const SEQUENCE: Sequence = Sequence::HaltonRotation;
/// Seed of references, unless a run has it.
const SEED: u64 = 0x7265_6665_7265_6e63;

/// What a reference is made of: 2^m Halton points in each of `REPLICATES` rotations.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ReferencePlan {
    /// Seed of the rotations.
    pub(crate) seed: u64,
    /// 2^m.
    pub(crate) photons_per_replicate: u64,
}

impl ReferencePlan {
    /// A reference of at least `photons` in all, under a seed that is none of `seeds`, those of the runs.
    ///
    /// # Errors
    /// No photons, and more than `MOST_REFERENCE_PHOTONS`.
    pub fn new(photons: u64, seeds: &[u64]) -> Result<Self> {
        if !(1..=MOST_REFERENCE_PHOTONS).contains(&photons) {
            let found = format!("{photons} reference photons");
            return Err(Diagnostic::new(Kind::Range, found, "1 to 2^35 reference photons"));
        }
        let photons_per_replicate = photons.div_ceil(u64::from(REPLICATES)).next_power_of_two();
        // The same for the same runs.
        let seed = (0..).map(|k| SEED.wrapping_add(k)).find(|seed| !seeds.contains(seed)).unwrap_or(SEED);
        Ok(Self { seed, photons_per_replicate })
    }

    /// Photons in all.
    pub fn photons(&self) -> u64 {
        self.photons_per_replicate * u64::from(REPLICATES)
    }

    /// Fixed-point units of a photon of weight 1.
    fn units_per_photon(&self) -> f64 {
        (1u64 << (64 - HEADROOM_BITS - self.photons_per_replicate.trailing_zeros())) as f64
    }
}

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

/// Fixed-point sums of one replicate of a reference, cell by cell over all grids; `None` after an interrupt.
///
/// # Errors
/// A sequence that cannot have this many points.
pub fn trace_replicate(
    grids: &Grids<'_>,
    plan: &ReferencePlan,
    replicate: u32,
    interrupt: &AtomicBool,
    progress: &(dyn Fn(u64) + Sync),
) -> Result<Option<Vec<u64>>> {
    let (scene, number) = (grids.scene, plan.photons_per_replicate);
    let receivers = Receivers::new(&scene.geometry, &grids.receivers);
    let points = PointSet { sequence: SEQUENCE, seed: plan.seed, replicate, number }.any()?;
    let emitters = scene.emitters.with_weights()?;
    let how = How { reuse: true, sampling: Sampling::default(), interrupt, progress };
    let range = 0..number;
    let sink = || receivers.fixed_point_sink(plan.units_per_photon());
    let traced = if scene.is_coloured() {
        trace_range(scene, &emitters, &points, range, Rgb::WHITE, how, sink)
    } else {
        trace_range(scene, &emitters, &points, range, Grey, how, sink)
    };
    let counts = (0..grids.receivers.len()).flat_map(|i| receivers.counts(i).iter());
    Ok(traced.complete.then(|| counts.collect()))
}

/// The illuminance of every cell of all grids, and what tells its spread over replicates.
#[derive(Debug)]
pub struct Reference<'g> {
    pub(super) grids: &'g Grids<'g>,
    areas_m2: Vec<f64>,
    illuminance_lx: Vec<f64>,
    own_nrms: Vec<f64>,
}

impl<'g> Reference<'g> {
    /// From the fixed-point sums of all replicates.
    ///
    /// # Errors
    /// Sums of another number of cells than the grids have.
    pub fn new(grids: &'g Grids<'g>, plan: &ReferencePlan, replicates: &[Vec<u64>]) -> Result<Self> {
        let cells = grids.cell_count();
        if let Some(bad) = replicates.iter().find(|sums| sums.len() != cells) {
            let found = format!("a replicate of {} cells", bad.len());
            return Err(Diagnostic::new(Kind::Range, found, format!("{cells} cells")));
        }
        let photon_lm = grids.scene.emitters.flux_lm() / plan.photons_per_replicate as f64;
        let unit_lm = photon_lm / plan.units_per_photon();
        let areas_m2 = areas_m2(&grids.receivers);
        let r = replicates.len();
        let lx =
            |replicate: usize, cell: usize| replicates[replicate][cell] as f64 * unit_lm / areas_m2[cell];
        let [sum, square] = moments(cells, r, lx);
        let own = |cells: Range<usize>| {
            nrms_of_mean(&sum[cells.clone()], &square[cells.clone()], &areas_m2[cells], r).unwrap_or(f64::NAN)
        };
        let own_nrms = grids.cell_ranges().map(own).collect();
        let illuminance_lx = sum.iter().map(|sum| sum / r as f64).collect();
        Ok(Self { grids, areas_m2, illuminance_lx, own_nrms })
    }

    /// Mean over the replicates, lx, cell by cell over all grids.
    pub fn illuminance_lx(&self) -> &[f64] {
        &self.illuminance_lx
    }

    /// nRMS to expect of that mean against the truth, grid by grid; NaN where it is unknown.
    pub fn own_nrms(&self) -> &[f64] {
        &self.own_nrms
    }

    /// Errors of a map by photons of `photon_lm` each, grid by grid, from its counts over all grids.
    pub(super) fn errors(&self, counts: impl Iterator<Item = u64>, photon_lm: f64) -> Result<Vec<Errors>> {
        let areas_m2 = &self.areas_m2;
        let lx: Vec<f64> = counts.zip(areas_m2).map(|(n, area)| n as f64 * photon_lm / area).collect();
        let of = |cells: Range<usize>| {
            Errors::of(&lx[cells.clone()], &self.illuminance_lx[cells.clone()], &areas_m2[cells])
        };
        self.grids.cell_ranges().map(of).collect()
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_plan_is_of_powers_of_two_and_of_a_seed_of_its_own() {
        let plan = |photons, seeds: &[u64]| ReferencePlan::new(photons, seeds);
        for (photons, each) in [(1, 1), (8, 1), (9, 2), (100, 16), (1 << 35, 1 << 32)] {
            let plan = plan(photons, &[1]).unwrap();
            assert_eq!((plan.photons_per_replicate, plan.photons()), (each, 8 * each));
            // Of a weight of 1 in every photon 2^16 times the sum still fits 64 bits; 16 bits are behind the
            // point.
            assert_eq!(plan.units_per_photon() * each as f64, (1u64 << 48) as f64);
        }
        assert!(plan(0, &[]).is_err() && plan((1 << 35) + 1, &[]).is_err() && plan(u64::MAX, &[]).is_err());
        assert_eq!(plan(1, &[SEED + 1]).unwrap().seed, SEED);
        assert_eq!(plan(1, &[SEED + 1, SEED]).unwrap().seed, SEED + 2);
    }
}
