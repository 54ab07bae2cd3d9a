//! A certificate that sampled directions have the density of a photometric file.
//!
//! [`Density`] is what the file says, by quadrature of its own candela; [`Judge`] is fed with draws, wherever
//! they come from ([`sampler`] draws with every variant and sequence), and gives a [`Certificate`]: tests
//! with p-values, corrected for their number. docs/CERTIFICATE.md says what is tested and why the null
//! distributions are valid.
//!
//! For independent draws every null distribution is that of random points. Low-discrepancy points are more
//! even than that: there the tests for random points are upper bounds (a sampler that fails them is wrong,
//! one that passes is as good as random points can tell), the L2-star discrepancy of the draws, mapped to the
//! unit square by the file's distribution functions (Rosenblatt 1952), is tested and shown beside that of
//! random points, and where the sequence is randomised the mean count of every cell over independent
//! randomisations is tested against their own spread.

pub mod density;
pub mod discrepancy;
mod quadrature;
pub mod sampler;
pub mod statistics;
mod tests_of_counts;
mod uniform;
mod verdict;

use serde::Serialize;

use crate::sample::grid::MAX_NODES;
pub use density::Density;
use discrepancy::{RANDOM_MEAN, random_tail, squared_l2_star};
use statistics::sidak;
use tests_of_counts::{CellMeans, chi_square, largest_cell};
use uniform::Uniformity;
pub use verdict::{Cells, Certificate, CoordinatesUsed, Discrepancy, Test, TestName};

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
            for (uniformity, value) in self.uniformity.iter_mut().zip(place) {
                uniformity.add(value);
            }
            if self.square.len() < DISCREPANCY_DRAWS {
                self.square.push([place[0], place[1]]);
            }
        }
    }

    /// Takes the draws of one more randomisation of the point set, independent of the others and of the set
    /// that is certified; only how many fall into each cell is used. Of a sequence without randomisation
    /// there is none.
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
        let dark = self.counts.iter().zip(&self.probabilities).filter(|(_, p)| **p == 0.0);
        let (zero, in_dark) = dark.fold((0, 0), |(cells, draws), (n, _)| (cells + 1, draws + n));
        let draws_in_zero_cells = in_dark + self.means.draws_in_zero_cells;
        let chi = chi_square(&self.counts, &self.probabilities);
        let largest = largest_cell(&self.counts, &self.probabilities);
        let mut tests = vec![chi.test(TestName::ChiSquare), largest.test(TestName::LargestCell)];
        let names = [TestName::KsTheta, TestName::KsPhi, TestName::KsThetaInRow, TestName::KsPhiInColumn];
        tests.extend(self.uniformity.iter().zip(names).map(|(uniformity, name)| uniformity.test(name)));
        let number = self.square.len();
        let squared = squared_l2_star(&mut self.square);
        let random_squared = RANDOM_MEAN / number.max(1) as f64;
        if self.points == PointKind::LowDiscrepancy {
            let scaled = number as f64 * squared;
            let p_value = if number > 0 { random_tail(scaled) } else { 1.0 };
            tests.push(Test::new(TestName::Discrepancy, scaled, None, p_value));
            let means = self.means.judge(&self.probabilities);
            tests.extend(means.map(|means| means.test(TestName::CellMeans)));
        }
        let together = tests.len();
        for test in &mut tests {
            test.p_corrected = sidak(test.p_value, together);
            test.passed = test.p_corrected >= FALSE_ALARM;
        }
        let passed = tests.iter().all(|t| t.passed) && draws_in_zero_cells == 0 && self.outside == 0;
        Certificate {
            points: self.points,
            draws: self.draws,
            replicate_draws: self.means.draws,
            replicates: self.means.replicates,
            cells: Cells { table: self.counts.len(), zero, pooled: chi.pools },
            draws_in_zero_cells,
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
