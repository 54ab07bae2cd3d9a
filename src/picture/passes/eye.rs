//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! A pass is of whole replicates or of a part of one, whose partial sum then stays open: the standard error
//! comes from whole ones.

use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::error::Result;
use crate::picture::Watch;
use crate::picture::camera::render;
use crate::picture::camera::render::Rendered;
use crate::picture::camera::{Film, Pass, Sums, View};
use crate::picture::gather::footprint::Footprints;
use crate::picture::gather::{Choice, Density, bandwidth};
use crate::picture::photon_map::{Frame, Kept, Photon, PhotonMap};
use crate::picture::summary::{Chosen, PictureSummary};
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

/// The camera at work.
pub(crate) struct Eye<'a, const C: usize> {
    pub(crate) view: View<'a>,
    watch: Watch<'a>,
    rendered: Rendered,
    footprints: Arc<Footprints<'a>>,
    /// What is seen so far.
    pub(crate) sums: Sums<C>,
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
            rendered: Rendered::default(),
            footprints: Arc::new(Footprints::new(&scene.geometry)),
            sums: Sums::new(camera.pixels)?,
            replicates: plan.replicates(),
            bandwidths: [asked_for(camera.bandwidth); 2],
        })
    }

    /// The map of photons, `part` of those that there will be, sorted for the bandwidth of their density, which they
    /// settle if nothing has; they are of so many replicates.
    fn map_of(
        &mut self,
        density: usize,
        photons: Vec<Photon<C>>,
        frame: Frame,
        part: f64,
        replicates: u32,
    ) -> PhotonMap<C> {
        let settled = self.bandwidths[density];
        let map = PhotonMap::build(photons, frame, settled.and_then(|s| s.chosen.radius_m).unwrap_or(0.0));
        if settled.is_some() || map.photons().is_empty() {
            return map;
        }
        let found = bandwidth::choose(&self.footprints, &map, self.view.camera.kernel, replicates, part);
        let neighbours = Some(found.mean_neighbours / part).filter(|n| n.is_finite());
        let chosen = Chosen { radius_m: Some(found.radius_m), neighbours };
        self.bandwidths[density] = Some(Settled { bandwidth: found.bandwidth(), chosen });
        map.rebuilt(found.radius_m)
    }

    /// Adds what is seen in a pass of these photons: of one of them the flux is that of the whole run, all are `part` of
    /// its photons. Gives them as they were mapped.
    pub(crate) fn add(
        &mut self,
        [caustic, diffuse]: Kept<C>,
        frame: Frame,
        photon_lm: f64,
        part: f64,
        pass: Pass<'_, C>,
    ) -> Result<[PhotonMap<C>; 2]> {
        let replicates = pass.replicates.len() as u32;
        let caustic = self.map_of(0, joined(caustic), frame, part, replicates);
        let maps = [caustic, self.map_of(1, joined(diffuse), frame, part, replicates)];
        // The neighbours of a pass are a part of those of the run.
        let of_pass = |n: u32| ((f64::from(n) * part + 0.5) as u32).max(FEWEST_IN_PASS.min(n));
        let density = |map, settled: Settled| {
            let bandwidth = match settled.bandwidth {
                Bandwidth::Nearest(n) => Bandwidth::Nearest(of_pass(n)),
                Bandwidth::AtLeast { radius_m, neighbours } => {
                    Bandwidth::AtLeast { radius_m, neighbours: of_pass(neighbours) }
                }
                other => other,
            };
            let choice = Choice { bandwidth, kernel: self.view.camera.kernel, replicates: self.replicates };
            Density::new(Arc::clone(&self.footprints), map, photon_lm, choice)
        };
        let with_photons = maps.iter().zip(self.bandwidths).filter(|(map, _)| !map.photons().is_empty());
        let densities: Vec<Density<'_, C>> =
            with_photons.filter_map(|(map, settled)| Some(density(map, settled?))).collect();
        self.look(&Pass { densities: &densities, ..pass })?;
        Ok(maps)
    }

    /// Adds what is seen in a pass. Ctrl-C while tracing: stop tracing, render what has been traced. Ctrl-C while rendering the last pass, which shows
    /// emitters: stop.
    pub(crate) fn look(&mut self, pass: &Pass<'_, C>) -> Result<()> {
        let [columns, rows] = self.sums.pixels.map(u64::from);
        let done = AtomicU64::new(0);
        let tell = |pixels: u64| {
            let before = done.fetch_add(pixels, Ordering::Relaxed);
            (self.watch.camera)((before + pixels) as f64 / (columns * rows) as f64);
        };
        let never = AtomicBool::new(false);
        let was_interrupted = self.watch.interrupt.load(Ordering::Relaxed);
        let interrupt = if was_interrupted || !pass.emission { &never } else { self.watch.interrupt };
        // The eye's paths are the same in every pass.
        self.rendered = render(&self.view, pass, &mut self.sums, interrupt, &tell)?;
        Ok(())
    }

    /// The film, and what the eye knows of its summary.
    pub(crate) fn finish(self) -> (Film<C>, PictureSummary) {
        let bandwidths = self.bandwidths.map(|b| b.map_or(Chosen::default(), |settled| settled.chosen));
        let summary = PictureSummary {
            method: self.view.camera.method,
            bandwidth: Some(bandwidths),
            eye_paths_killed: self.rendered.killed,
            pixels_unseen: self.rendered.unseen,
            eye_paths: self.rendered.paths,
            eye_paths_contradicted: self.rendered.contradicted,
            ..PictureSummary::default()
        };
        (self.sums.finish(), summary)
    }
}

/// A bandwidth that the camera names; `None` where it is to be chosen.
fn asked_for(bandwidth: Bandwidth) -> Option<Settled> {
    let (radius_m, neighbours) = match bandwidth {
        Bandwidth::Automatic => return None,
        Bandwidth::Radius(radius_m)
        | Bandwidth::Progressive(radius_m)
        | Bandwidth::AtLeast { radius_m, .. } => (Some(radius_m), None),
        Bandwidth::Nearest(n) => (None, Some(f64::from(n))),
    };
    Some(Settled { bandwidth, chosen: Chosen { radius_m, neighbours } })
}

/// Blocks one after another; each is dropped when it is copied.
fn joined<const C: usize>(blocks: Vec<Vec<Photon<C>>>) -> Vec<Photon<C>> {
    let mut all = Vec::with_capacity(blocks.iter().map(Vec::len).sum());
    for block in blocks {
        all.extend_from_slice(&block);
    }
    all
}
