//! What an interrupted run leaves is a sample of all the light, not of the part that happened to be traced first.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use caustix::emitter::{Emitter, Isotropic};
use caustix::error::Kind;
use caustix::geometry::Rectangle;
use caustix::run::{Outcome, Plan, Settings, StoppedBy, trace};
use caustix::scene::{Scene, SceneBuilder};
use caustix::surface::Material;
use glam::DVec3;

/// A lamp above a floor so wide that half of its light meets it, the first half of the first coordinate or the last.
fn lamp_over_floor() -> Scene {
    let corner = DVec3::new(-1e6, -1e6, 0.0);
    let floor = Rectangle::new(corner, DVec3::X * 2e6, DVec3::Y * 2e6).unwrap();
    let lamp = Emitter::Isotropic(Isotropic::new(DVec3::Z, 1000.0).unwrap());
    let mut scene = SceneBuilder::new();
    scene.surface("floor", floor.into(), Material::Absorber).emitter("lamp", lamp);
    scene.build().unwrap()
}

/// A run that is interrupted once this many photons are done.
fn interrupted_after(photons: u64, settings: &Settings) -> caustix::error::Result<Outcome> {
    let interrupt = AtomicBool::new(photons == 0);
    let done = AtomicU64::new(0);
    let progress = |n: u64| {
        if done.fetch_add(n, Ordering::Relaxed) + n >= photons {
            interrupt.store(true, Ordering::Relaxed);
        }
    };
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().unwrap();
    pool.install(|| trace(&lamp_over_floor(), &Plan::new(settings).unwrap(), &interrupt, &progress))
}

#[test]
fn an_interrupt_in_the_first_replicate_leaves_light_in_all_directions() {
    for photons in [1 << 16, 100_000, 300_000] {
        let settings = Settings { photons: Some(1 << 20), replicates: Some(1), ..Settings::default() };
        let outcome = interrupted_after(photons, &settings).unwrap();
        assert_eq!((outcome.stopped_by, outcome.replicates), (StoppedBy::Interrupt, 1));
        assert!(outcome.photons.is_power_of_two() && outcome.photons <= photons + (1 << 14));
        assert_eq!(outcome.photons, outcome.ledger.total_emitted());
        // A net of 2^m points has exactly half of them in each half of its first coordinate; a photon or two near the
        // horizon may miss the floor's edge.
        assert!(outcome.ledger.escaped.abs_diff(outcome.ledger.absorbed[0]) <= 4, "{:?}", outcome.ledger);
        assert!((outcome.absorbed_lm(0).value - 500.0).abs() < 2.0);
    }
}

#[test]
fn an_interrupt_in_a_later_replicate_leaves_the_finished_ones() {
    let settings = Settings { photons: Some(1 << 20), replicates: Some(4), ..Settings::default() };
    let outcome = interrupted_after((2 << 18) + 1, &settings).unwrap();
    assert_eq!((outcome.stopped_by, outcome.replicates), (StoppedBy::Interrupt, 2));
    assert_eq!((outcome.photons, outcome.ledger.total_emitted()), (2 << 18, 2 << 18));
    assert_eq!(outcome.accounts().sum[0], outcome.ledger.absorbed[0]);
}

#[test]
fn an_interrupt_before_anything_is_an_error_of_its_own_kind() {
    assert_eq!(interrupted_after(0, &Settings::default()).unwrap_err().kind(), Kind::Interrupted);
}
