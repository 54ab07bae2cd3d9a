//! How often a 95 % interval contains the exact value: over many seeds, for a total and for cells of any number of hits.
//!
//! An interval is the estimate plus and minus Student's 97.5 % point with R - 1 degrees times the standard error. Where the
//! standard error comes from the replicates' spread, the interval has to hold 95 % of the time. A cell with fewer than 10
//! hits in all gets the error of (hits + 1) Poisson hits, never 0; that is an upper estimate, so the claim for dim cells,
//! cells without hits included, is one-sided: at least 95 %.

use std::f64::consts::PI;

use caustix::run::Estimate;
use caustix::scene::Scene;
use caustix::sequence::Sequence;
use statrs::distribution::{Binomial, ContinuousCDF, DiscreteCDF, StudentsT};

use crate::support::judge::SIGNIFICANCE;
use crate::support::quadrature::cell_means;
use crate::support::scenes::{run, scene};
use crate::support::statistics::z_test;

const SEEDS: u64 = 400;
const REPLICATES: u32 = 8;
const PER_REPLICATE: u64 = 512;
const CELLS: usize = 12;
const SIDE: f64 = 8.0;
const FLUX: f64 = 1000.0;

/// An isotropic lamp 1 m above a wide plate: 96 hits in the brightest cells, less than 1 in the corners.
fn plate() -> Scene {
    scene(&format!(
        r#"
[[emitter]]
type = "isotropic"
position = [0.13, -0.21, 1.0]
flux_lm = {FLUX}
[material.black]
type = "absorber"
[[surface]]
name = "plate"
type = "rectangle"
material = "black"
corner = [-4.0, -4.0, 0.0]
edge_u = [{SIDE}, 0.0, 0.0]
edge_v = [0.0, {SIDE}, 0.0]
[[receiver]]
surface = "plate"
cells = [{CELLS}, {CELLS}]
"#
    ))
}

fn exact_lx() -> Vec<f64> {
    cell_means(CELLS, CELLS, 8, |u, v| {
        let (x, y) = (SIDE * (u - 0.5) - 0.13, SIDE * (v - 0.5) + 0.21);
        FLUX / (4.0 * PI) / (1.0 + x * x + y * y).powf(1.5)
    })
}

/// Covered and tried, seed by seed.
#[derive(Default)]
struct Cover(Vec<(u32, u32)>);

impl Cover {
    fn share(&self) -> f64 {
        let (hit, tried) = self.0.iter().fold((0, 0), |(a, b), (h, t)| (a + h, b + t));
        f64::from(hit) / f64::from(tried)
    }

    /// Standard error of the share: cells of one seed are no independent trials, seeds are.
    fn error(&self) -> f64 {
        let (n, share) = (self.0.len() as f64, self.share());
        let mean = self.0.iter().map(|s| f64::from(s.1)).sum::<f64>() / n;
        let square: f64 = self.0.iter().map(|(h, t)| (f64::from(*h) - share * f64::from(*t)).powi(2)).sum();
        (square / (n * (n - 1.0))).sqrt() / mean
    }
}

#[test]
fn ninety_five_percent_intervals_contain_the_exact_value_95_percent_of_the_time() {
    let scene = plate();
    let exact = exact_lx();
    let area = SIDE * SIDE / (CELLS * CELLS) as f64;
    let total = exact.iter().sum::<f64>() * area;
    let photons = PER_REPLICATE as f64 * f64::from(REPLICATES);
    let expected_hits: Vec<f64> = exact.iter().map(|e| e * area / FLUX * photons).collect();
    let student = StudentsT::new(0.0, 1.0, f64::from(REPLICATES - 1)).unwrap().inverse_cdf(0.975);
    let covers = |e: Estimate, exact: f64| (e.value - exact).abs() <= student * e.standard_error.unwrap();
    for sequence in [Sequence::SobolOwen, Sequence::Independent] {
        let (mut totals, mut empty) = (0u64, 0u64);
        let [mut bright, mut dim, mut all] = [const { Cover(Vec::new()) }; 3];
        for seed in 0..SEEDS {
            let outcome = run(&scene, sequence, PER_REPLICATE, REPLICATES, 1000 + seed);
            totals += u64::from(covers(outcome.receiver_flux_lm(0), total));
            let [mut b, mut d, mut a] = [(0, 0); 3];
            for (cell, &exact) in exact.iter().enumerate() {
                let covered = u32::from(covers(outcome.illuminance_lx(0, cell, area), exact));
                empty += u64::from(outcome.cells()[0].sum[cell] == 0);
                let class = if expected_hits[cell] >= 40.0 {
                    Some(&mut b)
                } else if expected_hits[cell] < 10.0 {
                    Some(&mut d)
                } else {
                    None
                };
                for (hit, tried) in class.into_iter().chain([&mut a]).map(|c| (&mut c.0, &mut c.1)) {
                    *hit += covered;
                    *tried += 1;
                }
            }
            bright.0.push(b);
            dim.0.push(d);
            all.0.push(a);
        }
        println!("{}: totals {totals} of {SEEDS}, {empty} cells without hits", sequence.name());
        for (name, cover) in [("bright", &bright), ("dim", &dim), ("all", &all)] {
            println!("  {name} cells: {:.4} +- {:.4}", cover.share(), cover.error());
        }
        assert!(empty > SEEDS, "the scene has cells without hits");
        // Totals: binomial, both tails.
        let binomial = Binomial::new(0.95, SEEDS).unwrap();
        let tail = binomial.cdf(totals).min(binomial.sf(totals.saturating_sub(1)));
        assert!(2.0 * tail > SIGNIFICANCE, "{totals} of {SEEDS}");
        // Bright cells: both sides.
        let z = (bright.share() - 0.95) / bright.error();
        assert!(z_test(z) > SIGNIFICANCE, "z = {z}");
        // Dim cells, and all together: not less.
        for cover in [&dim, &all] {
            assert!(cover.share() >= 0.95 - 3.0 * cover.error());
        }
    }
}
