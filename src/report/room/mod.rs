//! What the study of a room says ([`crate::lab::room`]): for a terminal, as Markdown, as CSV.

mod paper;
mod csv;
mod markdown;
mod text;

pub use csv::{csv, deviations_csv};
pub use markdown::markdown;
pub use text::text;
