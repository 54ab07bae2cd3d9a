//! A scene with a camera in another unit of length is the same picture.
//!
//! A scale of a power of two changes exponents alone, so every photon takes the same way however often it turns, and a pixel's
//! luminance changes by the scale's inverse square, bit for bit: its direct light, its densities with the bandwidth that is chosen
//! for them, its error and its bias. (Other scales round anew; the balls, rings and wine glasses that cameras look at magnify
//! that at every turn, so no bound on it is worth stating.)

use std::sync::atomic::AtomicBool;

use caustix::files::scene_toml::build::build;
use caustix::files::scene_toml::description::Description;
use caustix::files::scene_toml::read;
use caustix::picture::camera::Film;
use caustix::picture::{AnyPicture, PictureSummary, trace_picture};
use caustix::run::Outcome;
use caustix::scene::camera::{Camera, CameraSpec, Method};

use crate::lengths::scaled;
use crate::support::pictures::{plan, unwatched};
use crate::support::scenes::camera_scene_files;

/// Bits of a film whose luminances are multiplied by this.
fn bits<const C: usize>(film: &Film<C>, factor: f64) -> Vec<u64> {
    let values = film.value.iter().flatten();
    values.chain(&film.standard_error).chain(&film.bias).map(|v| (v * factor).to_bits()).collect()
}

/// The scene at this scale: its run, the bits of its picture in the luminance of scale 1, and how that was made.
fn seen(description: &Description, s: f64) -> (Outcome, Vec<u64>, PictureSummary) {
    let scene = build(&scaled(description.clone(), s)).unwrap_or_else(|e| panic!("{e:?}"));
    let plan = plan(1 << 15, 4);
    let (outcome, picture) = trace_picture(&scene, &plan, false, unwatched(&AtomicBool::new(false))).unwrap();
    let film = match &picture {
        AnyPicture::Grey(picture) => bits(&picture.film, s * s),
        AnyPicture::Rgb(picture) => bits(&picture.film, s * s),
    };
    (outcome, film, picture.summary().clone())
}

#[test]
fn powers_of_two_change_no_bit_of_a_picture() {
    for file in camera_scene_files() {
        let mut description = read(&file).unwrap_or_else(|e| panic!("{e:?}"));
        let original = CameraSpec::clone(&description.camera.as_ref().unwrap().spec);
        for (lens_radius_m, method) in [(0.0, Method::Map), (0.002, Method::Map), (0.0, Method::Splat)] {
            let spec = CameraSpec { lens_radius_m, method, pixels: [40, 30], samples: 4, ..original.clone() };
            description.camera.as_mut().unwrap().spec = Camera::new(spec).unwrap();
            let at = format!("{}, {method:?}, lens {lens_radius_m}", file.display());
            let (outcome, film, summary) = seen(&description, 1.0);
            assert!(film.iter().any(|b| *b != 0) && summary.photons_kept > 100, "{at}: {summary:?}");
            for s in [1024.0, 1.0 / 1024.0] {
                let (other_outcome, other_film, other) = seen(&description, s);
                assert!(outcome.cells() == other_outcome.cells(), "{at} x {s}");
                assert_eq!(outcome.ledger, other_outcome.ledger, "{at} x {s}");
                assert_eq!(
                    (summary.photons_kept, summary.cost),
                    (other.photons_kept, other.cost),
                    "{at} x {s}"
                );
                let radii = |summary: &PictureSummary| summary.bandwidth.map(|b| b.map(|c| c.radius_m));
                let expected = radii(&summary).map(|b| b.map(|r| r.map(|r| r * s)));
                assert_eq!(radii(&other), expected, "{at} x {s}");
                let differ = film.iter().zip(&other_film).filter(|(a, b)| a != b).count();
                assert_eq!(differ, 0, "{at} x {s}: of {} numbers", film.len());
            }
        }
    }
}
