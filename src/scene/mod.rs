//! Scenes: surfaces and what they are made of, emitters, receivers, a camera; checked once, and built for tracing.
//!
//! A [`SceneBuilder`] collects the parts, whose constructors refuse what cannot be, and checks what they are together. After
//! that nothing is checked again.

mod bodies;
pub mod builder;
pub mod camera;
pub mod check;
mod contacts;
mod endless;
mod facets;
pub mod far_field;
mod figure;
mod found;
pub mod inside;
pub mod media;
mod near_field;
pub mod nodes;
mod options;
pub mod evaluation;
pub mod receiver;
pub mod requires;
pub mod sheets;
mod sizes;
pub mod spot;
pub mod steps;
mod units;

use std::sync::OnceLock;

use glam::DVec3;

use crate::emitter::{Colour, Emitter, Emitters};
use crate::error::Diagnostic;
use crate::error::warning::Warning;
use crate::geometry::{Geometry, SurfaceId, Whereabouts};
use crate::surface::{self, Material};

pub use builder::SceneBuilder;
use camera::Camera;
use far_field::FarField;
use media::{Interface, Media};
pub use options::{Joint, SurfaceOptions};
use receiver::Receiver;

/// What a run needs to be repeated, beside its settings: where the scene comes from. Empty for one made in code.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Identity {
    /// The scene file's path as given.
    pub name: String,
    /// Its text.
    pub text: String,
    /// SHA-256 of the text, hexadecimal.
    pub sha256: String,
    /// (path as written in the scene, SHA-256 of the content), once for each part that names it, in their order.
    pub files: Vec<(String, String)>,
    /// SHA-256 of all that light depends on: everything but the camera, in a form that comments, layout and ways of writing
    /// a number do not change.
    pub light: String,
    /// SHA-256 of all that the results of given settings depend on, in the same form: everything but `[run]`.
    pub results: String,
}

/// A scene ready to be traced.
#[derive(Debug)]
pub struct Scene {
    /// Surfaces and the search structure over them.
    pub geometry: Geometry,
    /// Emitters.
    pub emitters: Emitters,
    /// Receivers, in the order of the scene.
    pub receivers: Vec<Receiver>,
    /// Far fields, in the order of the scene.
    pub far_fields: Vec<FarField>,
    /// Names of the emitters, in their order.
    pub emitter_names: Vec<String>,
    /// The fixed number of reflections of `[compare]`, where the scene names one.
    pub compared_reflections: Option<u32>,
    /// The camera, where the scene has one.
    pub camera: Option<Camera>,
    /// Where it comes from.
    pub identity: Identity,
    /// What is allowed but probably not meant.
    pub warnings: Vec<Diagnostic>,
    /// What was found when it was built and must be known beside its numbers: part of the warnings of every run.
    pub found: Vec<Warning>,
    /// Open surfaces that contradict each other.
    pub clashes: Vec<sheets::Clash>,
    /// What fills the space.
    pub media: Media,
    /// After how many total reflections in a row light is trapped: found when it is first asked for.
    pub trap_limit: OnceLock<u32>,
    /// The ambient medium at the camera.
    pub camera_ambient: media::MediumId,
    materials: Vec<Material>,
    starts: Vec<Whereabouts>,
    emitter_colours: Vec<Colour>,
}

impl Scene {
    /// What a surface is made of.
    #[inline]
    pub fn material(&self, surface: SurfaceId) -> &Material {
        &self.materials[surface.0 as usize]
    }

    /// What all surfaces are made of, by surface.
    pub fn materials(&self) -> &[Material] {
        &self.materials
    }

    /// Whether anything in it treats channels differently: then photons carry a weight for each.
    pub fn is_coloured(&self) -> bool {
        let has_colour = |colour: &Colour| *colour != Colour::WHITE;
        let [r, g, b] = self.camera.as_ref().map_or([0.0; 3], |camera| camera.background_cd_m2);
        self.materials.iter().any(Material::is_coloured)
            || self.emitter_colours.iter().any(has_colour)
            || r != g
            || g != b
    }

    /// The colour of an emitter's light: linear sRGB of luminance 1.
    #[inline]
    pub fn emitter_colour(&self, emitter: usize) -> [f64; 3] {
        // No index that could fail, so that a walk which carries no colour does not even look.
        self.emitter_colours.get(emitter).copied().unwrap_or_default().channels()
    }

    /// The side state of photons that leave an emitter.
    #[inline]
    pub fn start(&self, emitter: usize) -> Whereabouts {
        self.starts[emitter].clone()
    }

    /// Whether anything stands between `origin` (m) and the point `distance` (m) away along the unit vector `direction`, for
    /// a ray that starts in this state: any face but those with the same medium on both sides.
    pub fn is_hidden(
        &self,
        mut origin: DVec3,
        direction: DVec3,
        mut distance: f64,
        at: &Whereabouts,
    ) -> bool {
        if !self.media.may_vanish() {
            return self.geometry.occluded(origin, direction, distance, at);
        }
        let mut at = at.clone();
        loop {
            let hit = self.geometry.nearest(origin, direction, &at, &mut 0);
            let Some(hit) = hit.filter(|hit| hit.t < distance) else { return false };
            if self.media.reached(&hit, &at).interface != Interface::Nothing {
                return true;
            }
            self.media.leave(&mut at, &hit, hit.other_side());
            (origin, distance) = (hit.position, distance - hit.t);
        }
    }

    /// Bytes held by geometry, emitters and scattering tables.
    pub fn memory_bytes(&self) -> usize {
        let emitters: usize = self.emitters.as_slice().iter().map(Emitter::memory_bytes).sum();
        self.geometry.memory_bytes() + emitters + surface::memory_bytes(&self.materials)
    }
}
