//! Two plates that face each other, and a paraboloid with a lamp at its focus, against the formulas.

use std::f64::consts::PI;

use caustix::sequence::Sequence;

use crate::support::judge::{assert_cells, assert_total};
use crate::support::quadrature::{cell_means, composite};
use crate::support::scenes::{run, scene};

/// View factor from a small element to a parallel rectangle a x b at distance c, one corner of it opposite the element.
fn corner_factor(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    (x / p * (y / p).atan() + y / q * (x / q).atan()) / (2.0 * PI)
}

/// View factor between equal parallel rectangles a x b at distance c, directly opposite.
fn plates_factor(a: f64, b: f64, c: f64) -> f64 {
    let (x, y) = (a / c, b / c);
    let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
    2.0 / (PI * x * y)
        * ((p * p * q * q / (1.0 + x * x + y * y)).sqrt().ln()
            + x * q * (x / q).atan()
            + y * p * (y / p).atan()
            - x * x.atan()
            - y * y.atan())
}

#[test]
fn a_diffuse_plate_lights_another_by_the_view_factor() {
    let (a, b, c, reflectance, flux) = (1.2, 0.8, 0.5, 0.7, 1000.0);
    let scene = scene(&format!(
        r#"
[[emitter]]
type = "collimated"
position = [0.0, 0.0, 0.2]
aim = [0.0, 0.0, -1.0]
up = [0.0, 1.0, 0.0]
size = [{a}, {b}]
flux_lm = {flux}
[material.white]
type = "lambertian"
reflectance = {reflectance}
[material.black]
type = "absorber"
[[surface]]
name = "floor"
type = "rectangle"
material = "white"
corner = [-0.6, -0.4, 0.0]
edge_u = [{a}, 0.0, 0.0]
edge_v = [0.0, {b}, 0.0]
[[surface]]
name = "ceiling"
type = "rectangle"
material = "black"
corner = [-0.6, 0.4, {c}]
edge_u = [{a}, 0.0, 0.0]
edge_v = [0.0, -{b}, 0.0]
[[receiver]]
surface = "ceiling"
cells = [24, 16]
"#
    ));
    let outcome = run(&scene, Sequence::SobolOwen, 1 << 16, 16, 1);
    let emittance = reflectance * flux / (a * b);
    let exact = cell_means(24, 16, 2, |u, v| {
        let (x, y) = (u * a, v * b);
        let corners = [(x, y), (a - x, y), (x, b - y), (a - x, b - y)];
        emittance * corners.iter().map(|(x, y)| corner_factor(*x, *y, c)).sum::<f64>()
    });
    let total = reflectance * flux * plates_factor(a, b, c);
    let sum = exact.iter().sum::<f64>() * a * b / exact.len() as f64;
    assert!((sum / total - 1.0).abs() < 1e-9, "the two formulas agree: {sum}, {total}");
    assert_cells("plates", &scene, &outcome, 0, &exact);
    assert_total("plates", &outcome, outcome.receiver_flux_lm(0), total);
    // What is scattered and does not meet the ceiling leaves: nothing comes back from a black plate.
    assert_total("escaped", &outcome, outcome.escaped_lm(), reflectance * flux - total);
}

#[test]
fn a_paraboloid_makes_a_parallel_beam_of_the_known_profile() {
    // A ray at angle psi from the way to the vertex leaves parallel to the axis at r = 2 f tan(psi / 2); with candela I
    // the beam has E = reflectance I / (f^2 (1 + r^2 / (4 f^2))^2), at any distance.
    let (f, rim, reflectance, flux) = (0.05, 0.2, 0.92, 1000.0);
    let candela = flux / (4.0 * PI);
    let (side, cells) = (0.44, 20);
    let profile = |r: f64| {
        let k = 1.0 + (r / (2.0 * f)).powi(2);
        if r < rim { reflectance * candela / (f * f * k * k) } else { 0.0 }
    };
    // Cell means with the sum over y ended at the rim, where the profile jumps.
    let rule = composite(16);
    let width = side / f64::from(cells);
    let mut exact = Vec::new();
    for row in 0..cells {
        for column in 0..cells {
            let (x0, y0) = (f64::from(column) * width - 0.5 * side, 0.5 * side - f64::from(row + 1) * width);
            let mut sum = 0.0;
            for (s, ws) in &rule {
                let x = x0 + s * width;
                let reach = (rim * rim - x * x).max(0.0).sqrt();
                let (low, high) = (y0.max(-reach), (y0 + width).min(reach));
                for (t, wt) in rule.iter().filter(|_| high > low) {
                    sum += ws * wt * profile(x.hypot(low + t * (high - low))) * (high - low) / width;
                }
            }
            exact.push(sum);
        }
    }
    // Two distances, each with the wall's direct light told apart.
    for (distance, seed) in [(0.5, 2), (3.0, 3)] {
        let scene = scene(&format!(
            r#"
[[emitter]]
type = "isotropic"
position = [{f}, 0.0, 0.0]
flux_lm = {flux}
[material.silver]
type = "mirror"
reflectance = {reflectance}
[material.black]
type = "absorber"
[[surface]]
name = "dish"
type = "paraboloid"
material = "silver"
vertex = [0.0, 0.0, 0.0]
axis = [1.0, 0.0, 0.0]
focal_length = {f}
radius = {rim}
[[surface]]
name = "wall"
type = "rectangle"
material = "black"
corner = [{distance:?}, 0.22, -0.22]
edge_u = [0.0, -{side}, 0.0]
edge_v = [0.0, 0.0, {side}]
[[receiver]]
name = "beam"
surface = "wall"
cells = [{cells}, {cells}]
events = "indirect"
[[receiver]]
name = "spill"
surface = "wall"
cells = [{cells}, {cells}]
events = "direct"
"#
        ));
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 16, 16, seed);
        assert_cells("beam", &scene, &outcome, 0, &exact);
        // All light within the rim's angle, tan(psi / 2) = rim / (2 f).
        let half = (rim / (2.0 * f)).atan();
        let total = reflectance * flux * half.sin().powi(2);
        assert_total("beam", &outcome, outcome.receiver_flux_lm(0), total);
        if distance < 1.0 {
            let d = distance - f;
            let n = cells as usize;
            let direct = cell_means(n, n, 2, |u, v| {
                let r2 = ((u - 0.5) * side).powi(2) + ((v - 0.5) * side).powi(2);
                candela * d / (d * d + r2).powf(1.5)
            });
            assert_cells("spill", &scene, &outcome, 1, &direct);
        }
    }
}
