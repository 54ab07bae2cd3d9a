//! Eye paths through glass and by mirrors, in closed form.

use super::*;
use crate::emitter::Isotropic;
use crate::geometry::{Rectangle, Shape, box_mesh};
use crate::sample::coordinates::Coordinates;
use crate::scene::SceneBuilder;
use crate::scene::camera::{Camera, CameraSpec};
use crate::sequence::independent::IndependentPoints;
use crate::surface::{Dielectric, Mirror, Reflectance};

const PHOTOGRAPHED: [f64; 3] = [3.0, 2.0, 1.0];

/// Mean over so many paths of what an eye at the origin that looks along z sees before this background.
fn seen(surfaces: Vec<(Shape, Material)>, paths: u64) -> [f64; 3] {
    let mut scene = SceneBuilder::new();
    for (shape, material) in surfaces {
        scene.surface(format!("{material:?}"), shape, material);
    }
    scene.emitter("lamp", Emitter::Isotropic(Isotropic::new(DVec3::splat(9.0), 1.0).unwrap()));
    let scene = scene.build().unwrap();
    let pinhole = CameraSpec::pinhole(DVec3::ZERO, DVec3::Z, DVec3::Y, 1.0, [1, 1]);
    let view =
        View::new(&scene, &Camera::new(CameraSpec { background_cd_m2: PHOTOGRAPHED, ..pinhole }).unwrap(), 0)
            .unwrap();
    let pass = Pass { direct: true, ..Pass::EMISSION };
    let mut eye = EyePath::<3>::new(&view, &pass);
    let points = IndependentPoints::new(1, 0);
    let mut sum = [0.0; 3];
    for i in 0..paths {
        let ray = EyeRay { origin: DVec3::ZERO, direction: DVec3::Z };
        let found = eye.look(ray, &mut Coordinates::new(&points, i, true));
        (0..3).for_each(|c| sum[c] += found[c] / paths as f64);
    }
    assert_eq!(eye.killed, 0);
    sum
}

fn assert_parts(seen: [f64; 3], parts: impl Fn(usize) -> f64, tolerance: f64) {
    for c in 0..3 {
        let part = seen[c] / PHOTOGRAPHED[c];
        assert!((part - parts(c)).abs() <= tolerance, "channel {c}: {part} for {}", parts(c));
    }
}

fn glass() -> Material {
    Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap())
}

/// Before the eye; its front looks back at it.
fn plate(z: f64) -> Shape {
    Shape::Rectangle(Rectangle::new(DVec3::new(-1.0, 1.0, z), DVec3::X * 2.0, DVec3::Y * -2.0).unwrap())
}

#[test]
fn into_a_medium_it_sees_luminance_over_the_square_of_the_index() {
    // Normal incidence on n = 1.5: R = 0.04.
    assert_parts(seen(vec![(plate(1.0), glass())], 1), |_| 0.04 + 0.96 / 2.25, 1e-14);
}

#[test]
fn a_mirror_behind_a_pane_is_seen_with_all_reflections_between_them() {
    let pane = box_mesh(DVec3::new(-1.0, -1.0, 1.0), DVec3::new(1.0, 1.0, 1.1)).unwrap();
    let silver = [0.9, 0.6, 0.3];
    let mirror = Material::Mirror(Mirror::new(Reflectance::rgb(silver).unwrap()));
    let seen = seen(vec![(Shape::Mesh(pane), glass()), (plate(2.0), mirror)], 1 << 12);
    // A pane reflects 2 R / (1 + R) of the light and passes the rest; the sum over passages is a geometric
    // series.
    let r = 2.0 * 0.04 / 1.04;
    // Only ways of a share below 1/1024, and weights below 1/16, are a matter of chance: 5 standard errors.
    assert_parts(seen, |c| r + (1.0 - r) * (1.0 - r) * silver[c] / (1.0 - r * silver[c]), 2e-3);
}
