//! Pictures of hardly any photons, of one pixel, of too many: numbers with errors that say so, or a refusal.

use std::sync::atomic::AtomicBool;

use caustix::error::Kind;
use caustix::picture::camera::Film;
use caustix::picture::{AnyPicture, Picture, trace_picture};
use caustix::scene::Scene;
use caustix::scene::camera::{Bandwidth, Camera, CameraSpec, Method};
use caustix::surface::{Dielectric, Material, Mirror, Reflectance};
use glam::DVec3;

use crate::support::maps::{Samples, read_maps};
use crate::support::pictures::{beam, grey, plan, rectangle, scene, sphere, unwatched};
use crate::support::stranger::Stranger;

/// A beam by a mirror down on a plate: every photon arrives there after one event, a caustic that fills x from -0.5 to 0.5.
fn turned_beam(camera: CameraSpec) -> Scene {
    let mirror = rectangle("mirror", DVec3::new(-1.0, -1.0, 2.0), DVec3::new(2.0, 0.0, -2.0), DVec3::Y * 2.0);
    let plate = rectangle("plate", DVec3::new(-3.0, -3.0, -1.0), DVec3::X * 6.0, DVec3::Y * 6.0);
    let light = beam(DVec3::new(-2.0, 0.0, 1.0), DVec3::X, 0.5, 100.0);
    let silver = Material::Mirror(Mirror::new(Reflectance::new(1.0).unwrap()));
    scene(vec![(mirror, silver), (plate, grey(0.5))], vec![light], Some(camera))
}

/// Looks at a spot of the plate, in the light for `x` within 0.5 of 0.
fn looks_at(x: f64, bandwidth: Bandwidth) -> CameraSpec {
    let (from, to) = (DVec3::new(x, -2.5, 0.5), DVec3::new(x, 0.0, -1.0));
    CameraSpec { bandwidth, samples: 4, ..CameraSpec::pinhole(from, to, DVec3::Z, 1.0, [1, 1]) }
}

fn pictured(scene: &Scene, photons: u64, replicates: u32) -> Picture<1> {
    let watch_interrupt = AtomicBool::new(false);
    let (_, picture) =
        trace_picture(scene, &plan(photons, replicates), false, unwatched(&watch_interrupt)).unwrap();
    let AnyPicture::Grey(picture) = picture else { panic!("a grey scene") };
    picture
}

const BANDWIDTHS: [Bandwidth; 5] = [
    Bandwidth::Automatic,
    Bandwidth::Radius(0.2),
    Bandwidth::Nearest(2),
    Bandwidth::Nearest(1 << 20),
    Bandwidth::Progressive(0.2),
];

#[test]
fn no_photon_near_is_dark_and_not_certain() {
    // Two metres from the light, of so few photons that none was scattered to there.
    for bandwidth in [Bandwidth::Radius(0.2), Bandwidth::Progressive(0.2)] {
        let picture = pictured(&turned_beam(looks_at(2.5, bandwidth)), 1 << 6, 4);
        let film = &picture.film;
        assert_eq!(film.value, [[0.0]], "{bandwidth:?}");
        assert!(film.standard_error[0].is_finite() && film.standard_error[0] > 0.0, "{bandwidth:?}");
        assert_eq!(film.bias, [0.0], "{bandwidth:?}");
    }
    // Within reach of the light the same camera sees 100 lm/m2 of which a half is scattered evenly.
    let lit = pictured(&turned_beam(looks_at(0.0, Bandwidth::Radius(0.2))), 1 << 16, 4);
    let exact = 100.0 * 0.5 / std::f64::consts::PI;
    assert!((lit.film.value[0][0] / exact - 1.0).abs() < 0.02, "{:?}", lit.film);
}

#[test]
fn a_scene_in_which_nothing_arrives_by_an_event_is_seen_without_photons() {
    // The plate alone, beside the beam: no photon is kept, no density is made.
    let plate = rectangle("plate", DVec3::new(-3.0, -3.0, -1.0), DVec3::X * 6.0, DVec3::Y * 6.0);
    for bandwidth in BANDWIDTHS {
        let light = beam(DVec3::new(-2.0, 0.0, 1.0), DVec3::X, 0.5, 100.0);
        let dark = scene(vec![(plate.clone(), grey(0.5))], vec![light], Some(looks_at(0.0, bandwidth)));
        let picture = pictured(&dark, 1 << 10, 4);
        assert_eq!(picture.summary.photons_kept, 0);
        assert_eq!(picture.film.value, [[0.0]], "{bandwidth:?}");
        assert!(!picture.film.standard_error[0].is_nan(), "{bandwidth:?}");
    }
}

#[test]
fn one_photon_and_fewer_than_the_neighbours_wanted_give_numbers() {
    for bandwidth in BANDWIDTHS {
        for (photons, replicates) in [(1, 1), (2, 2), (7, 1), (40, 4)] {
            let picture = pictured(&turned_beam(looks_at(0.0, bandwidth)), photons, replicates);
            let (film, summary) = (&picture.film, &picture.summary);
            let at = format!("{bandwidth:?}, {photons} photons: {film:?}");
            // Each at its first arrival on the plate, a few once more.
            assert!(summary.photons_kept >= photons, "{at}");
            assert!(film.value[0][0].is_finite() && film.value[0][0] >= 0.0, "{at}");
            assert!(film.bias[0].is_finite(), "{at}");
            // One replicate knows no error; more know one, and it is not nothing.
            assert!(film.standard_error[0].is_nan() == (replicates == 1), "{at}");
            assert!(replicates == 1 || film.standard_error[0] > 0.0, "{at}");
        }
    }
    // More neighbours than there are photons: all of them, so the light of the whole beam over the area they need.
    let all = pictured(&turned_beam(looks_at(0.0, Bandwidth::Nearest(1 << 20))), 1 << 12, 4);
    let value = all.film.value[0][0];
    let exact = 100.0 * 0.5 / std::f64::consts::PI;
    assert!(value > 0.3 * exact && value < 1.5 * exact, "{value} {exact}");
}

#[test]
fn an_eye_in_a_glass_ball_sees_the_caustic_below_it_brighter_by_the_square_of_the_index() {
    // The lit plate from inside a ball about the eye: every ray leaves at right angles, so nothing is refracted, and what the
    // glass mirrors comes back to the eye's own point and on to what is behind it, which is dark but for R^2, R^4...
    let (eye, towards) = (DVec3::new(0.0, -1.5, -0.5), DVec3::new(0.0, 0.0, -1.0));
    let camera = CameraSpec {
        bandwidth: Bandwidth::Radius(0.2),
        samples: 1 << 12,
        ..CameraSpec::pinhole(eye, towards, DVec3::Z, 0.5, [1, 1])
    };
    let bare = turned_beam(camera.clone());
    let mirror = rectangle("mirror", DVec3::new(-1.0, -1.0, 2.0), DVec3::new(2.0, 0.0, -2.0), DVec3::Y * 2.0);
    let plate = rectangle("plate", DVec3::new(-3.0, -3.0, -1.0), DVec3::X * 6.0, DVec3::Y * 6.0);
    let silver = Material::Mirror(Mirror::new(Reflectance::new(1.0).unwrap()));
    let glass = Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap());
    let ball = (sphere("ball", eye, 0.3), glass);
    let light = beam(DVec3::new(-2.0, 0.0, 1.0), DVec3::X, 0.5, 100.0);
    let inside = scene(vec![(mirror, silver), (plate, grey(0.5)), ball], vec![light], Some(camera));
    let (bare, inside) = (pictured(&bare, 1 << 16, 8), pictured(&inside, 1 << 16, 8));
    let ratio = inside.film.value[0][0] / bare.film.value[0][0];
    // R = 0.04: n^2 (1 - R) (1 + R^2 + ...) = n^2 / (1 + R).
    let relative = |p: &Picture<1>| p.film.standard_error[0] / p.film.value[0][0];
    let error = ratio * relative(&inside).hypot(relative(&bare));
    let exact = 2.25 / 1.04;
    println!("{ratio} +- {error}, exact {exact}");
    assert!((ratio - exact).abs() < 4.0 * error && error < 0.02 * exact, "{ratio} +- {error}, {exact}");
}

#[test]
fn a_camera_in_the_plane_of_a_lit_plate_sees_numbers() {
    for bandwidth in BANDWIDTHS {
        // At the level of the plate, beyond its border, and a hair above and below it.
        for height in [0.0, 1e-9, -1e-9] {
            let (from, to) = (DVec3::new(-5.0, 0.0, -1.0 + height), DVec3::new(0.0, 0.0, -1.0 + height));
            let camera =
                CameraSpec { bandwidth, samples: 4, ..CameraSpec::pinhole(from, to, DVec3::Z, 20.0, [3, 3]) };
            let film = pictured(&turned_beam(camera), 1 << 10, 4).film;
            let numbers = film.value.iter().flatten().chain(&film.standard_error).chain(&film.bias);
            assert!(numbers.clone().all(|x| x.is_finite()), "{bandwidth:?} {height}: {film:?}");
        }
    }
}

#[test]
fn too_large_a_picture_is_refused_with_what_it_takes() {
    for (method, large) in [(Method::Map, "6144 MiB"), (Method::Splat, "8192 MiB")] {
        let camera = CameraSpec { method, pixels: [8192, 8192], ..looks_at(0.0, Bandwidth::Automatic) };
        let scene = turned_beam(camera.clone());
        let refused = trace_picture(&scene, &plan(1 << 10, 2), false, unwatched(&AtomicBool::new(false)));
        let refused = refused.unwrap_err();
        assert_eq!(refused.kind(), Kind::Limit);
        assert!(refused.to_string().contains(large) && refused.to_string().contains("1024 MiB"), "{refused}");
        // Products that no machine has room for are refused before anything is multiplied out.
        let refused = Camera::new(CameraSpec { pixels: [u32::MAX; 2], ..camera }).unwrap_err();
        assert_eq!(refused.what(), "pixels");
    }
    assert_eq!(Film::<1>::memory_bytes([8192, 8192]), 96 << 26);
    assert_eq!(Film::<3>::memory_bytes([8192, 8192]), 144 << 26);
}

const SCENE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0, 0, 1]
flux_lm = 100
[material.white]
type = "lambertian"
reflectance = 0.5
[[surface]]
name = "plate"
type = "rectangle"
material = "white"
corner = [-1, -1, 0]
edge_u = [2, 0, 0]
edge_v = [0, 2, 0]
[camera]
position = [0, -2, 1]
look_at = [0, 0, 0]
fov_deg = 0.1
"#;

#[test]
fn the_command_makes_a_picture_of_one_pixel_and_refuses_one_of_8192_by_8192_before_anything_is_written() {
    let s = Stranger::new();
    let go = |line: &str| {
        let (code, out, err) = s.types(line);
        (code, out + &err)
    };
    s.write("one.toml", format!("{SCENE}pixels = [1, 1]\n"));
    assert_eq!(go("render one.toml --photons 1024 -o one").0, 0);
    let maps = read_maps(s.path("one/camera.exr")).unwrap();
    assert_eq!((maps.width, maps.height), (1, 1));
    // A lamp of 100 / 4 pi cd at 1 m over a plate that scatters a half.
    let exact = 100.0 / (4.0 * std::f64::consts::PI) * 0.5 / std::f64::consts::PI;
    let (_, Samples::F32(y)) = maps.channels.iter().find(|(name, _)| name == "Y").unwrap() else {
        panic!("Y")
    };
    assert!((f64::from(y[0]) / exact - 1.0).abs() < 1e-3, "{} {exact}", y[0]);
    assert!(s.path("one/camera.png").is_file());

    s.write("large.toml", format!("{SCENE}pixels = [8192, 8192]\n"));
    for line in ["render large.toml --photons 1024 -o large", "check large.toml", "check large.toml --json"] {
        let (code, said) = go(line);
        assert_eq!(code, 1, "{line}: {said}");
        for part in ["8192 x 8192 pixels", "6144 MiB", "at most 1024 MiB"] {
            assert!(said.contains(part), "{line}: no \"{part}\" in\n{said}");
        }
    }
    assert!(!s.path("large").exists());
    // What `check` says a picture takes is part of its memory.
    s.write("some.toml", format!("{SCENE}pixels = [1600, 1000]\n"));
    let (code, said) = go("check some.toml --json");
    let memory_mb = serde_json::from_str::<serde_json::Value>(&said).unwrap()["memory_mb"].as_f64().unwrap();
    assert!(code == 0 && (153.6..155.0).contains(&memory_mb), "{memory_mb}");
}
