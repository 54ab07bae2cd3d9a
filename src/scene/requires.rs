//! What a scene requires: only that machinery runs (ARCHITECTURE, Numbers: "only what a scene requires").
//!
//! What is not in the list costs nothing: no storage and no branch in the inner loop. Only a scene of materials in colour
//! has photons with weights; only one with a camera keeps photons, and only where the camera makes a map of them. Nothing that a
//! scene can name needs wavelengths, so there are none.

use crate::emitter::Emits;
use crate::geometry::Shape;
use crate::surface::Bsdf;

use super::Scene;
use super::camera::Method;
use super::receiver::Cells;

/// The machinery this scene needs, each word once, in a fixed order.
pub fn requirements(scene: &Scene) -> Vec<&'static str> {
    let emitters = scene.emitters.as_slice();
    let surfaces = scene.geometry.surfaces();
    let bsdf = |test: fn(&Bsdf) -> bool| scene.bsdfs().iter().any(test);
    let shape = |test: fn(&Shape) -> bool| surfaces.iter().any(|s| test(&s.shape));
    let cells = |test: fn(&Cells) -> bool| scene.receivers.iter().any(|r| test(&r.cells));
    let specular = bsdf(|b| matches!(b, Bsdf::Dielectric(_) | Bsdf::Mirror { .. }));
    let mut emission: Vec<(u8, &str)> = emitters.iter().map(|e| e.kind().requires).collect();
    emission.sort_unstable();
    emission.dedup();
    let others = [
        ("choice of emitter", emitters.len() > 1),
        ("triangles", shape(|s| matches!(s, Shape::Mesh(_) | Shape::Rectangle(_)))),
        ("exact shapes", shape(|s| matches!(s, Shape::Sphere(_) | Shape::Paraboloid(_)))),
        ("smooth normals", specular && shape(|s| matches!(s, Shape::Mesh(m) if m.is_smooth()))),
        ("refraction", bsdf(|b| matches!(b, Bsdf::Dielectric(_)))),
        ("mirror reflection", bsdf(|b| matches!(b, Bsdf::Mirror { .. }))),
        (
            "diffuse scattering",
            bsdf(|b| matches!(b, Bsdf::Lambertian { reflectance } if reflectance.luminous() > 0.0)),
        ),
        ("tabulated scattering", bsdf(|b| matches!(b, Bsdf::Tabulated(_)))),
        ("colour", scene.is_coloured()),
        ("receiver cells", cells(|c| matches!(c, Cells::Grid { .. }))),
        ("receiver faces", cells(|c| matches!(c, Cells::Faces { .. }))),
        ("camera", scene.camera.is_some()),
        ("stored photons", scene.camera.as_ref().is_some_and(|c| c.method == Method::Map)),
    ];
    let others = others.into_iter().filter_map(|(word, required)| required.then_some(word));
    emission.into_iter().map(|(_, word)| word).chain(others).collect()
}
