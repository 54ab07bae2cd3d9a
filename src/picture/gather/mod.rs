//! Luminance from photons nearby, its error and its bias.

pub mod kernel;
pub mod faces;
pub mod footprint;
pub mod surfaces;
pub mod gathered;
pub mod sum;
pub mod bandwidth;
pub mod density;
