//! A flat pane of glass with all its inner reflections, and total reflection, against the formulas.
//!
//! Unpolarised at every face, order m of the light that passes a pane carries (1 - R)^2 R^(2m), together
//! (1 - R)/(1 + R), with R the mean of s and p; each order leaves 2 d tan(theta_t) further along. Fresnel's equations
//! stand here in their form of sines and tangents.

use caustix::run::Outcome;
use caustix::scene::Scene;
use caustix::sequence::Sequence;

use crate::support::judge::{SIGNIFICANCE, assert_cells, assert_total};
use crate::support::quadrature::{cell_means, root};
use crate::support::scenes::{run, scene};
use crate::support::statistics::z_test;

const IOR: f64 = 1.5;

/// Unpolarised reflectance from outside.
fn reflectance(theta: f64) -> f64 {
    if theta == 0.0 {
        return ((IOR - 1.0) / (IOR + 1.0)).powi(2);
    }
    let refracted = (theta.sin() / IOR).asin();
    let (minus, plus) = (theta - refracted, theta + refracted);
    0.5 * ((minus.sin() / plus.sin()).powi(2) + (minus.tan() / plus.tan()).powi(2))
}

/// Passed part of order m: through, with 2 m inner reflections.
fn passed(r: f64, m: u32) -> f64 {
    (1.0 - r).powi(2) * r.powi(2 * m as i32)
}

/// Part of order m that is sent back: m = 0 at the first face, else with 2 m - 1 inner reflections.
fn sent_back(r: f64, m: u32) -> f64 {
    if m == 0 { r } else { (1.0 - r).powi(2) * r.powi(2 * m as i32 - 1) }
}

/// A pane from z = `low` to `high`, as a closed box or as two open interfaces whose fronts look outwards.
fn pane(low: f64, high: f64, half: f64, closed: bool) -> String {
    let glass = format!("[material.glass]\ntype = \"dielectric\"\nior = {IOR}\n");
    let shapes = if closed {
        format!(
            "[[surface]]\nname = \"pane\"\ntype = \"box\"\nmaterial = \"glass\"\nmin = [-{half:?}, -{half:?}, {low:?}]\nmax = [{half:?}, {half:?}, {high:?}]\n"
        )
    } else {
        rectangle("upper face", "glass", [-half, -half, high], 2.0 * half, 2.0 * half)
            + &rectangle("lower face", "glass", [-half, half, low], 2.0 * half, -2.0 * half)
    };
    glass + &shapes
}

/// A horizontal rectangle; it looks up where `along_y` is positive.
fn rectangle(name: &str, material: &str, corner: [f64; 3], along_x: f64, along_y: f64) -> String {
    format!(
        "[[surface]]\nname = \"{name}\"\ntype = \"rectangle\"\nmaterial = \"{material}\"\ncorner = {corner:?}\nedge_u = [{along_x:?}, 0.0, 0.0]\nedge_v = [0.0, {along_y:?}, 0.0]\n"
    )
}

const LOW: f64 = 0.5;
const THICK: f64 = 0.1;
const CEILING: f64 = 1.2;
const ORDERS: u32 = 8;

/// A thin beam on a pane, and two strips whose cells catch one order each: below (receiver 0) and above (receiver 1).
fn orders_scene(theta: f64, closed: bool) -> Scene {
    let shift = 2.0 * THICK * (theta.sin() / IOR).asin().tan();
    let lift = 0.2;
    let half_cell = 0.5 * shift;
    let below = 0.5 * shift + LOW * theta.tan() - half_cell;
    let above = (CEILING - LOW - THICK) * theta.tan() - half_cell;
    let width = shift * f64::from(ORDERS);
    let text = format!(
        "[[emitter]]\ntype = \"collimated\"\nposition = [{:?}, 0.0, {:?}]\naim = [{:?}, 0.0, {:?}]\nradius = 0.01\nflux_lm = 1.0\n[material.black]\ntype = \"absorber\"\n",
        -lift * theta.tan(),
        LOW + THICK + lift,
        theta.sin(),
        -theta.cos()
    ) + &pane(LOW, LOW + THICK, 5.0, closed)
        + &rectangle("floor", "black", [below, -0.1, 0.0], width, 0.2)
        + &rectangle("ceiling", "black", [above, 0.1, CEILING], width, -0.2)
        + &format!(
            "[[receiver]]\nsurface = \"floor\"\ncells = [{ORDERS}, 1]\n[[receiver]]\nsurface = \"ceiling\"\ncells = [{ORDERS}, 1]\n"
        );
    scene(&text)
}

/// Counts of each order and its exact probability.
fn orders(outcome: &Outcome, r: f64) -> Vec<(u64, f64)> {
    (0..ORDERS)
        .flat_map(|m| {
            let at = m as usize;
            [(outcome.cells()[0].sum[at], passed(r, m)), (outcome.cells()[1].sum[at], sent_back(r, m))]
        })
        .collect()
}

#[test]
fn every_order_of_a_thin_beam_carries_its_term_of_the_series() {
    for degrees in [40.0f64, 60.0, 70.0, 80.0] {
        let theta = degrees.to_radians();
        let r = reflectance(theta);
        let series: f64 = (0..200).map(|m| passed(r, m)).sum();
        assert!((series - (1.0 - r) / (1.0 + r)).abs() < 1e-14);
        for closed in [true, false] {
            let scene = orders_scene(theta, closed);
            // Independent photons: binomial counts.
            let n = 1u64 << 16;
            let outcome = run(&scene, Sequence::Independent, n, 1, 3);
            for (count, p) in orders(&outcome, r) {
                if n as f64 * p >= 10.0 {
                    let z = (count as f64 - n as f64 * p) / (n as f64 * p * (1.0 - p)).sqrt();
                    assert!(z_test(z) > SIGNIFICANCE, "{degrees} degrees, closed {closed}: {count}, z = {z}");
                }
            }
            // A scrambled net: all events of a photon share its third coordinate, an order is one interval of it, and
            // only the two ends of an interval can be off by a photon each.
            let (n, replicates) = (1u64 << 12, 16);
            let outcome = run(&scene, Sequence::SobolOwen, n, replicates, 4);
            let photons = n as f64 * f64::from(replicates);
            for (count, p) in orders(&outcome, r) {
                let off = count as f64 - photons * p;
                assert!(
                    off.abs() < 2.0 * f64::from(replicates),
                    "{degrees} degrees, closed {closed}: off by {off}"
                );
            }
            assert_eq!(outcome.census.dimension_max, 3);
        }
    }
}

#[test]
fn a_pane_passes_and_sends_back_what_the_sums_say() {
    for degrees in [0.0f64, 30.0, 60.0, 75.0, 85.0] {
        let theta = degrees.to_radians();
        let r = reflectance(theta);
        for closed in [true, false] {
            let text = format!(
                "[[emitter]]\ntype = \"collimated\"\nposition = [0.0, 0.0, {:?}]\naim = [{:?}, 0.0, {:?}]\nsize = [0.05, 0.03]\nflux_lm = 1.0\n[material.black]\ntype = \"absorber\"\n",
                LOW + THICK + 0.1,
                theta.sin(),
                -theta.cos()
            ) + &pane(LOW, LOW + THICK, 100.0, closed)
                + &rectangle("floor", "black", [-100.0, -1.0, 0.0], 200.0, 2.0)
                + &rectangle("ceiling", "black", [-100.0, 1.0, CEILING], 200.0, -2.0);
            let scene = scene(&text);
            let surface = |name| scene.geometry.surface_named(name).unwrap().0 as usize;
            let n = 1u64 << 16;
            let outcome = run(&scene, Sequence::Independent, n, 1, 5);
            let transmitted = (1.0 - r) / (1.0 + r);
            for (name, p) in [("floor", transmitted), ("ceiling", 1.0 - transmitted)] {
                let count = outcome.ledger.absorbed[surface(name)];
                let z = (count as f64 - n as f64 * p) / (n as f64 * p * (1.0 - p)).sqrt();
                println!(
                    "{degrees} degrees, {name}: {count} of {n}, expected {:.1}, z = {z:.2}",
                    n as f64 * p
                );
                assert!(z_test(z) > SIGNIFICANCE);
            }
            assert_eq!(outcome.ledger.escaped, 0);
        }
    }
}

/// Illuminance at a distance r from the lamp's axis by light of these weights: each a part of the flux in its direction
/// and the path's height in glass; `air` is its height in air. E = I w sin(theta) / (r dr/dsin(theta) cos(theta)).
fn shifted_lx(
    candela: f64,
    r: f64,
    air: f64,
    paths: impl Iterator<Item = (Box<dyn Fn(f64) -> f64>, f64)>,
) -> f64 {
    paths
        .map(|(weight, glass)| {
            let distance = |s: f64| air * s / (1.0 - s * s).sqrt() + glass * s / (IOR * IOR - s * s).sqrt();
            let s = root(0.0, 1.0, |s| distance(s) - r);
            let slope = air * (1.0 - s * s).powf(-1.5) + glass * IOR * IOR * (IOR * IOR - s * s).powf(-1.5);
            candela * weight(s.asin()) * s / ((1.0 - s * s).sqrt() * r * slope)
        })
        .sum()
}

#[test]
fn a_point_lamp_through_a_pane_is_shifted_order_by_order() {
    let (low, high, lamp, ceiling) = (0.5, 0.7, 1.3, 1.6);
    let (glass, cells, coarse) = (high - low, 16, 6);
    let candela = 1000.0 / (4.0 * std::f64::consts::PI);
    let radius = |u: f64, v: f64| (1.6 * u - 0.8).hypot(1.6 * v - 0.8);
    let through = cell_means(cells, cells, 2, |u, v| {
        let orders = (0..12u32).map(|m| {
            let weight: Box<dyn Fn(f64) -> f64> = Box::new(move |theta| passed(reflectance(theta), m));
            (weight, f64::from(2 * m + 1) * glass)
        });
        shifted_lx(candela, radius(u, v), lamp - glass, orders)
    });
    let back = cell_means(coarse, coarse, 5, |u, v| {
        let orders = (0..12u32).map(|m| {
            let weight: Box<dyn Fn(f64) -> f64> = Box::new(move |theta| sent_back(reflectance(theta), m));
            (weight, f64::from(2 * m) * glass)
        });
        shifted_lx(candela, radius(u, v), (lamp - high) + (ceiling - high), orders)
    });
    for closed in [true, false] {
        let text = format!(
            "[[emitter]]\ntype = \"isotropic\"\nposition = [0.0, 0.0, {lamp:?}]\nflux_lm = 1000.0\n[material.black]\ntype = \"absorber\"\n"
        ) + &pane(low, high, 40.0, closed)
            + &rectangle("floor", "black", [-0.8, -0.8, 0.0], 1.6, 1.6)
            + &rectangle("ceiling", "black", [-0.8, 0.8, ceiling], 1.6, -1.6)
            + &format!(
                "[[receiver]]\nsurface = \"floor\"\ncells = [{cells}, {cells}]\n[[receiver]]\nsurface = \"ceiling\"\ncells = [{coarse}, {coarse}]\nevents = \"indirect\"\n"
            );
        let scene = scene(&text);
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 17, 16, 6);
        for (i, (name, exact)) in [("through", &through), ("back", &back)].into_iter().enumerate() {
            let label = format!("{name}, closed {closed}");
            assert_cells(&label, &scene, &outcome, i, exact);
            let flux = exact.iter().sum::<f64>() * 2.56 / exact.len() as f64;
            assert_total(&label, &outcome, outcome.receiver_flux_lm(i), flux);
        }
    }
}

#[test]
fn total_reflection_begins_within_1e_9_of_the_critical_angle() {
    let critical = (1.0 / IOR).asin();
    let n = 1u64 << 20;
    for (delta, total) in [(-1e-9, false), (1e-9, true)] {
        let theta: f64 = critical + delta;
        // The lamp is below an open water-like surface, on its back, in the dense medium.
        let text = format!(
            "[[emitter]]\ntype = \"collimated\"\nposition = [{:?}, 0.0, -0.5]\naim = [{:?}, 0.0, {:?}]\nradius = 0.01\nflux_lm = 1.0\nmedium = \"glass\"\n[material.glass]\ntype = \"dielectric\"\nior = {IOR}\n[material.black]\ntype = \"absorber\"\n",
            -0.5 * theta.tan(),
            theta.sin(),
            theta.cos()
        ) + &rectangle("interface", "glass", [-1.0, -1.0, 0.0], 2.0, 2.0)
            + &rectangle("floor", "black", [-5.0, -5.0, -1.0], 10.0, 10.0);
        let scene = scene(&text);
        let outcome = run(&scene, Sequence::Independent, n, 1, 7);
        let floor = scene.geometry.surface_named("floor").unwrap().0 as usize;
        let (reflected, escaped) = (outcome.ledger.absorbed[floor], outcome.ledger.escaped);
        assert_eq!(reflected + escaped, n);
        println!("critical angle {delta:+e}: {escaped} of {n} pass");
        if total {
            assert_eq!(escaped, 0, "beyond the critical angle nothing passes");
            continue;
        }
        // sin^2(theta_t) = (cos(delta) - cot(critical) sin(delta))^2 written without the cancellation from 1.
        let short = 2.0 * (0.5 * delta).sin().powi(2) - (-delta).sin() / critical.tan();
        let cos_t = (-short * (2.0 + short)).abs().sqrt();
        let cos_i = theta.cos();
        let transmittance_s = 4.0 * IOR * cos_i * cos_t / (IOR * cos_i + cos_t).powi(2);
        let transmittance_p = 4.0 * IOR * cos_i * cos_t / (cos_i + IOR * cos_t).powi(2);
        let p = 0.5 * (transmittance_s + transmittance_p);
        let z = (escaped as f64 - n as f64 * p) / (n as f64 * p * (1.0 - p)).sqrt();
        println!("expected {:.1}, z = {z:.2}", n as f64 * p);
        assert!(escaped > 0 && z_test(z) > SIGNIFICANCE);
    }
}
