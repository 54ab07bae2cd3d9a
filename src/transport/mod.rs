//! One photon from emission to its end, and the ledger of every lumen.
//!
//! [`walk()`] follows one photon; [`ledger`] counts where photons begin and end; [`census`] collects what a batch of photons
//! did beside that: coordinates used, exceptions made (`kept` writes both as bytes); [`parallel`] runs ranges of photon indices over threads;
//! [`attempts`] counts the points that photons by rejection take; [`mixed`] looks for places that light reaches in two media.

pub mod attempts;
pub mod census;
mod kept;
pub mod ledger;
pub mod mixed;
pub mod parallel;
pub mod trap;
pub mod walk;

pub use census::Census;
pub use ledger::Ledger;
pub use trap::walk;
pub use walk::{Arrival, End, Sink};
