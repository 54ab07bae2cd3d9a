//! Tables of scattering (BSDFs) as files give them: plain data, read once and checked once.
//!
//! [`table`] says what a table is, in which frames and units. [`read`] recognises a file by its content; the readers of
//! single formats stand beside it. [`integral`] gives albedos, [`value`] the function between nodes, [`reciprocity`] how far it is
//! from symmetric. What a photon does at a surface made of one is in [`crate::bsdf`].

pub mod integral;
pub mod klems;
pub mod merl;
mod read;
pub mod reciprocity;
mod remarks;
pub mod table;
pub mod text;
mod unfold;
pub mod value;
mod words;
mod xyz;
pub mod zemax;

pub use read::{Format, MAX_FILE_BYTES, parse, read};
pub use table::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};
