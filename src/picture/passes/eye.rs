//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! A pass is of whole replicates or of a part of one, whose partial sum then stays open: the standard error
//! comes from whole ones.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::error::Result;
use crate::picture::Watch;
use crate::picture::camera::{Film, Pass, Sums, View, render};
use crate::picture::gather::footprint::Footprints;
use crate::picture::gather::{Choice, Density, bandwidth};
use crate::picture::photon_map::{Frame, Kept, Photon, PhotonMap};
use crate::picture::summary::Chosen;
use crate::run::Plan;
use crate::scene::Scene;
use crate::scene::camera::{Bandwidth, Camera};

/// The bandwidth of a density, chosen once: from the first pass that has photons of it.
#[derive(Debug, Clone, Copy)]
struct Settled {
    bandwidth: Bandwidth,
    chosen: Chosen,
}

/// Fewest neighbours in a pass: of k nearest the relative variance is 1 / (k - 2).
const FEWEST_IN_PASS: u32 = 16;

/// The photons of a pass.
pub(crate) struct Batch<const C: usize> {
    /// Photons that were not scattered before, and those that were.
    pub(crate) photons: Kept<C>,
    /// What positions are counted in.
    pub(crate) frame: Frame,
    /// Flux of one of them, lm: that of the whole run.
    pub(crate) photon_lm: f64,
    /// Which part of the run's photons this is.
    pub(crate) part: f64,
    /// The replicates they are of: whole ones, or a part of one.
    pub(crate) replicates: Range<u32>,
    /// Whether these replicates end with this pass.
    pub(crate) finishes: bool,
    /// Whether it is the last pass, in which light that no photon brings is seen as well.
    pub(crate) last: bool,
}

/// What the camera saw in all.
pub(crate) struct Seeing<const C: usize> {
    pub(crate) film: Film<C>,
    /// Eye paths that did not end by themselves.
    pub(crate) killed: u64,
    /// Pixels that an interrupt left unseen.
    pub(crate) unseen: u64,
    /// Bandwidths of light that no surface scattered before, and of all other.
    pub(crate) bandwidths: [Chosen; 2],
}

/// The camera at work.
pub(crate) struct Eye<'a, const C: usize> {
    pub(crate) view: View<'a>,
    watch: Watch<'a>,
    killed: u64,
    unseen: u64,
    footprints: Arc<Footprints<'a>>,
    sums: Sums<C>,
    /// Replicates of the run as planned.
    replicates: u32,
    bandwidths: [Option<Settled>; 2],
}

impl<'a, const C: usize> Eye<'a, C> {
    /// The camera of a scene.
    ///
    /// # Errors
    /// A camera that cannot see; a picture that takes too much memory.
    pub(crate) fn new(scene: &'a Scene, camera: &Camera, plan: &Plan, watch: Watch<'a>) -> Result<Self> {
        Ok(Self {
            view: View::new(scene, camera, plan.seed())?,
            watch,
            killed: 0,
            unseen: 0,
            footprints: Arc::new(Footprints::new(&scene.geometry)),
            sums: Sums::new(camera.pixels)?,
            replicates: plan.replicates(),
            bandwidths: [None; 2],
        })
    }

    /// The bandwidth for a map, `part` of the photons that there will be, which are of so many replicates;
    /// `None` where there is nothing to choose from.
    fn choose(&self, map: &PhotonMap<C>, part: f64, replicates: u32) -> Option<Settled> {
        let camera = &self.view.camera;
        let mut bandwidth = camera.bandwidth;
        let mut chosen = Chosen { radius_m: None, neighbours: None };
        match bandwidth {
            Bandwidth::Automatic if map.photons().is_empty() => return None,
            Bandwidth::Automatic => {
                let found = bandwidth::choose(&self.footprints, map, camera.kernel, replicates, part);
                bandwidth = found.bandwidth();
                chosen.radius_m = Some(found.radius_m);
                chosen.neighbours = Some(found.mean_neighbours / part).filter(|n| n.is_finite());
            }
            Bandwidth::Radius(radius_m)
            | Bandwidth::Progressive(radius_m)
            | Bandwidth::AtLeast { radius_m, .. } => chosen.radius_m = Some(radius_m),
            Bandwidth::Nearest(n) => chosen.neighbours = Some(f64::from(n)),
        }
        Some(Settled { bandwidth, chosen })
    }

    /// The radius that a map of photons is sorted for, m: that of the bandwidth if it is known.
    fn radius_to_sort_for_m(&self, settled: Option<Settled>) -> f64 {
        match settled.map_or(self.view.camera.bandwidth, |s| s.bandwidth) {
            Bandwidth::Radius(radius_m)
            | Bandwidth::Progressive(radius_m)
            | Bandwidth::AtLeast { radius_m, .. } => radius_m,
            // For a guess from the number of photons.
            Bandwidth::Automatic | Bandwidth::Nearest(_) => 0.0,
        }
    }

    /// The map of a batch's photons sorted for the bandwidth of their density, which they settle if nothing
    /// has.
    fn map_of(&mut self, density: usize, photons: Vec<Photon<C>>, batch: &Batch<C>) -> PhotonMap<C> {
        let settled = self.bandwidths[density];
        let radius_m = self.radius_to_sort_for_m(settled);
        let map = PhotonMap::build(photons, batch.frame, radius_m);
        if settled.is_some() {
            return map;
        }
        self.bandwidths[density] = self.choose(&map, batch.part, batch.replicates.len() as u32);
        let wanted_m = self.radius_to_sort_for_m(self.bandwidths[density]);
        if wanted_m > 0.0 && wanted_m != radius_m { map.rebuilt(wanted_m) } else { map }
    }

    /// Adds what is seen of a batch, and gives its photons as they were mapped.
    pub(crate) fn add(&mut self, mut batch: Batch<C>) -> Result<[PhotonMap<C>; 2]> {
        let [caustic, diffuse] = std::mem::take(&mut batch.photons);
        let caustic = self.map_of(0, joined(caustic), &batch);
        let maps = [caustic, self.map_of(1, joined(diffuse), &batch)];
        // The neighbours of a pass are a part of those of the run.
        let of_pass = |n: u32| ((f64::from(n) * batch.part + 0.5) as u32).max(FEWEST_IN_PASS.min(n));
        let density = |map, settled: Settled| {
            let bandwidth = match settled.bandwidth {
                Bandwidth::Nearest(n) => Bandwidth::Nearest(of_pass(n)),
                Bandwidth::AtLeast { radius_m, neighbours } => {
                    Bandwidth::AtLeast { radius_m, neighbours: of_pass(neighbours) }
                }
                other => other,
            };
            let choice = Choice { bandwidth, kernel: self.view.camera.kernel, replicates: self.replicates };
            Density::new(Arc::clone(&self.footprints), map, batch.photon_lm, choice)
        };
        let with_photons = maps.iter().zip(self.bandwidths).filter(|(map, _)| !map.photons().is_empty());
        let densities: Vec<Density<'_, C>> =
            with_photons.filter_map(|(map, settled)| Some(density(map, settled?))).collect();
        let pass = Pass {
            densities: &densities,
            replicates: batch.replicates,
            finishes: batch.finishes,
            emission: batch.last,
            direct: batch.last,
        };
        self.look(&pass, batch.last)?;
        Ok(maps)
    }

    /// Adds emitters and background as seen directly, by mirrors and through glass, without light on
    /// surfaces.
    pub(crate) fn add_emitters(&mut self) -> Result<()> {
        self.look(&Pass::EMISSION, true)
    }

    /// Takes all photons so far for this many times their flux.
    pub(crate) fn scale(&mut self, factor: f64) {
        self.sums.scale(factor);
    }

    /// Takes back what is seen of a replicate that is not finished.
    pub(crate) fn drop_unfinished(&mut self) {
        self.sums.drop_unfinished();
    }

    /// Ctrl-C while tracing: stop tracing, render what has been traced. Ctrl-C while rendering the last pass:
    /// stop.
    fn look(&mut self, pass: &Pass<'_, C>, last: bool) -> Result<()> {
        let [columns, rows] = self.sums.pixels().map(u64::from);
        let done = AtomicU64::new(0);
        let tell = |pixels: u64| {
            let before = done.fetch_add(pixels, Ordering::Relaxed);
            (self.watch.camera)((before + pixels) as f64 / (columns * rows) as f64);
        };
        let never = AtomicBool::new(false);
        let was_interrupted = self.watch.interrupt.load(Ordering::Relaxed);
        let interrupt = if was_interrupted || !last { &never } else { self.watch.interrupt };
        let rendered = render(&self.view, pass, &mut self.sums, interrupt, &tell)?;
        // The eye's paths are the same in every pass.
        self.killed = rendered.killed;
        self.unseen = rendered.unseen;
        Ok(())
    }

    /// The film, and what is to be said of it.
    pub(crate) fn finish(self) -> Seeing<C> {
        let bandwidths = self.bandwidths.map(|b| b.map_or(Chosen::default(), |settled| settled.chosen));
        Seeing { film: self.sums.finish(), killed: self.killed, unseen: self.unseen, bandwidths }
    }
}

/// Blocks one after another; each is dropped when it is copied.
fn joined<const C: usize>(blocks: Vec<Vec<Photon<C>>>) -> Vec<Photon<C>> {
    let mut all = Vec::with_capacity(blocks.iter().map(Vec::len).sum());
    for block in blocks {
        all.extend_from_slice(&block);
    }
    all
}
