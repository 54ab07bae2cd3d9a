//! From sums to illuminance and standard errors.

pub mod replicates;
