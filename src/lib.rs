//! caustix traces photons from luminaires through glass, water and mirrors. Photometric files (IES LM-63, EULUMDAT) and a scene in;
//! illuminance maps in lux out, with the error of every number.
//!
//! # From a photometric file to a number
//!
//! 1. [`read_photometry`] reads the file; [`Photometric`] is the emitter that it describes, put somewhere by an [`AimFrame`].
//!    ([`Summary`] says what a data sheet would.)
//! 2. [`SceneBuilder`] collects named emitters, surfaces (a [`Shape`] of a [`Material`]) and receivers ([`ReceiverSpec`]),
//!    and checks them together. [`read_scene`] does the same for a scene file.
//! 3. [`Plan`] fixes how many photons are traced, in how many replicates, on which [`Sequence`]; [`trace`] traces them.
//! 4. [`Outcome`] gives lux and lumens, each an [`Estimate`]: value and standard error. [`write_map_exr`] and its neighbours
//!    write maps.
//!
//! ```
//! use caustix::{AimFrame, Emitter, Material, Photometric, Rectangle, ReceiverSpec, SceneBuilder, Shape};
//! use caustix::{Plan, Settings, read_photometry, trace};
//! use glam::dvec3;
//! use std::sync::atomic::AtomicBool;
//!
//! # fn main() -> Result<(), Vec<caustix::Diagnostic>> {
//! let photometry = read_photometry("ies/spot.ies")?;
//! let down = AimFrame::new(dvec3(0.0, 0.0, -1.0), None)?;
//! let lamp = Photometric::new(&photometry, dvec3(0.0, 0.0, 2.0), down, None)?;
//! let floor = Rectangle::new(dvec3(-1.0, -1.0, 0.0), dvec3(2.0, 0.0, 0.0), dvec3(0.0, 2.0, 0.0))?;
//!
//! let mut scene = SceneBuilder::new();
//! scene.emitter("lamp", Emitter::Photometric(lamp));
//! scene.surface("floor", Shape::Rectangle(floor), Material::Absorber);
//! scene.receiver(ReceiverSpec::new("floor", "floor")?.with_cells([1, 1])?);
//! let scene = scene.build()?;
//!
//! let plan = Plan::new(&Settings { photons: Some(1 << 14), ..Settings::default() })?;
//! let outcome = trace(&scene, &plan, &AtomicBool::new(false), &|_photons| {})?;
//! let floor = outcome.illuminance_lx(0, 0, scene.receivers[0].area_m2(0));
//! println!("{} +- {:?} lx on average", floor.value, floor.standard_error);
//! # assert!((4.0 * floor.value - outcome.receiver_flux_lm(0).value).abs() < 1e-9 * floor.value);
//! # assert!(floor.value > 0.0 && outcome.ledger.is_balanced());
//! # Ok(())
//! # }
//! ```
//!
//! `examples/embed.rs` is a scene with glass in it. Constructors return [`Invalid`], readers [`Diagnostic`]s with file, line and
//! column; nothing panics, exits or prints on data. `docs/METHOD.md` has the equations ("METHOD 3" in a comment is its section
//! 3), `ARCHITECTURE.md` the rooms of the source and the reasons.
//!
//! # Features
//!
//! `cli` (default): the command `caustix`. `plots` (default): drawings, maps as PNG. Without either the library reads, traces
//! and writes EXR, CSV, PLY, VTP and JSON.

// What only the command uses is dead without it; the build with the command denies dead code.
#![cfg_attr(not(feature = "cli"), allow(dead_code, unused_imports))]

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
pub use error::warning::{Severity, Warning};
pub use error::{Diagnostic, Invalid, Kind, Place, Result};
// Photometric files:
pub use files::converted::{ExportFormat, photometric_file};
pub use files::photometric::{
    parse as parse_photometry, read as read_photometry, read_with as read_photometry_with,
};
pub use photometry::export::{DataOrigin, Export, PhotometricFile};
pub use photometry::{
    EulumdatHead, Format, LampSet, LuminousOpening, PhotometricType, Photometry, Revision, Summary, Tilt,
    TiltTable, Web,
};
// Scattering tables:
pub use files::bsdf::{parse as parse_scattering, read as read_scattering};
pub use scattering::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};
// Scenes:
pub use emitter::sources::*;
pub use emitter::{AimFrame, Colour, Emits, Emitter};
pub use files::scene_toml::{
    RunDefaults, SceneFile, built_in as built_in_scene, parse_scene, read as read_scene_file,
    read_confined as read_confined_scene_file, read_scene,
};
pub use geometry::{
    Facing, Formula, HeightImage, Heightfield, Mesh, Noise, Octave, Paraboloid, Rectangle, Shape, Smoothing,
    Sphere, Surface, Transform, Wave, box_mesh,
};
pub use scene::camera::{Camera, CameraSpec};
pub use scene::far_field::{FarFieldSpec, Symmetry};
pub use scene::media::Medium;
pub use scene::receiver::{ReceiverEvents, ReceiverSide, ReceiverSpec};
pub use scene::{Joint, Scene, SceneBuilder, SurfaceOptions};
pub use surface::models::*;
pub use surface::{Material, Reflectance};
// Runs:
pub use run::{
    Algorithm, ErrorGoal, ErrorOf, Goal, Plan, Reached, Settings, StoppedBy, Variant, choose_cells, trace,
    trace_until, warnings,
};
pub use sequence::Sequence;
// Results:
pub use estimate::diagnosis::{Drift, Moment, Rate};
pub use estimate::extremes::Interval;
pub use estimate::spot::{Diameter, Encircled, Figure};
pub use run::{Estimate, Outcome};
pub use transport::{Census, Ledger};
// Results as text and files; `write_map_...` write a receiver's map, `write_picture_...` a camera's picture:
#[cfg(feature = "plots")]
pub use plot::maps::write_png as write_map_png;
#[cfg(feature = "plots")]
pub use plot::picture::{write_luminance_png, write_png as write_picture_png};
pub use report::diagnosis::{DiagnosisReport, DoublingReport};
pub use report::far_field::{
    FarFieldStatistics, Measured, export as export_far_field, write_csv as write_far_field_csv,
    write_exr as write_far_field_exr,
};
pub use report::json::Report;
pub use report::maps::{
    write_csv as write_map_csv, write_exr as write_map_exr, write_grid_csv as write_map_grid_csv,
};
pub use report::picture::{camera_attributes, write_exr as write_picture_exr};
pub use report::ply::write_ply as write_map_ply;
pub use report::spot::{Peak, SectionCell, SpotFigures, SpotStatistics};
pub use report::statistics::{GridStatistics, ReceiverStatistics};
pub use report::text::summary;
pub use report::uniformity::Uniformity;
pub use report::vtp::write_vtp as write_map_vtp;
// Studies:
pub use lab::certificate::{Certificate, Judge};
pub use lab::study::cells::Grids;
pub use lab::study::norms::Errors;
pub use lab::study::reference::{Reference, ReferencePlan, trace_replicate as trace_reference};
// Pictures:
pub use picture::{AnyPicture, Picture, PictureSummary, Watch, trace_picture};

/// The command `caustix`, with the arguments of the process.
#[cfg(feature = "cli")]
#[doc(hidden)]
pub use cli::main as command;
