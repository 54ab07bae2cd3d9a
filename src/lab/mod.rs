//! What is measured about the method itself: the error of every variant (`study`), the density of a sampler
//! (`certificate`), sequences in a room with a fixed number of reflections (`room`); and what many scenes say together
//! (`sweep`).

pub mod certificate;
pub mod study;
pub mod room;
pub mod sweep;
