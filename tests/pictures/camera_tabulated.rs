//! A table as the camera sees it: the value of the BSDF is the density of what photons do, on facets turned any way, from
//! both sides; what the table leaves is seen through it or mirrored in it.

use std::f64::consts::PI;

use caustix::geometry::Rectangle;
use caustix::sample::coordinates::Coordinates;
use caustix::scattering::{Frame, Quantity, ScatterTable};
use caustix::scene::camera::CameraSpec;
use caustix::scene::{Scene, SceneBuilder};
use caustix::sequence::owen::OwenPoints;
use caustix::surface::tabulated::Options;
use caustix::surface::{Event, Grey, Incidence, Leg, Material, Reference, Tabulated};
use glam::DVec3;

use crate::one_pixel::{assert_close, narrow, pixel};
use crate::support::local;
use crate::support::pictures::panel;
use crate::support::tables::{incidence, lobe, steps};

/// Reflects and transmits, unlike in azimuth; `strength` 1 scatters about 0.6 of the light.
fn table(strength: f64) -> ScatterTable {
    let angles =
        || [steps(0.0, 90.0, 15.0), steps(0.0, 360.0, 45.0), steps(0.0, 90.0, 10.0), steps(0.0, 360.0, 15.0)];
    let value = |share: f64| {
        move |_: usize, phi_i: f64, theta_i: f64, polar: f64, azimuth: f64| {
            let turn = (azimuth + 2.0 * phi_i).to_radians();
            strength * share * (1.0 + 0.8 * turn.cos()) * (1.0 - theta_i / 200.0) * (1.0 - polar / 180.0)
        }
    };
    let reflection = lobe((Quantity::Reflection, Frame::Surface), angles(), 1, value(0.15));
    let transmission = lobe((Quantity::Transmission, Frame::Surface), angles(), 1, value(0.08));
    ScatterTable::new("sheet", vec![reflection, transmission], vec![]).unwrap()
}

/// A function of the direction without symmetry.
fn probe(d: DVec3) -> f64 {
    1.0 + 0.7 * d.x + 0.5 * d.y * d.z - 0.6 * d.y + 0.3 * d.z
}

#[test]
fn the_value_is_what_photons_do() {
    let options = Options {
        reference: Reference::Along(DVec3::new(1.0, 2.0, 0.3)),
        rotation_deg: 25.0,
        ..Options::default()
    };
    let bsdf = Material::Tabulated(Box::new(Tabulated::new(&table(1.0), &options).unwrap().0));
    for (outward, wi) in [
        (DVec3::Z, DVec3::new(0.5, 0.2, 0.8)),
        (DVec3::new(0.3, -0.5, 0.8), DVec3::new(0.9, 0.1, 0.2)),
        (DVec3::new(0.3, -0.5, 0.8), DVec3::new(-0.5, 0.3, -0.4)),
        (DVec3::new(-0.7, 0.2, -0.1), DVec3::new(0.1, 0.9, 0.2)),
    ] {
        let (outward, wi) = (outward.normalize(), wi.normalize());
        let front = wi.dot(outward) > 0.0;
        let facet = if front { outward } else { -outward };
        let at = Incidence { direction: -wi, facet, smooth: facet, front, indices: [1.0; 2] };
        let n = 1u64 << 16;
        let points = OwenPoints::new(5, 0);
        // Reflected and transmitted apart: [f 1, f probe].
        let mut photons = [[0.0; 2]; 2];
        for i in 0..n {
            let left = bsdf.scatter(&at, &mut Coordinates::new(&points, i, true), &mut Grey);
            if let Event::Leaves { direction, through, .. } = left {
                photons[usize::from(through)][0] += 1.0 / n as f64;
                photons[usize::from(through)][1] += probe(direction) / n as f64;
            }
        }
        let mut values = [[0.0; 2]; 2];
        let (rows, columns) = (400, 800);
        for i in 0..rows {
            let z = 2.0 * (f64::from(i) + 0.5) / f64::from(rows) - 1.0;
            for j in 0..columns {
                let phi = 2.0 * PI * (f64::from(j) + 0.5) / f64::from(columns);
                let s = (1.0 - z * z).sqrt();
                let wo = DVec3::new(s * phi.cos(), s * phi.sin(), z);
                let pdf = bsdf.pdf(outward, Leg::new(wi, outward), Leg::new(wo, outward));
                let f = pdf * 4.0 * PI / f64::from(rows * columns);
                let through = (wo.dot(outward) > 0.0) != front;
                values[usize::from(through)][0] += f;
                values[usize::from(through)][1] += f * probe(wo);
            }
        }
        for through in 0..2 {
            for k in 0..2 {
                let (a, b) = (photons[through][k], values[through][k]);
                // 2^16 points of a net; the midpoint rule.
                assert!((a - b).abs() < 1e-3, "{outward} {wi}: through {through}, moment {k}: {a} {b}");
            }
            assert!(values[through][0] > 0.05);
        }
    }
}

fn sheet_before_a_panel(strength: f64, specular_remainder: bool) -> (Scene, f64) {
    let options = Options { specular_remainder, ..Options::default() };
    let sheet = Tabulated::new(&table(strength), &options).unwrap().0;
    let albedo = local::albedo(&sheet, true, incidence(20.0, 0.0))[0];
    let shape = Rectangle::new(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0).unwrap();
    let mut scene = SceneBuilder::new();
    scene
        .surface("sheet", shape.into(), Material::Tabulated(Box::new(sheet)))
        .emitter("panel", panel(DVec3::Z, DVec3::NEG_Z, DVec3::Y, [0.5; 2], PI * 0.25));
    (scene.build().unwrap(), albedo)
}

#[test]
fn what_a_table_leaves_is_seen_through_it() {
    let x = -2.0 * 20f64.to_radians().tan();
    let spec = CameraSpec { samples: 1024, ..narrow([x, 0.0, -1.0], [0.0, 0.0, 1.0]) };
    for strength in [1.0, 0.5] {
        let (scene, albedo) = sheet_before_a_panel(strength, true);
        let seen = pixel(&scene, &spec, 4, 0.1);
        assert_close("L S E through a sheet", seen.emission, 1.0 - albedo, 1e-5);
        let (scene, _) = sheet_before_a_panel(strength, false);
        assert_eq!(pixel(&scene, &spec, 4, 0.1).emission.value, 0.0);
    }
}

#[test]
fn light_behind_a_sheet_is_scattered_to_the_eye_before_it() {
    // Small and far: E = L A / d^2 on the other side, times the value straight through.
    let (scene, _) = sheet_before_a_panel(1.0, false);
    let spec = CameraSpec { samples: 1024, ..narrow([0.3, 0.0, -1.0], [0.0, 0.0, 0.0]) };
    let seen = pixel(&scene, &spec, 4, 0.1);
    let wo = DVec3::new(0.3, 0.0, -1.0).normalize();
    let bsdf = &scene.materials()[0];
    // Quadrature over the panel.
    let n = 60;
    let exact = (0..n * n)
        .map(|k| {
            let at = |k: i32| 0.5 * ((f64::from(k) + 0.5) / f64::from(n) - 0.5);
            let to = DVec3::new(at(k % n), at(k / n), 1.0);
            let wi = to.normalize();
            let f = bsdf.eval(DVec3::Z, Leg::new(wi, DVec3::Z), Leg::new(wo, DVec3::Z))[0];
            f * wi.z * wi.z / to.length_squared() * 0.25 / f64::from(n * n)
        })
        .sum::<f64>();
    assert_close("L D E through a sheet", seen.direct, exact, 0.01);
}
