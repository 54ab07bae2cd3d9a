//! Photons joined to the pinhole, against closed forms of the luminance that it sees.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;

use caustix::error::Kind;
use caustix::picture;
use caustix::picture::camera::splat::{Splat, SplatMoments};
use caustix::picture::photon_map::Channels;
use caustix::picture::trace_picture;
use caustix::run::Plan;
use caustix::run::tracer::Tracer;
use caustix::scene::Scene;
use caustix::scene::camera::{Camera, CameraSpec, Filter, Method};
use caustix::surface::{Dielectric, Grey, Lambertian, Material, Reflectance, Rgb};
use caustix::tally::Receivers;
use glam::{DVec2, DVec3};

use crate::support::judge::{SIGNIFICANCE, judge};
use crate::support::pictures::{beam, camera, grey, on_threads, panel, plan, rectangle, scene, unwatched};

/// Splats alone, without what eye paths add: value by channel [cd/m2] and standard error of the luminance.
struct Splatted<const C: usize> {
    value: Vec<[f64; C]>,
    error: Vec<f64>,
}

fn splatted<const C: usize, T: Channels<C>>(
    scene: &Scene,
    spec: &CameraSpec,
    plan: &Plan,
    carried: T,
) -> Splatted<C> {
    let mut splat = Splat::<C>::new(scene, &camera(spec.clone())).unwrap();
    let mut moments = SplatMoments::<C>::new((spec.pixels[0] * spec.pixels[1]) as usize);
    let receivers = Receivers::new(&scene.geometry, &scene.receivers);
    for replicate in 0..plan.replicates() {
        let n = plan.photons_per_replicate();
        let mut tracer = Tracer::new(scene, plan.algorithm(), plan.seed(), replicate, n);
        let sink = || splat.sink(receivers.sink());
        tracer.trace_into(n, carried, sink, &AtomicBool::new(false), &|_| {}).unwrap();
        splat.close(&mut moments, true);
    }
    assert_eq!(splat.cut(), 0);
    let photon_lm = scene.emitters.flux_lm() / plan.photons() as f64;
    let error = |pixel| moments.variance(pixel, plan.replicates()).sqrt() * photon_lm;
    Splatted {
        error: (0..moments.sum.len()).map(error).collect(),
        value: moments.sum.iter().map(|v| v.map(|v| v * photon_lm)).collect(),
    }
}

/// Fails unless the pixels agree with these luminances in their own standard errors, which must be small.
fn assert_pixels(label: &str, got: &Splatted<1>, exact: &[f64], replicates: u32, most_relative_error: f64) {
    let ts: Vec<f64> =
        got.value.iter().zip(&got.error).zip(exact).map(|((v, e), x)| (v[0] - x) / e).collect();
    let verdict = judge(&ts, replicates - 1);
    let worst = got.error.iter().zip(exact).map(|(e, x)| e / x).fold(0.0, f64::max);
    println!(
        "{label}: z^2/n {:.3}, extreme t {:.2}, errors up to {worst:.1e}",
        verdict.mean_z2, verdict.t_extreme
    );
    assert!(verdict.p_chi2 > SIGNIFICANCE && verdict.p_extreme > SIGNIFICANCE, "{label}: {verdict:?}");
    assert!(worst < most_relative_error, "{label}: {worst}");
}

#[test]
fn a_uniformly_lit_plate_is_as_bright_in_every_pixel_from_anywhere() {
    // Lit at 35 degrees to its normal, larger than all that is seen of it.
    let plate = rectangle("plate", DVec3::new(-30.0, -30.0, 0.0), DVec3::X * 60.0, DVec3::Y * 60.0);
    let direction = DVec3::new(35f64.to_radians().sin(), 0.0, -35f64.to_radians().cos());
    let light = beam(-20.0 * direction, direction, 12.0, 5000.0);
    let lit = scene(vec![(plate, grey(0.6))], vec![light], None);
    let exact = 5000.0 / (24.0 * 24.0) * 35f64.to_radians().cos() * 0.6 / PI;
    let at = |x: f64, y: f64, z: f64| DVec3::new(x, y, z);
    // All that pixels see, their filters' reach included, lies within the light.
    for (position, look_at, up, fov_deg, filter, photons) in [
        (at(0.0, 0.0, 3.0), at(0.0, 0.0, 0.0), DVec3::Y, 110.0, Filter::Box, 1 << 19),
        (at(2.0, -1.0, 1.5), at(1.0, 1.0, 0.0), DVec3::Z, 60.0, Filter::Tent, 1 << 19),
        (at(-9.0, 4.0, 7.0), at(0.0, 0.0, 0.0), DVec3::Z, 20.0, Filter::Gaussian, 1 << 19),
        (at(0.5, 0.5, 1.2), at(2.0, 1.0, 0.0), DVec3::new(0.0, 1.0, 2.0), 40.0, Filter::Gaussian, 1 << 21),
    ] {
        let spec = CameraSpec { filter, ..CameraSpec::pinhole(position, look_at, up, fov_deg, [6, 4]) };
        let plan = plan(photons, 16);
        let got = splatted(&lit, &spec, &plan, Grey);
        assert_pixels(&format!("{position} {filter:?}"), &got, &[exact; 24], 16, 0.02);
    }
}

#[test]
fn colour_is_that_of_the_plate() {
    let plate = rectangle("plate", DVec3::new(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0);
    let red = Material::Lambertian(Lambertian::new(Reflectance::rgb([0.8, 0.3, 0.05]).unwrap()));
    let lit = scene(vec![(plate, red)], vec![beam(DVec3::Z * 9.0, DVec3::NEG_Z, 4.0, 640.0)], None);
    let spec = CameraSpec::pinhole(DVec3::Z * 2.0, DVec3::ZERO, DVec3::Y, 60.0, [3, 2]);
    let got = splatted(&lit, &spec, &plan(1 << 17, 8), Rgb::WHITE);
    for pixel in got.value {
        // Ratios are exact, whatever the noise.
        assert!((pixel[0] / pixel[1] / (0.8 / 0.3) - 1.0).abs() < 1e-9, "{pixel:?}");
        assert!((pixel[2] / pixel[1] / (0.05 / 0.3) - 1.0).abs() < 1e-9, "{pixel:?}");
        assert!((pixel[1] / (10.0 * 0.3 / PI) - 1.0).abs() < 0.03, "{pixel:?}");
    }
}

#[test]
fn in_a_closed_enclosure_distance_and_direction_do_not_matter() {
    // A cube of side 2 with light of one exitance from all of every wall: E = M / (1 - rho) everywhere.
    let (m, rho) = (100.0, 0.5);
    let (mut surfaces, mut lamps) = (Vec::new(), Vec::new());
    for (i, normal) in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|n| [n, -n]).enumerate() {
        let u = normal.any_orthonormal_vector();
        let v = normal.cross(u);
        surfaces.push((rectangle(&format!("wall{i}"), -normal - u - v, 2.0 * u, 2.0 * v), grey(rho)));
        // A millionth from the wall: what light loses by that is far below the noise.
        lamps.push(panel(-normal * (1.0 - 1e-6), normal, u, [2.0, 2.0], 4.0 * m));
    }
    let enclosure = scene(surfaces, lamps, None);
    let exact = m / (1.0 - rho) * rho / PI;
    for (position, look_at) in [
        (DVec3::new(0.1, 0.2, 0.0), DVec3::new(0.9, -0.3, -1.0)),
        (DVec3::new(-0.9, -0.8, 0.7), DVec3::new(1.0, 1.0, -1.0)),
    ] {
        let spec = CameraSpec::pinhole(position, look_at, DVec3::Z, 100.0, [5, 3]);
        let got = splatted(&enclosure, &spec, &plan(1 << 18, 16), Grey);
        assert_pixels(&format!("{position}"), &got, &[exact; 15], 16, 0.02);
    }
}

/// Form factor of a plane element to a parallel rectangle over its corner, sides over the distance x and y (Howell).
fn over_corner(x: f64, y: f64) -> f64 {
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / p * (y / p).atan() + y / q * (x / q).atan()) / (2.0 * PI)
}

#[test]
fn a_polygon_light_gives_the_luminance_of_its_form_factor() {
    assert!((over_corner(1.0, 1.0) - 0.138_532).abs() < 5e-7);
    // A unit square at unit height; the plane element (x, y) is below the corners of four rectangles with signs.
    let exitance = 900.0;
    let form = |at: DVec2| {
        let part = |x: f64, y: f64| over_corner(x.abs(), y.abs()) * x.signum() * y.signum();
        part(1.0 - at.x, 1.0 - at.y) - part(-at.x, 1.0 - at.y) - part(1.0 - at.x, -at.y) + part(-at.x, -at.y)
    };
    assert!((form(DVec2::ZERO) - 0.138_532).abs() < 5e-7);
    let floor = rectangle("floor", DVec3::new(-9.0, -9.0, 0.0), DVec3::X * 18.0, DVec3::Y * 18.0);
    let light = panel(DVec3::new(0.5, 0.5, 1.0), DVec3::NEG_Z, DVec3::Y, [1.0, 1.0], exitance);
    let lit = scene(vec![(floor, grey(0.7))], vec![light], None);
    // From straight above, 1 m across 5 pixels about the corner: no perspective to invert by hand but a scale.
    let height = 0.6;
    let fov = 2.0 * (0.5f64 / height).atan().to_degrees();
    let camera = CameraSpec::pinhole(DVec3::Z * height, DVec3::ZERO, DVec3::Y, fov, [5, 5]);
    let spec = CameraSpec { filter: Filter::Box, ..camera };
    let exact: Vec<f64> = (0..25)
        .map(|pixel| {
            let (column, row) = (pixel % 5, pixel / 5);
            let n = 32;
            let mut mean = 0.0;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let x = (f64::from(column) + (f64::from(i) + 0.5) / f64::from(n)) / 5.0 - 0.5;
                let y = 0.5 - (f64::from(row) + (f64::from(j) + 0.5) / f64::from(n)) / 5.0;
                mean += exitance * form(DVec2::new(x, y)) * 0.7 / PI / f64::from(n * n);
            }
            mean
        })
        .collect();
    let got = splatted(&lit, &spec, &plan(1 << 20, 16), Grey);
    assert_pixels("polygon", &got, &exact, 16, 0.02);
}

#[test]
fn nothing_is_seen_through_glass_or_from_the_other_side() {
    let plate = || rectangle("plate", DVec3::new(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0);
    let light = || vec![beam(DVec3::Z * 9.0, DVec3::NEG_Z, 4.0, 640.0)];
    let sum = |s: &Scene, from: DVec3| {
        let spec = CameraSpec::pinhole(from, DVec3::ZERO, DVec3::Y, 60.0, [3, 2]);
        splatted(s, &spec, &plan(1 << 12, 4), Grey).value.iter().map(|v| v[0]).sum::<f64>()
    };
    let bare = scene(vec![(plate(), grey(0.6))], light(), None);
    assert!(sum(&bare, DVec3::Z * 2.0) > 0.0);
    assert_eq!(sum(&bare, DVec3::NEG_Z * 2.0), 0.0, "the dark side of a thin plate");
    // A small sheet of glass just before the pinhole; light passes beside it.
    let sheet = rectangle("sheet", DVec3::new(-1.5, -1.5, 1.9), DVec3::X * 3.0, DVec3::Y * 3.0);
    let glass = Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap());
    let behind_glass = scene(vec![(plate(), grey(0.6)), (sheet, glass)], light(), None);
    assert_eq!(sum(&behind_glass, DVec3::Z * 2.0), 0.0);
}

#[test]
fn a_pixel_without_a_splat_has_the_error_of_one_photon() {
    // The light covers the middle of what is seen.
    let plate = rectangle("plate", DVec3::new(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0);
    let spec = CameraSpec {
        method: Method::Splat,
        filter: Filter::Box,
        ..CameraSpec::pinhole(DVec3::Z * 2.0, DVec3::ZERO, DVec3::Y, 60.0, [12, 8])
    };
    let light = beam(DVec3::Z * 1.5, DVec3::NEG_Z, 0.3, 640.0);
    let lit = scene(vec![(plate, grey(0.6))], vec![light], Some(spec));
    let (_, picture) =
        trace_picture(&lit, &plan(1 << 14, 4), false, unwatched(&AtomicBool::new(false))).unwrap();
    let picture::AnyPicture::Grey(picture) = picture else { panic!("grey") };
    // Looking straight at a plane, cos / d^2 and the picture's area per solid angle multiply to (focal length / distance)^2.
    let focal_px = 6.0 / 30f64.to_radians().tan();
    let one = 640.0 / f64::from(1 << 14) * 0.6 / PI * (focal_px / 2.0).powi(2);
    let dark: Vec<f64> = picture
        .film
        .value
        .iter()
        .zip(&picture.film.standard_error)
        .filter(|(v, _)| v[0] == 0.0)
        .map(|(_, e)| *e)
        .collect();
    assert!(dark.len() > 40 && dark.len() < 96, "{}", dark.len());
    for error in dark {
        assert!((error / one - 1.0).abs() < 1e-12, "{error} {one}");
    }
}

#[test]
fn the_same_bits_on_any_number_of_threads_and_refusals() {
    let plate = rectangle("plate", DVec3::new(-5.0, -5.0, 0.0), DVec3::X * 10.0, DVec3::Y * 10.0);
    let spec = CameraSpec {
        method: Method::Splat,
        ..CameraSpec::pinhole(DVec3::Z * 2.0, DVec3::ZERO, DVec3::Y, 60.0, [12, 8])
    };
    let lit = |spec: &CameraSpec| {
        let light = beam(DVec3::Z * 9.0, DVec3::NEG_Z, 4.0, 640.0);
        scene(vec![(plate.clone(), grey(0.6))], vec![light], Some(spec.clone()))
    };
    let go = |spec: &CameraSpec| {
        trace_picture(&lit(spec), &plan(1 << 17, 4), false, unwatched(&AtomicBool::new(false)))
    };
    let on = |threads: usize| match on_threads(threads, || go(&spec)).unwrap().1 {
        picture::AnyPicture::Grey(picture) => picture,
        picture::AnyPicture::Rgb(_) => panic!("grey"),
    };
    let one = on(1);
    assert!(one.summary.photons_kept > 5_000 && one.film.value.iter().all(|v| v[0] > 0.0));
    for threads in [2, 7] {
        assert_eq!(on(threads).film, one.film);
    }
    let lens = Camera::new(CameraSpec { lens_radius_m: 0.01, ..spec.clone() }).unwrap_err();
    assert!(lens.what() == "lens_radius" && lens.to_string().contains("splat"), "{lens}");
    let large = Camera::new(CameraSpec { pixels: [16384, 16384], ..spec.clone() }).unwrap_err();
    assert_eq!(large.what(), "pixels");
    let large = go(&CameraSpec { pixels: [8192, 8192], ..spec.clone() }).unwrap_err();
    assert_eq!(large.kind(), Kind::Limit);
}
