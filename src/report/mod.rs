//! What a run says: report.json, the printed summary, maps as EXR, CSV, PLY and VTP; what a study says: [`compare`], [`room`],
//! [`sweep`].
//!
//! Numbers, text and plain files only: what is drawn is in `plot`, which comes after this room.

pub mod numbers;
pub mod colour;
pub mod statistics;
pub mod spot;
pub mod uniformity;
pub mod unknown;
pub mod attributes;
pub mod maps;
pub mod far_field;
mod far_field_warnings;
pub mod ply;
pub mod vtp;
pub mod picture;
pub mod camera;
pub mod diagnosis;
pub mod json;
pub mod vouched;
pub mod saved;
pub mod text;
mod data_sheet;
pub mod photometry;
pub mod photometry_rows;
pub mod bsdf;
pub mod certificate;
pub mod compare;
pub mod room;
pub mod sweep;
