//! One eye path: along mirrors and through glass to the first surface that scatters.
//!
//! What it finds (Heckbert's notation; S mirrors and glass, D what scatters): emitters that it crosses, L S* E; at the
//! scattering surface by shadow rays what comes straight from emitters, L D S* E; and from the photons there what had at
//! least one event before, L (S|D)+ D S* E. Each once.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use crate::emitter::{Emits, Emitter};
use crate::geometry::{Hit, Side, Whereabouts};
use crate::picture::camera::pinhole::EyeRay;
use crate::picture::camera::view::View;
use crate::picture::gather::density::{Density, Gathered};
use crate::sample::coordinates::{Chooser, Purpose};
use crate::scene::Scene;
use crate::surface::value::Leg;
use crate::surface::{Bsdf, Dielectric, EyeWeight, Incidence, mirror};
use crate::transport::walk::MAX_EVENTS;

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

/// An eye path, and what of it is still to be followed.
pub(crate) struct EyePath<'a, const C: usize> {
    pub view: &'a View<'a>,
    pub looks: Looks<'a, C>,
    pub gathered: Gathered<C>,
    /// Paths that the guard against endless ones ended.
    pub killed: u64,
    pending: Vec<Branch>,
}

/// A path on its way.
#[derive(Debug, Clone, Copy)]
struct Branch {
    origin: DVec3,
    direction: DVec3,
    at: Whereabouts,
    weight: EyeWeight,
    /// Its part of the ways that glass offered.
    share: f64,
    /// Surfaces met since the eye.
    events: u32,
}

/// Both ways at glass are followed as long as the fainter one keeps this share, else one of them is chosen: what glass mirrors is
/// faint but often of something bright, and would be noise. At most as many paths as the share goes into 1 come of one.
const LEAST_SHARE: f64 = 1.0 / 1024.0;

impl<'a, const C: usize> EyePath<'a, C> {
    /// Nothing looked at yet; photons of so many replicates are told apart.
    pub fn new(view: &'a View<'a>, looks: Looks<'a, C>, replicates: usize) -> Self {
        Self { view, looks, gathered: Gathered::new(replicates), killed: 0, pending: Vec::new() }
    }

    /// Follows a ray; gathers what photons bring and returns what is found without them, by channel, cd/m2.
    pub fn look<R: Chooser>(&mut self, ray: EyeRay, chooser: &mut R) -> [f64; 3] {
        let EyeRay { origin, direction } = ray;
        self.pending.push(Branch {
            origin,
            direction,
            at: self.view.start,
            weight: EyeWeight::ONE,
            share: 1.0,
            events: 0,
        });
        let mut found = [0.0; 3];
        while let Some(branch) = self.pending.pop() {
            self.follow(branch, &mut found, chooser);
        }
        found
    }

    fn follow<R: Chooser>(&mut self, mut path: Branch, found: &mut [f64; 3], chooser: &mut R) {
        let scene = self.view.scene;
        while path.events < MAX_EVENTS {
            if !path.weight.outlast(path.events, chooser) {
                return;
            }
            let Branch { origin, direction, weight, .. } = path;
            let hit = scene.geometry.nearest(origin, direction, &path.at, &mut 0);
            if self.looks.emission {
                let end = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
                add(found, weight, seen(scene, origin, direction, end));
                if hit.is_none() {
                    add(found, weight, self.view.spec.background_cd_m2);
                }
            }
            let Some(hit) = hit else { return };
            let bsdf = scene.bsdf(hit.surface);
            if bsdf.scatters() {
                let lit = self.scattered(&hit, &path, chooser);
                add(found, weight, lit);
            }
            let onward = match bsdf {
                Bsdf::Dielectric(glass) => Some(self.pass_glass(glass, &hit, &mut path, chooser)),
                _ => pass_on(bsdf, &hit, &mut path, chooser),
            };
            let Some((onward, through)) = onward else { return };
            path.leave(&hit, onward, through);
        }
        self.killed += 1;
    }

    /// Glass: mirrored and refracted, both where both are worth it. Of these the mirrored path waits.
    fn pass_glass<R: Chooser>(
        &mut self,
        glass: &Dielectric,
        hit: &Hit,
        path: &mut Branch,
        chooser: &mut R,
    ) -> (DVec3, bool) {
        let ways = glass.ways(&incidence(hit, path.direction));
        let r = ways.reflectance;
        let both = r > 0.0 && r < 1.0 && path.share * r.min(1.0 - r) >= LEAST_SHARE;
        if both {
            let mut branch = *path;
            branch.weight.scale(r);
            branch.share *= r;
            branch.leave(hit, ways.mirrored().0, false);
            self.pending.push(branch);
            path.weight.scale(1.0 - r);
            path.share *= 1.0 - r;
        }
        let through = both || !chooser.happens(r);
        let (onward, _) = if through { ways.refracted() } else { ways.mirrored() };
        if through {
            path.weight.scale(glass.luminance_factor(hit.front));
        }
        (onward, through)
    }

    /// The light that a surface scatters to the eye: by shadow rays as returned, by photons as gathered.
    fn scattered<R: Chooser>(&mut self, hit: &Hit, path: &Branch, chooser: &mut R) -> [f64; 3] {
        let bsdf = self.view.scene.bsdf(hit.surface);
        let wo = Leg { direction: -path.direction, front: hit.front };
        for density in self.looks.densities {
            if let Bsdf::Lambertian { reflectance } = bsdf {
                let value = reflectance.by_channel().map(|r| r * FRAC_1_PI);
                let weight = path.weight.weight();
                let weight = std::array::from_fn(|c| weight[c] * value[c]);
                density.gather_evenly(hit, channels(weight), &mut self.gathered);
                continue;
            }
            let value = |travel: DVec3, front: bool| {
                channels(bsdf.value_between(hit.normal, Leg { direction: -travel, front }, wo))
            };
            density.gather(hit, channels(path.weight.weight()), value, &mut self.gathered);
        }
        let scene = self.view.scene;
        if !self.looks.direct {
            // The coordinates are used up all the same, so that what follows is the same path in every pass.
            for emitter in scene.emitters.as_slice() {
                place_on(emitter, chooser);
            }
            return [0.0; 3];
        }
        direct(scene, hit, wo, &path.at, chooser)
    }
}

impl Branch {
    fn leave(&mut self, hit: &Hit, onward: DVec3, through: bool) {
        self.at.leave(hit, if hit.front == through { Side::Back } else { Side::Front });
        (self.origin, self.direction) = (hit.position, onward);
        self.events += 1;
    }
}

fn incidence(hit: &Hit, direction: DVec3) -> Incidence {
    let sign = if hit.front { 1.0 } else { -1.0 };
    Incidence { direction, facet: hit.normal * sign, smooth: hit.shading_normal * sign, front: hit.front }
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

/// Luminance towards the eye that comes straight from emitters: all of them, a shadow ray each. Area lights stand in nobody's way.
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
        let place = place_on(emitter, chooser);
        let Some(light) = emitter.direct_light(hit.position, place) else { continue };
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

/// Coordinates of a point of an emitter, where it has more than one.
#[inline]
fn place_on<R: Chooser>(emitter: &Emitter, chooser: &mut R) -> [f64; 2] {
    match emitter.kind().direct_coordinates {
        0 => [0.0; 2],
        _ => [chooser.uniform(Purpose::BeamPosition), chooser.uniform(Purpose::BeamPosition)],
    }
}

/// Where an eye path goes on from anything but glass: (direction, whether through the surface); `None` where it ends.
fn pass_on<R: Chooser>(bsdf: &Bsdf, hit: &Hit, path: &mut Branch, chooser: &mut R) -> Option<(DVec3, bool)> {
    match bsdf {
        Bsdf::Mirror { reflectance } => {
            let onward = mirror::reflected(&incidence(hit, path.direction)).0;
            path.weight.attenuate(reflectance.by_channel(), chooser).then_some((onward, false))
        }
        Bsdf::Tabulated(table) => {
            let [mirrored, straight] = table.beyond(hit.normal, path.direction, hit.front);
            // Both only where the two sides of a table differ: one of them, counted twice.
            let (way, times) = match (mirrored, straight) {
                (Some(a), Some(b)) => (if chooser.happens(0.5) { a } else { b }, 2.0),
                (Some(way), None) | (None, Some(way)) => (way, 1.0),
                (None, None) => return None,
            };
            let part = way.part.map(|p| p * times);
            path.weight.attenuate(part, chooser).then_some((way.direction, way.through))
        }
        Bsdf::Dielectric(_) | Bsdf::Lambertian { .. } | Bsdf::Absorber => None,
    }
}

#[inline]
fn add(sum: &mut [f64; 3], weight: EyeWeight, value: [f64; 3]) {
    let w = weight.weight();
    (0..3).for_each(|c| sum[c] += w[c] * value[c]);
}

/// The first C of three channels: one channel stands for all of grey light.
#[inline]
pub(crate) fn channels<const C: usize>(rgb: [f64; 3]) -> [f64; C] {
    std::array::from_fn(|c| rgb[c])
}
