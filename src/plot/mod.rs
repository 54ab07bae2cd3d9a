//! EXR, PNG, false colour, drawing.
//!
//! Pictures are drawn by our own antialiased canvas and stroke font, so that their bytes depend on nothing but the
//! numbers drawn: no system font, no graphics library. Every file is written under a temporary name and renamed.

pub mod canvas;
pub mod colour_map;
pub mod contour;
pub mod drawing;
pub mod false_colour;
pub mod font;
mod glyphs;
pub mod isolux;
pub mod resample;
pub mod scale;
pub mod tone;
