//! Tables of scattering (BSDFs) as files give them: plain data, read once and checked once.
//!
//! [`table`] says what a table is, in which frames and units; readers of single formats stand beside it. What a photon does
//! at a surface made of one is in [`crate::bsdf`].

pub mod table;

pub use table::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};
