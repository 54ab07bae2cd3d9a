//! What a sweep says ([`crate::lab::sweep`]): for a terminal, as Markdown, as CSV.

mod csv;
mod markdown;
mod text;

pub use csv::csv;
pub use markdown::markdown;
pub use text::text;

/// The unit of a figure, by the end of its name.
fn unit(figure: &str) -> &'static str {
    match figure {
        name if name.ends_with("_lm") => "lm",
        name if name.ends_with("_lx") => "lx",
        _ => "",
    }
}
