//! Pictures: all that a camera needs. The receivers of a run with a camera count what they do without one.
//!
//! Two methods. `map`: photons are kept where they arrive, up to the camera's memory; their density,
//! estimated where eye paths end, makes pixels; then they are dropped and the next ones are traced (a pass).
//! `splat`: each arrival is joined to the pinhole while it is traced, without a density.
//!
//! [`trace_picture`] traces and makes the picture, [`picture_of_saved`] makes one of saved photons. After an
//! interrupt a picture is of the photons traced until then, in whole ranges of indices.
//!
//! The files in the order of use: [`photon_map`] keeps and finds photons; [`gather`] estimates luminance from
//! them, with error and bias; [`camera`] turns pixels into rays and what they find into a film; [`summary`]
//! says how good it is, [`warnings`] what is wrong with it; [`passes`] leads photons of a run through all of these.

pub mod photon_map;
pub mod gather;
pub mod camera;
pub mod summary;
pub mod passes;
pub mod warnings;

use std::sync::atomic::AtomicBool;
use std::time::Instant;

use crate::error::{Diagnostic, Kind, Result};
use crate::math::digest::sha256_hex;
use crate::run::{Outcome, Plan, trace_by};
use crate::scene::Scene;
use crate::scene::camera::{Camera, Method};
use crate::surface::{Grey, Rgb};

use camera::splat::Splat;
use camera::{Film, View, film};
use passes::budget::capacity;
use passes::collector::Collector;
use photon_map::{Channels, SavedMap};
pub use summary::{Chosen, PictureSummary};
pub use warnings::{probe, warnings};

/// A picture of `C` channels: 1 or 3.
#[derive(Debug)]
pub struct Picture<const C: usize> {
    /// Its pixels, with standard error and bias, cd/m2.
    pub film: Film<C>,
    /// How it was made, and how good it is.
    pub summary: PictureSummary,
    /// The photons it was made of, in an order that does not depend on threads, where they were asked for.
    pub photons: Option<SavedMap<C>>,
}

/// A picture in one channel or three.
#[derive(Debug)]
pub enum AnyPicture {
    /// Luminance, of a scene without colour.
    Grey(Picture<1>),
    /// Linear sRGB whose Y is luminance.
    Rgb(Picture<3>),
}

impl AnyPicture {
    /// How it was made.
    pub fn summary(&self) -> &PictureSummary {
        match self {
            Self::Grey(picture) => &picture.summary,
            Self::Rgb(picture) => &picture.summary,
        }
    }
}

/// How a run is watched and stopped.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Set from outside to stop.
    pub interrupt: &'a AtomicBool,
    /// Told the number of photons after each batch.
    pub photons: &'a (dyn Fn(u64) + Sync),
    /// Told which part of a pass's pixels is done, 0 to 1.
    pub camera: &'a (dyn Fn(f64) + Sync),
}

/// What photons depend on: the scene but for its camera, the files it names, and the run's settings. Maps of
/// other photons have another hash.
pub fn hash_of_photons(scene: &Scene, plan: &Plan) -> String {
    let mut all = format!("{}\n{}\n", env!("CARGO_PKG_VERSION"), settings_of(plan));
    all += &scene.identity.light;
    sha256_hex(all.as_bytes())
}

/// The settings of a run in words.
fn settings_of(plan: &Plan) -> String {
    let algorithm = plan.algorithm();
    let way = if algorithm.variant.rejects() { algorithm.rejection.name() } else { algorithm.solver.name() };
    format!(
        "{} {way} {} seed {} {} x {} photons",
        algorithm.variant.name(),
        algorithm.sequence.name(),
        plan.seed(),
        plan.replicates(),
        plan.photons_per_replicate()
    )
}

/// The camera of a scene, for those who know that it has one.
///
/// # Errors
/// A scene without.
fn camera_of(scene: &Scene) -> Result<&Camera> {
    scene.camera.as_ref().ok_or_else(|| {
        Diagnostic::new(Kind::Missing, "a scene without a camera", "a scene with [camera] for a picture")
    })
}

/// Bytes that the picture of a camera takes while it is made, beside the photons: pixels and their sums.
pub fn memory_bytes(camera: &Camera, is_coloured: bool) -> u64 {
    match (camera.method, is_coloured) {
        (Method::Map, false) => Film::<1>::memory_bytes(camera.pixels),
        (Method::Map, true) => Film::<3>::memory_bytes(camera.pixels),
        (Method::Splat, false) => Splat::<1>::memory_bytes(camera.pixels),
        (Method::Splat, true) => Splat::<3>::memory_bytes(camera.pixels),
    }
}

/// What cannot be done with the camera of a scene, told before anything is allocated or traced. A scene
/// without one passes.
///
/// # Errors
/// A picture that takes more memory than pictures may; a camera that sees nothing (on a surface).
pub fn check(scene: &Scene) -> Result<()> {
    let Some(camera) = &scene.camera else { return Ok(()) };
    film::check_memory(camera.pixels, memory_bytes(camera, scene.is_coloured()))?;
    View::new(scene, camera, 0).map(|_| ())
}

/// Traces a scene with a camera by a plan, on the current rayon pool, and makes its picture. The outcome is
/// that of [`crate::run::trace`]. With `keep` the picture's photons are handed out too.
///
/// # Errors
/// Those of [`crate::run::trace`]; no camera, one that `check` refuses, or one that sees nothing (on a
/// surface); `keep` and more photons than the camera's memory holds.
pub fn trace_picture(
    scene: &Scene,
    plan: &Plan,
    keep: bool,
    watch: Watch<'_>,
) -> Result<(Outcome, AnyPicture)> {
    let camera = camera_of(scene)?;
    check(scene)?;
    if scene.is_coloured() {
        let (outcome, picture) = with_channels::<3, _>(scene, camera, plan, keep, watch, Rgb::WHITE)?;
        Ok((outcome, AnyPicture::Rgb(picture)))
    } else {
        let (outcome, picture) = with_channels::<1, _>(scene, camera, plan, keep, watch, Grey)?;
        Ok((outcome, AnyPicture::Grey(picture)))
    }
}

fn with_channels<const C: usize, T: Channels<C>>(
    scene: &Scene,
    camera: &Camera,
    plan: &Plan,
    keep: bool,
    watch: Watch<'_>,
    carried: T,
) -> Result<(Outcome, Picture<C>)> {
    match camera.method {
        Method::Map => {
            let mut collector = Collector::new(scene, camera, plan, keep, watch)?;
            let outcome = trace_by(
                scene,
                plan,
                |tracer, end, receivers| collector.stage(tracer, end, receivers, carried),
                watch.interrupt,
            )?;
            Ok((outcome, collector.finish()?))
        }
        Method::Splat => passes::splat::trace(scene, camera, plan, watch, carried),
    }
}

/// Whether a scene's camera can see photons that another run saved; told before anything is made of them.
///
/// # Errors
/// No camera, one that [`check`] refuses, or one that splats; photons of a surface that the scene does not
/// have; more than the camera's memory holds.
pub fn check_saved<const C: usize>(scene: &Scene, saved: &SavedMap<C>) -> Result<()> {
    let camera = camera_of(scene)?;
    check(scene)?;
    let refuse = |found: &str, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
    if camera.method == Method::Splat {
        return refuse(
            "method \"splat\" and photons from a file",
            "method = \"map\": splatting joins photons to the pinhole while they are traced",
        );
    }
    let primitives = scene.geometry.primitive_count() as u64;
    if saved.photons.iter().any(|p| u64::from(p.primitive) >= primitives) {
        return refuse("photons on surfaces that this scene does not have", "photons of the same scene");
    }
    let (number, most) = (saved.photons.len(), capacity::<C>(camera));
    if number > most {
        let required = format!("at most {most}, for which the camera has memory");
        return Err(Diagnostic::new(Kind::Limit, format!("{number} saved photons"), required)
            .hint("a photon_memory_mb as large as that of the run that saved them"));
    }
    Ok(())
}

/// The picture of photons that another run of the same scene saved.
///
/// # Errors
/// Those of [`check_saved`].
pub fn picture_of_saved<const C: usize>(
    scene: &Scene,
    plan: &Plan,
    saved: SavedMap<C>,
    watch: Watch<'_>,
) -> Result<Picture<C>> {
    check_saved(scene, &saved)?;
    let started = Instant::now();
    let mut collector = Collector::new(scene, camera_of(scene)?, plan, false, watch)?;
    collector.adopt(saved);
    let mut picture = collector.finish()?;
    picture.summary.time_s = started.elapsed().as_secs_f64();
    Ok(picture)
}
