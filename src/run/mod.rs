//! A whole run: a scene and settings in, sums and their spread out.
//!
//! [`Settings`] are made a [`Plan`]; [`trace`] traces its R replicates of n photons one after another, each
//! over all threads; [`Outcome`] keeps of each receiver and account only the sum and the sum of squares over
//! replicates.
//!
//! A picture is made by the same run: [`trace_by`] hands it the [`Tracer`] stage by stage. That function is
//! all that the two know of each other.

pub mod algorithm;
pub mod plan;
pub mod tracer;
pub mod outcome;
pub mod replicates;
pub mod warnings;

pub use algorithm::{Algorithm, Variant};
pub use outcome::{Estimate, Outcome, StoppedBy};
pub use plan::{MAX_PHOTONS, MAX_REPLICATES, Plan, Settings};
pub use replicates::{trace, trace_by};
pub use tracer::Tracer;
pub use warnings::warnings;
