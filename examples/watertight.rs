//! Rays walked straight through scenes of many bodies, none of which may leak or be met twice: `cargo run --release
//! --features measurements --example watertight`, 2 x 10^7 rays, about a minute on two cores. A first number after it is
//! another number of rays, a second one another seed, and a third word, `anywhere` or `edges`, that half of the rays alone. Of a scene of many bodies there are fewer rays, so that there are about
//! as many crossings of each. The figures are in docs/TRUST.md.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::expect_used, clippy::panic, dead_code)]

#[path = "../tests/geometry/bodies.rs"]
mod bodies;
#[path = "../tests/geometry/meshes.rs"]
mod meshes;

use std::time::Instant;

use bodies::Aim;

const RAYS: u64 = 20_000_000;
const SEED: u64 = 1000;

fn main() {
    let number = |i, otherwise| std::env::args().nth(i).map_or(otherwise, |n| n.parse().expect("a number"));
    let (rays, seed) = (number(1, RAYS), number(2, SEED));
    let cases = bodies::cases();
    let weight = |case: &bodies::Case| 0.5 / case.bodies() as f64;
    let all: f64 = cases.iter().map(|case| 2.0 * weight(case)).sum();
    println!("| bodies | rays to | rays | crossings | leaks | met twice | endless | s |");
    println!("|---|---|---|---|---|---|---|---|");
    let (mut sum, mut faults, mut lost) = (0, 0, 0);
    let asked = std::env::args().nth(3);
    let aims: Vec<Aim> = [(Aim::Anywhere, "anywhere"), (Aim::Edges, "edges")]
        .into_iter()
        .filter(|(_, word)| asked.as_deref().is_none_or(|asked| asked == *word))
        .map(|(aim, _)| aim)
        .collect();
    assert!(!aims.is_empty(), "the third argument is anywhere or edges");
    for (case, aim) in cases.iter().flat_map(|case| aims.iter().map(move |aim| (case, *aim))) {
        let started = Instant::now();
        let t = case.run((rays as f64 * weight(case) / all) as u64, seed, aim);
        let (name, s) = (&case.name, started.elapsed().as_secs_f64());
        println!(
            "| {name} | {aim:?} | {} | {} | {} | {} | {} | {s:.0} |",
            t.rays, t.crossings, t.leaks, t.doubles, t.endless
        );
        sum += t.rays;
        let is_at_meeting_edges = case.meets && aim == Aim::Edges;
        lost += if is_at_meeting_edges { t.leaks } else { 0 };
        faults += if is_at_meeting_edges { t.doubles + t.endless } else { t.faults() };
    }
    println!("{sum} rays, {faults} faults; {lost} rays aimed at edges where bodies meet were lost there");
}
