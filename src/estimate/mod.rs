//! From sums to illuminance and standard errors.
