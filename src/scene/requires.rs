//! What a scene requires: only that machinery runs (ARCHITECTURE, Numbers: "only what a scene requires").
//!
//! What is not in the list costs nothing: no storage and no branch in the inner loop. Only a scene of
//! materials in colour has photons with weights; only one with a camera keeps photons, and only where the
//! camera makes a map of them. Nothing that a scene can name needs wavelengths, so there are none.

use crate::emitter::Emits;
use crate::geometry::Shape;
use crate::surface::{Kind, Material, REQUIREMENTS};

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
    let words: Vec<&str> = materials.iter().flat_map(Material::requires).copied().collect();
    let mut emission: Vec<(u8, &str)> = emitters.iter().map(|e| e.kind().requires).collect();
    emission.sort_unstable();
    emission.dedup();
    let of_emitters_and_shapes = [
        ("choice of emitter", emitters.len() > 1),
        ("triangles", shape(|s| matches!(s, Shape::Mesh(_) | Shape::Rectangle(_)))),
        ("exact shapes", shape(|s| matches!(s, Shape::Sphere(_) | Shape::Paraboloid(_)))),
        ("smooth normals", specular && shape(|s| matches!(s, Shape::Mesh(m) if m.is_smooth()))),
    ];
    let of_materials = REQUIREMENTS.map(|word| (word, words.contains(&word)));
    let of_the_rest = [
        ("colour", scene.is_coloured()),
        ("receiver cells", cells(|c| matches!(c, Cells::Grid { .. }))),
        ("receiver faces", cells(|c| matches!(c, Cells::Faces { .. }))),
        ("camera", scene.camera.is_some()),
        ("stored photons", scene.camera.as_ref().is_some_and(|c| c.method == Method::Map)),
    ];
    let others = of_emitters_and_shapes.into_iter().chain(of_materials).chain(of_the_rest);
    let others = others.filter_map(|(word, required)| required.then_some(word));
    emission.into_iter().map(|(_, word)| word).chain(others).collect()
}
