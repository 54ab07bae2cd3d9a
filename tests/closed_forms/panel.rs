//! A Lambertian panel against the form factors of parallel rectangles.
//!
//! The illuminance below a corner of a rectangle of luminance L, parallel to the plane, is
//! L / 2 (X / sqrt(1 + X^2) atan(Y / sqrt(1 + X^2)) + Y / sqrt(1 + Y^2) atan(X / sqrt(1 + Y^2))), X and Y the sides over the
//! distance; any point is below the common corner of four rectangles with signs. (Howell, Menguc, Daun, Siegel, "Thermal
//! Radiation Heat Transfer", configuration factor of a plane element and a parallel rectangle.)

use std::f64::consts::PI;

use caustix::scene::requires::requirements;
use caustix::sequence::Sequence;

use crate::support::judge::{assert_cells, assert_total};
use crate::support::quadrature::cell_means;
use crate::support::scenes::{run, scene, try_scene};

const WIDTH: f64 = 1.3;
const HEIGHT: f64 = 0.5;
const DISTANCE: f64 = 0.8;
const FLUX_LM: f64 = 700.0;

/// Illuminance [lx] at x and y from the point below the centre.
fn below(x: f64, y: f64) -> f64 {
    let luminance = FLUX_LM / (PI * WIDTH * HEIGHT);
    let corner = |a: f64, b: f64| {
        let (x, y) = (a.abs() / DISTANCE, b.abs() / DISTANCE);
        let (p, q) = ((1.0 + x * x).sqrt(), (1.0 + y * y).sqrt());
        let value = 0.5 * luminance * (x / p * (y / p).atan() + y / q * (x / q).atan());
        value * a.signum() * b.signum()
    };
    let (l, r) = (x - 0.5 * WIDTH, x + 0.5 * WIDTH);
    let (b, t) = (y - 0.5 * HEIGHT, y + 0.5 * HEIGHT);
    corner(r, t) - corner(l, t) - corner(r, b) + corner(l, b)
}

fn panel(position: [f64; 3], size: [f64; 2], flux_lm: f64) -> String {
    format!(
        "[[emitter]]\ntype = \"panel\"\nposition = {position:?}\naim = [0, 0, -2]\nup = [0, 1, 1]\nsize = {size:?}\n\
         flux_lm = {flux_lm}\n"
    )
}

fn plate(x: f64, y: f64, half: f64, cells: usize) -> String {
    format!(
        r#"
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [{}, {}, 0.0]
edge_u = [{e}, 0.0, 0.0]
edge_v = [0.0, {e}, 0.0]
[[receiver]]
surface = "plate"
cells = [{cells}, {cells}]
"#,
        x - half,
        y - half,
        e = 2.0 * half
    )
}

const CENTRE: [f64; 3] = [0.2, -0.1, DISTANCE];

#[test]
fn a_plane_below_is_lit_as_the_form_factor_says() {
    let half = 1.5;
    let scene = scene(&(panel(CENTRE, [WIDTH, HEIGHT], FLUX_LM) + &plate(0.2, -0.1, half, 24)));
    assert!(requirements(&scene).contains(&"panel emission"));
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
fn the_formula_is_the_integral_over_the_panel() {
    let luminance = FLUX_LM / (PI * WIDTH * HEIGHT);
    for [x, y] in [[0.0, 0.0], [0.5 * WIDTH, 0.5 * HEIGHT], [1.5, -0.7]] {
        // L cos cos / d^2 = L h^2 / d^4.
        let integrand = |u: f64, v: f64| {
            let (dx, dy) = (WIDTH * (u - 0.5) - x, HEIGHT * (v - 0.5) - y);
            (DISTANCE / (dx * dx + dy * dy + DISTANCE * DISTANCE)).powi(2)
        };
        let integral = luminance * WIDTH * HEIGHT * cell_means(1, 1, 8, integrand)[0];
        assert!((integral / below(x, y) - 1.0).abs() < 1e-9, "{integral} {}", below(x, y));
    }
}

#[test]
fn small_cells_below_centre_corner_and_beside() {
    for (i, [x, y]) in [[0.0, 0.0], [0.5 * WIDTH, 0.5 * HEIGHT], [1.5, -0.7]].into_iter().enumerate() {
        let half = 0.09;
        let text = panel(CENTRE, [WIDTH, HEIGHT], FLUX_LM) + &plate(0.2 + x, -0.1 + y, half, 3);
        let scene = scene(&text);
        let at = |u: f64, v: f64| below(x + half * (2.0 * u - 1.0), y + half * (2.0 * v - 1.0));
        let outcome = run(&scene, Sequence::SobolOwen, 1 << 17, 16, 10 + i as u64);
        assert_cells("small cells", &scene, &outcome, 0, &cell_means(3, 3, 2, at));
    }
}

#[test]
fn of_several_panels_each_gets_its_share_and_the_choice_costs_no_coordinate() {
    let text = panel([0.0, 0.0, 1.0], [0.2, 0.2], 100.0)
        + &panel([0.0, 0.0, 2.0], [1.0, 0.1], 300.0)
        + &plate(0.0, 0.0, 1.0, 4);
    let outcome = run(&scene(&text), Sequence::SobolOwen, 1 << 12, 8, 3);
    assert_eq!(outcome.ledger.emitted[0] * 3, outcome.ledger.emitted[1], "a net is divided exactly");
    assert_eq!(outcome.census.dimension_max, 4);
}

#[test]
fn nothing_shines_backwards() {
    let above = plate(0.2, -0.1, 1.0, 4).replace("0.0]\nedge_u", "2.0]\nedge_u") + "side = \"both\"\n";
    let outcome =
        run(&scene(&(panel(CENTRE, [WIDTH, HEIGHT], FLUX_LM) + &above)), Sequence::SobolOwen, 1 << 12, 4, 4);
    assert_eq!(outcome.totals().sum[0], 0);
    assert_eq!(outcome.ledger.escaped, outcome.photons);
}

fn refused(text: &str) -> String {
    let errors = try_scene(text).err().unwrap_or_else(|| panic!("accepted:\n{text}"));
    assert_eq!(errors.len(), 1, "{errors:?}");
    assert_eq!(errors[0].line(), Some(1), "{errors:?}");
    errors[0].to_string()
}

#[test]
fn a_panel_on_or_across_a_closed_surface_is_refused() {
    let black = "[material.black]\ntype = \"absorber\"\n";
    let sphere = |centre: [f64; 3], radius: f64| {
        format!(
            "{black}[[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"black\"\ncenter = {centre:?}\nradius = {radius}\n"
        )
    };
    let panel = panel([0.0, 0.0, 1.0], [2.0, 1.0], 1.0);
    // On a surface; a corner inside a sphere; a sphere in the middle of one quarter, far from rim and centre.
    assert!(
        refused(&(panel.clone() + &plate(0.0, 0.0, 1.0, 2).replace("0.0]\nedge_u", "1.0]\nedge_u")))
            .contains("on surface")
    );
    assert!(refused(&(panel.clone() + &sphere([1.0, 0.5, 1.0], 0.3))).contains("partly inside"));
    assert!(refused(&(panel.clone() + &sphere([0.5, 0.25, 1.1], 0.15))).contains("cut by"));
    // Its end on an open surface, far from its centre.
    let shelf = plate(1.2, 0.0, 0.5, 2).replace("0.0]\nedge_u", "1.0]\nedge_u");
    assert!(refused(&(panel.clone() + &shelf)).contains("on surface"));
    // Inside, outside, and an open surface that crosses it are fine.
    // (It meets the panel in a line of the points that are looked at.)
    for fine in [sphere([0.0, 0.0, 1.0], 1.5), sphere([0.0, 0.0, 0.0], 0.9), {
        plate(0.0, 1.09375, 1.0, 2).replace("edge_v = [0.0, 2.0, 0.0]", "edge_v = [0.0, 0.0, 3.0]")
    }] {
        scene(&(panel.clone() + &fine));
    }
}
