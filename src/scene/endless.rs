//! Light that has no way out and meets nothing that absorbs: no run of it would end.

use glam::DVec3;

use crate::emitter::{Emits, Emitter};
use crate::error::{Diagnostic, Kind};
use crate::geometry::{Geometry, Shape, SurfaceId};
use crate::surface::Material;

/// The refusal of an emitter that stands in a closed surface in which nothing absorbs.
pub(super) fn refusal(
    name: &str,
    emitter: &Emitter,
    geometry: &Geometry,
    materials: &[Material],
) -> Option<Diagnostic> {
    let surfaces = geometry.surfaces();
    let walls = (0..surfaces.len() as u32).map(SurfaceId).filter(|id| {
        let material = &materials[id.0 as usize];
        geometry.is_closed(*id) && !material.is_transparent() && material.keeps_all()
    });
    let around = walls.filter(|id| is_inside(geometry, *id, emitter.position()));
    for wall in around {
        let within = surfaces[wall.0 as usize].shape.bounds();
        let others = surfaces.iter().zip(materials);
        if others.filter(|(s, _)| meet(s.shape.bounds(), within)).all(|(_, material)| material.keeps_all()) {
            let wall = &surfaces[wall.0 as usize].name;
            let found =
                format!("the light of emitter \"{name}\" inside \"{wall}\", where nothing absorbs any");
            let required = "a surface that absorbs light, or a way out: it would never end";
            let hint = format!("give \"{wall}\" a reflectance below 1");
            return Some(Diagnostic::new(Kind::Geometry, found, required).hint(hint));
        }
    }
    None
}

/// Whether a closed surface is around a point, whichever way its normals look.
fn is_inside(geometry: &Geometry, surface: SurfaceId, point: DVec3) -> bool {
    let is_inverted = match &geometry.surfaces()[surface.0 as usize].shape {
        Shape::Mesh(mesh) => mesh.topology().signed_volume_m3 < 0.0,
        Shape::Rectangle(_) | Shape::Sphere(_) | Shape::Paraboloid(_) => false,
    };
    geometry.is_behind(point, surface) != is_inverted
}

fn meet(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> bool {
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}
