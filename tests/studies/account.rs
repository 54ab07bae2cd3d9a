//! The coordinates that a study predicts from events are those that photons use, for every variant.

use caustix::lab::study::account::Events;
use caustix::run::{Algorithm, Plan, Settings, trace};
use caustix::scene::Scene;
use std::sync::atomic::AtomicBool;

use crate::support::scenes::scene;

/// Two lamps, a mirror, glass and grey walls: choices of emitter and cell, Fresnel events, absorption, scattering.
const MIXED: &str = r#"
[[emitter]]
type = "photometric"
file = "../ies/floodlight_b.ies"
position = [0.1, 0.2, 1.5]

[[emitter]]
type = "isotropic"
flux_lm = 3000
position = [-0.2, 0.1, 1.2]

[material.grey]
type = "lambertian"
reflectance = 0.6
[material.mirror]
type = "mirror"
reflectance = 0.9
[material.glass]
type = "dielectric"
ior = 1.5

[[surface]]
name = "room"
type = "box"
min = [-2, -2, -1]
max = [2, 2, 2]
material = "grey"
[[surface]]
name = "ball"
type = "sphere"
center = [0, 0, 0]
radius = 0.5
material = "glass"
[[surface]]
name = "mirror"
type = "rectangle"
corner = [-1.9, -1, -0.8]
edge_u = [0, 2, 0]
edge_v = [0, 0, 2]
material = "mirror"

[[receiver]]
surface = "mirror"
cells = [4, 4]
"#;

/// (mean, standard error of the mean) of the coordinates that photons drew.
fn drawn(scene: &Scene, algorithm: Algorithm) -> (f64, f64) {
    let settings = Settings { photons: Some(1 << 16), replicates: Some(4), seed: 7, algorithm };
    let plan = Plan::new(&settings).unwrap();
    let census = trace(scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap().census;
    let n = census.photons() as f64;
    let mean = census.dimension_mean();
    let square: f64 = census
        .dimension_histogram
        .iter()
        .enumerate()
        .map(|(k, photons)| *photons as f64 * (k as f64 - mean).powi(2))
        .sum();
    (mean, (square / n / n).sqrt())
}

#[test]
fn the_account_by_events_is_what_photons_draw_in_every_variant() {
    let mixed = scene(MIXED);
    let built_in = caustix::files::scene_toml::built_in().unwrap().build();
    let built_in = built_in.unwrap();
    for (name, scene) in [("mixed", &mixed), ("built in", &built_in)] {
        let events = Events::count(scene);
        for variant in ["mc", "mc:table", "qmc", "qmc:next-point", "qmc-inverse", "qmc-inverse-reuse"] {
            let algorithm = Algorithm::parse(variant).unwrap();
            if name == "mixed" && algorithm.sampling().skips_points() {
                // Points that give no photon would choose the emitter anew: refused, not biased.
                let plan = Plan::new(&Settings { algorithm, ..Settings::default() }).unwrap();
                let told = trace(scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap_err();
                assert!(told.required().contains("one emitter"), "{told}");
                continue;
            }
            let account = events.account(scene, algorithm);
            let (mean, error) = drawn(scene, algorithm);
            // Both are means over 2^16 photons. The histogram ends at 64 coordinates, so for geometric tails the spread is a
            // lower bound: 4.5 standard errors of the difference for 12 tests (2e-4 each), and a tenth for the tail.
            let slack = 1.1 * 4.5 * std::f64::consts::SQRT_2 * error;
            println!("{name} {variant}: {mean:.4} +- {error:.4}, account {:.4}", account.by_event);
            assert!((mean - account.by_event).abs() <= slack, "{name} {variant}: {mean} {account:?}");
        }
    }
}

#[test]
fn equations_count_the_events_of_a_plain_scene() {
    // Two faces of a slab, then a black plate below: B_s = 2 for what passes at once, C = 2.
    let built_in = caustix::files::scene_toml::built_in().unwrap().build();
    let built_in = built_in.unwrap();
    let events = Events::count(&built_in);
    assert_eq!(events.scattered, 0.0);
    assert!(events.specular > 1.0 && events.specular < 4.0, "{events:?}");
    assert!(events.end > 1.0 && events.end <= 2.0, "{events:?}");
    let account = events.account(&built_in, Algorithm::parse("mc").unwrap());
    assert!((account.equation_4 - (3.0 + events.specular + events.end)).abs() < 1e-12);
    assert!((account.equation_6 - (2.0 + events.end)).abs() < 1e-12);
}
