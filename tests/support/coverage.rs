//! Scenes whose illuminance is known, and how often a 95 % interval contains it.
//!
//! An interval is the estimate plus and minus Student's 97.5 % point with R - 1 degrees times the standard error. Where the
//! standard error comes from the replicates' spread, the interval has to hold 95 % of the time. A cell with fewer than 10
//! hits in all gets the error of (hits + 1) Poisson hits, never 0; that is an upper estimate, so the claim for dim cells,
//! cells without hits included, is one-sided: at least 95 %.

use std::f64::consts::PI;

use caustix::run::Estimate;
use caustix::scene::Scene;
use caustix::sequence::Sequence;
use rayon::prelude::*;
use statrs::distribution::{ContinuousCDF, StudentsT};

use super::quadrature::cell_means;
use super::scenes::{run, scene};

const FLUX: f64 = 1000.0;

/// A scene of one receiver with equal cells, and what arrives there.
pub struct Known {
    pub scene: Scene,
    /// By cell.
    pub exact_lx: Vec<f64>,
    pub cell_m2: f64,
}

/// An isotropic lamp 1 m above a wide black plate: 16 times as much light in the brightest cells as in the corners and more.
pub fn plate() -> Known {
    const CELLS: usize = 12;
    const SIDE: f64 = 8.0;
    let scene = scene(&format!(
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
    ));
    let exact_lx = cell_means(CELLS, CELLS, 8, |u, v| {
        let (x, y) = (SIDE * (u - 0.5) - 0.13, SIDE * (v - 0.5) + 0.21);
        FLUX / (4.0 * PI) / (1.0 + x * x + y * y).powf(1.5)
    });
    Known { scene, exact_lx, cell_m2: SIDE * SIDE / (CELLS * CELLS) as f64 }
}

/// A lamp in a white ball of this reflectance, off its centre: direct light by cos / d^2, and behind it the same
/// illuminance everywhere, Phi rho / (1 - rho) / area, because a Lambertian point of a sphere lights all of it equally.
pub fn ball(reflectance: f64) -> Known {
    const CELLS: [usize; 2] = [10, 6];
    let lamp = [0.23, -0.31, 0.17];
    let scene = scene(&format!(
        r#"
[[emitter]]
type = "isotropic"
position = {lamp:?}
flux_lm = {FLUX}
[material.white]
type = "lambertian"
reflectance = {reflectance}
[[surface]]
name = "ball"
type = "sphere"
material = "white"
center = [0.0, 0.0, 0.0]
radius = 1.0
[[receiver]]
surface = "ball"
side = "back"
cells = {CELLS:?}
"#
    ));
    let indirect = FLUX * reflectance / (1.0 - reflectance) / (4.0 * PI);
    let exact_lx = cell_means(CELLS[0], CELLS[1], 8, |u, v| {
        let (azimuth, z) = (2.0 * PI * u, 2.0 * v - 1.0);
        let across = (1.0 - z * z).sqrt();
        let p = [across * azimuth.cos(), across * azimuth.sin(), z];
        let to: Vec<f64> = p.iter().zip(lamp).map(|(p, lamp)| p - lamp).collect();
        let (square, along) = to.iter().zip(p).fold((0.0, 0.0), |(s, a), (d, p)| (s + d * d, a + d * p));
        FLUX / (4.0 * PI) * along / square.powf(1.5) + indirect
    });
    Known { scene, exact_lx, cell_m2: 4.0 * PI / (CELLS[0] * CELLS[1]) as f64 }
}

/// Covered and tried, seed by seed.
#[derive(Default)]
pub struct Cover(Vec<(u32, u32)>);

impl Cover {
    pub fn share(&self) -> f64 {
        let (hit, tried) = self.0.iter().fold((0, 0), |(a, b), (h, t)| (a + h, b + t));
        f64::from(hit) / f64::from(tried)
    }

    /// Whether there was anything to cover.
    pub fn is_tried(&self) -> bool {
        self.0.iter().any(|(_, tried)| *tried > 0)
    }

    /// Standard error of the share: cells of one seed are no independent trials, seeds are.
    pub fn error(&self) -> f64 {
        let (n, share) = (self.0.len() as f64, self.share());
        let mean = self.0.iter().map(|s| f64::from(s.1)).sum::<f64>() / n;
        let square: f64 = self.0.iter().map(|(h, t)| (f64::from(*h) - share * f64::from(*t)).powi(2)).sum();
        (square / (n * (n - 1.0))).sqrt() / mean
    }
}

/// How often what was covered.
#[derive(Default)]
pub struct Covers {
    pub totals: Cover,
    /// Cells that expect at least 30 hits, 10 to 30, 1 to 10, less than 1.
    pub cells: [Cover; 4],
    /// Cells that had no hit.
    pub empty: u64,
}

/// The least expected hits of each class of cells.
pub const CLASSES: [f64; 4] = [30.0, 10.0, 1.0, 0.0];

/// Runs of these seeds, each of `replicates` sets of `per_replicate` photons.
pub fn measure(
    known: &Known,
    sequence: Sequence,
    (per_replicate, replicates): (u64, u32),
    seeds: std::ops::Range<u64>,
) -> Covers {
    let total = known.exact_lx.iter().sum::<f64>() * known.cell_m2;
    let photons = per_replicate as f64 * f64::from(replicates);
    let class_of = |exact_lx: f64| {
        let expected = exact_lx * known.cell_m2 / FLUX * photons;
        CLASSES.iter().position(|least| expected >= *least).unwrap_or(CLASSES.len() - 1)
    };
    let student = StudentsT::new(0.0, 1.0, f64::from(replicates - 1)).unwrap().inverse_cdf(0.975);
    let covers = |e: Estimate, exact: f64| (e.value - exact).abs() <= student * e.standard_error.unwrap();
    let of_seed = |seed: u64| {
        let outcome = run(&known.scene, sequence, per_replicate, replicates, seed);
        let mut cells = [(0u32, 0u32); CLASSES.len()];
        for (cell, &exact) in known.exact_lx.iter().enumerate() {
            let (hit, tried) = &mut cells[class_of(exact)];
            *hit += u32::from(covers(outcome.illuminance_lx(0, cell, known.cell_m2), exact));
            *tried += 1;
        }
        let empty = outcome.cells()[0].sum.iter().filter(|sum| **sum == 0).count();
        (u32::from(covers(outcome.receiver_flux_lm(0), total)), cells, empty as u64)
    };
    let mut all = Covers::default();
    for (total, cells, empty) in seeds.into_par_iter().map(of_seed).collect::<Vec<_>>() {
        all.totals.0.push((total, 1));
        all.cells.iter_mut().zip(cells).for_each(|(cover, cell)| cover.0.push(cell));
        all.empty += empty;
    }
    all
}
