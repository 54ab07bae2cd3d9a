//! Light that has no way out and meets nothing that absorbs: no run of it would end.

use glam::DVec3;

use crate::emitter::{Emission, Emits, Emitter};
use crate::error::words::{grouped, quoted_names};
use crate::error::{Diagnostic, Kind};
use crate::geometry::{Geometry, Shape, Side, SurfaceId};
use crate::sample::coordinates::Coordinates;
use crate::sample::method::Sampling;
use crate::sequence::independent::IndependentPoints;
use crate::surface::{Event, Grey, Incidence, Material};

use super::Scene;
use super::media::Interface;

/// Photons of the probe of a scene in which nothing absorbs, of fixed points, and how many at a time.
const PROBE: u64 = 32;
const PART: u64 = 8;
const PROBE_SEED: u64 = 0x656e_646c;
/// Reflections after which a photon of it is taken to stay for ever, and faces that it may meet in all.
const MOST_REFLECTIONS: u32 = 20_000;
const MOST_FACES: u32 = 4 * MOST_REFLECTIONS;

/// The refusal of a scene of separate surfaces in which nothing absorbs, if most light does not find a way out;
/// the first of the surfaces between which it goes round.
pub(super) fn of_room(scene: &Scene) -> Option<(SurfaceId, Diagnostic)> {
    let ids = (0..scene.materials().len() as u32).map(SurfaceId);
    let walls: Vec<SurfaceId> = ids.filter(|s| !scene.material(*s).is_transparent()).collect();
    let first = *walls.first()?;
    if !scene.materials().iter().all(Material::keeps_all) {
        return None;
    }
    let points = IndependentPoints::new(PROBE_SEED, 0);
    let (mut traced, mut kept) = (0, 0);
    for start in (0..PROBE).step_by(PART as usize) {
        traced += PART;
        kept += (start..start + PART).filter(|index| stays(scene, &points, *index)).count() as u64;
        if 2 * kept <= traced {
            return None;
        }
    }
    let found = format!(
        "a scene in which nothing absorbs light: of {} photons {} went on after {} reflections",
        grouped(traced),
        grouped(kept),
        grouped(u64::from(MOST_REFLECTIONS))
    );
    let required = "a surface that absorbs light, or a way out: it would never end";
    let names = quoted_names(walls.iter().map(|s| scene.geometry.name(*s)));
    let one_of = if walls.len() > 1 { "one of " } else { "" };
    let hint = format!("give {one_of}{names} a reflectance below 1 (it is 1 where a mirror says none)");
    Some((first, Diagnostic::new(Kind::Geometry, found, required).hint(hint)))
}

/// Whether a photon goes on for ever, as far as one can tell.
fn stays(scene: &Scene, points: &IndependentPoints, index: u64) -> bool {
    let mut coordinates = Coordinates::new(points, index, true);
    let Some((emitter, emission)) = scene.emitters.emit(Sampling::default(), &mut coordinates) else {
        return false;
    };
    let Emission { mut origin, mut direction, .. } = emission;
    let (mut at, mut reflections) = (scene.start(emitter), 0);
    for _ in 0..MOST_FACES {
        let Some(hit) = scene.geometry.nearest(origin, direction, &at, &mut 0) else { return false };
        origin = hit.position;
        let Interface::Between(indices) = scene.media.reached(&hit, &at).interface else {
            scene.media.leave(&mut at, &hit, hit.other_side());
            continue;
        };
        let (material, incidence) = (scene.material(hit.surface), Incidence::of(&hit, direction, indices));
        let Event::Leaves { direction: onward, through, .. } =
            material.scatter(&incidence, &mut coordinates, &mut Grey)
        else {
            return false;
        };
        scene.media.leave(&mut at, &hit, if hit.front == through { Side::Back } else { Side::Front });
        direction = onward;
        reflections += u32::from(!material.is_transparent());
        if reflections == MOST_REFLECTIONS {
            return true;
        }
    }
    false
}

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
pub(super) fn is_inside(geometry: &Geometry, surface: SurfaceId, point: DVec3) -> bool {
    geometry.is_behind(point, surface) != is_inverted(&geometry.surfaces()[surface.0 as usize].shape)
}

/// Whether the normals of a closed surface look inward.
pub(super) fn is_inverted(shape: &Shape) -> bool {
    match shape {
        Shape::Mesh(mesh) => mesh.topology().signed_volume_m3 < 0.0,
        Shape::Rectangle(_) | Shape::Sphere(_) | Shape::Paraboloid(_) => false,
    }
}

fn meet(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> bool {
    a.0.cmple(b.1).all() && b.0.cmple(a.1).all()
}
