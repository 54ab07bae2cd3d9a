//! When a run has done enough: an error to be reached, a time to be kept.

use std::time::Instant;

use crate::error::{Diagnostic, Kind, Result};

use super::plan::Settings;

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
        let counting = looks(&[(1024, 0.04), (2048, 0.04 / 2_f64.sqrt())]).expected(0.01).unwrap();
        assert!(counting.abs_diff(16_384) <= 1, "{counting}");
        assert!(looks(&[(1024, 0.08), (2048, 0.04)]).expected(0.01).unwrap().abs_diff(8192) <= 1);
        // Noise that rises is counting's at least, one look alone too.
        assert!(looks(&[(1024, 0.04)]).expected(0.02).unwrap().abs_diff(4096) <= 1);
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
