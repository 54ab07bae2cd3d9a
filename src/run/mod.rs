//! A whole run: a scene and settings in, sums and their spread out.
//!
//! [`Settings`] are made a [`Plan`]; [`trace`] advances its R replicates of n photons
//! together, over all threads; [`Outcome`] keeps of each receiver and account the sum and the sum of squares over
//! replicates.
//!
//! A picture is made by the same photons, one replicate after another: [`turns`] hands it the [`Tracer`] stage by stage. That
//! file is all that the two know of each other.

pub mod algorithm;
pub mod plan;
pub mod tracer;
pub mod outcome;
pub mod kept;
pub mod forecast;
pub mod goal;
mod outcome_kept;
mod reach;
pub mod pace;
pub mod together;
pub mod turns;
mod schedule;
pub mod replicates;
pub mod share;
pub mod pilot;
pub mod dark;
pub mod warnings;

pub use algorithm::{Algorithm, Variant};
pub use goal::{ErrorGoal, ErrorOf, Goal};
pub use outcome::{Estimate, Outcome, Reached, StoppedBy};
pub use pilot::choose_cells;
pub use plan::{MAX_PHOTONS, MAX_REPLICATES, Plan, Settings};
pub use replicates::{trace, trace_until};
pub use tracer::Tracer;
pub use warnings::warnings;
