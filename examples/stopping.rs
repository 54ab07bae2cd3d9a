//! What an error is worth that decided when to stop: coverage of its intervals, and the true error against the one asked for,
//! on scenes with a closed form (docs/LONG_RUNS.md).
//!
//! cargo run --release --features measurements --example stopping -- [SEEDS] [REPLICATES]
#![allow(clippy::unwrap_used, clippy::print_stdout)]

use std::sync::atomic::AtomicBool;

use caustix::{
    Algorithm, ErrorGoal, ErrorOf, Goal, Outcome, Plan, Scene, Settings, parse_scene, trace_until,
};
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

/// A lamp of 100 lm 1 m above the middle of a plate of 2 m x 2 m: a face of a cube about it, which takes a sixth.
const PLATE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.0, 0.0, 1.0]
flux_lm = 100
[material.black]
type = "absorber"
[[surface]]
name = "wall"
type = "rectangle"
material = "black"
corner = [-1.0, -1.0, 0.0]
edge_u = [2.0, 0.0, 0.0]
edge_v = [0.0, 2.0, 0.0]
[[receiver]]
surface = "wall"
cells = [32, 32]
"#;

/// The same lamp in the middle of a sphere of radius 1 m that reflects a half: 200 lm arrive, equally everywhere.
const SPHERE: &str = r#"
[[emitter]]
type = "isotropic"
position = [0.0, 0.0, 0.0]
flux_lm = 100
[material.white]
type = "lambertian"
reflectance = 0.5
[[surface]]
name = "wall"
type = "sphere"
material = "white"
center = [0.0, 0.0, 0.0]
radius = 1.0
[[receiver]]
surface = "wall"
side = "back"
cells = [40, 25]
"#;

struct Case {
    name: &'static str,
    scene: &'static str,
    variant: &'static str,
    of: ErrorOf,
    relative: f64,
    /// Flux on the receiver, lm.
    flux_lm: f64,
}

const CASES: [Case; 6] = [
    Case::new("plate", PLATE, "mc", ErrorOf::Flux, 0.02, 100.0 / 6.0),
    Case::new("plate", PLATE, "qmc-inverse-reuse", ErrorOf::Flux, 0.004, 100.0 / 6.0),
    Case::new("sphere", SPHERE, "mc", ErrorOf::Flux, 0.006, 200.0),
    Case::new("sphere", SPHERE, "qmc-inverse-reuse", ErrorOf::Flux, 0.0006, 200.0),
    Case::new("plate", PLATE, "qmc-inverse-reuse", ErrorOf::Cells, 0.2, 100.0 / 6.0),
    Case::new("sphere", SPHERE, "qmc-inverse-reuse", ErrorOf::Cells, 0.05, 200.0),
];

impl Case {
    const fn new(
        name: &'static str,
        scene: &'static str,
        variant: &'static str,
        of: ErrorOf,
        relative: f64,
        flux_lm: f64,
    ) -> Self {
        Self { name, scene, variant, of, relative, flux_lm }
    }

    /// The scene: for a flux with few cells, so that it is looked at from few photons on.
    fn scene(&self) -> Scene {
        let text = match self.of {
            ErrorOf::Cells => self.scene.to_owned(),
            _ => self.scene.replace("[32, 32]", "[2, 2]").replace("[40, 25]", "[2, 2]"),
        };
        parse_scene(&text, ".").unwrap()
    }
}

/// What one run came to.
struct Run {
    photons: f64,
    /// Error of the flux in its standard errors, and relative to the flux.
    in_errors: f64,
    relative: f64,
    /// Root mean square error of the cells by area, relative to the mean.
    cells: f64,
}

fn main() {
    let mut arguments = std::env::args().skip(1).map(|n| n.parse::<u64>().unwrap());
    let seeds = arguments.next().unwrap_or(10_000);
    let replicates = arguments.next().map(|n| n as u32);
    println!(
        "{:<8}{:<20}{:<7}{:>9}{:>9}{:>12}{:>14}{:>16}{:>14}",
        "scene",
        "variant",
        "of",
        "asked %",
        "runs",
        "photons",
        "coverage %",
        "error / asked",
        " <= 1.1 asked %"
    );
    for case in &CASES {
        let scene = case.scene();
        let goal = ErrorGoal::new(case.relative, case.of).unwrap();
        // Maps take many times the photons.
        let seeds = if case.of == ErrorOf::Cells { seeds / 10 } else { seeds };
        let runs: Vec<Run> =
            (1..=seeds).into_par_iter().map(|seed| run(&scene, case, goal, seed, replicates)).collect();
        let r = f64::from(replicates.unwrap_or(caustix::run::goal::REPLICATES));
        let t = StudentsT::new(0.0, 1.0, r - 1.0).unwrap().inverse_cdf(0.975);
        let part = |is: &dyn Fn(&Run) -> bool| {
            100.0 * runs.iter().filter(|run| is(run)).count() as f64 / runs.len() as f64
        };
        let photons = runs.iter().map(|run| run.photons).sum::<f64>() / runs.len() as f64;
        let (rms, good) = match case.of {
            ErrorOf::Cells => {
                let mut errors: Vec<f64> = runs.iter().map(|run| run.cells / case.relative).collect();
                errors.sort_by(f64::total_cmp);
                (errors[errors.len() / 2], part(&|run| run.cells <= 1.1 * case.relative))
            }
            _ => {
                let square =
                    runs.iter().map(|run| run.relative * run.relative).sum::<f64>() / runs.len() as f64;
                (square.sqrt() / case.relative, f64::NAN)
            }
        };
        println!(
            "{:<8}{:<20}{:<7}{:>9}{:>9}{photons:>12.0}{:>14.2}{rms:>16.3}{good:>14.1}",
            case.name,
            case.variant,
            case.of.name(),
            100.0 * case.relative,
            seeds,
            part(&|run| run.in_errors.abs() <= t)
        );
    }
    println!(
        "of cells: the median over runs of the root mean square over cells, and how many are at most 1.1 times what was asked"
    );
}

fn run(scene: &Scene, case: &Case, error: ErrorGoal, seed: u64, replicates: Option<u32>) -> Run {
    let algorithm = Algorithm::parse(case.variant).unwrap();
    let settings = error.settings(Settings { seed, algorithm, replicates, ..Settings::default() });
    let goal = Goal { error: Some(error), until: None };
    let never = AtomicBool::new(false);
    let outcome = trace_until(scene, &Plan::new(&settings).unwrap(), goal, &never, &|_| {}).unwrap();
    assert!(outcome.reached.unwrap().is_met());
    let flux = outcome.receiver_flux_lm(0);
    Run {
        photons: outcome.photons as f64,
        in_errors: (flux.value - case.flux_lm) / flux.standard_error.unwrap(),
        relative: (flux.value - case.flux_lm) / case.flux_lm,
        cells: if case.of == ErrorOf::Cells { of_cells(scene, case, &outcome) } else { f64::NAN },
    }
}

/// Root mean square error of cells of equal area, relative to their mean.
fn of_cells(scene: &Scene, case: &Case, outcome: &Outcome) -> f64 {
    let cells = &outcome.cells()[0].sum;
    let mean = case.flux_lm / cells.len() as f64;
    let is_plate = case.scene == PLATE;
    let square = |(cell, photons): (usize, &u64)| {
        let expected = if is_plate { 100.0 * plate_share(cell) } else { mean };
        (*photons as f64 * outcome.photon_lm - expected).powi(2)
    };
    let number = scene.receivers[0].cells.len() as f64;
    (cells.iter().enumerate().map(square).sum::<f64>() / number).sqrt() / mean
}

/// Share of the lamp's light in a cell of the plate: its solid angle over 4 pi.
fn plate_share(cell: usize) -> f64 {
    // The solid angle of a rectangle with a corner below the lamp, 1 m away: atan(x y / sqrt(1 + x^2 + y^2)).
    let corner = |x: f64, y: f64| (x * y / (1.0 + x * x + y * y).sqrt()).atan();
    let [x, y] = [cell % 32, cell / 32].map(|k| k as f64 / 16.0 - 1.0);
    let [x1, y1] = [x + 1.0 / 16.0, y + 1.0 / 16.0];
    (corner(x1, y1) - corner(x, y1) - corner(x1, y) + corner(x, y)) / (4.0 * std::f64::consts::PI)
}
