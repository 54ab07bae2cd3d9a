//! caustix: a light-side caustics simulator.

pub mod error;
pub mod units;
pub mod math;
pub mod sequence;
pub mod sample;
pub mod photometry;
pub mod bsdf;
pub mod emitter;
pub mod geometry;
pub mod scene;
pub mod transport;
pub mod tally;
pub mod estimate;
pub mod run;
pub mod image;
pub mod report;
pub mod cli;

pub use error::{Diagnostic, Result};
