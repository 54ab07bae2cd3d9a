//! A sweep's values and errors: against closed forms, over seeds, and beside independent runs.

use std::f64::consts::PI;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use caustix::files::scene_toml::edit::with_value;
use caustix::lab::sweep::difference::Difference;
use caustix::lab::sweep::figures::{Figure, PointFigures};
use caustix::lab::sweep::grid::Grid;
use caustix::lab::sweep::results::Sweep;
use caustix::{Algorithm, Plan, Settings, Variant, parse_scene, trace};

/// A lamp of 100 lm above the middle of a black plate of 2 m.
const LAMP: &str = "[[emitter]]\nname = \"lamp\"\ntype = \"isotropic\"\nposition = [0.0, 0.0, 1.0]\nflux_lm = 100\n\
                    [material.black]\ntype = \"absorber\"\n[[surface]]\nname = \"plate\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
                    corner = [-1.0, -1.0, 0.0]\nedge_u = [2.0, 0.0, 0.0]\nedge_v = [0.0, 2.0, 0.0]\n\
                    [[receiver]]\nsurface = \"plate\"\ncells = [4, 4]\n";

/// Flux on the plate of a lamp at this height: its solid angle is 4 atan(a b / (z sqrt(a^2 + b^2 + z^2))) with a = b = 1.
fn flux_lm(z: f64) -> f64 {
    100.0 * 4.0 * (1.0 / (z * (2.0 + z * z).sqrt())).atan() / (4.0 * PI)
}

fn plan(photons: u64, replicates: u32, seed: u64, variant: Variant) -> Plan {
    let algorithm = Algorithm { solver: Algorithm::default().solver, ..Algorithm::from(variant) };
    Plan::new(&Settings { photons: Some(photons), replicates: Some(replicates), seed, algorithm }).unwrap()
}

/// What a text with other values gives.
fn point(text: &str, folder: &Path, values: &[(&str, &str)], plan: &Plan) -> PointFigures {
    let set = |text: String, (key, value): &(&str, &str)| with_value(&text, key, value).unwrap();
    let scene = parse_scene(&values.iter().fold(text.to_owned(), set), folder).unwrap();
    PointFigures::new(&scene, &trace(&scene, plan, &AtomicBool::new(false), &|_| {}).unwrap())
}

#[test]
fn values_and_differences_are_those_of_the_solid_angle() {
    let grid =
        Grid::parse(&["emitter.lamp.position[2]=0.5:2:0.5".into(), "emitter.lamp.flux_lm=100,200".into()])
            .unwrap();
    let plan = plan(1 << 17, 32, 7, Variant::QmcInverse);
    let of = |at| {
        let values: Vec<(&str, &str)> =
            grid.values(at).map(|(key, value)| (key, value.toml.as_str())).collect();
        Some(point(LAMP, Path::new(""), &values, &plan))
    };
    let points = (0..grid.points()).map(of).collect();
    let words = String::new;
    let shown: Vec<String> =
        ["plate.flux_lm", "plate.mean_lx", "escaped_lm", "absorbed.plate_lm"].map(str::to_owned).to_vec();
    let sweep = Sweep {
        scene_name: words(),
        scene_sha256: words(),
        command: words(),
        tracing: words(),
        notes: vec![],
        grid,
        shown,
        points,
    };
    let exact = |at: usize, shown: usize| {
        let number = |axis| sweep.grid.value(at, axis).number.unwrap();
        let (on_plate, all) = (number(1) / 100.0 * flux_lm(number(0)), number(1));
        [on_plate, on_plate / 4.0, all - on_plate, on_plate][shown]
    };
    let mut differences = 0;
    for at in 0..8 {
        for shown in 0..4 {
            let (figure, truth) = (sweep.figure(at, shown).unwrap(), exact(at, shown));
            let off = (figure.value.unwrap() - truth).abs();
            assert!(
                off < 5.0 * figure.standard_error.unwrap() && off < 1e-3 * truth,
                "{at} {figure:?} {truth}"
            );
            for axis in 0..2 {
                let Some(before) = sweep.grid.before(at, axis) else { continue };
                let difference = sweep.difference(at, shown, axis).unwrap();
                let truth = truth - exact(before, shown);
                let error = difference.standard_error.unwrap();
                assert!((difference.value - truth).abs() < 5.0 * error, "{at} {axis} {difference:?} {truth}");
                assert!(error < 1e-2 * truth.abs(), "{difference:?}");
                differences += 1;
            }
        }
    }
    assert_eq!(differences, 4 * (6 + 4));
}

/// The scatter of the difference about the truth over seeds is what the paired errors say, and not what independent ones would.
#[test]
fn the_paired_error_is_the_scatter_over_seeds() {
    const SEEDS: u64 = 240;
    let truth = flux_lm(1.05) - flux_lm(1.0);
    for (variant, independent_is_larger) in [(Variant::Mc, 4.0), (Variant::QmcInverse, 1.0)] {
        let (mut scatter, mut paired, mut independent) = (0.0, 0.0, 0.0);
        for seed in 0..SEEDS {
            let plan = plan(1 << 13, 8, seed, variant);
            let flux = |z: &str| {
                let point = point(LAMP, Path::new(""), &[("emitter.lamp.position[2]", z)], &plan);
                point.figure("plate.flux_lm").unwrap().clone()
            };
            let d = Difference::new(&flux("1.05"), &flux("1.0")).unwrap();
            scatter += (d.value - truth).powi(2) / SEEDS as f64;
            paired += d.standard_error.unwrap().powi(2) / SEEDS as f64;
            independent += d.independent.unwrap().powi(2) / SEEDS as f64;
        }
        // Both are means of squares of (nearly) normal numbers: of 240 and of 240 x 7 degrees of freedom, so their quotient has a
        // standard deviation of sqrt(2/240 + 2/1680) = 0.098. Four of them.
        let quotient = scatter / paired;
        println!(
            "{}: scatter / paired {quotient:.3}, independent / paired {:.2}",
            variant.name(),
            (independent / paired).sqrt()
        );
        assert!((quotient - 1.0).abs() < 0.39, "{}: {quotient}", variant.name());
        assert!(independent > independent_is_larger * scatter, "{}: {independent} {scatter}", variant.name());
    }
}

/// The error of a difference between neighbours is at least five times smaller than that of independent runs: neighbours are a
/// hundredth of a ball's radius, or 0.001 of an index, apart for independent points; a tenth of that for Sobol' points, whose own
/// errors are ten times smaller to begin with.
#[test]
fn differences_of_neighbours_have_a_fifth_of_the_error_or_less() {
    let scenes = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let cases = [
        ("glass_sphere", "surface.ball.center[0]", ["0.0", "0.0005", "0.00005"], "table.flux_lm"),
        ("ball_lens", "material.glass.ior", ["1.5", "1.501", "1.5001"], "plate.flux_lm"),
        ("flat_slab", "material.glass.ior", ["1.5", "1.501", "1.5001"], "plate.flux_lm"),
    ];
    for (name, key, [here, step, tenth], figure) in cases {
        let text = std::fs::read_to_string(scenes.join(format!("{name}.toml"))).unwrap();
        for (variant, there) in [(Variant::Mc, step), (Variant::QmcInverse, tenth)] {
            let plan = plan(1 << 16, 32, 1, variant);
            let of = |value: &str| -> Figure {
                point(&text, &scenes, &[(key, value)], &plan).figure(figure).unwrap().clone()
            };
            let ratio = Difference::new(&of(there), &of(here)).unwrap().ratio().unwrap();
            println!("{name}, {key} {here} and {there}, {}: {ratio:.1}", variant.name());
            assert!(ratio > 5.0, "{name} {}: {ratio}", variant.name());
        }
    }
}
