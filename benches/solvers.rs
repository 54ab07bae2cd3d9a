//! The solvers of the cell equation, side by side: evaluations, ns a solve, worst residual, failures.
//!
//! Two kinds of work: cells of the built-in luminaire as photons choose them (by flux, u uniform), and the families of
//! METHOD 3 and 8. Residuals are by quadrature. Timings of all methods are interleaved, the median of the passes
//! stands. `cargo bench --bench solvers` prints the tables as Markdown.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, missing_docs)]

use std::hint::black_box;
use std::path::Path;
use std::time::Instant;

use caustix::files::photometric;
use caustix::sequence::hash::mix64;
use caustix::sequence::to_unit_f64;

#[path = "../tests/support/cells.rs"]
mod cells;

use cells::{Case, Family, Method, Score, families, of_table};

/// Solves of one timed pass.
const BATCH: usize = 1 << 13;
const PASSES: usize = 41;

/// Pairs of a case and a u, the case with probability in proportion to its weight.
fn work(cases: &[(Case, f64)], seed: u64) -> Vec<(Case, f64)> {
    let mut sums = Vec::with_capacity(cases.len());
    let mut total = 0.0;
    for (_, weight) in cases {
        total += weight;
        sums.push(total);
    }
    let uniform = |i: usize| to_unit_f64(mix64(seed << 32 | i as u64));
    (0..BATCH)
        .map(|i| {
            let pick = uniform(2 * i) * total;
            let at = sums.partition_point(|s| *s <= pick).min(cases.len() - 1);
            (cases[at].0, uniform(2 * i + 1))
        })
        .collect()
}

/// ns a solve: the median over passes of all methods in turn.
fn time(methods: &[Method], work: &[(Case, f64)], passes: usize) -> Vec<f64> {
    let mut ns = vec![Vec::with_capacity(passes); methods.len()];
    for _ in 0..passes {
        for (method, ns) in methods.iter().zip(&mut ns) {
            let begin = Instant::now();
            let sum: f64 = work.iter().map(|(case, u)| method.solve(case, *u).0).sum();
            ns.push(begin.elapsed().as_nanos() as f64 / work.len() as f64);
            black_box(sum);
        }
    }
    let median = |mut all: Vec<f64>| {
        all.sort_by(f64::total_cmp);
        all[all.len() / 2]
    };
    ns.into_iter().map(median).collect()
}

fn percent(score: &Score) -> String {
    if score.failures == 0 {
        return "0".into();
    }
    format!("{} ({:.2} %)", score.failures, 100.0 * score.failures as f64 / score.solves as f64)
}

fn print_methods(methods: &[Method], table: &[(Case, f64)], families: &[Family], passes: usize) {
    let hard: Vec<(Case, f64)> =
        families.iter().flat_map(|f| f.cases.iter().map(|c| (*c, 1.0 / f.cases.len() as f64))).collect();
    let (lamp, adversary) = (work(table, 1), work(&hard, 2));
    let (lamp_ns, adversary_ns) = (time(methods, &lamp, passes), time(methods, &adversary, passes));
    println!(
        "| solver | evaluations, luminaire | most | ns | evaluations, families | most | ns | worst \\|F - u\\| | \
         failures |\n|---|---|---|---|---|---|---|---|---|"
    );
    for (k, method) in methods.iter().enumerate() {
        let (mut on_lamp, mut on_families) = (Score::default(), Score::default());
        lamp.iter().for_each(|(case, u)| on_lamp.add(case, *u, method.solve(case, *u)));
        families.iter().for_each(|f| on_families.join(&Score::of(*method, &f.cases)));
        let mut all = on_lamp;
        all.join(&on_families);
        println!(
            "| {} | {:.2} | {} | {:.0} | {:.2} | {} | {:.0} | {:.0e} | {} of {} |",
            method.name(),
            on_lamp.mean_evaluations(),
            on_lamp.most_evaluations,
            lamp_ns[k],
            on_families.mean_evaluations(),
            on_families.most_evaluations,
            adversary_ns[k],
            all.worst,
            percent(&all),
            all.solves
        );
    }
}

fn print_families(methods: &[Method], families: &[Family]) {
    print!("\nFailures, and mean evaluations, by family:\n\n| solver |");
    families.iter().for_each(|f| print!(" {} |", f.name));
    print!("\n|---|");
    families.iter().for_each(|_| print!("---|"));
    for method in methods {
        print!("\n| {} |", method.name());
        for family in families {
            let score = Score::of(*method, &family.cases);
            print!(
                " {:.2} %, {:.1} |",
                100.0 * score.failures as f64 / score.solves as f64,
                score.mean_evaluations()
            );
        }
    }
    println!();
}

fn main() {
    // Cargo passes --bench when it measures; a test run of all targets only wants to see that it works.
    let passes = if std::env::args().any(|a| a == "--bench") { PASSES } else { 1 };
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("ies/wavy_glass.ies");
    let table = of_table(&photometric::read(file).unwrap().web);
    let (methods, families) = (Method::all(), families());
    print_methods(&methods, &table, &families, passes);
    print_families(&methods, &families);
}
