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
pub mod part;
pub mod summary;
pub mod passes;
pub mod warnings;

use std::io::{self, Read};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use crate::error::{Diagnostic, Kind, Result};
use crate::math::digest::sha256_hex;
use crate::run::together::Watched;
use crate::run::turns::{KeepTurns, Stage, Turns, Unkept};
use crate::run::{Outcome, Plan};
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
    trace_picture_from(Turns::new(scene, plan)?, None, keep, watch, &Unkept)
}

/// The same of a run that has begun, or goes on from what `state` holds; what there is is kept as `kept` asks.
///
/// # Errors
/// As [`trace_picture`]; a state of another run.
pub fn trace_picture_from(
    turns: Turns<'_>,
    state: Option<&mut dyn Read>,
    hand_out: bool,
    watch: Watch<'_>,
    kept: &dyn KeepTurns,
) -> Result<(Outcome, AnyPicture)> {
    let scene = turns.scene();
    check(scene)?;
    if scene.is_coloured() {
        let (outcome, picture) = with_channels::<3, _>(turns, state, hand_out, watch, kept, Rgb::WHITE)?;
        Ok((outcome, AnyPicture::Rgb(picture)))
    } else {
        let (outcome, picture) = with_channels::<1, _>(turns, state, hand_out, watch, kept, Grey)?;
        Ok((outcome, AnyPicture::Grey(picture)))
    }
}

fn with_channels<const C: usize, T: Channels<C>>(
    mut turns: Turns<'_>,
    state: Option<&mut dyn Read>,
    hand_out: bool,
    watch: Watch<'_>,
    kept: &dyn KeepTurns,
    carried: T,
) -> Result<(Outcome, Picture<C>)> {
    let (scene, plan) = (turns.scene(), *turns.plan());
    let camera = camera_of(scene)?;
    if camera.method == Method::Splat {
        return passes::splat::trace(turns, state, camera, watch, kept, carried);
    }
    let mut collector = Collector::new(scene, camera, &plan, hand_out, watch, kept)?;
    if let Some(from) = state {
        turns.read(from).and_then(|()| collector.read(from)).map_err(|e| not_of_this(&e))?;
    }
    let watched = Watched { interrupt: watch.interrupt, progress: watch.photons };
    turns.run(watched, &mut Mapped { collector: &mut collector, carried })?;
    let picture = collector.finish(&turns)?;
    Ok((turns.finish()?, picture))
}

/// A state that holds something else than this run.
pub fn not_of_this(error: &io::Error) -> Diagnostic {
    let required = "a state of this scene, with its camera, and of these settings";
    Diagnostic::new(Kind::Syntax, format!("a state that holds {error}"), required)
}

/// Photons that a collector keeps.
struct Mapped<'c, 'a, const C: usize, T> {
    collector: &'c mut Collector<'a, C>,
    carried: T,
}

impl<const C: usize, T: Channels<C>> Stage for Mapped<'_, '_, C, T> {
    fn stage(&mut self, turns: &mut Turns<'_>, end: u64) -> Result<bool> {
        self.collector.stage(turns, end, self.carried)
    }

    /// A collector keeps what there is after every range of photons.
    fn turned(&mut self, _: &Turns<'_>) {}
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
    let mut collector = Collector::new(scene, camera_of(scene)?, plan, false, watch, &Unkept)?;
    collector.adopt(saved);
    let mut picture = collector.finish(&Turns::new(scene, plan)?)?;
    picture.summary.time_s = started.elapsed().as_secs_f64();
    Ok(picture)
}
