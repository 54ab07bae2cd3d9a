//! What a scene requires: only that machinery runs (ARCHITECTURE, Numbers: "only what a scene requires").
//!
//! What is not in the list costs nothing: no storage and no branch in the inner loop. Only a scene of
//! materials in colour has photons with weights; only one with a camera keeps photons, and only where the
//! camera makes a map of them. Nothing that a scene can name needs wavelengths, so there are none.

use std::collections::BTreeSet;

use crate::emitter::Emits;
use crate::geometry::Shape;
use crate::surface::{Kind, Material};

use super::Scene;
use super::camera::Method;
use super::receiver::Cells;

/// The machinery this scene needs, each word once, in a fixed order.
pub fn requirements(scene: &Scene) -> Vec<&'static str> {
    let emitters = scene.emitters.as_slice();
    let surfaces = scene.geometry.surfaces();
    let shape = |test: fn(&Shape) -> bool| surfaces.iter().any(|s| test(&s.shape));
    let cells = |test: fn(&Cells) -> bool| scene.receivers.iter().any(|r| test(&r.cells));
    let materials = scene.materials();
    let specular = materials.iter().any(|m| m.kind() == Kind::Specular);
    let of_materials = ranked(materials.iter().flat_map(Material::requires).copied());
    let emission = ranked(emitters.iter().map(|e| e.kind().requires));
    let of_emitters_and_shapes = [
        ("choice of emitter", emitters.len() > 1),
        ("triangles", shape(|s| matches!(s, Shape::Mesh(_) | Shape::Rectangle(_)))),
        ("exact shapes", shape(|s| matches!(s, Shape::Sphere(_) | Shape::Paraboloid(_)))),
        ("smooth normals", specular && shape(|s| matches!(s, Shape::Mesh(m) if m.is_smooth()))),
    ];
    let of_the_rest = [
        ("colour", scene.is_coloured()),
        ("receiver cells", cells(|c| matches!(c, Cells::Grid { .. }))),
        ("receiver faces", cells(|c| matches!(c, Cells::Faces { .. }))),
        ("far field", !scene.far_fields.is_empty()),
        ("camera", scene.camera.is_some()),
        ("stored photons", scene.camera.as_ref().is_some_and(|c| c.method == Method::Map)),
    ];
    let of_emitters_and_shapes = of_emitters_and_shapes.into_iter().filter_map(if_required);
    let of_the_rest = of_the_rest.into_iter().filter_map(if_required);
    emission.chain(of_emitters_and_shapes).chain(of_materials).chain(of_the_rest).collect()
}

fn if_required((word, is_required): (&'static str, bool)) -> Option<&'static str> {
    is_required.then_some(word)
}

/// Words in the order of their ranks, each once.
fn ranked(words: impl Iterator<Item = (u8, &'static str)>) -> impl Iterator<Item = &'static str> {
    words.collect::<BTreeSet<_>>().into_iter().map(|(_, word)| word)
}
