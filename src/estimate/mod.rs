//! From sums to illuminance and standard errors; from photons to luminance and its bias.

pub mod bandwidth;
pub mod density;
pub mod faces;
pub mod footprint;
pub mod gathered;
pub mod kernel;
pub mod replicates;
mod sum;
mod surfaces;
