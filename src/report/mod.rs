//! What a run says: report.json, the printed summary, the files of each receiver.

pub mod attributes;
pub mod candela;
pub mod json;
pub mod maps;
pub mod polar;
pub mod room;
pub mod statistics;
pub mod text;

pub use json::Report;
