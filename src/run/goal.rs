//! When a run has done enough: an error to be reached, a time to be kept.

use std::time::Instant;

use crate::error::{Diagnostic, Kind, Result};
use crate::estimate::replicates::standard_error_of_cell;
use crate::scene::Scene;

use super::outcome::{Estimate, Outcome};
use super::plan::{Plan, Settings};

/// Replicates of a run to an error that names no number. An error that decides when to stop is more often too small than too
/// large when it does: intervals of 95 % cover 91 % of 8 replicates, 94.3 % of 32 (docs/LONG_RUNS.md).
pub const REPLICATES: u32 = 32;
/// Most photons of a run to an error that names no number: days of a machine, and far fields keep all of their digits.
pub const MOST_PHOTONS: u64 = 1 << 38;

/// What ends a run before its photons do.
#[derive(Debug, Clone, Copy, Default)]
pub struct Goal {
    /// Enough when this is reached.
    pub error: Option<ErrorGoal>,
    /// Enough by then; the last block may end a little later.
    pub until: Option<Instant>,
}

/// A relative standard error (one sigma) to be reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ErrorGoal {
    relative: f64,
    of: ErrorOf,
}

/// What the error to be reached is of. Every receiver of a scene is to reach it.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ErrorOf {
    /// The flux on a receiver, and that which a far field sees.
    Flux,
    /// The mean of a receiver's evaluation grid, where it has one; its flux else.
    Mean,
    /// The cells: root mean square by area, relative to the mean.
    #[default]
    Cells,
    /// The brightest cell.
    Max,
}

impl ErrorOf {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Flux, Self::Mean, Self::Cells, Self::Max];

    /// The name in commands and files.
    pub const fn name(self) -> &'static str {
        ["flux", "mean", "cells", "max"][self as usize]
    }

    /// The one of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|of| of.name() == name)
    }
}

impl ErrorGoal {
    /// A relative standard error, as a fraction.
    ///
    /// # Errors
    /// What is not between 0 and 1.
    pub fn new(relative: f64, of: ErrorOf) -> Result<Self> {
        if relative > 0.0 && relative < 1.0 {
            return Ok(Self { relative, of });
        }
        let found = format!("an error of {} %", 100.0 * relative);
        Err(Diagnostic::new(Kind::Range, found, "a standard error above 0 % and below 100 %"))
    }

    /// The error to be reached, as a fraction.
    pub fn relative(&self) -> f64 {
        self.relative
    }

    /// What it is of.
    pub fn of(&self) -> ErrorOf {
        self.of
    }

    /// The settings of a run to this error: more replicates and as many photons as it takes, where none are named.
    #[must_use]
    pub fn settings(&self, settings: Settings) -> Settings {
        Settings {
            photons: settings.photons.or(Some(MOST_PHOTONS)),
            replicates: settings.replicates.or(Some(REPLICATES)),
            ..settings
        }
    }

    /// That a scene and a plan can reach an error.
    ///
    /// # Errors
    /// One replicate, points made for their number, maps too large for all replicates at a time; nothing to have the error of.
    pub fn check(&self, scene: &Scene, plan: &Plan) -> Result<()> {
        let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
        let sequence = plan.algorithm().sequence;
        if plan.replicates() < 2 {
            let found = format!("an error to be reached by one replicate of \"{}\"", sequence.name());
            return fail(found, "several replicates: the points of one set have no spread");
        }
        if !super::replicates::is_together(scene, plan) {
            return fail(
                "an error to be reached by replicates that are traced one after another".into(),
                "replicates together: fewer cells or replicates, a sequence that is not made for its number of points",
            );
        }
        let of_receivers = !scene.receivers.is_empty();
        let of_far_fields = self.of == ErrorOf::Flux && !scene.far_fields.is_empty();
        if of_receivers || of_far_fields {
            return Ok(());
        }
        let required = match scene.far_fields.is_empty() {
            true => "a scene with a receiver",
            false => "--error-of flux in a scene of far fields alone",
        };
        fail(format!("the error of {} without a receiver", self.of.name()), required)
    }

    /// The relative standard error that an outcome has, of the receiver where it is largest: infinite where nothing arrived;
    /// `None` where it is not known.
    pub fn measured(&self, scene: &Scene, outcome: &Outcome) -> Option<f64> {
        let relative = |e: Estimate| Some(e.standard_error? / e.value);
        let receivers = scene.receivers.iter().enumerate();
        let of_receivers = receivers.map(|(i, receiver)| match self.of {
            ErrorOf::Flux => relative(outcome.receiver_flux_lm(i)),
            ErrorOf::Mean => relative(match receiver.grid {
                Some(grid) => outcome.grid(i, grid.area_m2).0,
                None => outcome.receiver_flux_lm(i),
            }),
            ErrorOf::Cells => of_cells(outcome, i, receiver.areas_m2()),
            ErrorOf::Max => {
                outcome.peak_lx(i, receiver.areas_m2()).map(|peak| peak.standard_error / peak.value)
            }
        });
        let far_fields = if self.of == ErrorOf::Flux { scene.far_fields.len() } else { 0 };
        let of_far_fields = (0..far_fields).map(|i| relative(outcome.far_field_lm(i)[0]));
        let mut largest = 0.0;
        for error in of_receivers.chain(of_far_fields) {
            let error = error?;
            if error.is_nan() || error > largest {
                largest = if error.is_nan() { f64::INFINITY } else { error };
            }
        }
        Some(largest)
    }
}

/// sqrt(mean by area of the squared standard errors of the cells) over the mean illuminance. Cells of few photons owe the error
/// of counting (METHOD 7), so that none is certain.
fn of_cells(outcome: &Outcome, receiver: usize, areas_m2: &[f64]) -> Option<f64> {
    let cells = &outcome.cells()[receiver];
    let area = |cell: usize| areas_m2.get(cell).or(areas_m2.first()).copied().unwrap_or(0.0);
    let (mut squares, mut all_m2, mut photons) = (0.0, 0.0, 0);
    for (cell, (sum, square)) in cells.sum.iter().zip(&cells.square).enumerate() {
        let error = standard_error_of_cell(*sum, *square, outcome.replicates)?;
        let area = area(cell);
        // A face without area takes no photons.
        if area > 0.0 {
            (squares, all_m2, photons) = (squares + error * error / area, all_m2 + area, photons + sum);
        }
    }
    Some((squares * all_m2).sqrt() / photons as f64)
}

/// Looks at an error that a run is to reach.
#[derive(Debug, Clone, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Looks {
    /// Photons of each replicate and the error, of every look so far.
    taken: Vec<(u64, f64)>,
}

impl Looks {
    /// The error at a look at so many photons of each replicate.
    pub(super) fn take(&mut self, photons: u64, error: f64) {
        self.taken.push((photons, error));
    }

    /// The last look.
    pub fn last(&self) -> Option<(u64, f64)> {
        self.taken.last().copied()
    }

    /// Whether two looks in a row were good enough: one may be so by chance.
    pub fn are_enough(&self, relative: f64) -> bool {
        matches!(self.taken[..], [.., (_, before), (_, last)] if before <= relative && last <= relative)
    }

    /// Photons of each replicate at which this error is to be expected: by the rate of the last octave, within what nets give.
    pub fn expected(&self, relative: f64) -> Option<u64> {
        let (n, error) = self.last().filter(|(_, error)| error.is_finite() && *error > 0.0)?;
        let earlier = self.taken.iter().rev().find(|(k, e)| *k <= n / 2 && e.is_finite());
        let rate = earlier.map_or(0.5, |(k, e)| libm::log(e / error) / libm::log(n as f64 / *k as f64));
        let rate = rate.clamp(0.4, 1.0);
        let photons = n as f64 * libm::pow(error / relative, 1.0 / rate);
        Some(if photons < 1e18 { photons as u64 } else { u64::MAX })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looks(errors: &[(u64, f64)]) -> Looks {
        Looks { taken: errors.to_vec() }
    }

    #[test]
    fn one_look_is_not_enough_nor_two_that_are_not_neighbours() {
        for (errors, expected) in [
            (&[][..], false),
            (&[(8, 0.01)], false),
            (&[(8, 0.01), (9, 0.02)], false),
            (&[(8, 0.02), (9, 0.01)], false),
            (&[(8, 0.01), (9, 0.02), (10, 0.01)], false),
            (&[(8, 0.02), (9, 0.01), (10, 0.015)], true),
            (&[(8, f64::INFINITY), (9, f64::NAN)], false),
        ] {
            assert_eq!(looks(errors).are_enough(0.015), expected, "{errors:?}");
        }
    }

    #[test]
    fn what_is_to_be_expected_follows_the_last_octave() {
        // Errors of counting: a quarter of the error takes sixteen times the photons. Of nets: four times.
        assert_eq!(looks(&[(1024, 0.04), (2048, 0.04 / 2_f64.sqrt())]).expected(0.01).unwrap(), 16_384);
        assert_eq!(looks(&[(1024, 0.08), (2048, 0.04)]).expected(0.01).unwrap(), 8192);
        // Noise that rises is counting's at least, one look alone too.
        assert_eq!(looks(&[(1024, 0.04)]).expected(0.02), Some(4096));
        assert!(looks(&[(1024, 0.04), (2048, 0.05)]).expected(0.025).unwrap() < 2048 * 6);
        assert_eq!(looks(&[(1024, f64::INFINITY)]).expected(0.01), None);
        assert_eq!(looks(&[(1024, 0.5)]).expected(1e-12), Some(u64::MAX));
    }

    #[test]
    fn errors_that_cannot_be_are_refused() {
        for relative in [0.0, -0.1, 1.0, f64::NAN, f64::INFINITY] {
            assert!(ErrorGoal::new(relative, ErrorOf::Cells).is_err(), "{relative}");
        }
        assert!(ErrorOf::ALL.into_iter().all(|of| ErrorOf::from_name(of.name()) == Some(of)));
    }
}
