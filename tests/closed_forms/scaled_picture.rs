//! A scene with a camera in another unit of length is the same picture.
//!
//! A scale of a power of two changes exponents alone, so every photon takes the same way however often it turns, and a pixel's
//! luminance changes by the scale's inverse square, bit for bit: its direct light, its densities with the bandwidth that is chosen
//! for them, its error and its bias. (Other scales round anew; the balls, rings and wine glasses that cameras look at magnify
//! that at every turn, so no bound on it is worth stating.)

use std::sync::atomic::AtomicBool;

use caustix::picture::camera::Film;
use caustix::picture::{AnyPicture, PictureSummary, trace_picture};
use caustix::run::Outcome;

use toml::Table;

use crate::lengths;
use crate::support::pictures::{plan, unwatched};
use crate::support::scenes::camera_scene_files;

/// Bits of a film whose luminances are multiplied by this.
fn bits<const C: usize>(film: &Film<C>, factor: f64) -> Vec<u64> {
    let values = film.value.iter().flatten();
    values.chain(&film.standard_error).chain(&film.bias).map(|v| (v * factor).to_bits()).collect()
}

/// The scene at this scale: its run, the bits of its picture in the luminance of scale 1, and how that was made.
fn seen(file: &Table, s: f64, photons: u64) -> (Outcome, Vec<u64>, PictureSummary) {
    let scene = lengths::scene(&lengths::scaled(file.clone(), s));
    let plan = plan(photons, 4);
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
        let mut scene = lengths::table(&file);
        for (lens_radius, method, photons) in
            [(0.0, "map", 1 << 12), (0.002, "map", 1 << 12), (0.0, "splat", 1 << 14)]
        {
            let camera = scene["camera"].as_table_mut().unwrap();
            camera.insert("lens_radius".into(), lens_radius.into());
            camera.insert("method".into(), method.into());
            camera.insert("pixels".into(), vec![16, 12].into());
            camera.insert("samples".into(), 4.into());
            let at = format!("{}, {method}, lens {lens_radius}", file.display());
            let (outcome, film, summary) = seen(&scene, 1.0, photons);
            assert!(film.iter().any(|b| *b != 0) && summary.photons_kept > 100, "{at}: {summary:?}");
            for s in [1024.0, 1.0 / 1024.0] {
                let (other_outcome, other_film, other) = seen(&scene, s, photons);
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
