//! Density estimation: luminance from the photons about a point, with its spread over replicates and its bias.

use glam::DVec3;

use crate::geometry::{Geometry, Hit};
use crate::tally::photon_map::{Photon, PhotonMap};

/// What the difference between the two bandwidths is multiplied with for the bias of the narrower.
pub const BIAS_PER_DIFFERENCE: f64 = 1.0;

/// What is gathered for one pixel: sums over its samples. `C` channels: 1 or 3.
#[derive(Debug, Clone, PartialEq)]
pub struct Gathered<const C: usize> {
    /// Luminance by channel, cd/m2.
    pub value: [f64; C],
    /// The same at the second bandwidth, from which the bias is told.
    pub wide: [f64; C],
    /// Luminance (Y) that each replicate's photons make; they add up to that of `value`.
    pub by_replicate: Vec<f64>,
}

impl<const C: usize> Gathered<C> {
    /// Nothing, of this many replicates.
    pub fn new(replicates: usize) -> Self {
        Self { value: [0.0; C], wide: [0.0; C], by_replicate: vec![0.0; replicates] }
    }

    /// Nothing again.
    pub fn clear(&mut self) {
        self.value = [0.0; C];
        self.wide = [0.0; C];
        self.by_replicate.fill(0.0);
    }
}

/// A photon map with a bandwidth.
#[derive(Debug)]
pub struct Density<'m, const C: usize> {
    geometry: &'m Geometry,
    map: &'m PhotonMap<C>,
    /// Flux of one photon, lm.
    photon_lm: f64,
    radius_m: f64,
}

impl<'m, const C: usize> Density<'m, C> {
    /// All photons within this radius.
    pub fn fixed(geometry: &'m Geometry, map: &'m PhotonMap<C>, photon_lm: f64, radius_m: f64) -> Self {
        Self { geometry, map, photon_lm, radius_m }
    }

    /// Adds the luminance at a point of a scattering surface, times `weight`. `value_of(direction of travel, arrived on the
    /// front)` is the surface's BSDF towards the eye, 1/sr; photons of both sides are offered.
    pub fn gather(
        &self,
        at: &Hit,
        weight: [f64; C],
        mut value_of: impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) {
        let _ = self.geometry;
        let per_area = self.photon_lm / (std::f64::consts::PI * self.radius_m * self.radius_m);
        self.map.within(at.position, self.radius_m, |photon: &Photon<C>, _| {
            let f = value_of(photon.direction(), photon.is_front());
            let mut y = 0.0;
            for c in 0..C {
                let l = weight[c] * f[c] * f64::from(photon.weight[c]) * per_area;
                into.value[c] += l;
                into.wide[c] += l;
                y += if C == 1 { l } else { crate::units::LUMINANCE_OF_RGB[c] * l };
            }
            into.by_replicate[photon.replicate()] += y;
        });
    }
}
