//! What a run did not light: receivers at which nothing arrived, clear bodies and mirrors that no photon met; and
//! how long its photons were on their way.

use glam::DVec3;

use crate::emitter::Emits;
use crate::error::warning::{Severity, Warning, four_digits};
use crate::error::words::{grouped, quoted_names};
use crate::geometry::{Shape, SurfaceId, Whereabouts};
use crate::scene::Scene;
use crate::scene::receiver::{Receiver, ReceiverEvents};
use crate::surface::Kind;

use super::Outcome;

/// Below this many photons nothing is said of what none of them met.
const FEWEST: u64 = 1000;
/// From this many photons on, a surface that none met is unlikely to be just small.
const MANY: u64 = 1 << 16;
/// Events a photon from which on a run takes long.
const LONG: f64 = 1000.0;
/// Points of a receiver that are looked at from the emitters.
const POINTS: usize = 16;
/// Emitters that look.
const MOST_EMITTERS: usize = 16;
/// Clear faces looked through.
const MOST_FACES: usize = 64;

/// The warnings. `is_explained`: an earlier warning says what keeps the light away, so those of unlit things are left out.
pub(super) fn warnings(scene: &Scene, outcome: &Outcome, is_explained: bool) -> Vec<Warning> {
    let mut all: Vec<Warning> = long_walks(outcome).into_iter().collect();
    if outcome.photons >= FEWEST {
        let receivers = scene.receivers.iter().enumerate();
        all.extend(receivers.filter_map(|(i, receiver)| dark(scene, outcome, is_explained, i, receiver)));
        all.extend(unmet(scene, outcome).filter(|_| !is_explained));
    }
    all
}

/// Photons that are reflected very often: the number is right, and takes long.
fn long_walks(outcome: &Outcome) -> Option<Warning> {
    let events = events_a_photon(outcome);
    is_long(outcome).then(|| Warning {
        severity: Severity::Note,
        code: "long-walks",
        message: format!(
            "a photon is reflected or refracted {} times on average before it ends, so that a run takes long",
            four_digits(events)
        ),
        surfaces: Vec::new(),
        share: None,
        remedy: "few real surfaces absorb so little: look at the reflectances; else ask for fewer photons"
            .into(),
    })
}

/// Whether photons are on their way so long that a run takes long.
pub fn is_long(outcome: &Outcome) -> bool {
    events_a_photon(outcome) >= LONG
}

/// Events a photon, on average.
fn events_a_photon(outcome: &Outcome) -> f64 {
    outcome.census.exceptions.events as f64 / (outcome.photons as f64).max(1.0)
}

/// A receiver at which nothing arrived.
fn dark(
    scene: &Scene,
    outcome: &Outcome,
    is_explained: bool,
    i: usize,
    receiver: &Receiver,
) -> Option<Warning> {
    let (code, message, remedy) = match (outcome.totals().sum[i], outcome.other_events[i]) {
        (1.., _) => return None,
        (0, others @ 1..) => other_events(receiver, others as f64 * outcome.photon_lm),
        // Light on its other side has a warning of its own.
        (0, 0) if is_explained || outcome.turned_away[i] > 0 => return None,
        (0, 0) => nothing_arrives(scene, outcome, receiver),
    };
    let surfaces = vec![scene.geometry.name(receiver.surface).to_owned()];
    Some(Warning { severity: Severity::Note, code, message, surfaces, share: None, remedy: remedy.into() })
}

/// Code, message and remedy of a receiver that got light, but none of the kind that it counts.
fn other_events(receiver: &Receiver, lumens: f64) -> (&'static str, String, &'static str) {
    let (name, lumens) = (&receiver.name, four_digits(lumens));
    let (asked, arrived, remedy) = match receiver.events {
        ReceiverEvents::Indirect => (
            "indirect",
            "straight from emitters",
            "say `events = \"all\"` or \"direct\": nothing in the scene sends light on to it",
        ),
        ReceiverEvents::Direct | ReceiverEvents::All => (
            "direct",
            "after other events",
            "say `events = \"all\"` or \"indirect\": what has passed glass is not direct, however little it is bent",
        ),
    };
    let message =
        format!("receiver \"{name}\" counts {asked} light alone and got none; {lumens} lm arrived {arrived}");
    ("other-events", message, remedy)
}

/// Code, message and remedy of a receiver that got no light at all.
fn nothing_arrives(
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
) -> (&'static str, String, &'static str) {
    let message =
        format!("nothing arrived at receiver \"{}\" of {} photons", receiver.name, grouped(outcome.photons));
    let (message, remedy) = match blocker(scene, receiver) {
        Some(surface) => (
            format!("{message}: \"{}\" stands before it", scene.geometry.name(surface)),
            "move one of them, or put the receiver on the surface that is met first",
        ),
        None => (message, "look at where the light goes; a very small receiver needs more photons"),
    };
    ("nothing-arrives", message, remedy)
}

/// The opaque surface that blocks more than half of the sight lines from emitters to a receiver.
fn blocker(scene: &Scene, receiver: &Receiver) -> Option<SurfaceId> {
    let shape = &scene.geometry.surfaces()[receiver.surface.0 as usize].shape;
    let faces = shape.face_count();
    let some = |k: usize| shape.triangle(k * faces / faces.min(POINTS));
    let points: Vec<DVec3> = match shape {
        Shape::Sphere(sphere) => vec![sphere.centre()],
        Shape::Paraboloid(paraboloid) => vec![paraboloid.vertex()],
        _ => (0..faces.min(POINTS)).filter_map(some).map(|[a, b, c]| (a + b + c) / 3.0).collect(),
    };
    let (mut seen, mut looks) = (Vec::<(SurfaceId, usize)>::new(), 0);
    for (i, emitter) in scene.emitters.as_slice().iter().enumerate().take(MOST_EMITTERS) {
        let (from, start) = (emitter.position(), scene.start(i));
        for point in &points {
            looks += 1;
            let Some(direction) = (*point - from).try_normalize() else { continue };
            let Some(surface) = first_opaque(scene, from, direction, start.clone()) else { continue };
            match seen.iter_mut().find(|(s, _)| *s == surface) {
                Some((_, count)) => *count += 1,
                None => seen.push((surface, 1)),
            }
        }
    }
    let (surface, count) = seen.into_iter().max_by_key(|(_, count)| *count)?;
    (surface != receiver.surface && 2 * count > looks).then_some(surface)
}

/// The first surface on a straight line that is not clear.
fn first_opaque(scene: &Scene, from: DVec3, direction: DVec3, mut at: Whereabouts) -> Option<SurfaceId> {
    let mut origin = from;
    for _ in 0..MOST_FACES {
        let hit = scene.geometry.nearest(origin, direction, &at, &mut 0)?;
        if !scene.material(hit.surface).is_transparent() {
            return Some(hit.surface);
        }
        scene.media.leave(&mut at, &hit, hit.other_side());
        origin = hit.position;
    }
    None
}

/// Clear surfaces and mirrors that no photon met.
fn unmet(scene: &Scene, outcome: &Outcome) -> Option<Warning> {
    let ids = (0..scene.materials().len() as u32).map(SurfaceId);
    let specular: Vec<SurfaceId> = ids.filter(|s| scene.material(*s).kind() == Kind::Specular).collect();
    let is_met = |s: &&SurfaceId| outcome.census.exceptions.may_have_met(**s);
    let unmet: Vec<SurfaceId> = specular.iter().filter(|s| !is_met(s)).copied().collect();
    if unmet.is_empty() {
        return None;
    }
    let is_all = unmet.len() == specular.len() && scene.camera.is_none();
    let surfaces: Vec<String> = unmet.iter().map(|s| scene.geometry.name(*s).to_owned()).collect();
    let names = quoted_names(&surfaces);
    let and = if is_all { ", and there is nothing else that refracts or reflects it" } else { "" };
    Some(Warning {
        severity: if is_all && outcome.photons >= MANY { Severity::Doubtful } else { Severity::Note },
        code: "unlit",
        message: format!("no light met {names} ({} photons){and}", grouped(outcome.photons)),
        surfaces,
        share: None,
        remedy: "look at the place of the lamp, and at `translate` and the units of a mesh; what is very small or far away \
                 needs more photons"
            .into(),
    })
}
