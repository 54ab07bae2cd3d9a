//! Cameras, photon maps, splats, and the files of pictures.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "../support/mod.rs"]
mod support;

mod bias;
mod camera_paths;
mod camera_tabulated;
mod camera_views;
mod extremes;
mod mesh_ply;
mod one_pixel;
mod photon_bandwidths;
mod photon_density;
mod photon_density_few;
mod photon_kernels;
mod photon_map;
mod photons;
mod picture_bias;
mod run;
mod splat;
