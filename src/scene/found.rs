//! What is found wrong with a scene when it is built: what is allowed, but gives numbers that are not those meant.

use crate::error::warning::{Severity, Warning};
use crate::geometry::{Near, Shape, SurfaceId};

use super::sheets::Clash;
use super::{Joint, Scene, SurfaceOptions, bodies, inside, near_field, sheets, sizes, units};

/// What is to be said of a scene beside every number of it; the pairs of open surfaces that contradict each other, of which
/// some of that is.
pub(super) fn look(scene: &Scene, options: &[SurfaceOptions]) -> (Vec<Clash>, Vec<Warning>) {
    let (clashes, of_sheets) = sheets::look(scene);
    let near = scene.geometry.nearly().iter().filter_map(|near| nearly(scene, options, near));
    let cracked = (0..options.len() as u32).filter_map(|s| cracked(scene, SurfaceId(s)));
    let of_lamps = near_field::warnings(scene);
    (
        clashes,
        of_sheets
            .into_iter()
            .chain(near)
            .chain(cracked)
            .chain(of_lamps)
            .chain(sizes::warning(scene))
            .chain(units::warnings(scene))
            .chain(bodies::warnings(scene, options))
            .chain(inside::warnings(scene))
            .collect(),
    )
}

/// Faces that all but touch: what was said of their contact is not heard. Of two opaque surfaces it does not matter.
fn nearly(scene: &Scene, options: &[SurfaceOptions], near: &Near) -> Option<Warning> {
    let is_clear = |s: SurfaceId| scene.material(s).is_transparent();
    if !near.surfaces.into_iter().any(is_clear) {
        return None;
    }
    let is_glued = near.surfaces.iter().any(|s| options[s.0 as usize].contact == Some(Joint::Glued));
    let surfaces = near.surfaces.map(|s| scene.geometry.name(s).to_owned());
    let [a, b] = &surfaces;
    let (distance, is_sunk) = (near.distance_m.abs(), near.distance_m < 0.0);
    let how = match (is_sunk, is_glued) {
        (true, _) => "one reaches into the other",
        (false, true) => "they do not touch, so `contact = \"glued\"` joins nothing",
        (false, false) => "they do not touch",
    };
    Some(Warning {
        severity: if is_sunk || is_glued { Severity::Doubtful } else { Severity::Note },
        code: "nearly-touching",
        message: format!("faces of \"{a}\" and \"{b}\" are {distance:.1e} m from each other: {how}"),
        remedy: "give them the same coordinates, so that they touch (`contact` says what is between them), or move them \
                 clearly apart"
            .into(),
        surfaces: surfaces.into(),
        share: None,
    })
}

/// Open edges that open nothing: light gets out of what was meant to be closed, or rather of what has no inside now.
fn cracked(scene: &Scene, surface: SurfaceId) -> Option<Warning> {
    let Shape::Mesh(mesh) = &scene.geometry.surfaces()[surface.0 as usize].shape else { return None };
    let topology = mesh.topology();
    if !topology.is_cracked(mesh.area()) {
        return None;
    }
    let (_, [from, to]) = topology.first_open_edge?;
    let (name, is_clear) =
        (scene.geometry.name(surface).to_owned(), scene.material(surface).is_transparent());
    let taken = if is_clear { ", so it bounds no body: it is taken for an open surface" } else { "" };
    Some(Warning {
        severity: if is_clear { Severity::Doubtful } else { Severity::Note },
        code: "cracks",
        message: format!(
            "the mesh \"{name}\" has {} open edges (the first from {from} to {to} m), but what they leave open is {:.1e} \
             of its area{taken}",
            topology.open_edges,
            topology.opening_m2 / mesh.area()
        ),
        surfaces: vec![name],
        share: None,
        remedy: "close it where it was made: merge vertices that are meant to be one (their coordinates must be equal to \
                 the last digit) and fill holes; `closed = true` makes open edges an error"
            .into(),
    })
}
