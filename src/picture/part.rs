//! Photons of a part of a run, kept for a picture that is made when all parts are together.
//!
//! The camera sees the photons of all parts in one pass, as if one run had kept them ([`super::picture_of_saved`]); so
//! they have to fit into its memory together.

use std::io::{self, Read, Write};

use crate::error::{Diagnostic, Kind, Result};
use crate::math::varint::{expect, put, take_up_to};
use crate::run::Plan;
use crate::run::together::{Together, Watched};
use crate::scene::Scene;
use crate::scene::camera::Method;
use crate::surface::{Grey, Rgb};

use super::passes::budget::{capacity, with_reserve};
use super::photon_map::{Channels, Photon, PhotonStore, SavedMap};
use super::{AnyPicture, Watch, camera_of, check, hash_of_photons, picture_of_saved, settings_of};

/// Kept photons of a part, in one channel or three.
#[derive(Debug)]
pub enum AnyPhotons {
    /// Of a scene without colour.
    Grey(Photons<1>),
    /// In linear sRGB.
    Rgb(Photons<3>),
}

/// Kept photons of a part.
#[derive(Debug)]
pub struct Photons<const C: usize> {
    store: PhotonStore<C>,
    kept: Vec<Photon<C>>,
    /// Most that the camera has memory for.
    most: usize,
}

impl AnyPhotons {
    /// None yet, for the camera of a scene.
    ///
    /// # Errors
    /// A camera that cannot see, or whose picture is not made of kept photons.
    pub fn new(scene: &Scene) -> Result<Self> {
        check(scene)?;
        let camera = camera_of(scene)?;
        if camera.method == Method::Splat {
            let required =
                "method = \"map\", or a run in one piece: the sums of splats are not kept by parts";
            return Err(Diagnostic::new(Kind::Range, "a part of a picture with method \"splat\"", required));
        }
        Ok(match scene.is_coloured() {
            true => Self::Rgb(Photons::new(scene, capacity::<3>(camera))),
            false => Self::Grey(Photons::new(scene, capacity::<1>(camera))),
        })
    }

    /// Takes a run on to this index ([`Together::trace`]), and keeps what its camera will see.
    ///
    /// # Errors
    /// Those of tracing; more photons than the camera has memory for.
    pub fn trace(&mut self, run: &mut Together<'_>, end: u64, watched: Watched<'_>) -> Result<bool> {
        match self {
            Self::Grey(photons) => photons.trace(run, end, watched, Grey),
            Self::Rgb(photons) => photons.trace(run, end, watched, Rgb::WHITE),
        }
    }

    /// Writes them.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Grey(photons) => photons.write(out),
            Self::Rgb(photons) => photons.write(out),
        }
    }

    /// Adds those that were written.
    ///
    /// # Errors
    /// Those of the reader; photons of another scene.
    pub fn add_from(&mut self, scene: &Scene, from: &mut dyn Read) -> io::Result<()> {
        match self {
            Self::Grey(photons) => photons.add_from(scene, from),
            Self::Rgb(photons) => photons.add_from(scene, from),
        }
    }

    /// The picture of the photons of all parts.
    ///
    /// # Errors
    /// Those of [`picture_of_saved`]; photons that a run in one piece would have shown to the camera in several passes.
    pub fn picture(self, scene: &Scene, plan: &Plan, watch: Watch<'_>) -> Result<AnyPicture> {
        Ok(match self {
            Self::Grey(photons) => {
                AnyPicture::Grey(picture_of_saved(scene, plan, photons.saved(scene, plan)?, watch)?)
            }
            Self::Rgb(photons) => {
                AnyPicture::Rgb(picture_of_saved(scene, plan, photons.saved(scene, plan)?, watch)?)
            }
        })
    }
}

impl<const C: usize> Photons<C> {
    fn new(scene: &Scene, most: usize) -> Self {
        Self { store: PhotonStore::new(scene), kept: Vec::new(), most }
    }

    fn trace<T: Channels<C>>(
        &mut self,
        run: &mut Together<'_>,
        end: u64,
        Watched { interrupt, progress }: Watched<'_>,
        carried: T,
    ) -> Result<bool> {
        self.store.limit(self.most.saturating_sub(self.kept.len()));
        let store = &self.store;
        let is_complete = run.trace_by(end, |tracer, end, receivers| {
            let replicate = tracer.points.replicate;
            tracer.trace_into(end, carried, || store.sink(receivers.sink(), replicate), interrupt, progress)
        })?;
        match self.store.take() {
            Some(kept) => self.kept.extend(kept.into_iter().flatten().flatten()),
            None => return Err(too_many(self.most)),
        }
        Ok(is_complete)
    }

    fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [C as u64, self.kept.len() as u64])?;
        Photon::write_all(&self.kept, out)
    }

    fn add_from(&mut self, scene: &Scene, from: &mut dyn Read) -> io::Result<()> {
        expect(from, C as u64, "channels")?;
        let room = self.most.saturating_sub(self.kept.len()) as u64;
        let why = "photons, for which the camera has no memory: a larger photon_memory_mb";
        for _ in 0..take_up_to(from, room, why)? {
            self.kept.push(Photon::read(from, scene.geometry.primitive_count())?);
        }
        Ok(())
    }

    fn saved(self, scene: &Scene, plan: &Plan) -> Result<SavedMap<C>> {
        // As many as one run would be sure to hold at a time: it foretells with a reserve.
        if with_reserve(self.kept.len() as f64) > self.most as f64 {
            return Err(too_many(self.most));
        }
        Ok(SavedMap {
            scene_hash: hash_of_photons(scene, plan),
            settings: settings_of(plan),
            photons_traced: plan.photons(),
            replicates: plan.replicates(),
            photon_lm: scene.emitters.flux_lm() / plan.photons() as f64,
            frame: self.store.frame(),
            photons: self.kept,
        })
    }
}

fn too_many(most: usize) -> Diagnostic {
    let found = format!("more than {most} photons for the camera, less a reserve of an eighth");
    let required =
        "no more in all parts than the camera has memory for: a run in parts sees them in one pass";
    Diagnostic::new(Kind::Limit, found, required).hint("a larger photon_memory_mb, or fewer photons")
}
