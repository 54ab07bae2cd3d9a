//! What an interrupted run leaves is a sample of all the light, not of the part that happened to be traced first.

use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};

use caustix::emitter::{Emitter, Isotropic};
use caustix::error::Kind;
use caustix::geometry::Rectangle;
use caustix::run::{Algorithm, Outcome, Plan, Settings, StoppedBy, trace, warnings};
use caustix::scene::receiver::ReceiverSpec;
use caustix::scene::{Scene, SceneBuilder};
use caustix::sequence::Sequence;
use caustix::surface::Material;
use glam::DVec3;

/// A lamp above a floor so wide that half of its light meets it, the first half of the first coordinate or the last.
fn lamp_over_floor() -> Scene {
    let corner = DVec3::new(-1e6, -1e6, 0.0);
    let floor = Rectangle::new(corner, DVec3::X * 2e6, DVec3::Y * 2e6).unwrap();
    let lamp = Emitter::Isotropic(Isotropic::new(DVec3::Z, 1000.0).unwrap());
    let mut scene = SceneBuilder::new();
    scene.surface("floor", floor.into(), Material::Absorber).emitter("lamp", lamp);
    scene.receiver(ReceiverSpec::new("floor", "floor").unwrap().with_cells([8, 8]).unwrap());
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
fn an_interrupt_leaves_all_replicates_as_far_as_they_had_come() {
    let settings = |photons| Settings { photons: Some(photons), replicates: Some(4), ..Settings::default() };
    let outcome = interrupted_after((2 << 18) + 1, &settings(1 << 20)).unwrap();
    assert_eq!((outcome.stopped_by, outcome.replicates), (StoppedBy::Interrupt, 4));
    assert_eq!((outcome.photons, outcome.ledger.total_emitted()), (2 << 18, 2 << 18));
    assert!(outcome.absorbed_lm(0).standard_error.is_some_and(|error| error > 0.0));
    // The same photons as those of a run that asks for no more.
    let plan = Plan::new(&settings(2 << 18)).unwrap();
    let whole = trace(&lamp_over_floor(), &plan, &AtomicBool::new(false), &|_| {}).unwrap();
    assert_eq!((outcome.accounts(), outcome.cells()), (whole.accounts(), whole.cells()));
    assert_eq!((outcome.photon_lm, whole.stopped_by), (whole.photon_lm, StoppedBy::Photons));
}

#[test]
fn replicates_whose_maps_are_too_large_together_are_traced_in_turn_and_that_is_told() {
    // 2^16 replicates of 64 x 64 cells: 2^28 counters.
    let scene = |cells: u32| {
        let mut scene = SceneBuilder::new();
        let floor = Rectangle::new(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0).unwrap();
        let lamp = Emitter::Isotropic(Isotropic::new(DVec3::Z, 1000.0).unwrap());
        scene.surface("floor", floor.into(), Material::Absorber).emitter("lamp", lamp);
        scene.receiver(ReceiverSpec::new("floor", "floor").unwrap().with_cells([cells, cells]).unwrap());
        scene.build().unwrap()
    };
    let settings = Settings { photons: Some(1 << 16), replicates: Some(1 << 16), ..Settings::default() };
    let plan = Plan::new(&settings).unwrap();
    let traced = |scene: &Scene| trace(scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap();
    let told =
        |scene: &Scene, outcome| warnings(scene, outcome).iter().any(|w| w.code == "replicates-in-turn");
    let (few, many) = (scene(1), scene(64));
    let (together, in_turn) = (traced(&few), traced(&many));
    assert_eq!((told(&few, &together), told(&many, &in_turn)), (false, true));
    // The same photons both ways.
    assert_eq!((together.accounts(), together.totals()), (in_turn.accounts(), in_turn.totals()));
    assert_eq!(in_turn.cells()[0].sum.iter().sum::<u64>(), together.cells()[0].sum[0]);
}

#[test]
fn points_made_for_their_number_are_traced_one_replicate_after_another() {
    let sequence = Sequence::ALL.into_iter().find(|s| s.needs_number() && s.is_randomised()).unwrap();
    let algorithm = Algorithm { sequence, ..Algorithm::default() };
    let settings = Settings { photons: Some(1 << 18), replicates: Some(4), algorithm, ..Settings::default() };
    let outcome = interrupted_after((2 << 16) + 1, &settings).unwrap();
    assert_eq!((outcome.stopped_by, outcome.replicates), (StoppedBy::Interrupt, 2));
    assert_eq!((outcome.photons, outcome.accounts().sum[0]), (2 << 16, outcome.ledger.absorbed[0]));
}

#[test]
fn an_interrupt_before_anything_is_an_error_of_its_own_kind() {
    assert_eq!(interrupted_after(0, &Settings::default()).unwrap_err().kind(), Kind::Interrupted);
}
