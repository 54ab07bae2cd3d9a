//! One eye path: along mirrors and through glass to the first surface that scatters.
//!
//! What it finds (Heckbert's notation; S mirrors and glass, D what scatters): emitters that it crosses, L S*
//! E; at the scattering surface by shadow rays what comes straight from emitters, L D S* E; and from the
//! photons there what had at least one event before, L (S|D)+ D S* E. Each once.

use std::collections::BTreeMap;
use std::ops::Range;

use glam::DVec3;

use crate::emitter::{Emits, Emitter};
use crate::geometry::{Hit, Side, SurfaceId, Whereabouts};
use crate::picture::camera::pinhole::EyeRay;
use crate::picture::camera::view::View;
use crate::picture::gather::{Density, Gathered};
use crate::sample::coordinates::{Chooser, Purpose};
use crate::scene::Scene;
use crate::scene::media::{Interface, Media};
use crate::surface::{EyeWeight, Incidence, Leg, Material, Way};
use crate::transport::walk::MAX_EVENTS;

/// What a pass adds to the picture: photons are traced, mapped and dropped pass by pass where memory does not
/// hold all of them.
#[derive(Debug, Clone)]
pub struct Pass<'d, const C: usize> {
    /// Densities of this pass's photons, caustic and diffuse; their photon's flux is that of the whole run,
    /// so that passes add up.
    pub densities: &'d [Density<'d, C>],
    /// Replicates that have photons in this pass.
    pub replicates: Range<u32>,
    /// Whether these replicates end with this pass. A pass that is a part of a replicate has one replicate.
    pub finishes: bool,
    /// Whether emitters and the background are added: in one pass only.
    pub emission: bool,
    /// Whether direct light is added: in one pass only.
    pub direct: bool,
}

impl<const C: usize> Pass<'_, C> {
    /// Emitters and the background alone: what is left to the eye where every photon is joined to the
    /// pinhole.
    pub const EMISSION: Self =
        Self { densities: &[], replicates: 0..0, finishes: true, emission: true, direct: false };
}

/// An eye path, and what of it is still to be followed.
pub(crate) struct EyePath<'a, const C: usize> {
    pub view: &'a View<'a>,
    pub pass: &'a Pass<'a, C>,
    pub gathered: Gathered<C>,
    /// Paths that the guard against endless ones ended.
    pub killed: u64,
    /// Paths looked along.
    pub paths: u64,
    /// Surfaces reached in another medium than the scene says is there: how many paths did, and the last of them.
    pub contradicted: BTreeMap<SurfaceId, (u64, u64)>,
    pending: Vec<Branch>,
}

/// A path on its way.
#[derive(Debug, Clone)]
struct Branch {
    ray: EyeRay,
    at: Whereabouts,
    weight: EyeWeight,
    /// Its part of the ways that glass offered.
    share: f64,
    /// Surfaces met since the eye.
    events: u32,
}

/// Both ways at glass are followed as long as the fainter one keeps this share, else one of them is chosen:
/// what glass mirrors is faint but often of something bright, and would be noise. At most as many paths as
/// the share goes into 1 come of one.
const LEAST_SHARE: f64 = 1.0 / 1024.0;

impl<'a, const C: usize> EyePath<'a, C> {
    /// Nothing looked at yet.
    pub fn new(view: &'a View<'a>, pass: &'a Pass<'a, C>) -> Self {
        let gathered = Gathered::new(pass.replicates.end as usize);
        let contradicted = BTreeMap::new();
        Self { view, pass, gathered, killed: 0, paths: 0, contradicted, pending: Vec::new() }
    }

    /// Follows a ray; gathers what photons bring and returns what is found without them, by channel, cd/m2.
    pub fn look<R: Chooser>(&mut self, ray: EyeRay, chooser: &mut R) -> [f64; 3] {
        self.paths += 1;
        let at = self.view.start.clone();
        self.pending.push(Branch { ray, at, weight: EyeWeight::ONE, share: 1.0, events: 0 });
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
            let Branch { ray, weight, .. } = path;
            let hit = scene.geometry.nearest(ray.origin, ray.direction, &path.at, &mut 0);
            if self.pass.emission {
                let end = hit.as_ref().map_or(f64::INFINITY, |hit| hit.t);
                add(found, weight, seen(scene, ray, end));
                if hit.is_none() {
                    add(found, weight, self.view.camera.background_cd_m2);
                }
            }
            let Some(hit) = hit else { return };
            let reached = scene.media.reached(&hit, &path.at);
            if reached.is_contradicted {
                self.count_contradicted(hit.surface);
            }
            let Interface::Between(indices) = reached.interface else {
                scene.media.leave(&mut path.at, &hit, hit.other_side());
                path.ray.origin = hit.position;
                continue;
            };
            let material = scene.material(hit.surface);
            if material.scatters() {
                let lit = self.scattered(material, &hit, &path, chooser);
                add(found, weight, lit);
            }
            if !self.pass_on(material, (&hit, indices), &mut path, chooser) {
                return;
            }
        }
        self.killed += 1;
    }

    /// Once a path, however often it comes by.
    #[cold]
    fn count_contradicted(&mut self, surface: SurfaceId) {
        let (count, last) = self.contradicted.entry(surface).or_default();
        if *last != self.paths {
            (*count, *last) = (*count + 1, self.paths);
        }
    }

    /// Follows what goes on specularly: whether anything does. Of two ways both are followed where nothing is
    /// absorbed and both are worth it, of which the mirrored one waits; else one of them is chosen.
    fn pass_on<R: Chooser>(
        &mut self,
        material: &Material,
        (hit, indices): (&Hit, [f64; 2]),
        path: &mut Branch,
        chooser: &mut R,
    ) -> bool {
        let media = &self.view.scene.media;
        let ways = material.specular(&Incidence::of(hit, path.ray.direction, indices));
        let (way, through, chance) = match (ways.mirrored, ways.through) {
            (None, None) => return false,
            (Some(mirrored), None) => (mirrored, false, 1.0),
            (None, Some(straight)) => (straight, true, 1.0),
            (Some(mirrored), Some(straight)) => {
                let r = if ways.lossless { mirrored.part[0] } else { 0.5 };
                if ways.lossless && path.share * r.min(1.0 - r) >= LEAST_SHARE {
                    let mut branch = Branch { share: path.share * r, ..path.clone() };
                    branch.take(media, hit, &mirrored, false, 1.0);
                    self.pending.push(branch);
                    path.share *= 1.0 - r;
                    (straight, true, 1.0)
                } else if chooser.happens(r) {
                    (mirrored, false, r)
                } else {
                    (straight, true, 1.0 - r)
                }
            }
        };
        path.take(media, hit, &way, through, chance);
        ways.lossless || path.weight.roulette(chooser)
    }

    /// The light that a surface scatters to the eye: by shadow rays as returned, by photons as gathered.
    fn scattered<R: Chooser>(
        &mut self,
        material: &Material,
        hit: &Hit,
        path: &Branch,
        chooser: &mut R,
    ) -> [f64; 3] {
        let wo = Leg { direction: -path.ray.direction, front: hit.front };
        let weight = path.weight.weight();
        for density in self.pass.densities {
            if let Some(value) = material.even_value() {
                let weight = std::array::from_fn(|c| weight[c] * value[c]);
                density.gather_evenly(hit, channels(weight), &mut self.gathered);
                continue;
            }
            let value = |travel: DVec3, front: bool| {
                channels(material.eval(hit.normal, Leg { direction: -travel, front }, wo))
            };
            density.gather(hit, channels(weight), value, &mut self.gathered);
        }
        let scene = self.view.scene;
        if !self.pass.direct {
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
    /// Goes on from a surface along a way that was chosen with this chance.
    fn take(&mut self, media: &Media, hit: &Hit, way: &Way, through: bool, chance: f64) {
        self.weight.follow(way, chance);
        media.leave(&mut self.at, hit, if hit.front == through { Side::Back } else { Side::Front });
        self.ray = EyeRay { origin: hit.position, direction: way.direction };
        self.events += 1;
    }
}

/// Luminance of the emitters that a ray crosses within a distance.
fn seen(scene: &Scene, ray: EyeRay, within_m: f64) -> [f64; 3] {
    let mut sum = [0.0; 3];
    for (i, emitter) in scene.emitters.as_slice().iter().enumerate() {
        if let Some((luminance, distance_m)) = emitter.seen(ray.origin, ray.direction)
            && distance_m < within_m
        {
            let colour = scene.emitter_colour(i);
            (0..3).for_each(|c| sum[c] += luminance * colour[c]);
        }
    }
    sum
}

/// Luminance towards the eye that comes straight from emitters: all of them, a shadow ray each. Area lights
/// stand in nobody's way.
fn direct<R: Chooser>(scene: &Scene, hit: &Hit, wo: Leg, at: &Whereabouts, chooser: &mut R) -> [f64; 3] {
    let material = scene.material(hit.surface);
    let from = |side: Side| {
        let mut at = at.clone();
        scene.media.leave(&mut at, hit, side);
        at
    };
    let sides = [from(Side::Front), from(Side::Back)];
    let mut sum = [0.0; 3];
    for (i, emitter) in scene.emitters.as_slice().iter().enumerate() {
        let place = place_on(emitter, chooser);
        let Some(light) = emitter.direct_light(hit.position, place) else { continue };
        let wi = Leg::new(light.towards, hit.normal);
        let value = material.eval(hit.normal, wi, wo);
        if value == [0.0; 3] {
            continue;
        }
        let start = &sides[usize::from(!wi.front)];
        if scene.is_hidden(hit.position, light.towards, light.distance_m, start) {
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

#[cfg(test)]
mod tests;
