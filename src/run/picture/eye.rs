//! What a run asks of the camera: to add what it sees of a pass, and to make a film of the sums.
//!
//! The partial sums over replicates, from which the standard error comes, must be those of whole replicates. Passes come
//! in the order of the replicates and may end in the middle of one, so its partial sum stays open until photons of a later
//! one are seen.

use rayon::prelude::*;

use crate::bsdf::Bsdf;
use crate::camera::Film;
use crate::error::Result;
use crate::estimate::density::{Density, Gathered};
use crate::geometry::{Side, Whereabouts};
use crate::scene::Scene;
use crate::scene::camera::{Bandwidth, CameraSpec};
use crate::tally::photon_map::PhotonMap;

use super::summary::{Chosen, luminance_of};

/// The bandwidths of both densities, chosen once.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bandwidths {
    radius_m: [f64; 2],
}

impl Bandwidths {
    /// From the photons of the first pass, `part` of all.
    pub(super) fn choose<const C: usize>(eye: &Eye<'_, C>, _maps: &[PhotonMap<C>; 2], _part: f64) -> Self {
        let (low, high) = eye.scene.geometry.bounds();
        match eye.spec.bandwidth {
            Bandwidth::Radius(radius) | Bandwidth::Progressive(radius) => Self { radius_m: [radius; 2] },
            _ => Self { radius_m: [0.02 * (high - low).length(); 2] },
        }
    }

    pub(super) fn chosen(&self) -> [Chosen; 2] {
        self.radius_m.map(|r| Chosen { radius_m: Some(r), neighbours: None })
    }
}

/// One pixel's sums.
#[derive(Debug, Clone)]
struct Sums<const C: usize> {
    value: [f64; C],
    wide: [f64; C],
    /// Sum of squares of the closed replicates' partial sums.
    square: f64,
    /// The partial sum of the replicate that is open.
    open: f64,
}

/// The camera at work.
pub(super) struct Eye<'a, const C: usize> {
    scene: &'a Scene,
    spec: &'a CameraSpec,
    replicates: usize,
    sums: Vec<Sums<C>>,
    open: usize,
}

impl<'a, const C: usize> Eye<'a, C> {
    pub(super) fn new(scene: &'a Scene, spec: &'a CameraSpec, replicates: u32) -> Result<Self> {
        let pixels = spec.pixels[0] as usize * spec.pixels[1] as usize;
        let none = Sums { value: [0.0; C], wide: [0.0; C], square: 0.0, open: 0.0 };
        Ok(Self { scene, spec, replicates: replicates as usize, sums: vec![none; pixels], open: 0 })
    }

    /// A radius for which a map of so many photons is to be sorted.
    pub(super) fn search_radius_m(&self, _photons: usize) -> f64 {
        let (low, high) = self.scene.geometry.bounds();
        0.02 * (high - low).length()
    }

    /// Adds what is seen of these photons.
    pub(super) fn add(
        &mut self,
        maps: &[PhotonMap<C>; 2],
        photon_lm: f64,
        bandwidths: &Bandwidths,
        _part: f64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<()> {
        let geometry = &self.scene.geometry;
        let [caustic, diffuse] =
            [0, 1].map(|k| Density::fixed(geometry, &maps[k], photon_lm, bandwidths.radius_m[k]));
        let last = maps.iter().flat_map(|m| m.photons()).map(|p| p.replicate()).max().unwrap_or(self.open);
        let (scene, spec, open, replicates) = (self.scene, self.spec, self.open, self.replicates);
        self.sums.par_iter_mut().enumerate().for_each(|(pixel, sums)| {
            let mut gathered = Gathered::<C>::new(replicates);
            see(scene, spec, pixel, [&caustic, &diffuse], &mut gathered);
            for c in 0..C {
                sums.value[c] += gathered.value[c];
                sums.wide[c] += gathered.wide[c];
            }
            for r in open..=last {
                sums.open += gathered.by_replicate[r];
                if r < last {
                    sums.square += sums.open * sums.open;
                    sums.open = 0.0;
                }
            }
        });
        self.open = last;
        progress(1.0);
        Ok(())
    }

    /// Adds emitters and background as seen directly, by mirrors and through glass, without light on surfaces.
    pub(super) fn add_emitters(&mut self, progress: &(dyn Fn(f64) + Sync)) -> Result<()> {
        progress(1.0);
        Ok(())
    }

    /// The film; light of photons is scaled to what they turned out to stand for.
    pub(super) fn finish(self, scale: f64, replicates: u32) -> Film<C> {
        let r = f64::from(replicates);
        let error = |sums: &Sums<C>| {
            let y = luminance_of(sums.value);
            let square = sums.square + sums.open * sums.open;
            if r < 2.0 { f64::NAN } else { (r / (r - 1.0) * (square - y * y / r).max(0.0)).sqrt() * scale }
        };
        Film {
            pixels: self.spec.pixels,
            standard_error: self.sums.iter().map(error).collect(),
            bias: self.sums.iter().map(|s| luminance_of(s.value) - luminance_of(s.wide)).collect(),
            value: self.sums.iter().map(|s| s.value.map(|v| v * scale)).collect(),
        }
    }
}

fn see<const C: usize>(
    scene: &Scene,
    spec: &CameraSpec,
    pixel: usize,
    densities: [&Density<'_, C>; 2],
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
