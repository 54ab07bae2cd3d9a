//! Inside a diffuse sphere of albedo a.
//!
//! A photon meets the wall k times with probability a^(k-1) (1 - a), whatever the directions: mean 1/(1 - a), variance
//! a/(1 - a)^2. Light scattered by Lambert's law inside a sphere falls equally on all of it, so any luminaire anywhere in
//! it gives the uniform indirect illuminance a Phi / ((1 - a) 4 pi R^2).

use std::f64::consts::PI;

use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::Sampling;
use caustix::scene::Scene;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::{Points, Sequence};
use caustix::surface::Grey;
use caustix::transport::census::Exceptions;
use caustix::transport::{Arrival, End, Sink, walk};
use statrs::distribution::{ChiSquared, ContinuousCDF};

use crate::support::data::project;
use crate::support::judge::{SIGNIFICANCE, assert_cells, assert_total, student_p};
use crate::support::scenes::{run, scene};
use crate::support::statistics::z_test;

const RADIUS: f64 = 1.7;

fn sphere(emitter: &str, albedo: f64) -> Scene {
    scene(&format!(
        r#"
[[emitter]]
{emitter}
[material.white]
type = "lambertian"
reflectance = {albedo}
[[surface]]
name = "wall"
type = "sphere"
material = "white"
center = [0.3, -0.2, 0.1]
radius = {RADIUS}
[[receiver]]
name = "indirect"
surface = "wall"
side = "back"
events = "indirect"
cells = [16, 8]
[[receiver]]
name = "outside"
surface = "wall"
side = "front"
cells = [1, 1]
"#
    ))
}

#[derive(Default)]
struct Hits(u32);

impl Sink for Hits {
    fn arrive(&mut self, arrival: &Arrival<'_>) {
        assert_eq!(arrival.events, self.0, "events are counted one by one");
        self.0 += 1;
    }
}

/// Number of hits of each photon.
fn hits<P: Points>(scene: &Scene, points: &P, n: u64) -> Vec<u32> {
    let mut exceptions = Exceptions::default();
    (0..n)
        .map(|index| {
            let mut coordinates = Coordinates::new(points, index, true);
            let (emitter, emission) = scene.emitters.emit(Sampling::default(), &mut coordinates).unwrap();
            let mut sink = Hits::default();
            let end = walk(
                scene,
                emission,
                scene.start(emitter),
                Grey,
                &mut coordinates,
                &mut sink,
                &mut exceptions,
            );
            assert!(matches!(end, End::Absorbed(_)), "a closed sphere lets nothing out: {end:?}");
            sink.0
        })
        .collect()
}

/// Mean and mean square deviation from the exact mean.
fn moments(hits: &[u32], mean: f64) -> (f64, f64) {
    let n = hits.len() as f64;
    let sum: f64 = hits.iter().map(|h| f64::from(*h)).sum();
    let square: f64 = hits.iter().map(|h| (f64::from(*h) - mean).powi(2)).sum();
    (sum / n, square / n)
}

const LAMP: &str = "type = \"photometric\"\nfile = \"../ies/floodlight_b.ies\"\nposition = [0.9, 0.1, -0.6]\naim = [1.0, 0.2, 0.3]";

#[test]
fn hits_per_photon_are_geometric() {
    let n = 1u64 << 17;
    for (seed, a) in [(1, 0.2), (2, 0.5), (3, 0.8), (4, 0.95)] {
        let scene = sphere(LAMP, a);
        let hits = hits(&scene, &IndependentPoints::new(seed, 0), n);
        let (mean, variance) = (1.0 / (1.0 - a), a / (1.0 - a).powi(2));
        let (m, v) = moments(&hits, mean);
        // Fourth central moment of the geometric distribution: variance^2 (9 + (1 - a)^2 / a).
        let fourth = variance * variance * (9.0 + (1.0 - a).powi(2) / a);
        let z_mean = (m - mean) / (variance / n as f64).sqrt();
        let z_variance = (v - variance) / ((fourth - variance * variance) / n as f64).sqrt();
        println!(
            "albedo {a}: mean {m:.4} ({mean:.4}, z {z_mean:.2}), variance {v:.4} ({variance:.4}, z {z_variance:.2})"
        );
        assert!(z_test(z_mean) > SIGNIFICANCE && z_test(z_variance) > SIGNIFICANCE);
        // The whole distribution: chi-square over k, the tail pooled where fewer than 10 are expected.
        let expected = |k: u32| n as f64 * a.powi(k as i32 - 1) * (1.0 - a);
        let last = (1..).find(|k| expected(*k) < 10.0).unwrap();
        let tail = n as f64 * a.powi(last as i32 - 1);
        let count = |test: &dyn Fn(u32) -> bool| hits.iter().filter(|h| test(**h)).count() as f64;
        let chi2 = (1..last).map(|k| (count(&|h| h == k) - expected(k)).powi(2) / expected(k)).sum::<f64>()
            + (count(&|h| h >= last) - tail).powi(2) / tail;
        let p = ChiSquared::new(f64::from(last - 1)).unwrap().sf(chi2);
        println!("albedo {a}: chi-square {chi2:.1} of {} degrees, p {p:.3}", last - 1);
        assert!(p > SIGNIFICANCE);
    }
}

#[test]
fn scrambled_nets_keep_mean_and_variance_of_the_hits() {
    // Renormalised roulette: some of these photons decide tens of events on one coordinate.
    let replicates = 16;
    for (seed, a) in [(5, 0.5), (6, 0.9)] {
        let scene = sphere(LAMP, a);
        let (mean, variance) = (1.0 / (1.0 - a), a / (1.0 - a).powi(2));
        let sets: Vec<(f64, f64)> = (0..replicates)
            .map(|r| moments(&hits(&scene, &OwenPoints::new(seed, r), 1 << 13), mean))
            .collect();
        for (name, values, exact) in [
            ("mean", sets.iter().map(|s| s.0).collect::<Vec<_>>(), mean),
            ("variance", sets.iter().map(|s| s.1).collect(), variance),
        ] {
            let r = f64::from(replicates);
            let average = values.iter().sum::<f64>() / r;
            let spread = values.iter().map(|x| (x - average).powi(2)).sum::<f64>() / (r - 1.0);
            let t = (average - exact) / (spread / r).sqrt();
            println!("albedo {a}: {name} {average:.5}, exact {exact:.5}, t = {t:.2}");
            assert!(student_p(t, replicates - 1) > SIGNIFICANCE);
        }
    }
}

#[test]
fn any_file_off_centre_gives_uniform_indirect_illuminance() {
    let mut files: Vec<String> = std::fs::read_dir(project().join("ies"))
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap())
        .filter(|name| name.ends_with(".ies"))
        .collect();
    files.sort();
    assert!(files.len() >= 10);
    for (i, file) in files.iter().enumerate() {
        let a = [0.3, 0.5, 0.7][i % 3];
        let emitter = format!(
            "type = \"photometric\"\nfile = \"../ies/{file}\"\nposition = [-0.6, 0.5, 0.9]\naim = [0.4, -1.0, 0.3]\nup = [0.0, 0.2, 1.0]"
        );
        let scene = sphere(&emitter, a);
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 13, 16, 10 + i as u64);
        let uniform = a * scene.emitters.flux_lm() / ((1.0 - a) * 4.0 * PI * RADIUS * RADIUS);
        assert_cells(file, &scene, &outcome, 0, &[uniform; 128]);
        let exact = a / (1.0 - a) * scene.emitters.flux_lm();
        assert_total(file, &outcome, outcome.receiver_flux_lm(0), exact);
        assert_eq!(outcome.totals().sum[1], 0, "light outside the sphere");
        assert_eq!(outcome.ledger.absorbed[0], outcome.photons);
    }
}
