//! Luminance from the photons near a point, with its error and its bias.
//!
//! Each density is made twice: at its own bandwidth, which is what a pixel shows, and at one of twice the
//! area, which tells the bias. [`Density`] adds both to [`Gathered`], pixel by pixel; [`ErrorSums`] turns
//! what was gathered, pass by pass, into the standard error and the bias of a pixel. Nothing else computes
//! either.
//!
//! The files in the order of use: [`kernel`] weighs photons by distance; [`faces`] and [`footprint`] say
//! which part of a surface is the neighbourhood of a point; [`surfaces`] finds the nearest photons there;
//! [`gathered`] holds what a pixel has; [`error`] its error and bias; [`sum`] adds the photons about one
//! point; [`bandwidth`] chooses a radius from a `ladder`; [`density`] is the whole.

pub mod kernel;
pub mod faces;
pub mod footprint;
pub mod surfaces;
pub mod gathered;
pub mod error;
pub mod sum;
mod ladder;
pub mod bandwidth;
pub mod density;

pub use density::{Choice, Density};
pub use error::ErrorSums;
pub use gathered::Gathered;

/// The second bandwidth, in units of the first: twice the area.
pub const SECOND: f64 = std::f64::consts::SQRT_2;

/// Factor from the difference between the two bandwidths to the bias of the narrower: exact for a bias that
/// grows as the radius (at an edge), 1 / (sqrt 2 - 1); too large for one that grows as its square (where the
/// density is smooth), 1.
pub const BIAS_PER_DIFFERENCE: f64 = 1.0 / (SECOND - 1.0);
