//! What tests of pictures share: scenes in code, plans, runs on so many threads.

use std::sync::atomic::AtomicBool;

use caustix::emitter::{AimFrame, AreaLight, Beam, BeamSection, Emitter, Panel};
use caustix::geometry::{Rectangle, Shape, Sphere, Surface};
use caustix::picture::Watch;
use caustix::run::{Plan, Settings};
use caustix::scene::camera::{Camera, CameraSpec};
use caustix::scene::{Scene, SceneBuilder};
use caustix::surface::{Lambertian, Material, Reflectance};
use glam::DVec3;

pub fn rectangle(name: &str, corner: DVec3, u: DVec3, v: DVec3) -> Surface {
    Surface { name: name.into(), shape: Shape::Rectangle(Rectangle::new(corner, u, v).unwrap()) }
}

pub fn sphere(name: &str, centre: DVec3, radius: f64) -> Surface {
    Surface { name: name.into(), shape: Shape::Sphere(Sphere::new(centre, radius).unwrap()) }
}

pub fn grey(part: f64) -> Material {
    Material::Lambertian(Lambertian::new(Reflectance::new(part).unwrap()))
}

/// A square beam of this half width.
pub fn beam(centre: DVec3, direction: DVec3, half: f64, flux_lm: f64) -> Emitter {
    let frame = AimFrame::new(direction, Some(direction.cross(direction.any_orthonormal_vector()))).unwrap();
    let section = BeamSection::Rectangle { width: 2.0 * half, height: 2.0 * half };
    Emitter::Beam(Beam::new(centre, frame, section, flux_lm).unwrap())
}

pub fn panel(centre: DVec3, aim: DVec3, up: DVec3, size_m: [f64; 2], flux_lm: f64) -> Emitter {
    let frame = AimFrame::new(aim, Some(up)).unwrap();
    Emitter::Panel(AreaLight::new(centre, frame, Panel::new(size_m).unwrap(), flux_lm).unwrap())
}

pub fn scene(
    surfaces: Vec<(Surface, Material)>,
    emitters: Vec<Emitter>,
    camera: Option<CameraSpec>,
) -> Scene {
    let mut scene = SceneBuilder::new();
    for (surface, material) in surfaces {
        scene.surface(surface.name, surface.shape, material);
    }
    for (i, emitter) in emitters.into_iter().enumerate() {
        scene.emitter(format!("lamp{i}"), emitter);
    }
    if let Some(spec) = camera {
        scene.camera(self::camera(spec));
    }
    scene.build().unwrap()
}

pub fn camera(spec: CameraSpec) -> Camera {
    Camera::new(spec).unwrap()
}

pub fn plan(photons: u64, replicates: u32) -> Plan {
    Plan::new(&Settings {
        photons: Some(photons),
        replicates: Some(replicates),
        seed: 7,
        ..Settings::default()
    })
    .unwrap()
}

/// Nobody watches.
pub fn unwatched(interrupt: &AtomicBool) -> Watch<'_> {
    Watch { interrupt, photons: &|_| {}, camera: &|_| {} }
}

pub fn on_threads<T: Send>(threads: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(work)
}
