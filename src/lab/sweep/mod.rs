//! A sweep: the scenes of a grid of values, traced by common random numbers.
//!
//! Every scene is traced with the same seed, replicates and photons, so that replicate r of two scenes has the same points. What
//! they have in common, noise included, cancels in the difference of two scenes; its error comes from the spread of the
//! replicates' differences ([`difference`]).
//!
//! [`values`] are what one key takes, [`grid`] the product of several, [`figures`] what is taken of each scene, [`results`] all of
//! it.

pub mod values;
pub mod grid;
pub mod figures;
pub mod difference;
pub mod results;
