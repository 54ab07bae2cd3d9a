//! From sums to illuminance and standard errors.

pub mod density;
pub mod replicates;
