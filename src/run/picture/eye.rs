//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! The partial sums over replicates, from which the standard error comes, must be those of whole replicates. Passes come
//! in the order of the replicates and may end in the middle of one, so its partial sum stays open until photons of a later
//! one are seen.

use std::sync::Arc;
use std::sync::atomic::AtomicU64;
use std::sync::atomic::Ordering::Relaxed;

use rayon::prelude::*;

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

use super::Watch;
use super::summary::Chosen;

/// The bandwidths of both densities, chosen once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bandwidths {
    of: [Bandwidth; 2],
    chosen: [Chosen; 2],
}

impl Bandwidths {
    /// From the photons of the first pass, `part` of all.
    pub(super) fn choose<const C: usize>(eye: &Eye<'_, C>, maps: &[PhotonMap<C>; 2], part: f64) -> Self {
        let pairs = [0, 1].map(|k| match eye.view.spec().bandwidth {
            Bandwidth::Automatic => {
                let kernel = eye.view.spec().kernel;
                let found = bandwidth::choose(&eye.footprints, &maps[k], kernel, eye.replicates, part);
                let neighbours = Some(found.mean_neighbours).filter(|n| n.is_finite());
                (Bandwidth::Radius(found.radius_m), Chosen { radius_m: Some(found.radius_m), neighbours })
            }
            asked @ (Bandwidth::Radius(radius) | Bandwidth::Progressive(radius)) => {
                (asked, Chosen { radius_m: Some(radius), neighbours: None })
            }
            asked @ Bandwidth::Nearest(k) => {
                (asked, Chosen { radius_m: None, neighbours: Some(f64::from(k)) })
            }
        });
        Self { of: pairs.map(|p| p.0), chosen: pairs.map(|p| p.1) }
    }

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

/// The camera at work.
pub(super) struct Eye<'a, const C: usize> {
    view: View<'a>,
    footprints: Arc<Footprints<'a>>,
    watch: Watch<'a>,
    replicates: u32,
    sums: Sums<C>,
    /// Whether direct light, emitters and the background are in.
    lit: bool,
    killed: u64,
}

impl<'a, const C: usize> Eye<'a, C> {
    pub(super) fn new(
        scene: &'a Scene,
        spec: &'a CameraSpec,
        seed: u64,
        replicates: u32,
        watch: Watch<'a>,
    ) -> Result<Self> {
        Ok(Self {
            view: View::new(scene, spec, seed)?,
            footprints: Arc::new(Footprints::new(&scene.geometry)),
            watch,
            replicates,
            sums: Sums::new(spec.pixels)?,
            lit: false,
            killed: 0,
        })
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

    /// Adds what is seen of these photons. Where they are all there are (`is_whole`) what needs no photons is seen on the way.
    pub(super) fn add(
        &mut self,
        maps: &[PhotonMap<C>; 2],
        photon_lm: f64,
        bandwidths: &Bandwidths,
        is_whole: bool,
    ) -> Result<()> {
        let densities = [0, 1].map(|k| {
            let choice = Choice {
                bandwidth: bandwidths.of[k],
                kernel: self.view.spec().kernel,
                replicates: self.replicates,
            };
            Density::on(Arc::clone(&self.footprints), &maps[k], photon_lm, choice)
        });
        let replicates = replicates_of(maps);
        if is_whole {
            self.lit = true;
            self.render(&Pass::whole(&densities, replicates.end))
        } else {
            self.render(&Pass::photons(&densities, replicates))
        }
    }

    /// Adds emitters and background as seen directly, by mirrors and through glass, without light on surfaces.
    pub(super) fn add_emitters(&mut self) -> Result<()> {
        self.lit = true;
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

    /// The film; light of photons is scaled to what they turned out to stand for.
    ///
    /// # Errors
    /// Interrupted.
    pub(super) fn finish(mut self, scale: f64, replicates: u32) -> Result<(Film<C>, u64)> {
        if !self.lit {
            self.sums.scale(scale);
            self.render(&Pass::without_photons())?;
        }
        Ok((self.sums.finish(replicates), self.killed))
    }
}

/// From the first replicate to the last of which there are photons.
fn replicates_of<const C: usize>(maps: &[PhotonMap<C>; 2]) -> std::ops::Range<u32> {
    let of = |map: &PhotonMap<C>| {
        let none = || (u32::MAX, 0);
        let joined = |a: (u32, u32), b: (u32, u32)| (a.0.min(b.0), a.1.max(b.1));
        map.photons()
            .par_iter()
            .map(|photon| (photon.replicate() as u32, photon.replicate() as u32 + 1))
            .reduce(none, joined)
    };
    let [(a, b), (c, d)] = [of(&maps[0]), of(&maps[1])];
    a.min(c).min(b.max(d))..b.max(d)
}
