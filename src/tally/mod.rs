//! Order-free exact sums of hits.
//!
//! Where every photon has unit weight a tally is an array of integer counts; where photons carry weights
//! these are rounded to a quantum and added as integers. So tally(A and B) = merge(tally(A), tally(B)) for
//! any split of the photons, bit for bit.

pub mod counts;
pub mod far_field;
pub mod receiver;
pub mod spot;
pub mod weighted;
pub mod wide_sum;

pub use counts::Moments;
pub use receiver::{ReceiverSink, Receivers};
pub use weighted::WeightedReceivers;
pub use wide_sum::WideSum;
