//! Every class of light paths reaches the picture once and only once (Heckbert's notation: L light, S mirror or glass, D
//! what scatters, E eye), each in a scene where it has a closed form.

use std::f64::consts::PI;

use caustix::scene::Scene;

use crate::one_pixel::*;

const WHITE: f64 = 0.8;
const PALE: f64 = 0.05;
const SILVER: f64 = 0.9;

fn scene(parts: &[String]) -> Scene {
    crate::support::scenes::scene(&(MATERIALS.to_string() + &parts.concat()))
}

/// Mean illuminance of a disc of radius r that faces a small Lambertian spot of this flux at distance d: the part of the
/// flux within the cone, r^2 / (r^2 + d^2), over pi r^2.
fn facing(flux_lm: f64, r: f64, d: f64) -> f64 {
    flux_lm / (PI * (r * r + d * d))
}

#[test]
fn l_e_an_emitter_in_view() {
    // 2 m x 2 m of 4 pi lm: 1 cd/m2. Behind it a wall that the eye sees too: panels are light, not geometry.
    let text = [
        panel([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 2.0, 4.0 * PI),
        ceiling("wall", "black", [0.0, 0.0, 2.0], 3.0),
    ];
    let seen = pixel(&scene(&text), &narrow([0.3, 0.2, 0.0], [0.0, 0.1, 1.0]), 4, 0.1);
    assert_close("L E", seen.emission, 1.0, 1e-12);
    assert_close("L E, all", seen.all, 1.0, 1e-12);
    let dark = pixel(&scene(&text), &narrow([0.3, 0.2, 1.9], [0.0, 0.1, 1.0]), 4, 0.1);
    assert_none("from behind", dark.all);
}

#[test]
fn l_d_e_a_lamp_over_a_plate() {
    let text = [lamp([0.0, 0.0, 2.0], 4.0 * PI * 100.0), floor("plate", "white", [0.0; 3], 1.0)];
    // At 0.6 m from the foot: I cos / d^2.
    let d2 = 4.0 + 0.36f64;
    let exact = 100.0 * 2.0 / d2.powf(1.5) * WHITE / PI;
    let seen = pixel(&scene(&text), &narrow([1.0, -1.0, 1.5], [0.6, 0.0, 0.0]), 8, 0.1);
    assert_close("L D E", seen.direct, exact, 1e-4);
    assert_close("L D E, all", seen.all, exact, 1e-4);
    let below = pixel(&scene(&text), &narrow([1.0, -1.0, -1.5], [0.6, 0.0, 0.0]), 8, 0.1);
    assert_none("the back of the plate", below.all);
}

#[test]
fn l_s_e_an_emitter_by_mirror_and_through_glass() {
    // So large that what a pane reflects inside and lets out farther on meets it, too.
    let light = panel([0.0, 0.0, 1.0], [0.0, 0.0, -1.0], 6.0, 36.0 * PI);
    // The eye looks down into a mirror.
    let text = [light.clone(), floor("mirror", "silver", [0.0; 3], 1.0)];
    let seen = pixel(&scene(&text), &narrow([0.2, 0.0, 0.9], [0.0, 0.0, 0.0]), 4, 0.1);
    assert_close("L S E", seen.all, SILVER, 1e-12);
    // Through a pane: (1 - R) / (1 + R), the roulette's spread apart.
    let text = [light, cuboid("pane", "glass", [-1.0, -1.0, 0.4], [1.0, 1.0, 0.5])];
    for degrees in [0.0f64, 30.0, 60.0] {
        let theta = degrees.to_radians();
        let x = -0.45 * theta.tan();
        let spec = caustix::scene::camera::CameraSpec {
            samples: 4096,
            ..narrow([x, 0.0, 0.0], [x + theta.sin(), 0.0, theta.cos()])
        };
        let cos_t = (1.0 - (theta.sin() / 1.5).powi(2)).sqrt();
        let s = ((theta.cos() - 1.5 * cos_t) / (theta.cos() + 1.5 * cos_t)).powi(2);
        let p = ((1.5 * theta.cos() - cos_t) / (1.5 * theta.cos() + cos_t)).powi(2);
        let r = 0.5 * (s + p);
        let seen = pixel(&scene(&text), &spec, 4, 0.1);
        assert_close("L S S E", seen.emission, (1.0 - r) / (1.0 + r), 0.02);
    }
}

#[test]
fn l_d_s_e_a_plate_by_mirror() {
    let scene = scene(&[
        beam([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 0.5, 100.0),
        floor("plate", "white", [0.0; 3], 0.8),
        plate("mirror", "silver", [1.0, 0.0, 1.0], [0.0, 0.0, 0.8], [0.0, 0.8, 0.0]),
    ]);
    // The spot's middle is at (2, 0, 0) in the mirror.
    let seen = pixel(&scene, &narrow([-0.5, 0.0, 1.0], [2.0, 0.0, 0.0]), 6, 0.1);
    assert_close("L D S E", seen.direct, SILVER * 100.0 / (PI * 0.25) * WHITE / PI, 1e-9);
    assert_none("L D S E by photons", seen.caustic);
    assert_none("L D S E by emission", seen.emission);
}

/// A level beam that a mirror at 45 degrees turns down on a floor: a spot of radius 0.5.
fn turned_beam() -> [String; 3] {
    [
        beam([-3.0, 0.0, 1.5], [1.0, 0.0, 0.0], 0.5, 100.0),
        plate("turning mirror", "silver", [0.0, 0.0, 1.5], [0.8, 0.0, -0.8], [0.0, 0.8, 0.0]),
        floor("plate", "white", [0.0; 3], 1.0),
    ]
}

#[test]
fn l_s_d_e_a_plate_lit_by_mirror() {
    let seen = pixel(&scene(&turned_beam()), &narrow([1.5, -1.0, 1.0], [0.0; 3]), 12, 0.2);
    assert_close("L S D E", seen.caustic, SILVER * 100.0 / (PI * 0.25) * WHITE / PI, 0.02);
    assert_none("L S D E by shadow rays", seen.direct);
}

/// A sheet that reflects 0.3 and transmits 0.4, in the place of the plate.
fn paper() -> String {
    floor("plate", "paper", [0.0; 3], 1.0)
        + "[material.paper]\ntype = \"lambertian\"\nreflectance = 0.3\ntransmittance = 0.4\n"
}

#[test]
fn l_s_d_e_and_l_d_e_a_sheet_seen_from_both_sides() {
    let [beam, mirror, _] = turned_beam();
    let lit_by_mirror = scene(&[beam, mirror, paper()]);
    let lit_by_lamp = scene(&[lamp([0.0, 0.0, 2.0], 4.0 * PI * 100.0), paper()]);
    for (z, part) in [(1.0, 0.3), (-1.0, 0.4)] {
        let seen = pixel(&lit_by_mirror, &narrow([1.5, -1.0, z], [0.0; 3]), 12, 0.2);
        assert_close("L S D E at a sheet", seen.caustic, SILVER * 100.0 / (PI * 0.25) * part / PI, 0.02);
        assert_none("L S D E at a sheet by shadow rays", seen.direct);
        let seen = pixel(&lit_by_lamp, &narrow([1.0, -1.0, 1.5 * z], [0.6, 0.0, 0.0]), 8, 0.1);
        assert_close("L D E at a sheet", seen.direct, 100.0 * 2.0 / 4.36f64.powf(1.5) * part / PI, 1e-4);
    }
}

#[test]
fn l_s_d_s_e_a_plate_lit_by_mirror_and_seen_by_mirror() {
    let mut parts = turned_beam().to_vec();
    parts.push(plate("mirror", "silver", [1.2, 0.0, 0.35], [0.0, 0.0, 0.25], [0.0, 0.5, 0.0]));
    let seen = pixel(&scene(&parts), &narrow([-1.5, 0.0, 0.5], [2.4, 0.0, 0.0]), 12, 0.2);
    assert_close("L S D S E", seen.caustic, SILVER * SILVER * 100.0 / (PI * 0.25) * WHITE / PI, 0.02);
    assert_none("L S D S E by shadow rays", seen.direct);
}

#[test]
fn l_s_d_s_e_the_floor_of_a_pool() {
    let scene = scene(&[
        beam([0.0, 0.0, 3.0], [0.0, 0.0, -1.0], 0.5, 100.0),
        floor("water", "water", [0.0, 0.0, 0.5], 2.0),
        floor("floor", "white", [0.0; 3], 1.9),
    ]);
    let spec =
        caustix::scene::camera::CameraSpec { samples: 64, ..narrow([0.02, 0.0, 2.0], [0.02, 0.0, 0.0]) };
    let passes = 1.0 - (0.33f64 / 2.33).powi(2);
    // In through one face as flux, out through it as luminance: the square of the index.
    let exact = 100.0 / (PI * 0.25) * passes * WHITE / PI * passes / (1.33 * 1.33);
    let seen = pixel(&scene, &spec, 12, 0.2);
    assert_close("L S D S E", seen.caustic, exact, 0.02);
    assert_none("shadow rays stop at water", seen.direct);
}

#[test]
fn l_d_d_e_a_plate_lit_by_a_plate() {
    let scene = scene(&[
        beam([2.0, 0.0, 2.0], [-1.0, 0.0, -1.0], 0.02, 100.0),
        floor("lower", "white", [0.0; 3], 0.3),
        ceiling("upper", "pale", [0.0, 0.0, 1.0], 0.2),
    ]);
    let seen = pixel(&scene, &narrow([0.5, -0.5, 0.2], [0.0, 0.0, 1.0]), 16, 0.1);
    assert_close("L D D E", seen.diffuse, facing(100.0 * WHITE, 0.1, 1.0) * PALE / PI, 0.02);
    assert_none("L D D E by shadow rays", seen.direct);
    assert_none("L D D E as caustic", seen.caustic);
}

#[test]
fn l_d_s_d_e_a_plate_lit_by_a_plate_by_mirror() {
    // Two plates in one plane don't see each other, but the mirror above them.
    let scene = scene(&[
        beam([-0.5, 0.0, 3.0], [0.0, 0.0, -1.0], 0.02, 100.0),
        floor("lit", "white", [-0.5, 0.0, 0.0], 0.2),
        floor("seen", "pale", [0.5, 0.0, 0.0], 0.2),
        plate("mirror", "silver", [0.0, 0.0, 1.0], [0.25, 0.0, 0.0], [0.0, -0.5, 0.0]),
    ]);
    let radius = 0.15;
    // From the spot's image at (-0.5, 0, 2): cos^2 / (pi d^2) = 4 / (pi d^4), mean over the disc.
    let rings = 40;
    let mean = (0..rings * rings)
        .map(|k| {
            let r = radius * ((f64::from(k / rings) + 0.5) / f64::from(rings)).sqrt();
            let phi = 2.0 * PI * (f64::from(k % rings) + 0.5) / f64::from(rings);
            let d2 = (1.0 + r * phi.cos()).powi(2) + (r * phi.sin()).powi(2) + 4.0;
            4.0 / (PI * d2 * d2)
        })
        .sum::<f64>()
        / f64::from(rings * rings);
    let seen = pixel(&scene, &narrow([1.5, -1.0, 0.9], [0.5, 0.0, 0.0]), 17, radius);
    assert_close("L D S D E", seen.diffuse, 100.0 * WHITE * SILVER * mean * PALE / PI, 0.03);
    assert_none("L D S D E by shadow rays", seen.direct);
    assert_none("L D S D E as caustic", seen.caustic);
}

#[test]
fn l_s_d_d_e_a_plate_lit_by_a_plate_lit_by_mirror() {
    // The mirror turns a vertical beam by 45 degrees towards the origin.
    let s = 0.5f64.sqrt();
    let scene = scene(&[
        beam([2.0, 0.0, 4.0], [0.0, 0.0, -1.0], 0.02, 100.0),
        plate("mirror", "silver", [2.0, 0.0, 2.0], [0.3 * (1.0 - s), 0.0, 0.3 * s], [0.0, 0.2, 0.0]),
        floor("lower", "white", [0.0; 3], 0.3),
        ceiling("upper", "pale", [0.0, 0.0, 1.0], 0.2),
    ]);
    let seen = pixel(&scene, &narrow([0.5, -0.5, 0.2], [0.0, 0.0, 1.0]), 16, 0.1);
    assert_close("L S D D E", seen.diffuse, facing(100.0 * SILVER * WHITE, 0.1, 1.0) * PALE / PI, 0.02);
    assert_none("L S D D E by shadow rays", seen.direct);
    assert_none("L S D D E as caustic", seen.caustic);
}
