//! The reference of `compare` against quadrature and a closed form, and the errors that are measured against
//! it.
//!
//! Weights: two lamps over a black plate, whose cells are integrals of I cos / d^2 over the file's own table.
//! Colour: two lamps in a coloured sphere, whose wall receives the same indirect light everywhere. Errors:
//! independent points leave a binomial number of photons in each cell, so that their nRMS is known without
//! any reference.

use std::f64::consts::PI;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

use caustix::lab::study::cells::Grids;
use caustix::lab::study::reference::{REPLICATES, Reference, ReferencePlan, trace_replicate};
use caustix::run::{Algorithm, Plan, Settings, trace};
use caustix::surface::luminance;
use glam::DVec3;

use crate::support::data::in_project;
use crate::support::judge::{SIGNIFICANCE, judge, student_p};
use crate::support::lamp::Lamp;
use crate::support::quadrature::cell_means;
use crate::support::scenes::scene;
use crate::support::stranger::Stranger;

const AIM: DVec3 = DVec3::new(0.25, 0.15, -1.0);
const UP: DVec3 = DVec3::new(0.3, 1.0, 0.2);
const POSITION: DVec3 = DVec3::new(0.11, -0.07, 1.5);
/// Of the lamp without a table.
const BARE_LM: f64 = 700.0;
const BARE: DVec3 = DVec3::new(-0.8, 0.6, 0.9);

fn floodlight(position: DVec3) -> Lamp {
    Lamp::new("floodlight_b.ies", position, AIM, UP)
}

/// Illuminance that an isotropic point gives, lx.
fn bare_lx(flux_lm: f64, position: DVec3, point: DVec3, normal: DVec3) -> f64 {
    let to = point - position;
    -flux_lm / (4.0 * PI) * to.dot(normal) / to.length().powi(3)
}

fn lamps(position: DVec3, colour: &str, bare: DVec3, bare_lm: f64, bare_colour: &str) -> String {
    let file = in_project("ies/floodlight_b.ies");
    let [position, aim, up, bare] = [position, AIM, UP, bare].map(|v| v.to_array());
    format!(
        "[[emitter]]\ntype = \"photometric\"\nfile = \"{file}\"\nposition = {position:?}\naim = {aim:?}\nup = {up:?}\n\
         {colour}\n[[emitter]]\ntype = \"isotropic\"\nposition = {bare:?}\nflux_lm = {bare_lm}\n{bare_colour}\n"
    )
}

/// Both lamps over a black plate of 3 m x 3 m.
fn plate() -> String {
    lamps(POSITION, "", BARE, BARE_LM, "")
        + r#"
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-1.5, -1.5, 0.0]
edge_u = [3.0, 0.0, 0.0]
edge_v = [0.0, 3.0, 0.0]
[[receiver]]
surface = "plate"
cells = [1, 1]
"#
}

/// Mean illuminances of k x k cells of the plate, lx, by quadrature over the file's table.
fn plate_lx(k: usize) -> Vec<f64> {
    let lamp = floodlight(POSITION);
    cell_means(k, k, 120 / k, |u, v| {
        let point = DVec3::new(3.0 * u - 1.5, 3.0 * v - 1.5, 0.0);
        lamp.illuminance_lx(point, DVec3::Z) + bare_lx(BARE_LM, BARE, point, DVec3::Z)
    })
}

/// A clock that every system has.
fn clock() -> caustix::Result<Duration> {
    Ok(Duration::ZERO)
}

/// A reference as `compare` traces it, with the sums of its replicates.
fn traced<'g>(grids: &'g Grids<'g>, photons: u64) -> (Reference<'g>, Vec<Vec<u64>>) {
    let plan = ReferencePlan::new(photons, &[1]).unwrap();
    let replicate = |r| trace_replicate(grids, &plan, r, &AtomicBool::new(false), &|_| {}).unwrap();
    let replicates: Vec<Vec<u64>> = (0..REPLICATES).map(|r| replicate(r).unwrap()).collect();
    (Reference::new(grids, &plan, &replicates).unwrap(), replicates)
}

/// Relative standard error of the mean of a cell over the replicates, from their sums alone.
fn relative_error(replicates: &[Vec<u64>], cell: usize) -> f64 {
    let sums: Vec<f64> = replicates.iter().map(|r| r[cell] as f64).collect();
    let n = sums.len() as f64;
    let mean = sums.iter().sum::<f64>() / n;
    (sums.iter().map(|s| (s - mean).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt() / mean
}

/// Judges cells of a reference, from `first` on, in units of its own standard errors; the t of their sum,
/// too.
fn assert_exact(
    label: &str,
    (reference, replicates): &(Reference<'_>, Vec<Vec<u64>>),
    first: usize,
    exact: &[f64],
) {
    let found = &reference.illuminance_lx()[first..first + exact.len()];
    let t = |(cell, (found, exact)): (usize, (&f64, &f64))| {
        (found - exact) / (found * relative_error(replicates, first + cell))
    };
    let ts: Vec<f64> = found.iter().zip(exact).enumerate().map(t).collect();
    let verdict = judge(&ts, REPLICATES - 1);
    let of_all: Vec<Vec<u64>> =
        replicates.iter().map(|r| vec![r[first..first + exact.len()].iter().sum()]).collect();
    let ratio = found.iter().sum::<f64>() / exact.iter().sum::<f64>();
    let t = (ratio - 1.0) / relative_error(&of_all, 0);
    println!("{label}: {verdict:?}; in all {ratio:.6} of what is exact, t = {t:.2}");
    assert!(verdict.p_chi2 > SIGNIFICANCE && verdict.p_extreme > SIGNIFICANCE, "{label}: {verdict:?}");
    assert!(student_p(t, REPLICATES - 1) > SIGNIFICANCE, "{label}: t = {t}");
}

/// nRMS of cells of equal area.
fn nrms(found: &[f64], exact: &[f64]) -> f64 {
    let n = found.len() as f64;
    let squares: f64 = found.iter().zip(exact).map(|(a, b)| (a - b).powi(2)).sum();
    (squares / n).sqrt() / (exact.iter().sum::<f64>() / n)
}

#[test]
fn weights_give_every_cell_the_light_of_the_file() {
    let scene = scene(&plate());
    let grids = Grids::new(&scene, &[24, 8]).unwrap();
    let traced = traced(&grids, 1 << 19);
    for (grid, (first, k)) in [(0, 24), (576, 8)].into_iter().enumerate() {
        let exact = plate_lx(k);
        assert_exact(&format!("{k} x {k}"), &traced, first, &exact);
        let (reference, replicates) = &traced;
        let found = &reference.illuminance_lx()[first..first + k * k];
        // The error that the reference says it has is the root mean square of its cells' standard errors ...
        let errors =
            found.iter().enumerate().map(|(c, e)| (e * relative_error(replicates, first + c)).powi(2));
        let own =
            (errors.sum::<f64>() / (k * k) as f64).sqrt() / (found.iter().sum::<f64>() / (k * k) as f64);
        assert!((reference.own_nrms()[grid] / own - 1.0).abs() < 1e-6, "{own}");
        // ... and it has it: of 64 cells' squares, 7 degrees each, the root of the ratio spreads by about 10
        // %.
        let ratio = nrms(found, &exact) / own;
        println!("{k} x {k}: own nRMS {own:.5}, against quadrature {ratio:.3} of it");
        assert!((0.6..1.6).contains(&ratio), "{ratio}");
    }
}

#[test]
fn colour_and_weights_in_a_coloured_sphere() {
    let rho = [0.9, 0.3, 0.1];
    let (red, blue) = ([1.0, 0.1, 0.05], [0.05, 0.2, 1.0]);
    let (position, bare, bare_lm) = (DVec3::new(0.1, 0.2, 0.3), DVec3::new(-0.4, 0.3, -0.5), 900.0);
    let text = lamps(position, &format!("colour = {red:?}"), bare, bare_lm, &format!("colour = {blue:?}"))
        + &format!(
            r#"
[material.wall]
type = "lambertian"
reflectance = {rho:?}
[[surface]]
name = "wall"
type = "sphere"
material = "wall"
center = [0.0, 0.0, 0.0]
radius = 1.4
[[receiver]]
name = "direct"
surface = "wall"
side = "back"
events = "direct"
cells = [1, 1]
[[receiver]]
name = "indirect"
surface = "wall"
side = "back"
events = "indirect"
cells = [1, 1]
"#
        );
    let scene = scene(&text);
    let grids = Grids::new(&scene, &[8]).unwrap();
    let traced = traced(&grids, 1 << 19);
    let lamp = floodlight(position);
    let direct = cell_means(8, 8, 20, |u, v| {
        let z = 2.0 * v - 1.0;
        let (sin, cos) = (2.0 * PI * u).sin_cos();
        let inward = -DVec3::new((1.0 - z * z).sqrt() * cos, (1.0 - z * z).sqrt() * sin, z);
        let point = -1.4 * inward;
        lamp.illuminance_lx(point, inward) + bare_lx(bare_lm, bare, point, inward)
    });
    // After m reflections Y(c rho^m) / Y(c) of the flux of a lamp of colour c is left, on all of the wall
    // alike.
    let left = |c: [f64; 3]| luminance([0, 1, 2].map(|i| c[i] * rho[i] / (1.0 - rho[i]))) / luminance(c);
    let file_lm = scene.emitters.flux_lm() - bare_lm;
    let indirect = (file_lm * left(red) + bare_lm * left(blue)) / (4.0 * PI * 1.4 * 1.4);
    assert_exact("direct", &traced, 0, &direct);
    assert_exact("indirect", &traced, 64, &[indirect; 64]);
}

#[test]
fn a_run_s_errors_are_the_norms_of_its_own_counts() {
    let bare = scene(&plate());
    let finer = scene(&plate().replace("cells = [1, 1]", "cells = [12, 12]"));
    let grids = Grids::new(&bare, &[12]).unwrap();
    let (reference, _) = traced(&grids, 1 << 13);
    let (ladder, quiet) = ([1 << 9, 1 << 11], AtomicBool::new(false));
    for name in ["mc", "qmc-inverse-reuse", "qmc-inverse:hammersley-rotation"] {
        let algorithm = Algorithm::parse(name).unwrap();
        let runs = reference.measure(algorithm, 3, &ladder, clock, &quiet, &|_| {}).unwrap().unwrap();
        for (run, photons) in runs.iter().zip(ladder) {
            // The same photons as `render` counts them.
            let settings = Settings { photons: Some(photons), replicates: Some(1), seed: 3, algorithm };
            let outcome = trace(&finer, &Plan::new(&settings).unwrap(), &quiet, &|_| {}).unwrap();
            let cell_m2 = 9.0 / 144.0;
            let lx: Vec<f64> =
                outcome.cells()[0].sum.iter().map(|n| *n as f64 * outcome.photon_lm / cell_m2).collect();
            let exact = reference.illuminance_lx();
            let sum =
                |of: &dyn Fn(f64, f64) -> f64| lx.iter().zip(exact).map(|(a, b)| of(*a, *b)).sum::<f64>();
            let squares = sum(&|a, b| (a - b).powi(2));
            let expected = [
                nrms(&lx, exact),
                (squares / sum(&|_, b| b * b)).sqrt(),
                sum(&|a, b| (a - b).abs()) / sum(&|_, b| b),
            ];
            let found = run.errors[0];
            for (found, expected) in
                [found.nrms, found.relative_rms, found.relative_l1].into_iter().zip(expected)
            {
                assert!((found / expected - 1.0).abs() < 1e-12, "{name}, {photons}: {found} {expected}");
            }
            assert_eq!((run.seed, run.photons), (3, photons));
        }
    }
}

/// The whole command: nRMS of independent points is the binomial's, sqrt(mean of p (1 - p) / N (Phi / A)^2)
/// over the mean.
#[test]
fn the_nrms_of_independent_points_is_the_binomial_s() {
    let (k, photons, seeds) = (16, 4096.0, 16.0);
    let stranger = Stranger::with(&[("plate.toml", &plate())]);
    let line = "compare plate.toml -o out --variants mc --photons 4096 --from 4096 --cells 16 --seeds 16 --quiet \
                --reference-photons 2^19";
    let (code, _, told) = stranger.types(line);
    assert_eq!(code, 0, "{told}");
    let csv = std::fs::read_to_string(stranger.path("out/compare.csv")).unwrap();
    let mut lines = csv.lines().map(|line| line.split(',').collect::<Vec<_>>());
    let column = lines.next().unwrap().iter().position(|name| *name == "nrms").unwrap();
    let found: f64 = lines.next().unwrap()[column].parse().unwrap();

    let exact = plate_lx(k);
    let (flux_lm, cell_m2) = (scene(&plate()).emitters.flux_lm(), 9.0 / (k * k) as f64);
    let variance = |lx: &f64| {
        let p = lx * cell_m2 / flux_lm;
        p * (1.0 - p) / photons * (flux_lm / cell_m2).powi(2)
    };
    let variances: Vec<f64> = exact.iter().map(variance).collect();
    let n = exact.len() as f64;
    let sum: f64 = variances.iter().sum();
    let expected = (sum / n).sqrt() / (exact.iter().sum::<f64>() / n);
    // Relative standard deviation of the mean square over the seeds; of a count of mean m the square of the
    // deviation has the variance 2 m^2 + m. The reference's own square, 1/100 of the run's, is left out.
    let spread = |(v, lx): (&f64, &f64)| v * v * (2.0 + flux_lm / (photons * lx * cell_m2));
    let deviation = (variances.iter().zip(&exact).map(spread).sum::<f64>() / seeds).sqrt() / sum;
    let z = ((found / expected).powi(2) - 1.0) / deviation;
    println!("nRMS {found:.5}, by the binomial {expected:.5}; squares off by {z:.2} standard deviations");
    assert!(z.abs() < 4.0, "{found} for {expected}: {z}");
}
