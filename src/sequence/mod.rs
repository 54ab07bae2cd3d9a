//! Point sequences: pure functions of (index, coordinate, seed, replicate).
//!
//! A point of a sequence lies in the unit hypercube; its coordinates are 64-bit integers, u = bits / 2^64, so that a
//! coordinate can be renormalised several times before it runs out of digits (METHOD 2). Nothing here has state:
//! any thread may ask for any coordinate of any point in any order and gets the same bits.
//!
//! To add a sequence: a file beside these with a type that implements [`Points`], a line in [`Sequence`], a line in
//! [`Sequence::ALL`], and an arm where a run is started (`run::trace`), which matches once a batch, not once a
//! coordinate.

pub mod hash;
pub mod independent;
pub mod joe_kuo;
pub mod owen;
pub mod sobol;

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
}

impl Sequence {
    /// Every sequence, in the order in which they are listed to users.
    pub const ALL: [Self; 3] = [Self::Independent, Self::Sobol, Self::SobolOwen];

    /// The name in commands and files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Sobol => "sobol",
            Self::SobolOwen => "sobol-owen",
        }
    }

    /// The sequence of this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|sequence| sequence.name() == name)
    }

    /// Whether a seed changes the points, that is whether replicates and a standard error exist.
    pub const fn is_randomised(self) -> bool {
        !matches!(self, Self::Sobol)
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
