//! What a run says: report.json, the printed summary, the files of each receiver; what a study says: [`compare`].

pub mod attributes;
pub mod bsdf;
pub mod bsdf_plot;
pub mod camera;
pub mod candela;
pub mod compare;
pub mod json;
pub mod maps;
pub mod picture;
pub mod ply;
pub mod polar;
pub mod room;
pub mod saved;
pub mod statistics;
pub mod text;

pub use json::Report;
