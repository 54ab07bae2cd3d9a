//! Order-free exact sums of hits.
//!
//! Every photon has unit weight, so a tally is an array of integer counts: tally(A and B) = merge(tally(A), tally(B))
//! for any split of the photons, bit for bit.

pub mod counts;
pub mod receiver;

pub use counts::{Counts, Moments};
pub use receiver::{FixedPointSink, ReceiverSink, Receivers};
