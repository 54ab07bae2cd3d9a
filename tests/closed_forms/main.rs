//! Scenes whose light has a closed form, laws that a run must keep (bits, coverage, rates), and the frames of luminaires.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "../support/mod.rs"]
mod support;

mod coverage;
mod default_cells;
mod determinism;
mod diagnosis;
mod diffuse_sheet;
mod direct;
mod disc;
mod discontinuous;
mod emitter_colour;
mod far_field;
mod grid;
mod interrupted;
mod lengths;
mod media;
mod mistakes;
mod nephroid;
mod panel;
mod photometric_frame;
mod scaled;
mod scaled_picture;
mod shapes;
mod slab;
mod sphere;
mod spot;
mod tabulated_scenes;
mod warnings;
