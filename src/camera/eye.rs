//! One eye path: along mirrors and through glass to the first surface that scatters.
//!
//! What it finds (Heckbert's notation; S mirrors and glass, D what scatters): emitters that it crosses, L S* E; at the
//! scattering surface by shadow rays what comes straight from emitters, L D S* E; and from the photons there what had at
//! least one event before, L (S|D)+ D S* E. Each once.

use glam::DVec3;

use super::view::View;
use crate::bsdf::value::Leg;
use crate::bsdf::{Bsdf, EyeWeight, Incidence, Outcome};
use crate::estimate::density::{Density, Gathered};
use crate::geometry::{Hit, Side, Whereabouts};
use crate::sample::coordinates::{Chooser, Purpose};
use crate::scene::Scene;
use crate::transport::walk::MAX_EVENTS;

use super::pinhole::EyeRay;

/// What an eye path looks for.
#[derive(Debug, Clone, Copy)]
pub struct Looks<'d, const C: usize> {
    /// Emitters and the background.
    pub emission: bool,
    /// Direct light at the scattering surface.
    pub direct: bool,
    /// Photons there: as many densities as there are, each with its own bandwidth.
    pub densities: &'d [Density<'d, C>],
}

/// An eye path on its way.
pub(super) struct EyePath<'a, const C: usize> {
    pub view: &'a View<'a>,
    pub looks: Looks<'a, C>,
    pub gathered: &'a mut Gathered<C>,
    /// Paths that the guard against endless ones ended.
    pub killed: u64,
}

impl<const C: usize> EyePath<'_, C> {
    /// Follows a ray; gathers what photons bring and returns what is found without them, by channel, cd/m2.
    pub fn look<R: Chooser>(&mut self, ray: EyeRay, chooser: &mut R) -> [f64; 3] {
        let scene = self.view.scene;
        let EyeRay { mut origin, mut direction } = ray;
        let mut at = self.view.start;
        let mut weight = EyeWeight::ONE;
        let mut found = [0.0; 3];
        for _ in 0..MAX_EVENTS {
            let hit = scene.geometry.nearest(origin, direction, &at, &mut 0);
            if self.looks.emission {
                let end = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
                add(&mut found, weight, seen(scene, origin, direction, end));
                if hit.is_none() {
                    add(&mut found, weight, self.view.spec.background_cd_m2);
                }
            }
            let Some(hit) = hit else { return found };
            let bsdf = scene.bsdf(hit.surface);
            if bsdf.scatters() {
                let lit = self.scattered(&hit, direction, &at, weight, chooser);
                add(&mut found, EyeWeight::ONE, lit);
            }
            let Some((onward, through)) = pass_on(bsdf, &hit, direction, &mut weight, chooser) else {
                return found;
            };
            at.leave(&hit, if hit.front == through { Side::Back } else { Side::Front });
            (origin, direction) = (hit.position, onward);
        }
        self.killed += 1;
        found
    }

    /// The light that a surface scatters to the eye: by shadow rays as returned, by photons as gathered.
    fn scattered<R: Chooser>(
        &mut self,
        hit: &Hit,
        direction: DVec3,
        at: &Whereabouts,
        weight: EyeWeight,
        chooser: &mut R,
    ) -> [f64; 3] {
        let bsdf = self.view.scene.bsdf(hit.surface);
        let wo = Leg { direction: -direction, front: hit.front };
        for density in self.looks.densities {
            let value = |travel: DVec3, front: bool| {
                channels(bsdf.value_between(hit.normal, Leg { direction: -travel, front }, wo))
            };
            density.gather(hit, channels(weight.weight()), value, self.gathered);
        }
        if !self.looks.direct {
            return [0.0; 3];
        }
        let mut lit = [0.0; 3];
        add(&mut lit, weight, direct(self.view.scene, hit, wo, at, chooser));
        lit
    }
}

/// Luminance of the emitters that a ray crosses within a distance.
fn seen(scene: &Scene, origin: DVec3, direction: DVec3, within_m: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (i, emitter) in scene.emitters.as_slice().iter().enumerate() {
        if let Some((luminance, distance_m)) = emitter.seen(origin, direction)
            && distance_m < within_m
        {
            let colour = scene.emitter_colour(i);
            (0..3).for_each(|c| sum[c] += luminance * colour[c]);
        }
    }
    sum
}

/// Luminance towards the eye that comes straight from emitters: all of them, a shadow ray each. Panels stand in nobody's way.
fn direct<R: Chooser>(scene: &Scene, hit: &Hit, wo: Leg, at: &Whereabouts, chooser: &mut R) -> [f64; 3] {
    let bsdf = scene.bsdf(hit.surface);
    let from = |side: Side| {
        let mut at = *at;
        at.leave(hit, side);
        at
    };
    let sides = [from(Side::Front), from(Side::Back)];
    let mut sum = [0.0; 3];
    for (i, emitter) in scene.emitters.as_slice().iter().enumerate() {
        let u = if emitter.direct_coordinates() == 0 {
            [0.0; 2]
        } else {
            [chooser.uniform(Purpose::BeamPosition), chooser.uniform(Purpose::BeamPosition)]
        };
        let Some(light) = emitter.direct_light(hit.position, u) else { continue };
        let wi = Leg::new(light.towards, hit.normal);
        let value = bsdf.value_between(hit.normal, wi, wo);
        if value == [0.0; 3] {
            continue;
        }
        let start = &sides[usize::from(!wi.front)];
        if scene.geometry.occluded(hit.position, light.towards, light.distance_m, start) {
            continue;
        }
        let illuminance_lx = light.illuminance_lx * light.towards.dot(hit.normal).abs();
        let colour = scene.emitter_colour(i);
        (0..3).for_each(|c| sum[c] += illuminance_lx * value[c] * colour[c]);
    }
    sum
}

/// Where an eye path goes on: (direction, whether through the surface); `None` where it ends.
fn pass_on<R: Chooser>(
    bsdf: &Bsdf,
    hit: &Hit,
    direction: DVec3,
    weight: &mut EyeWeight,
    chooser: &mut R,
) -> Option<(DVec3, bool)> {
    match bsdf {
        Bsdf::Dielectric(_) | Bsdf::Mirror { .. } => {
            let sign = if hit.front { 1.0 } else { -1.0 };
            let facing = Incidence {
                direction,
                facet: hit.normal * sign,
                smooth: hit.shading_normal * sign,
                front: hit.front,
            };
            let Outcome::Leaves { direction: onward, through, .. } = bsdf.interact(&facing, chooser, weight)
            else {
                return None;
            };
            if let (Bsdf::Dielectric(dielectric), true) = (bsdf, through) {
                weight.scale(dielectric.luminance_factor(hit.front));
            }
            Some((onward, through))
        }
        Bsdf::Tabulated(table) => {
            let [mirrored, straight] = table.beyond(hit.normal, direction, hit.front);
            // Both only where the two sides of a table differ: one of them, counted twice.
            let (way, times) = match (mirrored, straight) {
                (Some(a), Some(b)) => (if chooser.happens(0.5) { a } else { b }, 2.0),
                (Some(way), None) | (None, Some(way)) => (way, 1.0),
                (None, None) => return None,
            };
            let part = way.part.map(|p| p * times);
            weight.attenuate(part, chooser).then_some((way.direction, way.through))
        }
        Bsdf::Lambertian { .. } | Bsdf::Absorber => None,
    }
}

#[inline]
fn add(sum: &mut [f64; 3], weight: EyeWeight, value: [f64; 3]) {
    let w = weight.weight();
    (0..3).for_each(|c| sum[c] += w[c] * value[c]);
}

/// The first C of three channels: one channel stands for all of grey light.
#[inline]
pub(super) fn channels<const C: usize>(rgb: [f64; 3]) -> [f64; C] {
    std::array::from_fn(|c| rgb[c])
}
