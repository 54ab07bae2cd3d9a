//! Point sequences: pure functions of (index, coordinate, seed, replicate).
//!
//! A point of a sequence lies in the unit hypercube; its coordinates are 64-bit integers, u = bits / 2^64, so that a
//! coordinate can be renormalised several times before it runs out of digits (METHOD 2). Nothing here has state:
//! any thread may ask for any coordinate of any point in any order and gets the same bits.
//!
//! To add a sequence: a file beside these with a type that implements [`Points`], a line in [`Sequence`], one in its
//! list, and an arm in [`other::OtherPoints`]. Only a sequence that is to be as fast as it can be also gets
//! an arm where a run is started (`run::trace`), which matches once a batch, not once a coordinate.

pub mod hash;
pub mod primes;
pub mod fraction;
pub mod permutation;
pub mod independent;
pub mod joe_kuo;
pub mod sobol;
pub mod owen;
pub mod faure;
pub mod radical;
pub mod halton;
pub mod hammersley;
pub mod lattice;
pub mod kronecker;
pub mod weyl;
pub mod stratified;
pub mod shift;
pub mod other;

/// Coordinates that a low-discrepancy sequence itself supplies; those beyond come from the counter hash of
/// [`independent`].
pub const LOW_DISCREPANCY_COORDINATES: u32 = 64;

/// The points of one replicate of one sequence: what the inner loop is compiled against.
pub trait Points: Sync {
    /// Coordinate `coordinate` of point `index` as a 64-bit fraction: u = bits / 2^64, in [0, 1).
    fn coordinate(&self, index: u64, coordinate: u32) -> u64;
}

/// The sequences that can be named.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sequence {
    /// Independent pseudo-random points from a counter hash.
    Independent,
    /// Sobol' points as they stand; no seed, so one replicate and no standard error.
    Sobol,
    /// Sobol' points under nested uniform (Owen) scrambling by a hash.
    SobolOwen,
    /// Sobol' points under a random digital shift.
    SobolShift,
    /// Halton points: radical inverses in prime bases.
    Halton,
    /// Halton points, rotated at random (Cranley and Patterson).
    HaltonRotation,
    /// Halton points with Faure's permutations of the digits.
    HaltonFaure,
    /// The same, rotated.
    HaltonFaureRotation,
    /// A Hammersley set: i / N and radical inverses.
    Hammersley,
    /// The same, rotated.
    HammersleyRotation,
    /// A rank-1 lattice.
    Lattice,
    /// The same, rotated.
    LatticeRotation,
    /// Multiples of square roots of primes, modulo 1.
    Weyl,
    /// The same, rotated.
    WeylRotation,
    /// Multiples of powers of a harmonious number, modulo 1 (R2 and its kin).
    Kronecker,
    /// The same, rotated.
    KroneckerRotation,
    /// One uniform point in each rectangle of a grid, in every pair of coordinates.
    Jittered,
    /// One uniform point in each of N intervals, in every coordinate.
    LatinHypercube,
}

/// Of every sequence, in the order in which they are listed to users: its name in commands and files; whether a seed
/// changes the points; whether they are a set made for a known number of them.
const LIST: [(Sequence, &str, bool, bool); 18] = [
    (Sequence::Independent, "independent", true, false),
    (Sequence::Sobol, "sobol", false, false),
    (Sequence::SobolOwen, "sobol-owen", true, false),
    (Sequence::SobolShift, "sobol-shift", true, false),
    (Sequence::Halton, "halton", false, false),
    (Sequence::HaltonRotation, "halton-rotation", true, false),
    (Sequence::HaltonFaure, "halton-faure", false, false),
    (Sequence::HaltonFaureRotation, "halton-faure-rotation", true, false),
    (Sequence::Hammersley, "hammersley", false, true),
    (Sequence::HammersleyRotation, "hammersley-rotation", true, true),
    (Sequence::Lattice, "lattice", false, true),
    (Sequence::LatticeRotation, "lattice-rotation", true, true),
    (Sequence::Weyl, "weyl", false, false),
    (Sequence::WeylRotation, "weyl-rotation", true, false),
    (Sequence::Kronecker, "kronecker", false, false),
    (Sequence::KroneckerRotation, "kronecker-rotation", true, false),
    (Sequence::Jittered, "jittered", true, true),
    (Sequence::LatinHypercube, "latin-hypercube", true, true),
];

impl Sequence {
    /// Every sequence, in the order in which they are listed to users.
    pub const ALL: [Self; LIST.len()] = {
        let (mut all, mut i) = ([Self::Independent; LIST.len()], 0);
        while i < LIST.len() {
            all[i] = LIST[i].0;
            assert!(all[i] as usize == i, "the list and the type have one order");
            i += 1;
        }
        all
    };

    /// The name in commands and files.
    pub const fn name(self) -> &'static str {
        LIST[self as usize].1
    }

    /// The sequence of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|sequence| sequence.name() == name)
    }

    /// Whether a seed changes the points, that is whether replicates and a standard error exist.
    pub const fn is_randomised(self) -> bool {
        LIST[self as usize].2
    }

    /// Whether the points are a set made for a known number of them, of which a first part is no sample.
    pub const fn needs_number(self) -> bool {
        LIST[self as usize].3
    }
}

/// A 64-bit fraction as an `f64` in [0, 1): the upper 53 bits, so that 1 is never reached by rounding.
#[inline]
pub fn to_unit_f64(bits: u64) -> f64 {
    const SCALE: f64 = 1.0 / 9_007_199_254_740_992.0; // 2^-53
    (bits >> 11) as f64 * SCALE
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_round_trip() {
        for sequence in Sequence::ALL {
            assert_eq!(Sequence::from_name(sequence.name()), Some(sequence));
        }
        assert_eq!(Sequence::from_name("halton!"), None);
    }

    #[test]
    fn the_largest_fraction_stays_below_one() {
        assert_eq!(to_unit_f64(u64::MAX), 1.0 - f64::EPSILON / 2.0);
        assert_eq!(to_unit_f64(1 << 63), 0.5);
    }
}
