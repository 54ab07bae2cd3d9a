//! caustix: a light-side caustics simulator. Photometric files (IES LM-63) and a scene in; illuminance maps in lux out, with
//! the error of every number.
//!
//! The pipeline, in the order of the modules; each uses only those before it:
//!
//! 1. [`photometry`] reads a luminaire's file, [`scattering`] holds a surface's table; [`scene::file`] reads a scene, and [`scene::build`] makes a [`scene::Scene`] of
//!    it: shapes ([`geometry`]), what they are made of ([`bsdf`]), [`emitter`]s, receivers. Everything is checked here, once.
//! 2. [`run::Plan`] fixes how many photons are traced, in how many replicates, on which [`sequence`].
//! 3. [`run::trace`]: point i of the sequence gives photon i its coordinates ([`sample`]); they choose its emitter, its
//!    direction and what happens to it at every surface ([`transport`]), until it is absorbed or escapes.
//! 4. [`tally`] counts arrivals in the receivers' cells, in integers: any number of threads gives the same bits.
//! 5. [`estimate`] turns counts of replicates into standard errors; [`run::Outcome`] gives lux and lumens.
//! 6. [`certificate`] compares directions that a sampler gives with the density that a photometric file stands for.
//! 7. [`image`], [`report`] and [`cli`] write EXR, PNG and JSON, and are the command.
//!
//! Errors are [`Diagnostic`]s; nothing panics, exits or prints on data. `docs/METHOD.md` has the equations ("METHOD 3" in a
//! comment is its section 3), `ARCHITECTURE.md` the reasons.
//!
//! # Example
//!
//! Illuminance in the middle of the plate of the built-in scene, and the flux on all of it:
//!
//! ```
//! use caustix::run::{Plan, Settings, trace};
//! use caustix::files::scene_toml;
//! use std::sync::atomic::AtomicBool;
//!
//! # fn main() -> Result<(), Vec<caustix::Diagnostic>> {
//! let scene = scene_toml::built_in()?.build()?;
//! let settings = Settings { photons: Some(1 << 14), ..Settings::default() };
//! let plan = Plan::new(&settings).map_err(|e| vec![e])?;
//! let interrupt = AtomicBool::new(false);
//! let outcome = trace(&scene, &plan, &interrupt, &|_photons| {}).map_err(|e| vec![e])?;
//!
//! let plate = &scene.receivers[0];
//! let cell = 256 * 512 + 256; // row 256, column 256 of 512 x 512
//! let middle = outcome.illuminance_lx(0, cell, plate.area_m2(cell));
//! let flux = outcome.receiver_flux_lm(0);
//! println!("{} lx in the middle, {} lm +- {:?}", middle.value, flux.value, flux.standard_error);
//!
//! assert!((scene.emitters.flux_lm() - 989.58).abs() < 0.01);
//! assert!((flux.value - 803.06).abs() < 1.0); // what 2^22 photons say
//! assert!(outcome.ledger.is_balanced());
//! # Ok(())
//! # }
//! ```

// In import order: a room uses only rooms before it (tests/house checks).
#[path = "."]
mod rooms {
    pub mod error;
    pub mod units;
    pub mod math;
    pub mod sequence;
    pub mod sample;
    pub mod photometry;
    pub mod scattering;
    pub mod geometry;
    pub mod surface;
    pub mod emitter;
    pub mod scene;
    pub mod transport;
    pub mod tally;
    pub mod estimate;
    pub mod run;
    pub mod picture;
    pub mod lab;
    pub mod files;
    pub mod report;
    #[cfg(feature = "plots")]
    pub mod plot;
    #[cfg(feature = "cli")]
    pub mod cli;
}

// Private. The feature `internals` opens them to this package's own tests, benches and examples, and to nobody else.
#[cfg(not(feature = "internals"))]
use rooms::*;
#[cfg(feature = "internals")]
pub use rooms::*;

// The door. Errors and warnings:
pub use error::{Diagnostic, Invalid, Kind, Result};
// Photometric files:
pub use files::lm63::{parse as parse_photometry, read as read_photometry};
pub use photometry::{LuminousOpening, PhotometricType, Photometry, Revision, Summary, Tilt, Web};
// Scattering tables:
pub use files::bsdf::{parse as parse_scattering, read as read_scattering};
pub use scattering::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};
// Scenes:
pub use emitter::{
    AimFrame, AreaLight, Beam, BeamSection, Colour, Disc, Emits, Emitter, Isotropic, Panel, Photometric,
};
pub use files::scene_toml::read_scene;
pub use geometry::{
    Facing, Formula, Heightfield, Mesh, Noise, Octave, Paraboloid, Rectangle, Shape, Smoothing, Sphere,
    Surface, Transform, Wave, box_mesh,
};
pub use scene::camera::{Camera, CameraSpec};
pub use scene::receiver::{ReceiverEvents, ReceiverSide, ReceiverSpec};
pub use scene::{Scene, SceneBuilder};
pub use surface::{Dielectric, Material, Reflectance, Tabulated};
// Runs:
pub use run::{Algorithm, Plan, Settings, StoppedBy, Variant, trace};
pub use sequence::Sequence;
// Results:
pub use run::{Estimate, Outcome};
pub use transport::{Census, Ledger};
// Results as text and files; `write_map_...` write a receiver's map, `write_picture_...` a camera's picture:
#[cfg(feature = "plots")]
pub use plot::maps::write_png as write_map_png;
#[cfg(feature = "plots")]
pub use plot::picture::{write_luminance_png, write_png as write_picture_png};
pub use report::json::Report;
pub use report::maps::{write_csv as write_map_csv, write_exr as write_map_exr};
pub use report::picture::{camera_attributes, write_exr as write_picture_exr};
pub use report::ply::write_ply as write_map_ply;
pub use report::statistics::ReceiverStatistics;
pub use report::text::summary;
// Pictures:
pub use picture::{AnyPicture, Picture, PictureSummary, Watch, trace_picture};

/// The command `caustix`, with the arguments of the process.
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use cli::main as command;
