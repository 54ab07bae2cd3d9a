//! Receivers without `cells`: those that a pilot chooses have the error that it aims at, against closed forms.

use std::sync::atomic::AtomicBool;

use caustix::run::{Plan, Settings, choose_cells, trace};
use caustix::scene::Scene;
use caustix::scene::receiver::Cells;
use caustix::sequence::Sequence;

use crate::support::scenes::scene;

/// A lamp of one candela 0.7 m over the middle of a floor of 4 m x 2 m, a black ball above it, and a plate in the dark.
fn rooms(keys: &str) -> String {
    format!(
        r#"
[[emitter]]
type = "isotropic"
flux_lm = 12.566370614359172
position = [0, 0, 0.7]
[material.black]
type = "absorber"
[[surface]]
name = "floor"
type = "rectangle"
material = "black"
corner = [-2, -1, 0]
edge_u = [4, 0, 0]
edge_v = [0, 2, 0]
[[surface]]
name = "far side"
type = "rectangle"
material = "black"
corner = [-2, -1, -1]
edge_u = [4, 0, 0]
edge_v = [0, 2, 0]
[[surface]]
name = "ball"
type = "sphere"
material = "black"
center = [0, 0, 2]
radius = 0.5
[[receiver]]
surface = "floor"
{keys}
[[receiver]]
surface = "ball"
[[receiver]]
surface = "far side"
"#
    )
}

fn plan(photons: u64, seed: u64, sequence: Sequence) -> Plan {
    let mut settings = Settings { photons: Some(photons), seed, ..Settings::default() };
    settings.algorithm.sequence = sequence;
    Plan::new(&settings).unwrap()
}

fn counts(scene: &Scene) -> Vec<[u32; 2]> {
    let of = |cells| match cells {
        Cells::Grid { nu, nv } => [nu, nv],
        Cells::Faces { count } => [count as u32, 1],
    };
    scene.receivers.iter().map(|receiver| of(receiver.cells)).collect()
}

fn chosen(text: &str, plan: &Plan) -> Scene {
    let mut scene = scene(text);
    choose_cells(&mut scene, plan, &AtomicBool::new(false)).unwrap();
    scene
}

/// Solid angle of a cell of the floor, seen by the lamp.
fn solid_angle([a, b]: [f64; 2], [c, d]: [f64; 2]) -> f64 {
    let h = 0.7;
    let corner = |x: f64, y: f64| (x * y / (h * (x * x + y * y + h * h).sqrt())).atan();
    corner(b, d) - corner(a, d) - corner(b, c) + corner(a, c)
}

/// The relative error of the floor's cells, half of the light by half, against solid angles.
#[test]
fn cells_have_about_the_error_that_is_aimed_at() {
    for photons in [1 << 17, 1 << 20] {
        let plan = plan(photons, 5, Sequence::SobolOwen);
        let scene = chosen(&rooms(""), &plan);
        let [nu, nv] = counts(&scene)[0];
        assert_eq!(nu, 2 * nv, "square cells");
        let outcome = trace(&scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap();
        let edge = |i: u32, n: u32, side: f64| side * (f64::from(i) / f64::from(n) - 0.5);
        let mut errors: Vec<(f64, f64)> = (0..nu * nv)
            .map(|cell| {
                let (column, row) = (cell % nu, cell / nu);
                let x = [edge(column, nu, 4.0), edge(column + 1, nu, 4.0)];
                let y = [edge(row, nv, 2.0), edge(row + 1, nv, 2.0)];
                let truth = solid_angle(x, y);
                let area = scene.receivers[0].area_m2(0);
                let lumens = area * outcome.illuminance_lx(0, cell as usize, area).value;
                ((lumens / truth - 1.0).abs(), truth)
            })
            .collect();
        errors.sort_by(|a, b| a.0.total_cmp(&b.0));
        let light: f64 = errors.iter().map(|(_, truth)| truth).sum();
        let mut below = 0.0;
        let median = errors.iter().find(|(_, truth)| {
            below += truth;
            2.0 * below >= light
        });
        // Half of the absolute values of a normal deviate are below 0.6745. Counts go in steps of 2 in the number of cells.
        let standard = median.unwrap().0 / 0.6745;
        assert!((0.012..0.032).contains(&standard), "{nu} x {nv}: {standard}");
    }
}

#[test]
fn cells_depend_on_the_scene_and_the_number_of_photons_alone() {
    let of = |photons, seed, sequence| counts(&chosen(&rooms(""), &plan(photons, seed, sequence)));
    let first = of(1 << 18, 1, Sequence::SobolOwen);
    assert_eq!(first, of(1 << 18, 99, Sequence::SobolOwen));
    assert_eq!(first, of(1 << 18, 1, Sequence::Independent));
    // Sixteen times the photons: cells a quarter as wide, within a step.
    let more = of(1 << 22, 1, Sequence::SobolOwen);
    for (few, many) in first.iter().zip(&more).take(2) {
        let finer = f64::from(many[0]) / f64::from(few[0]);
        assert!((2.6..5.7).contains(&finer), "{few:?} {many:?}");
    }
    // About three times as many round the ball as from pole to pole; no light at all, the fewest.
    assert_eq!(first[1][1], (f64::from(first[1][0]) / 3.0).round() as u32);
    assert_eq!(first[2], [8, 4]);
}

#[test]
fn cells_that_are_given_stay_and_grids_too() {
    let plan = plan(1 << 14, 1, Sequence::SobolOwen);
    let scene = chosen(&rooms("cells = [30, 20]\ngrid = [5, 5]"), &plan);
    assert_eq!(counts(&scene)[0], [30, 20]);
    let grid = scene.receivers[0].grid.unwrap();
    assert_eq!([grid.nu, grid.nv], [5, 5]);
    let scene = chosen(&rooms("grid = [5, 5]"), &plan);
    assert_eq!(scene.receivers[0].grid.unwrap().nu, 5);
    let area = scene.receivers[0].total_area_m2();
    assert!((area - 8.0).abs() < 1e-12, "{area}");
    assert_eq!(scene.receivers.len(), 3);
}
