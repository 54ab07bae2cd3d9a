//! The study: the error of every algorithm variant on one scene, measured.
//!
//! [`cells`] divides the scene's receivers into the grids that errors are measured on; [`norms`] are the
//! errors; [`reference`](mod@reference) traces what they are measured against; [`runs`] traces one point set
//! of one algorithm and takes the errors at every number of photons of a ladder; [`account`] predicts the
//! coordinates a photon uses from the events it goes through; [`results`] holds all that, [`fit`] and
//! [`table`] are what follows from it.

pub mod norms;
pub mod fit;
pub mod results;
pub mod table;
pub mod account;
pub mod cells;
pub mod reference;
pub mod runs;

/// Part of the key of every finished part of a study, raised with each change after which the same study
/// gives other numbers: parts of before are then not used.
pub const REVISION: u32 = 2;
