//! What of a run with a camera is done while photons are traced.
//!
//! [`collector`] keeps photons within a [`budget`] of memory and shows them to the [`eye`] pass by pass;
//! [`splat`] joins them to the pinhole instead.

pub(crate) mod budget;
pub(crate) mod eye;
pub(crate) mod collector;
pub(crate) mod splat;
