//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! A pass is of whole replicates or of a part of one, whose partial sum then stays open: the standard error
//! comes from whole ones.

use std::io::{self, Read, Write};
use std::ops::Range;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use crate::error::Result;
use crate::math::varint::{damaged, put, put_reals, take, take_real, take_up_to};
use crate::picture::Watch;
use crate::picture::camera::render::{Rendered, render_tiles};
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
    /// Whether the tracing had been interrupted when the pass began.
    was_interrupted: bool,
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
            was_interrupted: false,
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

    /// The maps of a pass of these photons, which are `part` of all; they settle the bandwidths if nothing has.
    pub(crate) fn maps(
        &mut self,
        [caustic, diffuse]: Kept<C>,
        frame: Frame,
        part: f64,
        replicates: u32,
    ) -> [PhotonMap<C>; 2] {
        let caustic = self.map_of(0, joined(caustic), frame, part, replicates);
        [caustic, self.map_of(1, joined(diffuse), frame, part, replicates)]
    }

    /// The densities of these maps: of one photon the flux is that of the whole run.
    pub(crate) fn densities<'m>(
        &self,
        maps: &'m [PhotonMap<C>; 2],
        photon_lm: f64,
        part: f64,
    ) -> Vec<Density<'m, C>>
    where
        'a: 'm,
    {
        // The neighbours of a pass are a part of those of the run.
        let of_pass = |n: u32| ((f64::from(n) * part + 0.5) as u32).max(FEWEST_IN_PASS.min(n));
        let density = |map: &'m PhotonMap<C>, settled: Settled| {
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
        with_photons.filter_map(|(map, settled)| Some(density(map, settled?))).collect()
    }

    /// Tiles of the picture.
    pub(crate) fn tile_count(&self) -> usize {
        self.sums.tile_count()
    }

    /// Adds what is seen in a pass, in some tiles of the picture. Ctrl-C while tracing: stop tracing, render what has been traced.
    /// Ctrl-C while rendering the last pass, which shows emitters: stop.
    pub(crate) fn look(&mut self, pass: &Pass<'_, C>, tiles: Range<usize>) -> Result<()> {
        let (first, all) = (tiles.start, self.tile_count());
        let [columns, rows] = self.sums.pixels.map(u64::from);
        let done = AtomicU64::new(columns * rows * first as u64 / all as u64);
        let tell = |pixels: u64| {
            let before = done.fetch_add(pixels, Ordering::Relaxed);
            (self.watch.camera)((before + pixels) as f64 / (columns * rows) as f64);
        };
        let never = AtomicBool::new(false);
        if first == 0 {
            // The eye's paths are the same in every pass.
            self.rendered = Rendered::default();
            self.was_interrupted = self.watch.interrupt.load(Ordering::Relaxed);
        }
        let interrupt = if self.was_interrupted || !pass.emission { &never } else { self.watch.interrupt };
        let some = render_tiles(&self.view, pass, &mut self.sums, tiles, interrupt, &tell)?;
        self.rendered.merge(some);
        Ok(())
    }

    /// Writes what is seen so far, and what is settled.
    ///
    /// # Errors
    /// Those of the writer.
    pub(crate) fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        for settled in self.bandwidths {
            put(out, [u64::from(settled.is_some())])?;
            if let Some(Settled { bandwidth, chosen }) = settled {
                let (kind, number, radius_m) = match bandwidth {
                    Bandwidth::Automatic => (0, 0, 0.0),
                    Bandwidth::AtLeast { radius_m, neighbours } => (1, neighbours, radius_m),
                    Bandwidth::Radius(radius_m) => (2, 0, radius_m),
                    Bandwidth::Nearest(neighbours) => (3, neighbours, 0.0),
                    Bandwidth::Progressive(radius_m) => (4, 0, radius_m),
                };
                put(out, [kind, number.into()])?;
                // What is not known is written as NaN.
                let chosen = [chosen.radius_m, chosen.neighbours].map(|x| x.unwrap_or(f64::NAN));
                put_reals(out, [radius_m].into_iter().chain(chosen))?;
            }
        }
        self.rendered.write(out)?;
        self.sums.write(out)
    }

    /// Takes what was written in the place of what there is.
    ///
    /// # Errors
    /// Those of the reader; what is of another picture.
    pub(crate) fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        for settled in &mut self.bandwidths {
            *settled = None;
            if take_up_to(from, 1, "bandwidths")? == 1 {
                let (kind, number) = (take(from)?, take_up_to(from, u32::MAX.into(), "neighbours")? as u32);
                let [radius_m, chosen_m, neighbours] = [take_real(from)?, take_real(from)?, take_real(from)?];
                let bandwidth = match kind {
                    1 => Bandwidth::AtLeast { radius_m, neighbours: number },
                    2 => Bandwidth::Radius(radius_m),
                    3 => Bandwidth::Nearest(number),
                    4 => Bandwidth::Progressive(radius_m),
                    _ => return Err(damaged("a bandwidth that no picture has")),
                };
                let [radius_m, neighbours] = [chosen_m, neighbours].map(|x| Some(x).filter(|x| !x.is_nan()));
                *settled = Some(Settled { bandwidth, chosen: Chosen { radius_m, neighbours } });
            }
        }
        self.rendered = Rendered::read(from)?;
        self.sums.read(from)
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
