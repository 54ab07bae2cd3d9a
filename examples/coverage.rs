//! How often a 95 % interval contains the exact value, over 10,000 seeds: `cargo run --release --features
//! measurements --example coverage`, a quarter of an hour on two cores. A number after it is another number of seeds.
//! The figures are in docs/TRUST.md.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::expect_used, clippy::panic, dead_code)]

#[path = "../tests/support/coverage.rs"]
mod coverage;
#[path = "../tests/support/data.rs"]
mod data;
#[path = "../tests/support/quadrature.rs"]
mod quadrature;
#[path = "../tests/support/scenes.rs"]
mod scenes;

use caustix::sequence::Sequence;
use coverage::{Cover, Known, ball, measure, plate};

const SEEDS: u64 = 10_000;

fn main() {
    let seeds = std::env::args().nth(1).map_or(SEEDS, |n| n.parse().expect("a number of seeds"));
    println!("{seeds} seeds, 8 replicates; per cent covered, +- one standard error");
    println!("| scene | photons | totals | cells of 30 hits and more | 10 to 30 | 1 to 10 | less than 1 |");
    println!("|---|---|---|---|---|---|---|");
    let balls = [0.3, 0.5, 0.8, 0.95].map(|r| (format!("ball of reflectance {r}"), ball(r)));
    for (name, known) in &balls {
        row(name, known, 512, seeds);
    }
    for per_replicate in [512, 4096] {
        row("black plate", &plate(), per_replicate, seeds);
    }
    row(&balls[1].0, &balls[1].1, 4096, seeds);
}

fn row(name: &str, known: &Known, per_replicate: u64, seeds: u64) {
    let covers = measure(known, Sequence::SobolOwen, (per_replicate, 8), 1..seeds + 1);
    let percent = |cover: &Cover| match cover.is_tried() {
        true => format!("{:.2} +- {:.2}", 100.0 * cover.share(), 100.0 * cover.error()),
        false => "-".to_string(),
    };
    let columns: Vec<String> = [&covers.totals].into_iter().chain(&covers.cells).map(percent).collect();
    println!("| {name} | 8 x {per_replicate} | {} |", columns.join(" | "));
}
