//! What a certificate says: its tests, and what else draws show.

use std::fmt;

use serde::{Serialize, Serializer};

use super::{FALSE_ALARM, PointKind};

/// Whether one test was passed.
#[derive(Debug, Clone, Serialize)]
pub struct Test {
    /// Which.
    #[serde(skip)]
    pub name: TestName,
    /// What it compares.
    pub what: &'static str,
    /// The test statistic: chi-square, largest Kolmogorov-Smirnov distance, N T^2, largest t, or the largest
    /// deviation of a cell in per cent of its expectation.
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

/// The tests; in JSON by these names.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
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
    /// Its name in tables, and what it compares.
    const fn words(self) -> [&'static str; 2] {
        match self {
            Self::ChiSquare => ["chi-square", "counts of the table's cells"],
            Self::LargestCell => ["largest cell", "the least likely count, % of its expectation"],
            Self::KsTheta => ["KS theta", "theta"],
            Self::KsPhi => ["KS phi | theta", "phi given theta"],
            Self::KsThetaInRow => ["KS theta in row", "theta given its row"],
            Self::KsPhiInColumn => ["KS phi in column", "phi given theta and its column"],
            Self::Discrepancy => ["discrepancy", "N T^2 of the draws in the unit square"],
            Self::CellMeans => ["cell means", "mean counts over randomisations, t"],
        }
    }
}

impl fmt::Display for TestName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.words()[0])
    }
}

fn by_name<S: Serializer>(tests: &[Test], serializer: S) -> Result<S::Ok, S::Error> {
    serializer.collect_map(tests.iter().map(|test| (test.name, test)))
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
    /// Further draws, in as many randomisations as `replicates` says, behind `TestName::CellMeans`.
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
    /// The tests, in the order of `TestName`; in JSON an object by name.
    #[serde(serialize_with = "by_name")]
    pub tests: Vec<Test>,
    /// Discrepancy in the unit square.
    pub discrepancy: Discrepancy,
    /// Coordinates of a draw.
    pub coordinates: CoordinatesUsed,
    /// Whether every test was passed and no draw is where there is no light.
    pub passed: bool,
}

impl Test {
    /// A test by itself, not yet corrected for others.
    pub(super) fn new(name: TestName, statistic: f64, degrees: Option<usize>, p_value: f64) -> Self {
        let [_, what] = name.words();
        let passed = p_value >= FALSE_ALARM;
        Self { name, what, statistic, degrees, p_value, p_corrected: p_value, passed }
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
