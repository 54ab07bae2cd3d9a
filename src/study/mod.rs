//! Studies: the error of algorithms and sequences, measured.
//!
//! [`norms`] are the errors, [`fit`] how they fall with the number of photons; [`room`] compares sequences in a scene whose
//! photons are reflected a fixed number of times.

pub mod norms;
pub mod fit;
pub mod room;
