//! The points of any sequence by name behind one type.
//!
//! The walk is compiled for independent, Sobol' and Owen-scrambled Sobol' points each by themselves. All others share
//! this type, which decides at each coordinate: it costs a few tenths of a nanosecond there and saves a copy of the walk
//! for each of them.

use std::num::NonZeroU64;

use super::halton::HaltonPoints;
use super::hammersley::HammersleyPoints;
use super::independent::IndependentPoints;
use super::kronecker::KroneckerPoints;
use super::lattice::LatticePoints;
use super::owen::OwenPoints;
use super::shift::{digital_shift, rotation};
use super::sobol::SobolPoints;
use super::stratified::StratifiedPoints;
use super::{Points, Sequence};
use crate::error::{Diagnostic, Kind, Result};

/// Most points of a set whose number must be known.
pub const MAX_NUMBER: u64 = 1 << 48;

/// The points of one replicate of any sequence.
pub struct OtherPoints(Box<dyn Points>);

impl OtherPoints {
    /// The points of this sequence, seed and replicate; `number` is the number of points N of the set, which the
    /// sequences that [`Sequence::needs_number`] must know and the others don't look at. Sequences without a seed
    /// don't look at seed and replicate.
    ///
    /// # Errors
    /// A sequence that needs the number of points without one, or with 0 or more than [`MAX_NUMBER`].
    pub fn new(sequence: Sequence, seed: u64, replicate: u32, number: Option<u64>) -> Result<Self> {
        let known = || known_number(sequence, number);
        Ok(Self(match sequence {
            Sequence::Independent => Box::new(IndependentPoints::new(seed, replicate)),
            Sequence::Sobol => Box::new(SobolPoints),
            Sequence::SobolOwen => Box::new(OwenPoints::new(seed, replicate)),
            Sequence::SobolShift => Box::new(digital_shift(SobolPoints, seed, replicate)),
            Sequence::Halton => Box::new(HaltonPoints::plain()),
            Sequence::HaltonRotation => Box::new(rotation(HaltonPoints::plain(), seed, replicate)),
            Sequence::HaltonFaure => Box::new(HaltonPoints::faure()),
            Sequence::HaltonFaureRotation => Box::new(rotation(HaltonPoints::faure(), seed, replicate)),
            Sequence::Hammersley => Box::new(HammersleyPoints::new(known()?)),
            Sequence::HammersleyRotation => {
                Box::new(rotation(HammersleyPoints::new(known()?), seed, replicate))
            }
            Sequence::Lattice => Box::new(LatticePoints::new(known()?)),
            Sequence::LatticeRotation => Box::new(rotation(LatticePoints::new(known()?), seed, replicate)),
            Sequence::Weyl => Box::new(KroneckerPoints::weyl()),
            Sequence::WeylRotation => Box::new(rotation(KroneckerPoints::weyl(), seed, replicate)),
            Sequence::Kronecker => Box::new(KroneckerPoints::roberts()),
            Sequence::KroneckerRotation => Box::new(rotation(KroneckerPoints::roberts(), seed, replicate)),
            Sequence::Jittered => Box::new(StratifiedPoints::jittered(seed, replicate, known()?)),
            Sequence::LatinHypercube => Box::new(StratifiedPoints::latin(seed, replicate, known()?)),
        }))
    }
}

fn known_number(sequence: Sequence, number: Option<u64>) -> Result<NonZeroU64> {
    let fail = |kind, found: String| {
        Err(Diagnostic::new(
            kind,
            format!("{found} for the sequence \"{}\"", sequence.name()),
            "a number of points from 1 to 2^48: this sequence is a set of points made for their number",
        ))
    };
    match number.map(|n| (n, NonZeroU64::new(n))) {
        None => fail(Kind::Missing, "no number of points".into()),
        Some((_, Some(known))) if known.get() <= MAX_NUMBER => Ok(known),
        Some((n, _)) => fail(Kind::Range, format!("{n} points")),
    }
}

impl Points for OtherPoints {
    #[inline]
    fn coordinate(&self, index: u64, coordinate: u32) -> u64 {
        self.0.coordinate(index, coordinate)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_or_replicate_changes_exactly_the_randomised_ones() {
        for sequence in Sequence::ALL {
            let stream = |seed, replicate| -> Vec<u64> {
                let points = OtherPoints::new(sequence, seed, replicate, Some(1000)).unwrap();
                (0..40).flat_map(|i| [points.coordinate(i, 0), points.coordinate(i, 3)]).collect()
            };
            let name = sequence.name();
            assert_eq!(stream(1, 0) != stream(2, 0), sequence.is_randomised(), "{name}");
            assert_eq!(stream(1, 0) != stream(1, 1), sequence.is_randomised(), "{name}");
            assert_eq!(stream(1, 1), stream(1, 1), "{name}");
        }
    }

    #[test]
    fn a_number_that_must_be_known_is_asked_for() {
        for sequence in Sequence::ALL {
            for number in [None, Some(0), Some(MAX_NUMBER + 1)] {
                let made = OtherPoints::new(sequence, 1, 0, number);
                assert_eq!(made.is_err(), sequence.needs_number(), "{} {number:?}", sequence.name());
                if let Err(told) = made {
                    assert!(told.to_string().contains(sequence.name()), "{told}");
                    assert!(told.required().contains("number of points"), "{told}");
                }
            }
        }
    }
}
