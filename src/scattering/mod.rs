//! Tables of scattering (BSDFs) as files give them: plain data, read once and checked once.
//!
//! [`table`] says what a table is, in which frames and units. [`read`] recognises a file by its content; the readers of
//! single formats stand beside it. [`integral`] gives albedos, [`value`] the function between nodes, [`reciprocity`] how far it is
//! from symmetric. What a photon does at a surface made of one is in [`crate::surface`].

pub mod integral;
pub mod reciprocity;
pub mod table;
pub mod value;

pub use table::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};
