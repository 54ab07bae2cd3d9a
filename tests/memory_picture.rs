//! Photons take no more memory than the camera was given, however many there are.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

// A binary of its own: the allocator counts the whole process, so no other test may run beside this one.
#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/mod.rs"]
mod support;

use std::sync::atomic::AtomicBool;

use caustix::picture::{PictureSummary, trace_picture};
use caustix::scene::Scene;
use caustix::scene::camera::{Bandwidth, CameraSpec};
use caustix::surface::{Dielectric, Lambertian, Material, Reflectance};
use glam::DVec3;

use crate::allocator::peak_of;
use crate::support::pictures::{beam, grey, on_threads, panel, plan, rectangle, scene, sphere, unwatched};

/// A glass ball over a table before a wall, under a beam and a panel.
fn ball_on_table(table: Material, memory_bytes: u64, bandwidth: Bandwidth, pixels: [u32; 2]) -> Scene {
    let position = DVec3::new(0.2, -1.6, 0.9);
    let camera = CameraSpec {
        photon_memory_bytes: memory_bytes,
        bandwidth,
        samples: 4,
        ..CameraSpec::pinhole(position, DVec3::new(0.0, 0.3, 0.0), DVec3::Z, 60.0, pixels)
    };
    let plate = rectangle("table", DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0);
    let back = rectangle("wall", DVec3::new(-1.0, 1.0, 0.0), DVec3::X * 2.0, DVec3::Z * 1.5);
    let glass = Material::Dielectric(Dielectric::new(1.5, 1.0).unwrap());
    let light = [
        beam(DVec3::new(0.1, 0.2, 2.0), DVec3::NEG_Z, 0.3, 300.0),
        panel(DVec3::Z * 1.8, DVec3::NEG_Z, DVec3::X, [0.4, 0.4], 700.0),
    ];
    let ball = (sphere("ball", DVec3::new(0.1, 0.2, 0.35), 0.25), glass);
    scene(vec![(plate, table), (back, grey(0.4)), ball], light.into(), Some(camera))
}

fn peak(scene: &Scene, photons: u64) -> (usize, PictureSummary) {
    let plan = plan(photons, 4);
    let go = || trace_picture(scene, &plan, false, unwatched(&AtomicBool::new(false))).unwrap();
    let (peak, (_, picture)) = peak_of(go);
    (peak, picture.summary().clone())
}

#[test]
fn photons_take_what_the_camera_has_for_them_and_a_refused_picture_takes_nothing() {
    let red = Material::Lambertian(Lambertian::new(Reflectance::rgb([0.9, 0.5, 0.4]).unwrap()));
    on_threads(2, || {
        for (label, table, bytes_of_photon) in [("one channel", grey(0.5), 28), ("colour", red, 36)] {
            for bandwidth in [Bandwidth::Automatic, Bandwidth::Radius(0.02), Bandwidth::Nearest(100)] {
                let with = |bytes| ball_on_table(table.clone(), bytes, bandwidth, [16, 12]);
                // Threads and their stacks are made once.
                peak(&with(1 << 20), 1 << 12);
                let budget = 1u64 << 21;
                let (peak, summary) = peak(&with(budget), 3 << 19);
                // As they come, and in the map with its index.
                let needed = summary.photons_kept * (2 * bytes_of_photon + 8);
                println!(
                    "{label}, {bandwidth:?}: {peak} bytes for a budget of {budget}; {needed} needed, {} passes",
                    summary.passes
                );
                assert!(needed > 10 * budget && summary.passes >= 10, "{needed}, {}", summary.passes);
                // Beside photons a run has batches on their way and places that a bandwidth is tried at.
                assert!(peak < budget as usize + (1 << 19), "{label}, {bandwidth:?}: {peak}");
                // A budget that is not used would be no bound.
                assert!(peak > budget as usize / 3, "{label}, {bandwidth:?}: {peak}");
            }
        }
    });
    let large = ball_on_table(grey(0.5), 1 << 20, Bandwidth::Automatic, [8192, 8192]);
    let go = || trace_picture(&large, &plan(1 << 12, 4), false, unwatched(&AtomicBool::new(false)));
    let (peak, refused) = peak_of(go);
    assert!(refused.is_err());
    assert!(peak < 1 << 12, "{peak} bytes to refuse a picture of 6 GiB");
}
