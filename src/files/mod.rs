//! Everything that reads or writes bytes: photometric files, scattering tables, meshes, scenes, maps, parts of studies.
//!
//! A reader gives the plain data of the room it serves; a writer takes it. Nothing else in the program opens a file.

pub mod atomic;
pub mod base64;
pub mod bsdf;
pub mod bytes;
mod candela;
mod confine;
pub mod converted;
pub mod decimal;
mod decode;
pub mod eulumdat;
mod excerpt;
pub mod exr;
pub mod folder;
pub mod height_image;
pub(crate) mod kinds;
pub mod letters;
pub mod lm63;
pub mod obj;
mod obj_text;
pub mod outputs;
pub mod parts;
pub mod photometric;
pub mod photon_map;
#[cfg(feature = "plots")]
pub mod png;
pub mod run_state;
pub mod scene_toml;
pub mod set;
pub(crate) mod suggest;
