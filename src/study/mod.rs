//! Algorithm variants side by side: their errors against a reference, how these fall with N, and what a photon costs.

pub mod norms;
pub mod fit;
pub mod results;
pub mod table;
