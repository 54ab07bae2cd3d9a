//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! The partial sums over replicates, from which the standard error comes, must be those of whole replicates. Passes come
//! in the order of the replicates and may end in the middle of one, so its partial sum stays open until photons of a later
//! one are seen.

use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use crate::camera::film::Sums;
use crate::camera::render::{Pass, render};
use crate::camera::{Film, View};
use crate::error::{Diagnostic, Kind, Result};
use crate::estimate::bandwidth;
use crate::estimate::density::{Choice, Density};
use crate::estimate::footprint::Footprints;
use crate::scene::Scene;
use crate::scene::camera::{Bandwidth, CameraSpec};
use crate::tally::photon_map::{Frame, Photon, PhotonMap};

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

    /// The maps sorted for these bandwidths.
    pub(super) fn sorted<const C: usize>(&self, maps: [PhotonMap<C>; 2]) -> [PhotonMap<C>; 2] {
        let mut kinds = 0..;
        maps.map(|map| match self.search_radius_m(kinds.next().unwrap_or(0)) {
            radius if radius > 0.0 && radius != map.built_for_m() => map.rebuilt(radius),
            _ => map,
        })
    }

    /// The radius for which a map of one kind is to be sorted, m; 0 where the map may guess.
    fn search_radius_m(&self, kind: usize) -> f64 {
        match self.of[kind] {
            Bandwidth::Radius(radius) | Bandwidth::Progressive(radius) => radius,
            Bandwidth::Nearest(_) | Bandwidth::Automatic => 0.0,
        }
    }
}

/// What the camera sees in a pass.
pub(super) struct Seen<'m, const C: usize> {
    /// Photons that were not scattered before, and those that were.
    pub(super) maps: &'m [PhotonMap<C>; 2],
    /// Flux of one of them, lm: that of the whole run.
    pub(super) photon_lm: f64,
    pub(super) bandwidths: Bandwidths,
    /// The replicates they are of; the first may have had photons in the pass before.
    pub(super) replicates: Range<u32>,
    /// Whether these replicates end with this pass.
    pub(super) finishes: bool,
    /// Whether it is the last pass, in which light that no photon brings is seen as well.
    pub(super) last: bool,
}

/// The camera at work.
pub(super) struct Eye<'a, const C: usize> {
    view: View<'a>,
    footprints: Arc<Footprints<'a>>,
    watch: Watch<'a>,
    replicates: u32,
    sums: Sums<C>,
    killed: u64,
}

impl<'a, const C: usize> Eye<'a, C> {
    pub(super) fn new(scene: &'a Scene, spec: &'a CameraSpec, plan: &Plan, watch: Watch<'a>) -> Result<Self> {
        Ok(Self {
            view: View::new(scene, spec, plan.seed)?,
            footprints: Arc::new(Footprints::new(&scene.geometry)),
            watch,
            replicates: plan.replicates,
            sums: Sums::new(spec.pixels)?,
            killed: 0,
        })
    }

    /// The bandwidths of a run, from the photons of its first pass: `part` of all.
    pub(super) fn choose(&self, maps: &[PhotonMap<C>; 2], part: f64) -> Bandwidths {
        let CameraSpec { bandwidth, kernel, .. } = *self.view.spec();
        let pairs = [0, 1].map(|k| match bandwidth {
            Bandwidth::Automatic => {
                let found = bandwidth::choose(&self.footprints, &maps[k], kernel, self.replicates, part);
                let neighbours = Some(found.mean_neighbours).filter(|n| n.is_finite());
                (Bandwidth::Radius(found.radius_m), Chosen { radius_m: Some(found.radius_m), neighbours })
            }
            Bandwidth::Radius(radius) | Bandwidth::Progressive(radius) => {
                (bandwidth, Chosen { radius_m: Some(radius), neighbours: None })
            }
            Bandwidth::Nearest(k) => (bandwidth, Chosen { radius_m: None, neighbours: Some(f64::from(k)) }),
        });
        Bandwidths { of: pairs.map(|p| p.0), chosen: pairs.map(|p| p.1) }
    }

    /// Maps of photons of either kind, sorted for the bandwidths if these are known.
    pub(super) fn maps(
        &self,
        photons: [Vec<Photon<C>>; 2],
        frame: Frame,
        known: Option<&Bandwidths>,
    ) -> [PhotonMap<C>; 2] {
        let asked = Bandwidths { of: [self.view.spec().bandwidth; 2], chosen: [Chosen::default(); 2] };
        let bandwidths = known.unwrap_or(&asked);
        let mut kinds = 0..;
        photons.map(|photons| {
            let radius_m = bandwidths.search_radius_m(kinds.next().unwrap_or(0));
            PhotonMap::build(photons, frame, radius_m)
        })
    }

    /// Adds what is seen of a pass's photons.
    pub(super) fn add(&mut self, seen: &Seen<'_, C>) -> Result<()> {
        let densities = [0, 1].map(|k| {
            let choice = Choice {
                bandwidth: seen.bandwidths.of[k],
                kernel: self.view.spec().kernel,
                replicates: self.replicates,
            };
            Density::on(Arc::clone(&self.footprints), &seen.maps[k], seen.photon_lm, choice)
        });
        let replicates = seen.replicates.clone();
        self.render(&Pass {
            densities: &densities,
            replicates,
            finishes: seen.finishes,
            emission: seen.last,
            direct: seen.last,
        })
    }

    /// A photon turned out to carry another flux than passes so far took it for.
    pub(super) fn scale(&mut self, factor: f64) {
        self.sums.scale(factor);
    }

    /// Adds emitters and background as seen directly, by mirrors and through glass, without light on surfaces.
    pub(super) fn add_emitters(&mut self) -> Result<()> {
        self.render(&Pass::emission())
    }

    fn render(&mut self, pass: &Pass<'_, C>) -> Result<()> {
        let [columns, rows] = self.view.spec().pixels.map(f64::from);
        let done = AtomicU64::new(0);
        let progress = |pixels: u64| {
            let done = done.fetch_add(pixels, Relaxed) + pixels;
            (self.watch.camera)(done as f64 / (columns * rows));
        };
        let rendered = render(&self.view, pass, &mut self.sums, self.watch.interrupt, &progress)?;
        self.killed += rendered.killed;
        if !rendered.complete {
            return Err(Diagnostic::new(
                Kind::Interrupted,
                "an interrupt before the picture was finished",
                "all pixels: a part of them is no picture",
            ));
        }
        Ok(())
    }

    /// The film, and the number of eye paths that did not end by themselves.
    pub(super) fn finish(self) -> (Film<C>, u64) {
        (self.sums.finish(), self.killed)
    }
}
