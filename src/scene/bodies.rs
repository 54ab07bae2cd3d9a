//! Clear bodies that are not what they look like: of an index below that of air, in a body of their own index,
//! with faces given twice, cut by something opaque, glued to nothing.

use std::collections::{BTreeSet, HashMap};

use glam::DVec3;

use crate::error::warning::{Severity, Warning};
use crate::geometry::{Mesh, Shape, SurfaceId};

use super::media::{MediumId, Role};
use super::{Joint, Scene, SurfaceOptions};

/// Points looked at of a body.
const POINTS: usize = 32;
/// Pairs that cut each other, of those that are told.
const MOST_CUTS: usize = 1000;

/// What is to be said of the bodies of a scene.
pub(super) fn warnings(scene: &Scene, options: &[SurfaceOptions]) -> Vec<Warning> {
    let ids = || (0..options.len() as u32).map(SurfaceId);
    let is_body = |s: &SurfaceId| matches!(scene.media.role(*s), Role::Body { .. });
    let clear = || ids().filter(|s| scene.material(*s).is_transparent());
    let mut all: Vec<Warning> = clear().filter_map(|s| relative_index(scene, s)).collect();
    // Of all their faces, so once.
    let bounds: Vec<_> = scene.geometry.surfaces().iter().map(|s| s.shape.bounds()).collect();
    all.extend(ids().filter(is_body).filter_map(|s| nested_in_the_same(scene, &bounds, s)));
    all.extend(ids().filter(is_body).filter_map(|s| nested_part(scene, s)));
    all.extend(clear().filter_map(|s| doubled_faces(scene, s)));
    let near: BTreeSet<_> = scene.geometry.nearly().iter().map(|near| near.surfaces).collect();
    let cuts = ids().filter(is_body).flat_map(|body| {
        let solid = ids().filter(|s| scene.media.role(*s) == Role::Solid);
        let near = &near;
        solid.filter_map(move |solid| cut(scene, near, body, solid))
    });
    all.extend(cuts.take(MOST_CUTS));
    let contacts = scene.geometry.contacts().iter().map(|contact| contact.surfaces);
    let touching: BTreeSet<SurfaceId> =
        contacts.filter(|[a, b]| a != b).chain(near.iter().copied()).flatten().collect();
    all.extend(ids().filter(|s| !touching.contains(s)).filter_map(|s| glued_to_nothing(scene, options, s)));
    all
}

/// An index below 1: no clear matter has one.
fn relative_index(scene: &Scene, surface: SurfaceId) -> Option<Warning> {
    let (ior, _) = scene.material(surface).indices()?;
    if ior >= 1.0 {
        return None;
    }
    let name = scene.geometry.name(surface).to_owned();
    Some(Warning {
        severity: Severity::Note,
        code: "index-below-one",
        message: format!(
            "the refractive index {ior} of \"{name}\" is below that of air: indices are absolute (against air), not those of \
             one medium in another"
        ),
        surfaces: vec![name],
        share: None,
        remedy: format!(
            "a bubble, or what is hollow in glass, has `ior = 1`; if it is inverted, say `ior = {:.4}`",
            1.0 / ior
        ),
    })
}

/// Points on a body.
fn points(shape: &Shape) -> Vec<DVec3> {
    let faces = shape.face_count();
    let around = |centre: DVec3, radius: f64| {
        DVec3::AXES.into_iter().flat_map(move |axis| [centre + axis * radius, centre - axis * radius])
    };
    match shape {
        Shape::Sphere(sphere) => around(sphere.centre(), sphere.radius()).collect(),
        _ => {
            let some = (0..faces.min(POINTS)).filter_map(|k| shape.triangle(k * faces / faces.min(POINTS)));
            some.map(|[a, b, c]| (a + b + c) / 3.0).collect()
        }
    }
}

/// A body that is all in others, of which the one that fills its place has the same index.
fn nested_in_the_same(scene: &Scene, bounds: &[(DVec3, DVec3)], body: SurfaceId) -> Option<Warning> {
    let geometry = &scene.geometry;
    let Role::Body { medium, .. } = scene.media.role(body) else { return None };
    let surfaces = geometry.surfaces();
    let (low, high) = bounds[body.0 as usize];
    let others: Vec<SurfaceId> = (0..surfaces.len() as u32)
        .map(SurfaceId)
        .filter(|s| {
            let (l, h) = bounds[s.0 as usize];
            *s != body
                && matches!(scene.media.role(*s), Role::Body { .. })
                && l.cmple(low).all()
                && high.cmple(h).all()
        })
        .collect();
    // What fills a point, without the body itself.
    let filled = |point: DVec3| -> Option<(u32, MediumId, SurfaceId)> {
        let containing = others.iter().filter(|s| geometry.contains_surely(**s, point) == Some(true));
        let ranked = containing.filter_map(|s| match scene.media.role(*s) {
            Role::Body { medium, rank, .. } => Some((rank, medium, *s)),
            Role::Solid | Role::Open { .. } => None,
        });
        ranked.max_by_key(|(rank, ..)| *rank)
    };
    if others.is_empty() {
        return None;
    }
    let around: Option<Vec<_>> = points(&surfaces[body.0 as usize].shape).into_iter().map(filled).collect();
    let around = around?;
    let (_, _, outer) = *around.first()?;
    if around.iter().any(|(_, m, _)| *m != medium) {
        return None;
    }
    let (inner, outer) = (scene.geometry.name(body).to_owned(), scene.geometry.name(outer).to_owned());
    Some(Warning {
        severity: Severity::Note,
        code: "same-medium",
        message: format!(
            "the body \"{inner}\" lies in \"{outer}\" and has the same refractive index: it bounds nothing, light goes \
             through it as if it were not there"
        ),
        surfaces: vec![inner, outer],
        share: None,
        remedy: "if it is meant as a cavity, it is a body of air: `ior = 1`".into(),
    })
}

/// A part of a mesh in another part of it, wound alike.
fn nested_part(scene: &Scene, surface: SurfaceId) -> Option<Warning> {
    scene.geometry.has_nested_part(surface).then(|| {
        let name = scene.geometry.name(surface).to_owned();
        Warning {
            severity: Severity::Note,
            code: "same-medium",
            message: format!(
                "a part of the mesh \"{name}\" lies inside another part of it and is wound the same way: it bounds nothing, light \
                 goes through it as if it were not there"
            ),
            surfaces: vec![name],
            share: None,
            remedy: "if it is meant as a cavity, wind its faces the other way round, or make it a body of its own, of air: `ior = 1`"
                .into(),
        }
    })
}

/// Faces that a mesh has twice, once each way round.
fn doubled_faces(scene: &Scene, surface: SurfaceId) -> Option<Warning> {
    let Shape::Mesh(mesh) = &scene.geometry.surfaces()[surface.0 as usize].shape else { return None };
    if mesh.topology().duplicates.is_empty() {
        return None;
    }
    let count = both_ways(mesh);
    let name = scene.geometry.name(surface).to_owned();
    (count > 0).then(|| Warning {
        severity: Severity::Doubtful,
        code: "doubled-faces",
        message: format!(
            "{count} faces of the mesh \"{name}\" are there twice, once each way round: light goes in and out at one place, \
             and between them is no body"
        ),
        surfaces: vec![name],
        share: None,
        remedy: "export it without \"two-sided\" faces: each face of a clear body once, with its front out".into(),
    })
}

fn both_ways(mesh: &Mesh) -> usize {
    let mut ways: HashMap<[u32; 3], [bool; 2]> = HashMap::new();
    for triangle in mesh.triangles() {
        let [a, b, c] = *triangle;
        let mut key = [a, b, c];
        key.sort_unstable();
        let is_even = [[a, b, c], [b, c, a], [c, a, b]].contains(&key);
        ways.entry(key).or_default()[usize::from(is_even)] = true;
    }
    ways.values().filter(|ways| **ways == [true; 2]).count()
}

/// Something opaque that passes through the walls of a body.
fn cut(scene: &Scene, near: &BTreeSet<[SurfaceId; 2]>, body: SurfaceId, solid: SurfaceId) -> Option<Warning> {
    // What is sunk by rounding is told by itself.
    if near.contains(&[body.min(solid), body.max(solid)]) || !scene.geometry.is_cut_by(body, solid) {
        return None;
    }
    let [body, solid] = [body, solid].map(|s| scene.geometry.name(s).to_owned());
    Some(Warning {
        severity: Severity::Note,
        code: "cut-body",
        message: format!(
            "\"{solid}\" cuts through the body \"{body}\": light meets it from within the body, as if the two were glued, and \
             does not leave the body before"
        ),
        remedy:
            "if it is meant to stand on it, give both the same height (`contact` says what is between them)"
                .into(),
        surfaces: vec![body, solid],
        share: None,
    })
}

/// A surface that touches nothing, and says it is glued.
fn glued_to_nothing(scene: &Scene, options: &[SurfaceOptions], surface: SurfaceId) -> Option<Warning> {
    if options[surface.0 as usize].contact != Some(Joint::Glued) {
        return None;
    }
    let name = scene.geometry.name(surface).to_owned();
    Some(Warning {
        severity: Severity::Doubtful,
        code: "glued-to-nothing",
        message: format!("\"{name}\" has `contact = \"glued\"`, but no face of it touches another surface's"),
        surfaces: vec![name],
        share: None,
        remedy: "faces touch where they lie in one plane, to the last digit of their coordinates: give both the same height, or \
                 leave the key away"
            .into(),
    })
}
