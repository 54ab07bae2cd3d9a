//! How often a healthy run is doubted, and which rates it has, over 4000 seeds of scenes whose light has a closed form: `cargo run
//! --release --features measurements --example healthy`, some minutes of processor time. A number after it is another number of
//! seeds. The figures are in docs/METHOD.md, section 10.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::expect_used, clippy::panic, dead_code)]

#[path = "../tests/support/data.rs"]
mod data;
#[path = "../tests/support/healthy.rs"]
mod healthy;
#[path = "../tests/support/scenes.rs"]
mod scenes;

use caustix::sequence::Sequence;
use healthy::{ball, doubted, mean, of_seeds, plate, plates, rates};

const SEEDS: u64 = 4000;

fn main() {
    let seeds = std::env::args().nth(1).map_or(SEEDS, |n| n.parse().expect("a number of seeds"));
    let sequences = [Sequence::Independent, Sequence::SobolOwen];
    let cases = [
        ("a plate, 4 replicates", plate(1.7), 1 << 10, 4),
        ("a plate, 8 replicates", plate(1.7), 1 << 10, 8),
        ("a plate of few photons, 8 replicates", plate(0.5), 1 << 10, 8),
        ("a plate, 32 replicates", plate(1.7), 1 << 8, 32),
        ("four plates, 8 replicates", plates(), 1 << 9, 8),
        ("a grey ball, 8 replicates", ball(), 1 << 8, 8),
    ];
    println!("{seeds} seeds each");
    println!("| scene | sequence | doubted, % | unknown, % | rate | its spread | error it gives |");
    println!("|---|---|---|---|---|---|---|");
    for (name, scene, n, replicates) in &cases {
        for sequence in sequences {
            let runs = of_seeds(scene, sequence, (*n, *replicates), 1..seeds + 1);
            let percent = |count: usize, of: usize| format!("{:.2}", 100.0 * count as f64 / of as f64);
            let unknown = runs.iter().flatten().filter(|of| of.verdict == "unknown").count();
            let [rates, errors] = rates(&runs);
            let [rate, error] = mean(&rates);
            println!(
                "| {name} of {n} | {} | {} | {} | {rate:.3} | {:.3} | {:.3} |",
                sequence.name(),
                percent(doubted(&runs), runs.len()),
                percent(unknown, runs.iter().flatten().count()),
                error * (rates.len() as f64).sqrt(),
                mean(&errors)[0],
            );
        }
    }
}
