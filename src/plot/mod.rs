//! Drawings: false-colour maps, polar diagrams, plots of errors, as PNG and SVG.
//!
//! Pictures are drawn by our own antialiased canvas and stroke font, so that their bytes depend on nothing but the
//! numbers drawn: no system font, no graphics library.

mod chain;
mod coverage;
mod glyphs;
pub mod font;
mod resample;
mod contour;
pub mod canvas;
pub mod drawing;
mod disc;
mod page;
mod isolux;
mod markers;
mod false_colour;
pub mod maps;
pub mod picture;
mod polar;
pub mod candela;
pub mod far_field;
pub mod spot;
pub mod isocandela;
pub mod bsdf;
pub mod compare;
pub mod sweep;
