//! What a run is asked to do, made definite.

use std::ops::Range;

use crate::error::{Diagnostic, Kind, Result};

use super::algorithm::Algorithm;

/// Photons of a run that names no number.
const DEFAULT_PHOTONS: u64 = 1 << 22;
/// Replicates of a run that names no number.
pub const DEFAULT_REPLICATES: u32 = 8;
/// Most photons of a run: 2^48, so that counts and their products have room.
pub const MAX_PHOTONS: u64 = 1 << 48;
/// Most replicates.
pub const MAX_REPLICATES: u32 = 1 << 16;

/// What a run is asked to do.
#[derive(Debug, Clone, Copy)]
pub struct Settings {
    /// Photons in all; `None`: 2^22, rounded up to R 2^m.
    pub photons: Option<u64>,
    /// Independent randomisations R; `None`: 8 (1 for a sequence without a seed).
    pub replicates: Option<u32>,
    /// Seed of the randomisation.
    pub seed: u64,
    /// Algorithm variant, with its sequence.
    pub algorithm: Algorithm,
}

impl Default for Settings {
    fn default() -> Self {
        Self { photons: None, replicates: None, seed: 1, algorithm: Algorithm::default() }
    }
}

/// What a run does: settings made definite.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Plan {
    photons_per_replicate: u64,
    replicates: u32,
    seed: u64,
    algorithm: Algorithm,
}

impl Plan {
    /// The plan for these settings: n = 2^m where no number of photons is asked for, else N / R rounded up.
    ///
    /// # Errors
    /// No photons, no replicates, more than `MAX_PHOTONS` or `MAX_REPLICATES`, and several replicates of
    /// a sequence that has no seed.
    pub fn new(settings: &Settings) -> Result<Self> {
        let Settings { photons, replicates, seed, algorithm } = *settings;
        let sequence = algorithm.sequence;
        let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
        let default = if sequence.is_randomised() { DEFAULT_REPLICATES } else { 1 };
        let replicates = replicates.unwrap_or(default);
        if replicates == 0 || replicates > MAX_REPLICATES {
            return fail(format!("{replicates} replicates"), "1 to 65536 replicates");
        }
        if replicates > 1 && !sequence.is_randomised() {
            return fail(
                format!("{replicates} replicates of the sequence \"{}\"", sequence.name()),
                "one replicate: this sequence has no seed, so all replicates would be the same points",
            );
        }
        if photons.is_some_and(|n| n == 0 || n > MAX_PHOTONS) {
            return fail(format!("{} photons", photons.unwrap_or(0)), "1 to 2^48 photons");
        }
        let share = photons.unwrap_or(DEFAULT_PHOTONS).div_ceil(u64::from(replicates));
        let photons_per_replicate = if photons.is_some() { share } else { share.next_power_of_two() };
        Ok(Self { photons_per_replicate, replicates, seed, algorithm })
    }

    /// Photons in all.
    pub fn photons(&self) -> u64 {
        self.photons_per_replicate * u64::from(self.replicates)
    }

    /// Photons of one replicate, n.
    pub fn photons_per_replicate(&self) -> u64 {
        self.photons_per_replicate
    }

    /// The numbers of photons at which a replicate pauses: `first`, then each twice the one before, to n.
    pub(super) fn doublings(&self, first: u64) -> impl Iterator<Item = u64> + use<> {
        let n = self.photons_per_replicate;
        std::iter::successors(Some(n.min(first)), move |end| (*end < n).then(|| n.min(2 * end)))
    }

    /// The indices of the kth of so many parts of each replicate, counted from 1.
    pub fn part(&self, [k, of]: [u32; 2]) -> Range<u64> {
        let (n, k, of) = (u128::from(self.photons_per_replicate), u128::from(k), u128::from(of));
        let at = |k: u128| (n * k / of) as u64;
        at(k - 1)..at(k)
    }

    /// Replicates, R.
    pub fn replicates(&self) -> u32 {
        self.replicates
    }

    /// Seed of the randomisation.
    pub fn seed(&self) -> u64 {
        self.seed
    }

    /// Algorithm variant, with its sequence.
    pub fn algorithm(&self) -> Algorithm {
        self.algorithm
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::Sequence;

    fn plan(photons: Option<u64>, replicates: Option<u32>, sequence: Sequence) -> Result<Plan> {
        let algorithm = Algorithm { sequence, ..Algorithm::default() };
        Plan::new(&Settings { photons, replicates, algorithm, ..Settings::default() })
    }

    #[test]
    fn photons_are_rounded_up_to_powers_of_two_only_when_not_asked_for() {
        let default = plan(None, None, Sequence::SobolOwen).unwrap();
        assert_eq!((default.photons(), default.photons_per_replicate), (1 << 22, 1 << 19));
        let six = plan(None, Some(6), Sequence::SobolOwen).unwrap();
        assert_eq!(six.photons(), 6 << 20);
        let asked = plan(Some(4_456_448), None, Sequence::SobolOwen).unwrap();
        assert_eq!(asked.photons(), 4_456_448);
        let odd = plan(Some(1_000_001), None, Sequence::SobolOwen).unwrap();
        assert_eq!(odd.photons(), 1_000_008);
    }

    #[test]
    fn a_sequence_without_seed_has_one_replicate() {
        assert_eq!(plan(None, None, Sequence::Sobol).unwrap().replicates, 1);
        assert!(plan(None, Some(8), Sequence::Sobol).is_err());
    }

    #[test]
    fn impossible_numbers_are_refused() {
        assert!(plan(Some(0), None, Sequence::SobolOwen).is_err());
        assert!(plan(Some(u64::MAX), None, Sequence::SobolOwen).is_err());
        assert!(plan(None, Some(0), Sequence::SobolOwen).is_err());
        assert!(plan(None, Some(1 << 17), Sequence::SobolOwen).is_err());
    }
}
