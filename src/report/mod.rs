//! What a run says.

pub mod polar;
