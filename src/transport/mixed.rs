//! Places that light reaches in two media: through an open surface, and past it.
//!
//! Behind an open transparent surface is the medium that it states, up to the walls. A window that is drawn as one sheet, or a
//! sheet of water that does not reach to its walls, has places behind it that lamp or camera see directly, through another
//! medium: one of the two is wrong. A probe of few photons finds them.

use std::collections::BTreeMap;

use glam::DVec3;
use rayon::prelude::*;

use crate::emitter::Emits;
use crate::geometry::{Side, SurfaceId, Whereabouts};
use crate::sample::coordinates::Coordinates;
use crate::sample::method::Sampling;
use crate::scene::Scene;
use crate::scene::media::{MediumId, Role};
use crate::sequence::independent::IndependentPoints;
use crate::surface::Grey;

use super::census::Exceptions;
use super::trap::walk;
use super::walk::{Arrival, Sink};

/// Photons of the probe, of fixed points: the same for every run of a scene.
const PROBE: u64 = 4096;
const PROBE_SEED: u64 = 0x6d69_7865;
/// Emitters looked for from each place.
const MOST_EMITTERS: usize = 16;

/// What sees a place directly that light reaches through an open surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Witness {
    /// An emitter, by its number.
    Emitter(usize),
    /// The camera.
    Camera,
    /// A place that other light reaches without it, with nothing between the two.
    Place(SurfaceId),
}

/// Places behind an open surface that are seen past it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Mixed {
    /// The surface.
    pub sheet: SurfaceId,
    /// What sees them.
    pub witness: Witness,
    /// The media there, of the light through the surface and of what sees it.
    pub media: [MediumId; 2],
    /// Share of all photons that reach such places.
    pub share: f64,
}

/// The open surfaces past which places behind them are seen, each once.
pub fn probe(scene: &Scene) -> Vec<Mixed> {
    if !scene.media.has_sheets() {
        return Vec::new();
    }
    let camera = scene.camera.as_ref().map(|camera| camera.position);
    // In a body the ambient medium says nothing.
    let is_in_a_body = |point: DVec3| {
        scene.geometry.all_behind(point).iter().any(|s| matches!(scene.media.role(*s), Role::Body { .. }))
    };
    let camera = camera.filter(|position| !is_in_a_body(*position));
    let points = IndependentPoints::new(PROBE_SEED, 0);
    let follow = |index: u64| {
        let mut coordinates = Coordinates::new(&points, index, true);
        let (emitter, emission) = scene.emitters.emit(Sampling::default(), &mut coordinates)?;
        let mut places =
            Places { scene, camera, index: index as usize, sheet: None, found: None, place: None };
        let start = scene.start(emitter);
        walk(scene, emission, start, Grey, &mut coordinates, &mut places, &mut Exceptions::default());
        Some((places.found, places.place))
    };
    let (found, places): (Vec<_>, Vec<_>) = (0..PROBE).into_par_iter().filter_map(follow).unzip();
    let places: Vec<Place> = places.into_iter().flatten().collect();
    let found = found.into_iter().flatten().chain(beside(scene, &places));
    let mut counts: BTreeMap<SurfaceId, (u64, Found)> = BTreeMap::new();
    for found in found {
        let (count, first) = counts.entry(found.sheet).or_insert((0, found));
        *count += 1;
        *first = if found.witness < first.witness { found } else { *first };
    }
    let mixed = |(count, Found { sheet, witness, media }): (u64, Found)| Mixed {
        sheet,
        witness,
        media,
        share: count as f64 / PROBE as f64,
    };
    counts.into_values().map(mixed).collect()
}

#[derive(Debug, Clone, Copy)]
struct Found {
    sheet: SurfaceId,
    witness: Witness,
    media: [MediumId; 2],
}

/// Follows a photon, and looks around where it arrives.
struct Places<'a> {
    scene: &'a Scene,
    camera: Option<DVec3>,
    index: usize,
    /// The open surface met last.
    sheet: Option<SurfaceId>,
    found: Option<Found>,
    /// Where it first arrived at an opaque surface, outside all bodies.
    place: Option<Place>,
}

/// A point on a photon's way, shortly before it arrives at an opaque surface.
#[derive(Debug, Clone)]
struct Place {
    /// Where it arrives, and on what.
    arrival: DVec3,
    surface: SurfaceId,
    /// From there back on its way, m, as far as it may be gone.
    back: DVec3,
    at: Whereabouts,
    sheet: Option<SurfaceId>,
}

/// Places that are looked at from each.
const LOOKS: usize = 8;
/// A place is so far off the surface, of the distance of the two.
const OFF: f64 = 0.1;

/// Places behind a sheet from which one sees, with nothing between, places in another medium lit without it.
fn beside<'a>(scene: &'a Scene, places: &'a [Place]) -> impl Iterator<Item = Found> + 'a {
    let lit_without: Vec<&Place> = places.iter().filter(|place| place.sheet.is_none()).collect();
    places.iter().enumerate().filter_map(move |(i, here)| {
        let sheet = here.sheet?;
        (0..LOOKS.min(lit_without.len())).find_map(|k| {
            let there = lit_without[(LOOKS * i + k) % lit_without.len()];
            let media = [here.at.ambient(), there.at.ambient()];
            let apart = (there.arrival - here.arrival).length();
            let before = |p: &Place| p.arrival + p.back * (OFF * apart / p.back.length()).min(0.5);
            let (from, to) = (before(here), before(there));
            let direction = (to - from).try_normalize()?;
            let is_seen = media[0] != media[1]
                && !scene.geometry.occluded(from, direction, (to - from).length(), &here.at);
            is_seen.then_some(Found { sheet, witness: Witness::Place(there.surface), media })
        })
    })
}

impl Sink for Places<'_> {
    fn arrive(&mut self, arrival: &Arrival<'_>) {
        let (scene, here) = (self.scene, arrival.whereabouts.ambient());
        let is_solid = scene.media.role(arrival.hit.surface) == Role::Solid;
        if is_solid && self.place.is_none() && scene.media.bodies_of(arrival.whereabouts).next().is_none() {
            self.place = Some(Place {
                arrival: arrival.hit.position,
                surface: arrival.hit.surface,
                back: arrival.direction * -arrival.hit.t,
                at: Whereabouts::start(arrival.whereabouts.behind()).in_ambient(here),
                sheet: self.sheet,
            });
        }
        match scene.media.role(arrival.hit.surface) {
            Role::Open { .. } => self.sheet = Some(arrival.hit.surface),
            Role::Body { .. } => {}
            Role::Solid if self.found.is_none() => {
                let Some(sheet) = self.sheet else { return };
                if scene.media.bodies_of(arrival.whereabouts).next().is_some() {
                    return;
                }
                let (witness, there) = match self.witness(arrival, here) {
                    Some(found) => found,
                    None => return,
                };
                self.found = Some(Found { sheet, witness, media: [here, there] });
            }
            Role::Solid => {}
        }
    }
}

impl Places<'_> {
    /// What sees the place from another medium, and that medium.
    fn witness(&self, arrival: &Arrival<'_>, here: MediumId) -> Option<(Witness, MediumId)> {
        let (scene, place) = (self.scene, arrival.hit.position);
        let emitters = scene.emitters.as_slice();
        for k in 0..emitters.len().min(MOST_EMITTERS) {
            let i = (self.index + k) % emitters.len();
            let start = scene.start(i);
            if start.ambient() == here || scene.media.bodies_of(&start).next().is_some() {
                continue;
            }
            let Some(light) = emitters[i].direct_light(place, [0.5; 2]) else { continue };
            if self.sees(arrival, light.towards, light.distance_m) {
                return Some((Witness::Emitter(i), start.ambient()));
            }
        }
        let to_camera = self.camera? - place;
        let is_seen =
            scene.camera_ambient != here && self.sees(arrival, to_camera.normalize(), to_camera.length());
        is_seen.then_some((Witness::Camera, scene.camera_ambient))
    }

    /// Whether nothing at all stands between the place and a point on the side of arrival.
    fn sees(&self, arrival: &Arrival<'_>, towards: DVec3, distance_m: f64) -> bool {
        let (hit, front) = (arrival.hit, arrival.hit.front);
        if (towards.dot(hit.normal) > 0.0) != front {
            return false;
        }
        let mut at = arrival.whereabouts.clone();
        self.scene.media.leave(&mut at, hit, if front { Side::Front } else { Side::Back });
        !self.scene.geometry.occluded(hit.position, towards, distance_m, &at)
    }
}
