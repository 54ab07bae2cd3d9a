//! What stands inside something: lamps and cameras in what no light gets out of, anything in a clear body.

use glam::DVec3;

use crate::error::warning::{Severity, Warning};
use crate::geometry::{Shape, SurfaceId, Whereabouts};

use super::Scene;
use super::endless::{is_inside, is_inverted};
use super::media::Role;
use super::receiver::ReceiverSide;

/// The code of a lamp whose light stays where nothing looks.
pub const LAMP_INSIDE: &str = "lamp-inside";

/// Points looked at of a surface.
const POINTS: usize = 16;
/// Columns and rows of rays from the camera, at most.
const RAYS: u32 = 256;

/// What is to be said of it.
pub(super) fn warnings(scene: &Scene) -> Vec<Warning> {
    let ids = || (0..scene.materials().len() as u32).map(SurfaceId);
    let walls: Vec<SurfaceId> =
        ids().filter(|s| scene.geometry.is_closed(*s) && scene.material(*s).is_opaque()).collect();
    let mut all: Vec<Warning> = walls.iter().filter_map(|wall| lamps_in(scene, *wall)).collect();
    all.extend(walls.iter().filter_map(|wall| camera_in(scene, *wall)));
    let bodies = ids().filter(|s| matches!(scene.media.role(*s), Role::Body { .. }));
    all.extend(bodies.filter_map(|body| all_in(scene, body)));
    all.extend(nothing_seen(scene));
    all
}

/// Emitters within a closed surface, by name.
fn lamps<'a>(scene: &'a Scene, surface: SurfaceId) -> impl Iterator<Item = String> + 'a {
    let is_inverted = is_inverted(&scene.geometry.surfaces()[surface.0 as usize].shape);
    let inside = scene.emitter_names.iter().enumerate().filter(move |(i, _)| {
        let is_behind = scene.start(*i).behind().any(|s| s == surface);
        is_behind != is_inverted
    });
    inside.map(|(_, name)| format!("emitter \"{name}\""))
}

/// Lamps in what lets no light out, and in which nothing measures or sees it.
fn lamps_in(scene: &Scene, wall: SurfaceId) -> Option<Warning> {
    let lamps: Vec<String> = lamps(scene, wall).collect();
    let is_watched = scene.camera.as_ref().is_some_and(|c| is_inside(&scene.geometry, wall, c.position));
    if lamps.is_empty() || is_watched || measures_within(scene, wall) {
        return None;
    }
    let name = scene.geometry.name(wall).to_owned();
    Some(Warning {
        severity: Severity::Doubtful,
        code: LAMP_INSIDE,
        message: format!(
            "{} inside \"{name}\", which is closed and lets no light through: all of it ends there",
            standing(&lamps)
        ),
        surfaces: vec![name],
        share: None,
        remedy: "move it out, or put a receiver on the inside (`side = \"back\"`)".into(),
    })
}

/// Whether a receiver counts what arrives on the inside of a closed surface, or on something within.
fn measures_within(scene: &Scene, wall: SurfaceId) -> bool {
    let surfaces = scene.geometry.surfaces();
    let outward = match is_inverted(&surfaces[wall.0 as usize].shape) {
        true => ReceiverSide::Back,
        false => ReceiverSide::Front,
    };
    scene.receivers.iter().any(|receiver| {
        if receiver.surface == wall {
            return receiver.side != outward;
        }
        points(&surfaces[receiver.surface.0 as usize].shape).any(|p| is_inside(&scene.geometry, wall, p))
    })
}

/// Points on a shape.
fn points(shape: &Shape) -> impl Iterator<Item = DVec3> {
    let faces = shape.face_count();
    (0..faces.min(POINTS)).map(move |k| match (shape, shape.triangle(k * faces / faces.min(POINTS))) {
        (_, Some([a, b, c])) => (a + b + c) / 3.0,
        (Shape::Sphere(sphere), _) => sphere.centre() + DVec3::Z * sphere.radius(),
        (Shape::Paraboloid(paraboloid), _) => paraboloid.vertex(),
        (Shape::Mesh(_) | Shape::Rectangle(_), None) => DVec3::NAN,
    })
}

/// A camera in what lets no light in, without a lamp in it.
fn camera_in(scene: &Scene, wall: SurfaceId) -> Option<Warning> {
    let camera = scene.camera.as_ref()?;
    if !is_inside(&scene.geometry, wall, camera.position) || lamps(scene, wall).next().is_some() {
        return None;
    }
    let name = scene.geometry.name(wall).to_owned();
    Some(Warning {
        severity: Severity::Doubtful,
        code: "camera-inside",
        message: format!(
            "the camera stands inside \"{name}\", which is closed and lets no light through: its picture is black"
        ),
        surfaces: vec![name],
        share: None,
        remedy: "move it out, or leave the face before it away".into(),
    })
}

/// Lamps, camera and receivers in a clear body: legal, but also what mixed up units and places look like.
fn all_in(scene: &Scene, body: SurfaceId) -> Option<Warning> {
    let mut within: Vec<String> = lamps(scene, body).collect();
    let camera = scene.camera.as_ref().filter(|camera| is_inside(&scene.geometry, body, camera.position));
    within.extend(camera.map(|_| "the camera".to_owned()));
    let receivers = scene.receivers.iter().filter(|receiver| {
        let shape = &scene.geometry.surfaces()[receiver.surface.0 as usize].shape;
        receiver.surface != body
            && points(shape).all(|p| scene.geometry.contains_surely(body, p) == Some(true))
    });
    within.extend(receivers.map(|receiver| format!("receiver \"{}\"", receiver.name)));
    if within.is_empty() {
        return None;
    }
    let name = scene.geometry.name(body).to_owned();
    let ior = scene.material(body).indices().map_or(1.0, |(ior, _)| ior);
    Some(Warning {
        severity: Severity::Note,
        code: "inside-body",
        message: format!("{} inside the body \"{name}\" of refractive index {ior}", standing(&within)),
        surfaces: vec![name],
        share: None,
        remedy:
            "if it is not meant to, look at positions and at the units of the mesh (`scale`, `translate`)"
                .into(),
    })
}

/// That these stand.
fn standing(list: &[String]) -> String {
    format!("{} {}", list.join(" and "), if list.len() == 1 { "stands" } else { "stand" })
}

/// A camera that looks past everything.
fn nothing_seen(scene: &Scene) -> Option<Warning> {
    let camera = scene.camera.as_ref()?;
    let behind = scene.geometry.all_behind(camera.position);
    let start = Whereabouts::start(behind).in_ambient(scene.camera_ambient);
    let (right, up) = (camera.forward.cross(camera.up), camera.up);
    let [columns, rows] = camera.pixels;
    let half_width = libm::tan(0.5 * camera.fov_deg.to_radians());
    let half_height = half_width * f64::from(rows) / f64::from(columns);
    // From -1 to 1, from the middle outwards, since something is there as a rule.
    let along = |n: u32| {
        let n = n.min(RAYS);
        let mut all: Vec<f64> = (0..n).map(|k| f64::from(2 * k + 1) / f64::from(n) - 1.0).collect();
        all.sort_by(|a, b| a.abs().total_cmp(&b.abs()));
        all
    };
    let (across, down) = (along(columns), along(rows));
    let sees = |x: f64, y: f64| {
        let direction = camera.forward + right * (x * half_width) + up * (y * half_height);
        scene.geometry.nearest(camera.position, direction.normalize(), &start, &mut 0).is_some()
    };
    if down.iter().any(|y| across.iter().any(|x| sees(*x, *y))) {
        return None;
    }
    Some(Warning {
        severity: Severity::Doubtful,
        code: "nothing-seen",
        message: "the camera sees no surface: its whole picture is background".into(),
        surfaces: Vec::new(),
        share: None,
        remedy: "look at its position and look_at".into(),
    })
}
