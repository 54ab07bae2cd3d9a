//! Rays walked straight through scenes of many bodies, none of which may leak or be met twice: `cargo run --release
//! --features measurements --example watertight`, 2 x 10^7 rays, some minutes on two cores. A number after it is another
//! number of rays. The figures are in docs/TRUST.md.
#![allow(clippy::print_stdout, clippy::unwrap_used, clippy::expect_used, clippy::panic, dead_code)]

#[path = "../tests/geometry/bodies.rs"]
mod bodies;
#[path = "../tests/geometry/meshes.rs"]
mod meshes;

use std::time::Instant;

use bodies::Aim;

const RAYS: u64 = 20_000_000;

fn main() {
    let rays = std::env::args().nth(1).map_or(RAYS, |n| n.parse().expect("a number of rays"));
    let cases = bodies::cases();
    let each = rays.div_ceil(2 * cases.len() as u64);
    println!("| bodies | rays to | rays | crossings | leaks | met twice | endless | s |");
    println!("|---|---|---|---|---|---|---|---|");
    let (mut faults, mut lost) = (0, 0);
    for (case, aim) in cases.iter().flat_map(|case| [(case, Aim::Anywhere), (case, Aim::Edges)]) {
        let started = Instant::now();
        let t = case.run(each, 1000, aim);
        let (name, s) = (&case.name, started.elapsed().as_secs_f64());
        println!(
            "| {name} | {aim:?} | {} | {} | {} | {} | {} | {s:.0} |",
            t.rays, t.crossings, t.leaks, t.doubles, t.endless
        );
        let is_at_meeting_edges = case.meets && aim == Aim::Edges;
        lost += if is_at_meeting_edges { t.leaks } else { 0 };
        faults += if is_at_meeting_edges { t.doubles + t.endless } else { t.faults() };
    }
    let all = 2 * each * cases.len() as u64;
    println!("{all} rays, {faults} faults; {lost} rays aimed at edges where bodies meet were lost there");
}
