//! A run with a camera: its receivers, its passes, its bits.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use caustix::error::Kind;
use caustix::files::photon_map;
use caustix::files::scene_toml::parse_scene;
use caustix::picture::camera::Film;
use caustix::picture::{AnyPicture, Picture, Watch, hash_of_photons, picture_of_saved, trace_picture};
use caustix::run::{Outcome, Plan, Settings, StoppedBy, trace};
use caustix::scene::camera::{Bandwidth, Camera, CameraSpec};
use caustix::scene::receiver::ReceiverSpec;
use caustix::scene::{Scene, SceneBuilder};
use caustix::surface::{Dielectric, Lambertian, Material, Reflectance};
use glam::DVec3;

use crate::support::data::project;
use crate::support::pictures::{beam, grey, on_threads, panel, plan, rectangle, sphere, unwatched};

/// A glass ball above a table before a wall, under a beam and a panel: light of L S+ D and of L D D.
fn ball_on_table(wall: Material, memory_bytes: u64, with_camera: bool) -> Scene {
    let position = DVec3::new(0.2, -1.6, 0.9);
    let camera = CameraSpec {
        photon_memory_bytes: memory_bytes,
        bandwidth: Bandwidth::Radius(0.1),
        samples: 4,
        ..CameraSpec::pinhole(position, DVec3::new(0.0, 0.3, 0.0), DVec3::Z, 60.0, [16, 12])
    };
    let table = rectangle("table", DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    let back = rectangle("wall", DVec3::new(-1.0, 1.0, 0.0), DVec3::X * 2.0, DVec3::Z * 1.5);
    let glass = Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap());
    let mut scene = SceneBuilder::new();
    let ball = sphere("ball", DVec3::new(0.1, 0.2, 0.35), 0.25);
    for (surface, material) in [(table, grey(0.5)), (back, wall), (ball, glass)] {
        scene.surface(surface.name, surface.shape, material);
    }
    scene
        .emitter("beam", beam(DVec3::new(0.1, 0.2, 2.0), DVec3::NEG_Z, 0.3, 300.0))
        .emitter("panel", panel(DVec3::Z * 1.8, DVec3::NEG_Z, DVec3::X, [0.4, 0.4], 700.0))
        .receiver(ReceiverSpec::new("table", "table").unwrap().with_cells([8, 8]).unwrap());
    if with_camera {
        scene.camera(Camera::new(camera).unwrap());
    }
    scene.build().unwrap()
}

const ROOM: u64 = 1 << 30;

fn pictured(scene: &Scene, plan: &Plan, keep: bool) -> (Outcome, Picture<1>) {
    let (outcome, picture) = trace_picture(scene, plan, keep, unwatched(&AtomicBool::new(false))).unwrap();
    match picture {
        AnyPicture::Grey(picture) => (outcome, picture),
        AnyPicture::Rgb(_) => panic!("a grey scene"),
    }
}

fn bits<const C: usize>(film: &Film<C>) -> Vec<u64> {
    let values = film.value.iter().flatten();
    values.chain(&film.standard_error).chain(&film.bias).map(|v| v.to_bits()).collect()
}

#[test]
fn receivers_and_ledger_are_those_of_a_run_without_a_camera() {
    // Memory for all, so little that replicates are traced in parts, and none: every photon kept is a pass.
    for (photons, replicates, memory) in
        [(1 << 16, 4, ROOM), (30_000, 3, ROOM), (1 << 16, 4, 1 << 18), (30_000, 3, 1 << 18), (96, 3, 0)]
    {
        let plan = plan(photons, replicates);
        let bare = ball_on_table(grey(0.4), memory, false);
        let without = trace(&bare, &plan, &AtomicBool::new(false), &|_| {}).unwrap();
        let (with, picture) = pictured(&ball_on_table(grey(0.4), memory, true), &plan, false);
        assert_eq!((with.photons, &with.ledger), (without.photons, &without.ledger));
        assert_eq!(with.cells(), without.cells());
        assert_eq!(with.accounts(), without.accounts());
        assert_eq!(with.census.dimension_histogram, without.census.dimension_histogram);
        assert_eq!((picture.summary.photons, picture.summary.replicates), (plan.photons(), replicates));
        assert!((picture.summary.passes > 1) == (memory < ROOM), "{:?}", picture.summary);
    }
}

#[test]
fn one_two_and_seven_threads_give_the_same_bits() {
    let scene = ball_on_table(grey(0.4), ROOM, true);
    let on = |threads| on_threads(threads, || pictured(&scene, &plan(1 << 15, 4), true));
    let (_, one) = on(1);
    assert!(one.film.value.iter().filter(|v| v[0] > 0.0).count() > 50);
    for threads in [2, 7] {
        let (_, other) = on(threads);
        assert!(bits(&other.film) == bits(&one.film));
        assert!(other.photons == one.photons, "kept photons come in one order");
    }
}

#[test]
fn colour_takes_three_channels_and_its_luminance_is_that_of_the_weights() {
    let red = Material::Lambertian(Lambertian::new(Reflectance::rgb([0.9, 0.1, 0.1]).unwrap()));
    let scene = ball_on_table(red, ROOM, true);
    let plan = plan(1 << 14, 2);
    let (_, picture) = trace_picture(&scene, &plan, true, unwatched(&AtomicBool::new(false))).unwrap();
    let AnyPicture::Rgb(picture) = picture else { panic!("a scene in colour") };
    for photon in picture.photons.unwrap().photons {
        let [r, g, b] = photon.weight.map(f64::from);
        assert!((0.2126 * r + 0.7152 * g + 0.0722 * b - 1.0).abs() < 1e-6);
        assert!(photon.is_scattered() || photon.weight == [1.0; 3], "glass does not colour");
    }
}

#[test]
fn passes_add_up_to_the_picture_of_one() {
    let plan = plan(1 << 16, 4);
    let (_, whole) = pictured(&ball_on_table(grey(0.4), ROOM, true), &plan, false);
    assert_eq!(whole.summary.passes, 1);
    let kept = whole.summary.photons_kept;
    for (memory, least_passes) in [(1 << 20, 2), (1 << 18, 8)] {
        let (_, parts) = pictured(&ball_on_table(grey(0.4), memory, true), &plan, false);
        let passes = parts.summary.passes;
        println!("{memory} bytes: {passes} passes for {kept} photons");
        assert!(passes >= least_passes, "{passes}");
        assert_eq!(parts.summary.photons_kept, kept, "every photon is kept once");
        for (a, b) in parts.film.value.iter().zip(&whole.film.value) {
            assert!((a[0] - b[0]).abs() <= 1e-12 * b[0].abs(), "{a:?} {b:?}");
        }
        // The spread is that of whole replicates; where a pass has hardly a photon an error is added, never taken.
        for (a, b) in parts.film.standard_error.iter().zip(&whole.film.standard_error) {
            assert!(*a >= b * (1.0 - 1e-5), "{a} {b}");
        }
    }
}

#[test]
fn kept_photons_give_the_picture_again_bit_for_bit() {
    let plan = plan(1 << 15, 4);
    let scene = ball_on_table(grey(0.4), ROOM, true);
    let (_, fresh) = pictured(&scene, &plan, true);
    let kept = fresh.photons.unwrap();
    assert_eq!((kept.photons_traced, kept.replicates), (1 << 15, 4));
    assert_eq!(kept.photons.len() as u64, fresh.summary.photons_kept);
    let again = picture_of_saved(&scene, &plan, kept.clone(), unwatched(&AtomicBool::new(false))).unwrap();
    assert!(bits(&again.film) == bits(&fresh.film));
    let mut strange = kept;
    strange.photons[5].primitive = 1000;
    let refused = picture_of_saved(&scene, &plan, strange, unwatched(&AtomicBool::new(false)));
    assert_eq!(refused.unwrap_err().kind(), Kind::Range);
    let small = ball_on_table(grey(0.4), 1 << 18, true);
    // Photons that are too many are not handed out; all else is as without asking.
    let (asked, too_many) = pictured(&small, &plan, true);
    let (_, unasked) = pictured(&small, &plan, false);
    assert!(too_many.photons.is_none() && too_many.summary.passes > 1, "{:?}", too_many.summary);
    assert_eq!(asked.photons, 1 << 15);
    let (sum, expected) = (total(&too_many.film), total(&unasked.film));
    assert!((sum / expected - 1.0).abs() < 1e-12, "{sum} {expected}");
    // Room for all but not for what is foretold (an eighth more and some): kept all the same.
    let needed = fresh.summary.photons_kept * (2 * 28 + 8);
    let tight = ball_on_table(grey(0.4), needed + needed / 100, true);
    let (_, all) = pictured(&tight, &plan, true);
    assert!(all.summary.passes == 1 && bits(&all.film) == bits(&fresh.film));
    assert_eq!(all.photons.unwrap().photons.len() as u64, fresh.summary.photons_kept);
}

/// A run on one thread that is interrupted once this many photons are done.
fn interrupted_after(photons: u64, memory: u64, plan: &Plan) -> (Outcome, Picture<1>) {
    let interrupt = AtomicBool::new(false);
    let done = AtomicU64::new(0);
    let progress = |n: u64| {
        if done.fetch_add(n, Ordering::Relaxed) + n >= photons {
            interrupt.store(true, Ordering::Relaxed);
        }
    };
    let watch = Watch { interrupt: &interrupt, photons: &progress, camera: &|_| {} };
    let scene = ball_on_table(grey(0.4), memory, true);
    let (outcome, picture) = on_threads(1, || trace_picture(&scene, plan, false, watch)).unwrap();
    let AnyPicture::Grey(picture) = picture else { panic!("a grey scene") };
    (outcome, picture)
}

#[test]
fn an_interrupted_run_leaves_the_picture_of_what_was_traced() {
    let four = plan(1 << 18, 4);
    let (outcome, picture) = interrupted_after((2 << 16) + 1, ROOM, &four);
    assert_eq!((outcome.stopped_by, outcome.replicates), (StoppedBy::Interrupt, 2));
    assert_eq!((picture.summary.photons, picture.summary.replicates), (2 << 16, 2));
    // The first two replicates alone are the same photons.
    let (_, two) = pictured(&ball_on_table(grey(0.4), ROOM, true), &plan(2 << 16, 2), false);
    assert!(bits(&picture.film) == bits(&two.film));
    // In several passes a photon's flux was that of the whole run until it turned out otherwise.
    let (outcome, parts) = interrupted_after((2 << 16) + 1, 1 << 20, &four);
    assert!(parts.summary.passes > 1 && outcome.replicates >= 2, "{:?}", parts.summary);
    assert_eq!(parts.summary.photons, outcome.photons);
    let (sum, expected) = (total(&parts.film), total(&two.film));
    assert!((sum / expected - 1.0).abs() < 0.02, "{sum} {expected}");
}

/// Another camera.
fn change(scene: &mut Scene, how: impl FnOnce(&mut CameraSpec)) {
    let mut spec = CameraSpec::clone(scene.camera.as_ref().unwrap());
    how(&mut spec);
    scene.camera = Some(Camera::new(spec).unwrap());
}

/// A run whose camera is interrupted in its `pass`th pass, on one thread.
fn interrupted_in_pass(pass: u32, memory: u64, plan: &Plan) -> (Outcome, Picture<1>) {
    let interrupt = AtomicBool::new(false);
    let (in_pass, of_pass) = (AtomicU64::new(1), AtomicU64::new(0));
    let camera = |part: f64| {
        // Parts of a pass rise to 1.
        if part.to_bits() < of_pass.swap(part.to_bits(), Ordering::Relaxed) {
            in_pass.fetch_add(1, Ordering::Relaxed);
        }
        if in_pass.load(Ordering::Relaxed) == u64::from(pass) {
            interrupt.store(true, Ordering::Relaxed);
        }
    };
    let watch = Watch { interrupt: &interrupt, photons: &|_| {}, camera: &camera };
    let mut scene = ball_on_table(grey(0.4), memory, true);
    change(&mut scene, |spec| spec.pixels = [36, 20]);
    let (outcome, picture) = on_threads(1, || trace_picture(&scene, plan, false, watch)).unwrap();
    let AnyPicture::Grey(picture) = picture else { panic!("a grey scene") };
    (outcome, picture)
}

#[test]
fn an_interrupt_while_the_camera_looks_costs_neither_receivers_nor_the_pixels_seen() {
    let four = plan(1 << 16, 4);
    let bare = ball_on_table(grey(0.4), ROOM, false);
    let without = trace(&bare, &four, &AtomicBool::new(false), &|_| {}).unwrap();
    // In the only pass: all is traced, a tile is seen.
    let (outcome, picture) = interrupted_in_pass(1, ROOM, &four);
    assert_eq!((outcome.stopped_by, outcome.cells()), (StoppedBy::Photons, without.cells()));
    assert_eq!(picture.summary.pixels_unseen, 36 * 20 - 256);
    assert_eq!(picture.film.standard_error.iter().filter(|e| e.is_finite()).count(), 256);
    // In one before the last: tracing ends, and what there is by then is seen wholly.
    let (outcome, picture) = interrupted_in_pass(2, 1 << 18, &four);
    assert_eq!((outcome.stopped_by, picture.summary.pixels_unseen), (StoppedBy::Interrupt, 0));
    assert!(outcome.replicates < 4 && picture.summary.passes >= 2, "{:?}", picture.summary);
    let mut scene = ball_on_table(grey(0.4), ROOM, true);
    change(&mut scene, |spec| spec.pixels = [36, 20]);
    let (sum, expected) = (total(&picture.film), total(&pictured(&scene, &four, false).1.film));
    assert!((sum / expected - 1.0).abs() < 0.02, "{sum} {expected}");
}

#[test]
fn what_an_interrupt_leaves_of_a_replicate_is_taken_back() {
    // A replicate takes several passes; the interrupt comes in the middle of the fifth of eight.
    let eight = plan(1 << 19, 8);
    let (outcome, parts) = interrupted_after((4 << 16) + (1 << 15) + 1, 1 << 18, &eight);
    assert!(parts.summary.passes > 2 * parts.summary.replicates, "{:?}", parts.summary);
    assert_eq!((parts.summary.photons, parts.summary.replicates), (outcome.photons, 4));
    // The same photons as a run of four replicates in passes.
    let four = ball_on_table(grey(0.4), 1 << 18, true);
    let (_, whole) = pictured(&four, &plan(4 << 16, 4), false);
    for (a, b) in parts.film.value.iter().zip(&whole.film.value) {
        assert!((a[0] - b[0]).abs() <= 1e-12 * b[0].abs(), "{a:?} {b:?}");
    }
    for (a, b) in parts.film.standard_error.iter().zip(&whole.film.standard_error) {
        // The spread of the eye's samples is that of all they saw.
        assert!(*a >= 0.9 * b && *a <= 1.5 * b, "{a} {b}");
    }
}

#[test]
fn a_bandwidth_chosen_in_the_first_of_many_passes_is_near_that_of_one() {
    let plan = plan(1 << 18, 8);
    let chosen = |memory| {
        let mut scene = ball_on_table(grey(0.4), memory, true);
        change(&mut scene, |spec| spec.bandwidth = Bandwidth::Automatic);
        let (_, picture) = pictured(&scene, &plan, false);
        (picture.summary.bandwidth.unwrap().map(|b| b.radius_m.unwrap()), picture.summary)
    };
    let (whole, one) = chosen(ROOM);
    // Several replicates in the first pass, one, and parts of one.
    for memory in [1 << 21, 1 << 20, 1 << 19, 1 << 18, 1 << 17] {
        let (parts, many) = chosen(memory);
        println!("{} passes: {parts:?} m, one: {whole:?} m", many.passes);
        assert!(many.passes > one.passes);
        let [caustic, diffuse] = [0, 1].map(|k| parts[k] / whole[k]);
        // How sharp a caustic is few photons cannot tell: they blur it more.
        assert!((0.7..7.0).contains(&caustic) && (0.5..2.0).contains(&diffuse), "{parts:?} {whole:?}");
    }
}

fn total(film: &Film<1>) -> f64 {
    film.value.iter().map(|v| v[0]).sum()
}

#[test]
fn a_saved_map_is_of_its_scene_and_settings_and_undamaged() {
    let plan = plan(1 << 13, 2);
    let scene = ball_on_table(grey(0.4), ROOM, true);
    let (_, fresh) = pictured(&scene, &plan, true);
    let mut bytes = Vec::new();
    photon_map::write(&fresh.photons.unwrap(), &mut bytes).unwrap();
    let hash = hash_of_photons(&scene, &plan);
    let read = photon_map::read::<1>(&bytes, &hash).unwrap();
    let again = picture_of_saved(&scene, &plan, read, unwatched(&AtomicBool::new(false))).unwrap();
    assert!(bits(&again.film) == bits(&fresh.film));
    for at in [0, 9, bytes.len() / 2, bytes.len() - 1] {
        let mut damaged = bytes.clone();
        damaged[at] ^= 4;
        assert!(photon_map::read::<1>(&damaged, &hash).is_err(), "byte {at}");
    }
    assert!(photon_map::read::<1>(&bytes[..bytes.len() - 50], &hash).is_err());
    let settings = Settings { photons: Some(1 << 13), replicates: Some(2), seed: 8, ..Settings::default() };
    let other = Plan::new(&settings).unwrap();
    let refused = photon_map::read::<1>(&bytes, &hash_of_photons(&scene, &other));
    assert_eq!(refused.unwrap_err().kind(), Kind::Range);
}

#[test]
fn the_hash_of_photons_is_of_all_but_the_camera() {
    let plan = plan(1 << 13, 2);
    let folder = tempfile::tempdir().unwrap();
    let lamp = std::fs::read_to_string(project().join("ies/spot.ies")).unwrap();
    let of = |text: &str, lamp: &str| {
        std::fs::write(folder.path().join("a.ies"), lamp).unwrap();
        hash_of_photons(&parse_scene(text, folder.path()).unwrap(), &plan)
    };
    let scene = "[[emitter]]\ntype = 'photometric'\nfile = 'a.ies'\nposition = [0, 0, 2]\n\
                 [material.wall]\ntype = \"absorber\"\n\
                 [[surface]]\nname = 's'\ntype = 'sphere'\nmaterial = 'wall'\ncenter = [0, 0, 0]\nradius = 1\n";
    let camera = "[camera]\nposition = [0, 0, 4]\nlook_at = [0, 1, 0]\nfov_deg = 40\npixels = [8, 8]\n";
    let bare = of(scene, &lamp);
    assert_eq!(of(&format!("{scene}{camera}"), &lamp), bare);
    assert_eq!(of(&format!("{scene}{}", camera.replace("40", "50")), &lamp), bare);
    assert_ne!(of(&scene.replace("absorber", "mirror"), &lamp), bare);
    assert_ne!(of(scene, &lamp.replace("narrow beam", "wide beam")), bare);
}
