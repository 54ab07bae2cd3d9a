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
use super::shift::{Shifted, digital_shift, rotation};
use super::sobol::SobolPoints;
use super::stratified::StratifiedPoints;
use super::{Points, Sequence};
use crate::error::{Diagnostic, Kind, Result};

/// Most points of a set whose number must be known.
pub const MAX_NUMBER: u64 = 1 << 48;

/// The points of one replicate of any sequence.
#[derive(Debug, Clone)]
pub enum OtherPoints {
    /// Independent points.
    Independent(IndependentPoints),
    /// Plain Sobol' points.
    Sobol(SobolPoints),
    /// Owen-scrambled Sobol' points.
    SobolOwen(OwenPoints),
    /// Sobol' points under a digital shift.
    SobolShift(Shifted<SobolPoints>),
    /// Halton points, with or without Faure's permutations.
    Halton(HaltonPoints),
    /// The same, rotated.
    HaltonRotation(Shifted<HaltonPoints>),
    /// A Hammersley set.
    Hammersley(HammersleyPoints),
    /// The same, rotated.
    HammersleyRotation(Shifted<HammersleyPoints>),
    /// A rank-1 lattice.
    Lattice(LatticePoints),
    /// The same, rotated.
    LatticeRotation(Shifted<LatticePoints>),
    /// An additive recurrence: Weyl's or the R2-type one.
    Kronecker(KroneckerPoints),
    /// The same, rotated.
    KroneckerRotation(Shifted<KroneckerPoints>),
    /// Jittered or Latin hypercube points.
    Stratified(StratifiedPoints),
}

impl OtherPoints {
    /// The points of this sequence, seed and replicate; `number` is the number of points N of the set, which the
    /// sequences that [`Sequence::needs_number`] must know and the others don't look at. Sequences without a seed
    /// don't look at seed and replicate.
    ///
    /// # Errors
    /// A sequence that needs the number of points without one, or with 0 or more than [`MAX_NUMBER`].
    pub fn new(sequence: Sequence, seed: u64, replicate: u32, number: Option<u64>) -> Result<Self> {
        let known = || known_number(sequence, number);
        let turned = |points| rotation(points, seed, replicate);
        Ok(match sequence {
            Sequence::Independent => Self::Independent(IndependentPoints::new(seed, replicate)),
            Sequence::Sobol => Self::Sobol(SobolPoints),
            Sequence::SobolOwen => Self::SobolOwen(OwenPoints::new(seed, replicate)),
            Sequence::SobolShift => Self::SobolShift(digital_shift(SobolPoints, seed, replicate)),
            Sequence::Halton => Self::Halton(HaltonPoints::plain()),
            Sequence::HaltonRotation => Self::HaltonRotation(turned(HaltonPoints::plain())),
            Sequence::HaltonFaure => Self::Halton(HaltonPoints::faure()),
            Sequence::HaltonFaureRotation => Self::HaltonRotation(turned(HaltonPoints::faure())),
            Sequence::Hammersley => Self::Hammersley(HammersleyPoints::new(known()?)),
            Sequence::HammersleyRotation => {
                Self::HammersleyRotation(rotation(HammersleyPoints::new(known()?), seed, replicate))
            }
            Sequence::Lattice => Self::Lattice(LatticePoints::new(known()?)),
            Sequence::LatticeRotation => {
                Self::LatticeRotation(rotation(LatticePoints::new(known()?), seed, replicate))
            }
            Sequence::Weyl => Self::Kronecker(KroneckerPoints::weyl()),
            Sequence::WeylRotation => {
                Self::KroneckerRotation(rotation(KroneckerPoints::weyl(), seed, replicate))
            }
            Sequence::Kronecker => Self::Kronecker(KroneckerPoints::roberts()),
            Sequence::KroneckerRotation => {
                Self::KroneckerRotation(rotation(KroneckerPoints::roberts(), seed, replicate))
            }
            Sequence::Jittered => Self::Stratified(StratifiedPoints::jittered(seed, replicate, known()?)),
            Sequence::LatinHypercube => Self::Stratified(StratifiedPoints::latin(seed, replicate, known()?)),
        })
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
        match self {
            Self::Independent(points) => points.coordinate(index, coordinate),
            Self::Sobol(points) => points.coordinate(index, coordinate),
            Self::SobolOwen(points) => points.coordinate(index, coordinate),
            Self::SobolShift(points) => points.coordinate(index, coordinate),
            Self::Halton(points) => points.coordinate(index, coordinate),
            Self::HaltonRotation(points) => points.coordinate(index, coordinate),
            Self::Hammersley(points) => points.coordinate(index, coordinate),
            Self::HammersleyRotation(points) => points.coordinate(index, coordinate),
            Self::Lattice(points) => points.coordinate(index, coordinate),
            Self::LatticeRotation(points) => points.coordinate(index, coordinate),
            Self::Kronecker(points) => points.coordinate(index, coordinate),
            Self::KroneckerRotation(points) => points.coordinate(index, coordinate),
            Self::Stratified(points) => points.coordinate(index, coordinate),
        }
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
