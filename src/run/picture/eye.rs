//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! A pass is of whole replicates or of a part of one, whose partial sum then stays open: the standard error comes from whole
//! ones.

use std::ops::Range;

use rayon::prelude::*;

use crate::bsdf::Bsdf;
use crate::camera::Film;
use crate::error::Result;
use crate::estimate::density::{Density, Gathered};
use crate::geometry::{Side, Whereabouts};
use crate::scene::Scene;
use crate::scene::camera::{Bandwidth, CameraSpec};
use crate::tally::photon_map::PhotonMap;

use super::super::plan::Plan;
use super::summary::{Chosen, luminance_of};

/// The bandwidths of both densities, chosen once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bandwidths {
    radius_m: [f64; 2],
}

impl Bandwidths {
    pub(super) fn chosen(&self) -> [Chosen; 2] {
        self.radius_m.map(|r| Chosen { radius_m: Some(r), neighbours: None })
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

/// One pixel's sums.
#[derive(Debug, Clone)]
struct Sums<const C: usize> {
    value: [f64; C],
    wide: [f64; C],
    /// Sum and sum of squares of the closed replicates' partial sums.
    photons: f64,
    square: f64,
    /// The partial sum of the replicate that is open.
    open: f64,
}

/// The camera at work.
pub(super) struct Eye<'a, const C: usize> {
    scene: &'a Scene,
    spec: &'a CameraSpec,
    sums: Vec<Sums<C>>,
    replicates: u32,
}

impl<'a, const C: usize> Eye<'a, C> {
    pub(super) fn new(scene: &'a Scene, spec: &'a CameraSpec, _plan: &Plan) -> Result<Self> {
        let pixels = spec.pixels[0] as usize * spec.pixels[1] as usize;
        let none = Sums { value: [0.0; C], wide: [0.0; C], photons: 0.0, square: 0.0, open: 0.0 };
        Ok(Self { scene, spec, sums: vec![none; pixels], replicates: 0 })
    }

    /// A radius for which maps are to be sorted, m.
    pub(super) fn search_radius_m(&self, chosen: &Option<Bandwidths>) -> f64 {
        let (low, high) = self.scene.geometry.bounds();
        chosen.map_or(0.02 * (high - low).length(), |b| b.radius_m[0])
    }

    /// Bandwidths from the photons of the first pass, `part` of all.
    pub(super) fn choose(&self, _maps: &[PhotonMap<C>; 2], _part: f64) -> Bandwidths {
        match self.spec.bandwidth {
            Bandwidth::Radius(radius) | Bandwidth::Progressive(radius) => {
                Bandwidths { radius_m: [radius; 2] }
            }
            _ => Bandwidths { radius_m: [self.search_radius_m(&None); 2] },
        }
    }

    /// Adds what is seen in a pass.
    pub(super) fn add(&mut self, seen: &Seen<'_, C>, progress: &(dyn Fn(f64) + Sync)) -> Result<()> {
        let geometry = &self.scene.geometry;
        let density =
            |k: usize| Density::fixed(geometry, &seen.maps[k], seen.photon_lm, seen.bandwidths.radius_m[k]);
        let densities = [density(0), density(1)];
        let (scene, spec) = (self.scene, self.spec);
        let replicates = seen.replicates.start as usize..seen.replicates.end as usize;
        self.sums.par_iter_mut().enumerate().for_each(|(pixel, sums)| {
            let mut gathered = Gathered::<C>::new(replicates.end);
            see(scene, spec, pixel, &densities, &mut gathered);
            for c in 0..C {
                sums.value[c] += gathered.value[c];
                sums.wide[c] += gathered.wide[c];
            }
            for r in replicates.clone() {
                sums.open += gathered.by_replicate[r];
                if seen.finishes {
                    sums.photons += sums.open;
                    sums.square += sums.open * sums.open;
                    sums.open = 0.0;
                }
            }
        });
        if seen.finishes {
            self.replicates += seen.replicates.len() as u32;
        }
        progress(1.0);
        let _ = (seen.last, seen.part);
        Ok(())
    }

    /// Adds emitters and background as seen directly, by mirrors and through glass, without light on surfaces.
    pub(super) fn add_emitters(&mut self, progress: &(dyn Fn(f64) + Sync)) -> Result<()> {
        progress(1.0);
        Ok(())
    }

    /// Takes all photons so far for this many times their flux.
    pub(super) fn scale(&mut self, factor: f64) {
        for sums in &mut self.sums {
            sums.value = sums.value.map(|v| v * factor);
            sums.wide = sums.wide.map(|v| v * factor);
            sums.photons *= factor;
            sums.square *= factor * factor;
            sums.open *= factor;
        }
    }

    /// The film.
    pub(super) fn finish(self) -> Film<C> {
        let r = f64::from(self.replicates);
        let variance = |s: &Sums<C>| (r * s.square - s.photons * s.photons).max(0.0) / (r - 1.0);
        let of_photons = |s: &Sums<C>| match self.replicates {
            0 => 0.0,
            1 => f64::NAN,
            _ => variance(s).sqrt(),
        };
        Film {
            pixels: self.spec.pixels,
            standard_error: self.sums.iter().map(of_photons).collect(),
            bias: self.sums.iter().map(|s| luminance_of(s.value) - luminance_of(s.wide)).collect(),
            value: self.sums.iter().map(|s| s.value).collect(),
        }
    }
}

fn see<const C: usize>(
    scene: &Scene,
    spec: &CameraSpec,
    pixel: usize,
    densities: &[Density<'_, C>; 2],
    into: &mut Gathered<C>,
) {
    let [width, height] = spec.pixels.map(f64::from);
    let focal = 0.5 * width / libm::tan(0.5 * spec.fov_deg.to_radians());
    let (x, y) = (pixel as u32 % spec.pixels[0], pixel as u32 / spec.pixels[0]);
    let (x, y) = (f64::from(x) + 0.5 - 0.5 * width, f64::from(y) + 0.5 - 0.5 * height);
    let right = spec.forward.cross(spec.up);
    let direction = (spec.forward * focal + right * x - spec.up * y).normalize();
    let start = Whereabouts::start(scene.geometry.all_behind(spec.position));
    let Some(hit) = scene.geometry.nearest(spec.position, direction, &start, &mut 0) else { return };
    let Bsdf::Lambertian { reflectance } = scene.bsdf(hit.surface) else { return };
    let side = if hit.front { Side::Front } else { Side::Back };
    let f = reflectance.luminous() / std::f64::consts::PI;
    for density in densities {
        let value_of = |_, front: bool| [if front == (side == Side::Front) { f } else { 0.0 }; C];
        density.gather(&hit, [1.0; C], value_of, into);
    }
}
