//! What of a run with a camera is done while photons are traced.

pub(crate) mod collector;
pub(crate) mod eye;
pub(crate) mod splat;
