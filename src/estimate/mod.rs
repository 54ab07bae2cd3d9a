//! From sums to illuminance and standard errors; from photons to luminance and its bias; from directions to tables.

pub mod replicates;
pub mod extremes;
pub mod far_field;
pub mod spot;
pub mod diagnosis;
