//! A certificate that sampled directions have the density of a photometric file.
//!
//! [`Density`] is what the file says, by quadrature of its own candela; [`Judge`] is fed with draws, wherever they come
//! from ([`sampler`] draws with every variant and sequence), and gives a [`Certificate`]: tests with p-values, corrected
//! for their number. docs/CERTIFICATE.md says what is tested and why the null distributions are valid.
//!
//! For independent draws every null distribution is that of random points. Low-discrepancy points are more even than
//! that: there the tests for random points are upper bounds (a sampler that fails them is wrong, one that passes is as good
//! as random points can tell), the L2-star discrepancy of the draws, mapped to the unit square by the file's distribution
//! functions (Rosenblatt 1952), is tested and shown beside that of random points, and where the sequence is randomised
//! the mean count of every cell over independent randomisations is tested against their own spread.

pub mod density;
pub mod discrepancy;
mod quadrature;
pub mod sampler;
pub mod statistics;
mod tests_of_counts;
mod uniform;

use std::fmt;

use serde::{Serialize, Serializer};

use crate::sample::grid::MAX_NODES;
pub use density::Density;
use discrepancy::{RANDOM_MEAN, random_tail, squared_l2_star};
use statistics::sidak;
use tests_of_counts::{CellMeans, chi_square, largest_cell};
use uniform::Uniformity;

/// Chance that the certificate of a right sampler fails: the level of all its tests together.
pub const FALSE_ALARM: f64 = 1e-3;
/// Draws whose discrepancy is computed: the first of them, where there are more.
pub const DISCREPANCY_DRAWS: usize = 1 << 22;
/// Randomisations beside the one that is certified, over which [`Judge::replicate`] is meant to be called.
pub const REPLICATES: u32 = 16;

// A cell's index fits the counters of a table that a grid accepts.
const _: () = assert!(MAX_NODES <= u32::MAX as usize);

/// One sampled direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// Polar angle of the unfolded grid ([`crate::photometry::FullGrid`]), rad.
    pub theta_rad: f64,
    /// Azimuth of the unfolded grid, rad.
    pub phi_rad: f64,
    /// Coordinates of the point sequence that it took.
    pub coordinates: u32,
}

/// What the draws are made from, so what they are compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum PointKind {
    /// Independent random points: the tests are exact.
    Random,
    /// Points of a low-discrepancy sequence: the tests for random points are upper bounds.
    LowDiscrepancy,
}

/// Collects draws and judges them.
#[derive(Debug, Clone)]
pub struct Judge<'d> {
    density: &'d Density<'d>,
    points: PointKind,
    probabilities: Vec<f64>,
    counts: Vec<u64>,
    outside: u64,
    draws: u64,
    uniformity: [Uniformity; 4],
    square: Vec<[f64; 2]>,
    means: CellMeans,
    coordinates: u64,
    coordinates_max: u32,
}

/// Whether one test was passed.
#[derive(Debug, Clone, Serialize)]
pub struct Test {
    /// Which.
    #[serde(skip)]
    pub name: TestName,
    /// What it compares.
    pub what: &'static str,
    /// The test statistic: chi-square, largest Kolmogorov-Smirnov distance, N T^2, largest t, or the largest deviation of
    /// a cell in per cent of its expectation.
    pub statistic: f64,
    /// Degrees of freedom, where the test has any.
    pub degrees: Option<usize>,
    /// Chance of so large a statistic under the test's null hypothesis.
    pub p_value: f64,
    /// The same, corrected for the number of tests (Sidak).
    pub p_corrected: f64,
    /// Whether the corrected chance is at least [`FALSE_ALARM`].
    pub passed: bool,
}

/// The tests.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum TestName {
    /// Chi-square over the cells of the table.
    ChiSquare,
    /// The cell whose count is least likely.
    LargestCell,
    /// Kolmogorov-Smirnov on theta.
    KsTheta,
    /// Kolmogorov-Smirnov on phi given theta.
    KsPhi,
    /// Kolmogorov-Smirnov on theta inside its row.
    KsThetaInRow,
    /// Kolmogorov-Smirnov on phi inside its column, given theta.
    KsPhiInColumn,
    /// L2-star discrepancy against random points.
    Discrepancy,
    /// Mean counts of the cells over randomisations against their spread.
    CellMeans,
}

impl TestName {
    /// The key in JSON.
    pub const fn key(self) -> &'static str {
        match self {
            Self::ChiSquare => "chi_square",
            Self::LargestCell => "largest_cell",
            Self::KsTheta => "ks_theta",
            Self::KsPhi => "ks_phi",
            Self::KsThetaInRow => "ks_theta_in_row",
            Self::KsPhiInColumn => "ks_phi_in_column",
            Self::Discrepancy => "discrepancy",
            Self::CellMeans => "cell_means",
        }
    }

    /// The name in tables and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::ChiSquare => "chi-square",
            Self::LargestCell => "largest cell",
            Self::KsTheta => "KS theta",
            Self::KsPhi => "KS phi | theta",
            Self::KsThetaInRow => "KS theta in row",
            Self::KsPhiInColumn => "KS phi in column",
            Self::Discrepancy => "discrepancy",
            Self::CellMeans => "cell means",
        }
    }
}

fn by_name<S: Serializer>(tests: &[Test], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(tests.iter().map(|test| (test.name.key(), test)))
}

impl fmt::Display for TestName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}

/// The cells of a table as the tests saw them.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Cells {
    /// In the unfolded table.
    pub table: usize,
    /// Of them with an integral of zero: they must be empty.
    pub zero: usize,
    /// Neighbours together until they expect at least five draws.
    pub pooled: usize,
}

/// L2-star discrepancy of the draws in the unit square.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Discrepancy {
    /// Draws that it was computed of.
    #[serde(rename = "samples")]
    pub draws: usize,
    /// T.
    pub l2_star: f64,
    /// Root mean square of T for as many random points.
    pub random: f64,
    /// The first over the second.
    pub ratio: f64,
}

/// Coordinates of the point sequence that a draw took.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct CoordinatesUsed {
    /// In the mean.
    pub mean: f64,
    /// At most.
    pub max: u32,
}

/// What the draws of a sampler show.
#[derive(Debug, Clone, Serialize)]
pub struct Certificate {
    /// What the draws were made from.
    pub points: PointKind,
    /// Draws judged.
    #[serde(rename = "samples")]
    pub draws: u64,
    /// Further draws, in as many randomisations as `replicates` says, behind [`TestName::CellMeans`].
    #[serde(rename = "replicate_samples")]
    pub replicate_draws: u64,
    /// Randomisations of these.
    pub replicates: u32,
    /// The table.
    pub cells: Cells,
    /// Draws in cells of the table whose integral is zero; one is enough to fail.
    #[serde(rename = "samples_in_zero_cells")]
    pub draws_in_zero_cells: u64,
    /// Draws outside the table; one is enough to fail.
    #[serde(rename = "samples_outside")]
    pub draws_outside: u64,
    /// The tests, in the order of [`TestName`]; in JSON an object by name.
    #[serde(serialize_with = "by_name")]
    pub tests: Vec<Test>,
    /// Discrepancy in the unit square.
    pub discrepancy: Discrepancy,
    /// Coordinates of a draw.
    pub coordinates: CoordinatesUsed,
    /// Whether every test was passed and no draw is where there is no light.
    pub passed: bool,
}

impl<'d> Judge<'d> {
    /// A judge of draws that should have this density.
    pub fn new(density: &'d Density<'d>, points: PointKind) -> Self {
        let probabilities = density.probabilities();
        Self {
            density,
            points,
            counts: vec![0; probabilities.len()],
            means: CellMeans::default(),
            probabilities,
            outside: 0,
            draws: 0,
            uniformity: [(); 4].map(|()| Uniformity::new()),
            square: Vec::new(),
            coordinates: 0,
            coordinates_max: 0,
        }
    }

    /// Takes one draw of the set that is certified.
    pub fn draw(&mut self, draw: Draw) {
        let Draw { theta_rad, phi_rad, coordinates } = draw;
        self.draws += 1;
        self.coordinates += u64::from(coordinates);
        self.coordinates_max = self.coordinates_max.max(coordinates);
        let Some(cell) = self.density.cell(theta_rad, phi_rad) else {
            self.outside += 1;
            return;
        };
        self.counts[cell] += 1;
        if self.probabilities[cell] > 0.0 {
            let place = self.density.place(cell, theta_rad, phi_rad);
            let values = [place.theta, place.phi, place.theta_in_row, place.phi_in_column];
            for (uniformity, value) in self.uniformity.iter_mut().zip(values) {
                uniformity.add(value);
            }
            if self.square.len() < DISCREPANCY_DRAWS {
                self.square.push([place.theta, place.phi]);
            }
        }
    }

    /// Takes the draws of one more randomisation of the point set, independent of the others and of the set that is
    /// certified; only how many fall into each cell is used. Of a sequence without randomisation there is none.
    pub fn replicate(&mut self, draws: impl IntoIterator<Item = Draw>) {
        let mut counts = vec![0; self.counts.len()];
        let mut number = 0;
        for draw in draws {
            number += 1;
            match self.density.cell(draw.theta_rad, draw.phi_rad) {
                Some(cell) => counts[cell] += 1,
                None => self.outside += 1,
            }
        }
        self.means.add(&counts, number, &self.probabilities);
    }

    /// The verdict on all draws so far.
    pub fn certificate(mut self) -> Certificate {
        let zero = |count: &(&u64, &f64)| *count.1 == 0.0;
        let in_zero_cells =
            self.counts.iter().zip(&self.probabilities).filter(zero).map(|c| *c.0).sum::<u64>()
                + self.means.draws_in_zero_cells;
        let chi = chi_square(&self.counts, &self.probabilities);
        let largest = largest_cell(&self.counts, &self.probabilities);
        let mut tests = vec![
            chi.test(TestName::ChiSquare, "counts of the table's cells"),
            largest.test(TestName::LargestCell, "the least likely count, % of its expectation"),
        ];
        let names = [
            (TestName::KsTheta, "theta"),
            (TestName::KsPhi, "phi given theta"),
            (TestName::KsThetaInRow, "theta given its row"),
            (TestName::KsPhiInColumn, "phi given theta and its column"),
        ];
        for ((name, what), uniformity) in names.into_iter().zip(&self.uniformity) {
            tests.push(uniformity.test(name, what));
        }
        let number = self.square.len();
        let squared = squared_l2_star(&mut self.square);
        let random_squared = RANDOM_MEAN / number.max(1) as f64;
        if self.points == PointKind::LowDiscrepancy {
            let scaled = number as f64 * squared;
            let p_value = if number > 0 { random_tail(scaled) } else { 1.0 };
            let what = "N T^2 of the draws in the unit square";
            tests.push(Test::new(TestName::Discrepancy, what, scaled, None, p_value));
            if let Some(means) = self.means.judge(&self.probabilities) {
                tests.push(means.test(TestName::CellMeans, "mean counts over randomisations, t"));
            }
        }
        let together = tests.len();
        for test in &mut tests {
            test.p_corrected = sidak(test.p_value, together);
            test.passed = test.p_corrected >= FALSE_ALARM;
        }
        let passed = tests.iter().all(|t| t.passed) && in_zero_cells == 0 && self.outside == 0;
        Certificate {
            points: self.points,
            draws: self.draws,
            replicate_draws: self.means.draws,
            replicates: self.means.replicates,
            cells: Cells {
                table: self.counts.len(),
                zero: self.probabilities.iter().filter(|p| **p == 0.0).count(),
                pooled: chi.pools,
            },
            draws_in_zero_cells: in_zero_cells,
            draws_outside: self.outside,
            tests,
            discrepancy: Discrepancy {
                draws: number,
                l2_star: libm::sqrt(squared),
                random: libm::sqrt(random_squared),
                ratio: libm::sqrt(squared / random_squared),
            },
            coordinates: CoordinatesUsed {
                mean: self.coordinates as f64 / self.draws.max(1) as f64,
                max: self.coordinates_max,
            },
            passed,
        }
    }
}

impl Test {
    /// A test by itself, not yet corrected for others.
    fn new(name: TestName, what: &'static str, statistic: f64, degrees: Option<usize>, p_value: f64) -> Self {
        Self { name, what, statistic, degrees, p_value, p_corrected: p_value, passed: p_value >= FALSE_ALARM }
    }
}

impl Certificate {
    /// Which tests failed and with which chance, one clause each; nothing where it passed.
    pub fn failures(&self) -> Vec<String> {
        let draws =
            |n: u64, what: &str| (n > 0).then(|| format!("{n} draw{} {what}", if n == 1 { "" } else { "s" }));
        let places = [
            draws(self.draws_in_zero_cells, "in cells of the table that are dark"),
            draws(self.draws_outside, "outside the table"),
        ];
        let failed = self.tests.iter().filter(|t| !t.passed);
        let tests = failed.map(|t| {
            let p =
                if t.p_corrected < 1e-15 { "below 1e-15".into() } else { format!("{:.1e}", t.p_corrected) };
            format!("{} ({}): corrected p {p}", t.name, t.what)
        });
        places.into_iter().flatten().chain(tests).collect()
    }
}
