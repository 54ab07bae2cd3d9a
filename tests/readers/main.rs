//! Files that are read: photometric files, scattering tables, scenes; what they mean and what is said about bad ones.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "../support/mod.rs"]
mod support;

#[allow(dead_code)]
#[path = "../../examples/make_brdf.rs"]
mod make_brdf;
#[allow(dead_code)]
#[path = "../../examples/make_ies.rs"]
mod make_ies;

mod broken_scene;
mod damage;
mod damaged_states;
mod eulumdat_damaged;
mod eulumdat_made;
mod eulumdat_real;
mod mistakes;
mod mistakes_told;
mod mistakes_warned;
mod photometry_cases;
mod photometry_damaged;
mod photometry_own;
mod photometry_real;
mod scattering_damaged;
mod scattering_formats;
mod scattering_material;
mod scattering_own;
mod scattering_real;
mod scattering_refined;
mod scene_builder;
mod scene_camera;
mod scene_damaged;
mod scene_errors;
mod scene_lamps;
mod scene_limits;
mod scene_own;
mod scene_shape_errors;
mod scene_strangers;
mod scene_tabulated;
mod survivors;
