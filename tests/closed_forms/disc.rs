//! A Lambertian disc against the form factor of a plane element below a parallel disc, and the surfaces that may not meet it.
//!
//! The illuminance at r from the axis and h below a disc of radius 1 and luminance L is
//! pi L / 2 (1 - (h^2 + r^2 - 1) / sqrt((1 + h^2 + r^2)^2 - 4 r^2)); on the axis pi L sin^2 of the half angle at which the disc
//! is seen. (Howell, Menguc, Daun, Siegel, "Thermal Radiation Heat Transfer".)

use std::f64::consts::PI;

use caustix::scene::requires::requirements;
use caustix::sequence::Sequence;

use crate::support::judge::{assert_cells, assert_total};
use crate::support::quadrature::cell_means;
use crate::support::scenes::{run, scene, try_scene};

const RADIUS: f64 = 0.6;
const DISTANCE: f64 = 0.8;
const FLUX_LM: f64 = 700.0;
const LUMINANCE: f64 = FLUX_LM / (PI * PI * RADIUS * RADIUS);

/// Illuminance [lx] at x and y from the point below the centre.
fn below(x: f64, y: f64) -> f64 {
    let (h2, r2) = ((DISTANCE / RADIUS).powi(2), (x * x + y * y) / (RADIUS * RADIUS));
    let sum = 1.0 + h2 + r2;
    0.5 * PI * LUMINANCE * (1.0 - (sum - 2.0) / (sum * sum - 4.0 * r2).sqrt())
}

const DISC: &str = "[[emitter]]\ntype = \"disc\"\nposition = [0.2, -0.1, 0.8]\nradius = 0.6\nflux_lm = 700\n";

fn surface(keys: &str) -> String {
    format!(
        "[material.black]\ntype = \"absorber\"\n[[surface]]\nname = \"it\"\nmaterial = \"black\"\n{keys}\n"
    )
}

/// A square plate below the centre, in cells.
fn plate(x: f64, half: f64, cells: usize) -> String {
    let rectangle = format!(
        "type = \"rectangle\"\ncorner = [{}, {}, 0.0]\nedge_u = [{e}, 0.0, 0.0]\nedge_v = [0.0, {e}, 0.0]",
        0.2 + x - half,
        -0.1 - half,
        e = 2.0 * half
    );
    surface(&rectangle) + &format!("[[receiver]]\nsurface = \"it\"\ncells = [{cells}, {cells}]\n")
}

#[test]
fn a_plane_below_is_lit_as_the_form_factor_says() {
    let half = 1.5;
    let scene = scene(&(DISC.to_string() + &plate(0.0, half, 24)));
    assert!(requirements(&scene).contains(&"disc emission"));
    let exact = cell_means(24, 24, 2, |u, v| below(half * (2.0 * u - 1.0), half * (2.0 * v - 1.0)));
    for (sequence, seed) in [(Sequence::SobolOwen, 1), (Sequence::Independent, 2)] {
        let outcome = run(&scene, sequence, 1 << 16, 16, seed);
        assert_cells(sequence.name(), &scene, &outcome, 0, &exact);
        let flux = exact.iter().sum::<f64>() * (2.0 * half / 24.0).powi(2);
        assert_total(sequence.name(), &outcome, outcome.receiver_flux_lm(0), flux);
        assert_eq!(outcome.census.dimension_max, 4, "two coordinates for the place, two for the direction");
    }
}

#[test]
fn a_small_receiver_on_the_axis_and_one_beside_it() {
    let sin2 = RADIUS * RADIUS / (RADIUS * RADIUS + DISTANCE * DISTANCE);
    assert!((below(0.0, 0.0) / (PI * LUMINANCE * sin2) - 1.0).abs() < 1e-14);
    for (i, x) in [0.0, RADIUS, 1.4].into_iter().enumerate() {
        let half = 0.09;
        let scene = scene(&(DISC.to_string() + &plate(x, half, 3)));
        let at = |u: f64, v: f64| below(x + half * (2.0 * u - 1.0), half * (2.0 * v - 1.0));
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 17, 16, 10 + i as u64);
        assert_cells("small cells", &scene, &outcome, 0, &cell_means(3, 3, 2, at));
    }
}

#[test]
fn nothing_shines_backwards() {
    let above = plate(0.0, 1.0, 4).replace("0.0]\nedge_u", "2.0]\nedge_u") + "side = \"both\"\n";
    let outcome = run(&scene(&(DISC.to_string() + &above)), Sequence::SobolOwen, 1 << 12, 4, 4);
    assert_eq!(outcome.totals().sum[0], 0);
    assert_eq!(outcome.ledger.escaped, outcome.photons);
}

/// What is found wrong with an emitter and a surface, in one error that points to the emitter; empty if nothing is.
fn found(emitter: &str, surface: &str) -> String {
    let errors = match try_scene(&(emitter.to_string() + surface)) {
        Ok(_) => return String::new(),
        Err(errors) => errors,
    };
    assert_eq!((errors.len(), errors[0].line()), (1, Some(1)), "{errors:?}");
    errors[0].found().to_string()
}

#[test]
fn a_surface_on_or_across_a_light_is_found_for_every_shape() {
    let head = |kind: &str, size: &str| {
        format!("[[emitter]]\ntype = \"{kind}\"\nposition = [0, 0, 1]\nflux_lm = 1\n{size}\n")
    };
    // Each reaches to 1 along x and 0.5 along y at least, and not to 1 along both.
    let lights = [
        ("panel", head("panel", "size = [2, 1]")),
        ("disc", head("disc", "radius = 1")),
        ("beam", head("collimated", "radius = 1")),
        ("beam", head("collimated", "size = [2, 1]")),
    ];
    let sphere = |centre: [f64; 3], radius: f64| {
        surface(&format!("type = \"sphere\"\ncenter = {centre:?}\nradius = {radius}"))
    };
    let cuboid =
        |min: [f64; 3], max: [f64; 3]| surface(&format!("type = \"box\"\nmin = {min:?}\nmax = {max:?}"));
    let flat = |corner: [f64; 3], v: [f64; 3]| {
        surface(&format!("type = \"rectangle\"\ncorner = {corner:?}\nedge_u = [0.4, 0, 0]\nedge_v = {v:?}"))
    };
    for (noun, light) in &lights {
        let cut = format!("the {noun} \"emitter 1\" cut by the closed surface \"it\"");
        // Through the middle of a part, small and smaller; a long thin bar across, whose corners are all far outside.
        for through in [
            sphere([0.5, 0.1, 1.01], 0.02),
            sphere([-0.31, -0.27, 1.0], 1e-6),
            cuboid([0.3, 0.2, 0.9], [0.3001, 0.2001, 1.1]),
            cuboid([-5.0, 0.2, 0.999], [5.0, 0.21, 1.001]),
            cuboid([0.2, -5.0, 0.5], [0.21, 5.0, 1.5]),
        ] {
            assert_eq!(found(light, &through), cut, "{through}");
        }
        let partly = "the light of emitter \"emitter 1\" starting partly inside a closed surface";
        assert_eq!(found(light, &sphere([1.0, 0.0, 1.0], 0.3)), partly);
        let on = if *noun == "beam" { "" } else { "emitter \"emitter 1\" on surface \"it\"" };
        for flush in [[0.5, 0.1, 1.0], [0.9, -0.1, 1.0]] {
            assert_eq!(found(light, &flat(flush, [0.0, 0.2, 0.0])), on);
        }
        // Beside, before, behind, around, from wall to wall; and an open surface that crosses.
        for fine in [
            sphere([0.0, 1.6, 1.0], 0.55),
            sphere([0.3, 0.3, 0.49], 0.5),
            sphere([0.3, 0.3, 1.51], 0.5),
            sphere([0.0, 0.0, 1.0], 1.5),
            cuboid([-1.0, -1.0, 0.0], [1.0, 1.0, 2.0]),
            cuboid([-5.0, 1.1, 0.5], [5.0, 1.2, 1.5]),
            flat([0.3, 0.2, 0.7], [0.0, 0.0, 0.6]),
        ] {
            assert_eq!(found(light, &fine), "", "{light}{fine}");
        }
    }
    // The corner of a panel is no part of the disc in it.
    let corner = sphere([0.95, 0.47, 1.0], 0.04);
    assert!(found(&lights[0].1, &corner).contains("cut by") && found(&lights[1].1, &corner).is_empty());
}
