//! Point sequences, coordinates, and the samplers made of them: solvers, luminaires, scattering tables.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "../support/mod.rs"]
mod support;

mod cell_solver;
mod coordinates_account;
mod density;
mod sequences;
mod sequences_discrepancy;
mod sequences_render;
mod solvers;
mod table_checks;
mod tabulated;
mod tabulated_files;
mod tabulated_grid;
mod tabulated_options;
mod tabulated_rows;
