//! How often the intervals of U0, Ud, minimum and maximum contain the exact values, over 1000 seeds of six scenes whose light has
//! a closed form: `cargo run --release --features measurements --example uniformity`, about five minutes of processor time. A number
//! after it is another number of seeds. The figures are in docs/TRUST.md.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::expect_used, clippy::panic, dead_code)]

#[path = "../tests/support/data.rs"]
mod data;
#[path = "../tests/support/scenes.rs"]
mod scenes;

use caustix::report::statistics::ReceiverStatistics;
use caustix::scene::Scene;
use caustix::sequence::Sequence;
use rayon::prelude::*;

const SEEDS: u64 = 1000;

/// A beam of 1.2 m x 1.2 m straight down onto a plate of 1 m x 1 m, and a black stop of these sides over the middle of a cell.
fn beam(cells: u32, stop: Option<[f64; 2]>) -> Known {
    let side = 1.0 / f64::from(cells);
    let shade = stop.map_or(String::new(), |[a, b]| {
        let [x, y] = [1.5 * side - 0.5 * a, 2.5 * side - 0.5 * b];
        format!(
            "[[surface]]\nname = \"stop\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
             corner = [{x}, {y}, 1.0]\nedge_u = [{a}, 0.0, 0.0]\nedge_v = [0.0, {b}, 0.0]\n"
        )
    });
    let text = format!(
        "[[emitter]]\ntype = \"collimated\"\nposition = [0.5, 0.5, 2.0]\nsize = [1.2, 1.2]\nflux_lm = 1440\n\
         [material.black]\ntype = \"absorber\"\n[[surface]]\nname = \"plate\"\ntype = \"rectangle\"\nmaterial = \"black\"\n\
         corner = [0.0, 0.0, 0.0]\nedge_u = [1.0, 0.0, 0.0]\nedge_v = [0.0, 1.0, 0.0]\n{shade}\
         [[receiver]]\nsurface = \"plate\"\ncells = [{cells}, {cells}]\n"
    );
    let shaded = stop.map_or(0.0, |[a, b]| a * b);
    let least = 1000.0 * (1.0 - shaded / (side * side));
    Known { scene: scenes::scene(&text), least, mean: 1000.0 * (1.0 - shaded), most: 1000.0 }
}

/// A lamp in the middle of a black ball of 1 m: Phi / (4 pi) everywhere.
fn ball() -> Known {
    let text = "[[emitter]]\ntype = \"isotropic\"\nposition = [0, 0, 0]\nflux_lm = 1000\n[material.black]\ntype = \"absorber\"\n\
                [[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"black\"\ncenter = [0, 0, 0]\nradius = 1\n\
                [[receiver]]\nsurface = \"ball\"\ncells = [8, 4]\nside = \"back\"\n";
    let lx = 250.0 / std::f64::consts::PI;
    Known { scene: scenes::scene(text), least: lx, mean: lx, most: lx }
}

struct Known {
    scene: Scene,
    least: f64,
    mean: f64,
    most: f64,
}

/// Of one seed: which of U0, Ud, minimum and maximum are covered, and how wide U0 is; nothing where it is not given.
fn tried(known: &Known, per_replicate: u64, seed: u64) -> Option<([bool; 4], f64)> {
    let outcome = scenes::run(&known.scene, Sequence::SobolOwen, per_replicate, 8, seed);
    let found = ReceiverStatistics::new(&outcome, &known.scene.receivers[0], 0).uniformity;
    let u0 = found.u0?;
    let truth = [known.least / known.mean, known.least / known.most, known.least, known.most];
    let intervals = [Some(u0), found.ud, found.minimum, found.maximum];
    let covers: Vec<bool> =
        intervals.iter().zip(truth).map(|(i, x)| i.is_some_and(|i| i.low <= x && x <= i.high)).collect();
    Some((covers.try_into().unwrap(), u0.high - u0.low))
}

fn main() {
    let seeds = std::env::args().nth(1).map_or(SEEDS, |n| n.parse().expect("a number of seeds"));
    let scenes = [
        ("beam, flat", beam(5, None), 1 << 15),
        ("lamp in a ball, flat", ball(), 1 << 15),
        ("beam, a cell in half shade", beam(5, Some([0.13, 0.12])), 1 << 15),
        ("beam, a cell in deep shade", beam(5, Some([0.19, 0.19])), 1 << 15),
        ("beam, flat, noisy", beam(48, None), 1 << 13),
        ("beam, a cell in half shade, noisy", beam(20, Some([0.03, 0.03])), 1 << 13),
    ];
    println!("{seeds} seeds, 8 replicates; per cent covered of those given");
    println!("| scene | photons | exact U0 | given | U0 | Ud | minimum | maximum | widest U0 |");
    println!("|---|---|---|---|---|---|---|---|---|");
    for (name, known, per_replicate) in &scenes {
        let given: Vec<_> =
            (1..seeds + 1).into_par_iter().filter_map(|seed| tried(known, *per_replicate, seed)).collect();
        let percent = |k: usize| match given.len() {
            0 => "-".to_string(),
            n => format!("{:.1}", 100.0 * given.iter().filter(|(c, _)| c[k]).count() as f64 / n as f64),
        };
        let columns: Vec<String> = (0..4).map(percent).collect();
        let widest = given.iter().map(|(_, width)| *width).fold(0.0, f64::max);
        println!(
            "| {name} | 8 x {per_replicate} | {:.4} | {} | {} | {widest:.3} |",
            known.least / known.mean,
            given.len(),
            columns.join(" | ")
        );
    }
}
