//! Scenes: what is read from a scene file, checked once, and built for tracing.
//!
//! [`mod@file`] reads the text into a [`description`]; [`build`] loads the files it names and makes a [`Scene`]: surfaces with
//! what they are made of, emitters, receivers. After that nothing is checked again.

pub mod camera;
pub mod check;
pub mod receiver;
pub mod requires;

use crate::emitter::colour::WHITE;
use crate::emitter::{Emitter, Emitters};
use crate::error::{Diagnostic, Result};
use crate::geometry::{Geometry, Surface, SurfaceId, Whereabouts};
use crate::surface::{self, Material};

use crate::files::scene_toml::description::Place;
use camera::CameraSpec;
use receiver::{Receiver, ReceiverSpec};

/// What a run needs to be repeated, beside its settings: the scene and the hashes of the files it names.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Identity {
    /// The scene file's path as given.
    pub name: String,
    /// Its text.
    pub text: String,
    /// SHA-256 of the text, hexadecimal.
    pub sha256: String,
    /// (path as written in the scene, SHA-256 of the content), in the order of the scene.
    pub files: Vec<(String, String)>,
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
    /// Names of the emitters, in their order.
    pub emitter_names: Vec<String>,
    /// The fixed number of reflections of `[compare]`, where the scene names one.
    pub compared_reflections: Option<u32>,
    /// The camera, where the scene has one.
    pub camera: Option<CameraSpec>,
    /// Where it comes from.
    pub identity: Identity,
    /// What is allowed but probably not meant.
    pub warnings: Vec<Diagnostic>,
    materials: Vec<Material>,
    starts: Vec<Whereabouts>,
    emitter_colours: Vec<[f64; 3]>,
}

/// The parts of a scene, for those who build one in code.
#[derive(Debug, Default)]
pub struct SceneParts {
    /// Surfaces and what they are made of.
    pub surfaces: Vec<(Surface, Material)>,
    /// Emitters with their names.
    pub emitters: Vec<(String, Emitter)>,
    /// Colours of the emitters, linear sRGB of luminance 1 ([`crate::emitter::colour`]); emitters beyond the last are white.
    pub emitter_colours: Vec<[f64; 3]>,
    /// Receivers.
    pub receivers: Vec<ReceiverSpec>,
    /// The fixed number of reflections of `[compare]`, if there is one.
    pub compared_reflections: Option<u32>,
    /// The camera, if there is one.
    pub camera: Option<CameraSpec>,
    /// Where the scene comes from; empty for one made in code.
    pub identity: Identity,
    /// Warnings so far.
    pub warnings: Vec<Diagnostic>,
    /// Where surfaces, emitters and receivers stand in the scene file, for messages; empty for a scene made in code.
    pub places: Places,
}

/// Where the parts of a scene stand in its file, each in the order of the parts.
#[derive(Debug, Default)]
pub struct Places {
    /// Of surfaces.
    pub surfaces: Vec<Place>,
    /// Of emitters.
    pub emitters: Vec<Place>,
    /// Of receivers.
    pub receivers: Vec<Place>,
    /// Of the camera, where there is one.
    pub camera: Option<Place>,
}

impl Scene {
    /// A scene of these parts, checked.
    ///
    /// # Errors
    /// All that is wrong: geometry that cannot be traced, coincident surfaces, an emitter on a surface or inside a
    /// closed dielectric, a receiver without area or on no surface, no flux.
    pub fn new(parts: SceneParts) -> std::result::Result<Self, Vec<Diagnostic>> {
        let (surfaces, materials): (Vec<_>, Vec<_>) = parts.surfaces.into_iter().unzip();
        let (emitter_names, emitters): (Vec<_>, Vec<_>) = parts.emitters.into_iter().unzip();
        let mut errors = check::coincidences(&surfaces, &parts.places.surfaces);
        let geometry =
            Geometry::build(surfaces).map_err(|e| [std::mem::take(&mut errors), vec![e]].concat())?;
        let keep = |result: Result<_>, errors: &mut Vec<Diagnostic>| result.map_err(|e| errors.push(e)).ok();
        let receivers: Vec<Receiver> = parts
            .receivers
            .iter()
            .enumerate()
            .filter_map(|(i, spec)| {
                let receiver = Receiver::new(spec, &geometry);
                keep(receiver.map_err(|e| check::at_place(&parts.places.receivers, i, e)), &mut errors)
            })
            .collect();
        let mut starts = Vec::with_capacity(emitters.len());
        for (i, (name, emitter)) in emitter_names.iter().zip(&emitters).enumerate() {
            match check::start(name, emitter, &geometry, &materials) {
                Ok(start) => starts.push(start),
                Err(e) => errors.push(check::at_place(&parts.places.emitters, i, e)),
            }
        }
        let emitters = Emitters::new(emitters).map_err(|e| errors.push(e)).ok();
        match emitters {
            Some(emitters) if errors.is_empty() => Ok(Self {
                geometry,
                emitters,
                receivers,
                emitter_names,
                compared_reflections: parts.compared_reflections,
                camera: parts.camera,
                identity: parts.identity,
                warnings: parts.warnings,
                materials,
                starts,
                emitter_colours: parts.emitter_colours,
            }),
            _ => Err(errors),
        }
    }

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
        let has_colour = |colour: &[f64; 3]| *colour != WHITE;
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
        self.emitter_colours.get(emitter).copied().unwrap_or(WHITE)
    }

    /// The side state of photons that leave an emitter.
    #[inline]
    pub fn start(&self, emitter: usize) -> Whereabouts {
        self.starts[emitter]
    }

    /// Bytes held by geometry, emitters and scattering tables.
    pub fn memory_bytes(&self) -> usize {
        let emitters: usize = self.emitters.as_slice().iter().map(Emitter::memory_bytes).sum();
        self.geometry.memory_bytes() + emitters + surface::memory_bytes(&self.materials)
    }
}
