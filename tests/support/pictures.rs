//! What tests of pictures share: scenes in code, plans, runs on so many threads.

use std::sync::atomic::AtomicBool;

use caustix::emitter::collimated::CrossSection;
use caustix::emitter::{Collimated, Emitter, Panel};
use caustix::geometry::{Rectangle, Shape, Sphere, Surface};
use caustix::picture::Watch;
use caustix::run::{Plan, Settings};
use caustix::scene::camera::{Camera, CameraSpec};
use caustix::scene::{Scene, SceneParts};
use caustix::surface::{Bsdf, Reflectance};
use glam::DVec3;

pub fn rectangle(name: &str, corner: DVec3, u: DVec3, v: DVec3) -> Surface {
    Surface { name: name.into(), shape: Shape::Rectangle(Rectangle::new(corner, u, v).unwrap()) }
}

pub fn sphere(name: &str, centre: DVec3, radius: f64) -> Surface {
    Surface { name: name.into(), shape: Shape::Sphere(Sphere::new(centre, radius).unwrap()) }
}

pub fn grey(part: f64) -> Bsdf {
    Bsdf::Lambertian { reflectance: Reflectance::grey(part) }
}

/// A square beam of this half width.
pub fn beam(centre: DVec3, direction: DVec3, half: f64, flux_lm: f64) -> Emitter {
    let x = direction.any_orthonormal_vector();
    let section = CrossSection::Rectangle(x * half, direction.cross(x) * half);
    Emitter::Collimated(Collimated { centre, direction, section, flux_lm })
}

pub fn panel(centre: DVec3, aim: DVec3, up: DVec3, size_m: [f64; 2], flux_lm: f64) -> Emitter {
    Emitter::Panel(Panel::new(centre, aim, up, size_m, flux_lm))
}

pub fn scene(surfaces: Vec<(Surface, Bsdf)>, emitters: Vec<Emitter>, camera: Option<CameraSpec>) -> Scene {
    let emitters = emitters.into_iter().enumerate().map(|(i, e)| (format!("lamp{i}"), e)).collect();
    Scene::new(SceneParts { surfaces, emitters, camera: camera.map(self::camera), ..SceneParts::default() })
        .unwrap()
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
