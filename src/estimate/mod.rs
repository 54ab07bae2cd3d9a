//! From sums to illuminance and standard errors; from photons to luminance and its bias.

pub mod replicates;
pub mod extremes;
