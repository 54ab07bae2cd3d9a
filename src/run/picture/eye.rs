//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! A pass is of whole replicates or of a part of one, whose partial sum then stays open: the standard error comes from whole
//! ones.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::camera::{Film, Pass, Sums, View, render};
use crate::error::{Diagnostic, Kind, Result};
use crate::estimate::bandwidth;
use crate::estimate::density::{Choice, Density};
use crate::estimate::footprint::Footprints;
use crate::scene::Scene;
use crate::scene::camera::{Bandwidth, CameraSpec, FEWEST_NEIGHBOURS};
use crate::tally::photon_map::PhotonMap;

use super::super::plan::Plan;
use super::Watch;
use super::summary::Chosen;

/// The bandwidths of both densities, chosen once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bandwidths {
    of: [Bandwidth; 2],
    chosen: [Chosen; 2],
}

impl Bandwidths {
    pub(super) fn chosen(&self) -> [Chosen; 2] {
        self.chosen
    }
}

/// What the camera sees in a pass.
pub(super) struct Seen<'m, const C: usize> {
    /// Photons that were not scattered before, and those that were.
    pub(super) maps: &'m [PhotonMap<C>; 2],
    /// Flux of one of them, lm: that of the whole run.
    pub(super) photon_lm: f64,
    pub(super) bandwidths: Bandwidths,
    /// Which part of the run's photons this is.
    pub(super) part: f64,
    /// The replicates they are of: whole ones, or a part of one.
    pub(super) replicates: Range<u32>,
    /// Whether these replicates end with this pass.
    pub(super) finishes: bool,
    /// Whether it is the last pass, in which light that no photon brings is seen as well.
    pub(super) last: bool,
}

/// The camera at work. What was traced when an interrupt came is seen; one that comes while the camera looks ends it.
pub(super) struct Eye<'a, const C: usize> {
    view: View<'a>,
    spec: &'a CameraSpec,
    watch: Watch<'a>,
    killed: u64,
    footprints: Arc<Footprints<'a>>,
    sums: Sums<C>,
    replicates: u32,
}

impl<'a, const C: usize> Eye<'a, C> {
    /// The camera of a scene.
    ///
    /// # Errors
    /// A camera that cannot see; a picture that takes too much memory.
    pub(super) fn new(scene: &'a Scene, spec: &'a CameraSpec, plan: &Plan, watch: Watch<'a>) -> Result<Self> {
        Ok(Self {
            view: View::new(scene, spec, plan.seed)?,
            spec,
            watch,
            killed: 0,
            footprints: Arc::new(Footprints::new(&scene.geometry)),
            sums: Sums::new(spec.pixels)?,
            replicates: plan.replicates,
        })
    }

    /// Bandwidths from the photons of the first pass, `part` of all.
    pub(super) fn choose(&self, maps: &[PhotonMap<C>; 2], part: f64) -> Bandwidths {
        let mut of = [self.spec.bandwidth; 2];
        let mut chosen = [Chosen { radius_m: None, neighbours: None }; 2];
        for k in 0..2 {
            match self.spec.bandwidth {
                // Of no photons there is nothing to choose.
                Bandwidth::Automatic if maps[k].photons().is_empty() => {}
                Bandwidth::Automatic => {
                    let kernel = self.spec.kernel;
                    let found = bandwidth::choose(&self.footprints, &maps[k], kernel, self.replicates, part);
                    of[k] = Bandwidth::AtLeast { radius_m: found.radius_m, neighbours: FEWEST_NEIGHBOURS };
                    let neighbours = Some(found.mean_neighbours / part).filter(|n| n.is_finite());
                    chosen[k] = Chosen { radius_m: Some(found.radius_m), neighbours };
                }
                Bandwidth::Radius(radius_m)
                | Bandwidth::Progressive(radius_m)
                | Bandwidth::AtLeast { radius_m, .. } => {
                    chosen[k].radius_m = Some(radius_m);
                }
                Bandwidth::Nearest(n) => chosen[k].neighbours = Some(f64::from(n)),
            }
        }
        Bandwidths { of, chosen }
    }

    /// A map of photons, sorted for the bandwidth if that is known: `density` 0 or 1.
    pub(super) fn radius_to_sort_for_m(&self, chosen: Option<&Bandwidths>, density: usize) -> f64 {
        match chosen.map_or(self.spec.bandwidth, |b| b.of[density]) {
            Bandwidth::Radius(radius_m)
            | Bandwidth::Progressive(radius_m)
            | Bandwidth::AtLeast { radius_m, .. } => radius_m,
            // For a guess from the number of photons.
            Bandwidth::Automatic | Bandwidth::Nearest(_) => 0.0,
        }
    }

    /// Adds what is seen in a pass.
    pub(super) fn add(&mut self, seen: &Seen<'_, C>) -> Result<()> {
        // The neighbours of a pass are a part of those of the run; two are the fewest that have a density.
        let of_pass = |n: u32| ((f64::from(n) * seen.part + 0.5) as u32).max(2);
        let density = |k: usize| {
            let bandwidth = match seen.bandwidths.of[k] {
                Bandwidth::Nearest(n) => Bandwidth::Nearest(of_pass(n)),
                Bandwidth::AtLeast { radius_m, neighbours } => {
                    Bandwidth::AtLeast { radius_m, neighbours: of_pass(neighbours) }
                }
                other => other,
            };
            let choice = Choice { bandwidth, kernel: self.spec.kernel, replicates: self.replicates };
            Density::on(Arc::clone(&self.footprints), &seen.maps[k], seen.photon_lm, choice)
        };
        let with_photons = |k: &usize| !seen.maps[*k].photons().is_empty();
        let densities: Vec<Density<'_, C>> = (0..2).filter(with_photons).map(density).collect();
        let pass = Pass {
            densities: &densities,
            replicates: seen.replicates.clone(),
            finishes: seen.finishes,
            emission: seen.last,
            direct: seen.last,
        };
        self.look(&pass)
    }

    /// Adds emitters and background as seen directly, by mirrors and through glass, without light on surfaces.
    pub(super) fn add_emitters(&mut self) -> Result<()> {
        self.look(&Pass::emission())
    }

    /// Takes all photons so far for this many times their flux.
    pub(super) fn scale(&mut self, factor: f64) {
        self.sums.scale(factor);
    }

    fn look(&mut self, pass: &Pass<'_, C>) -> Result<()> {
        let [columns, rows] = self.sums.pixels().map(u64::from);
        let done = AtomicU64::new(0);
        let tell = |pixels: u64| {
            let before = done.fetch_add(pixels, Ordering::Relaxed);
            (self.watch.camera)((before + pixels) as f64 / (columns * rows) as f64);
        };
        let never = AtomicBool::new(false);
        let was_interrupted = self.watch.interrupt.load(Ordering::Relaxed);
        let interrupt = if was_interrupted { &never } else { self.watch.interrupt };
        let rendered = render(&self.view, pass, &mut self.sums, interrupt, &tell)?;
        self.killed += rendered.killed;
        if rendered.complete {
            return Ok(());
        }
        let required = "all pixels: a part of them is no picture";
        Err(Diagnostic::new(Kind::Interrupted, "an interrupt before the picture was finished", required))
    }

    /// The film, and the number of eye paths that did not end by themselves.
    pub(super) fn finish(self) -> (Film<C>, u64) {
        (self.sums.finish(), self.killed)
    }
}
