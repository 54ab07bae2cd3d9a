//! Scenes from their parts.

use std::collections::BTreeSet;

use crate::emitter::{Colour, Emitter, Emitters};
use crate::error::{Diagnostic, Kind, Place};
use crate::geometry::{Geometry, Shape, Surface, coincident_surfaces};
use crate::surface::Material;

use super::camera::Camera;
use super::receiver::{Cells, MOST_CELLS, Receiver, ReceiverSpec};
use super::{Identity, Scene, check};

/// The parts of a scene so far. [`SceneBuilder::build`] makes the scene of them, or tells all that is wrong.
#[derive(Debug, Default)]
pub struct SceneBuilder {
    surfaces: Vec<(Surface, Material, Option<Place>)>,
    emitters: Vec<(String, Emitter, Colour, Option<Place>)>,
    receivers: Vec<(ReceiverSpec, Option<Place>)>,
    camera: Option<Camera>,
    compared_reflections: Option<u32>,
    place: Option<Place>,
}

impl SceneBuilder {
    /// A scene without parts.
    pub fn new() -> Self {
        Self::default()
    }

    /// Where the parts that follow stand in the file they come from: messages about them point there.
    pub fn at(&mut self, place: Place) -> &mut Self {
        self.place = Some(place);
        self
    }

    /// A surface of its own name and what it is made of.
    pub fn surface(&mut self, name: impl Into<String>, shape: Shape, material: Material) -> &mut Self {
        self.surfaces.push((Surface { name: name.into(), shape }, material, self.place));
        self
    }

    /// An emitter of white light, of its own name.
    pub fn emitter(&mut self, name: impl Into<String>, emitter: Emitter) -> &mut Self {
        self.coloured_emitter(name, emitter, Colour::WHITE)
    }

    /// An emitter of its own name.
    pub fn coloured_emitter(
        &mut self,
        name: impl Into<String>,
        emitter: Emitter,
        colour: Colour,
    ) -> &mut Self {
        self.emitters.push((name.into(), emitter, colour, self.place));
        self
    }

    /// A receiver.
    pub fn receiver(&mut self, receiver: ReceiverSpec) -> &mut Self {
        self.receivers.push((receiver, self.place));
        self
    }

    /// The camera, instead of any before.
    pub fn camera(&mut self, camera: Camera) -> &mut Self {
        self.camera = Some(camera);
        self
    }

    /// The fixed number of reflections of a comparison.
    pub fn compared_reflections(&mut self, reflections: u32) -> &mut Self {
        self.compared_reflections = Some(reflections);
        self
    }

    /// The scene of these parts.
    ///
    /// # Errors
    /// All that is wrong: names used twice, geometry that cannot be traced, coincident surfaces, an emitter on a surface or inside
    /// a closed dielectric, a receiver without area or on no surface, too many cells, no flux.
    pub fn build(self) -> Result<Scene, Vec<Diagnostic>> {
        let mut errors = self.names_used_twice();
        let (mut surfaces, mut materials, mut places) = (Vec::new(), Vec::new(), Vec::new());
        for (surface, bsdf, place) in self.surfaces {
            surfaces.push(surface);
            materials.push(bsdf);
            places.push(place);
        }
        // Neither of two surfaces in one place would be first.
        for ([_, second], e) in coincident_surfaces(&surfaces) {
            errors.push(e.placed(places[second]));
        }
        let geometry = match Geometry::build(surfaces) {
            Ok(geometry) => geometry,
            Err(e) => {
                errors.push(e);
                return Err(errors);
            }
        };
        let (mut receivers, mut cells) = (Vec::new(), 0u64);
        for (spec, place) in &self.receivers {
            let before = cells;
            match Receiver::new(spec, &geometry) {
                Ok(receiver) => {
                    cells +=
                        if let Cells::Grid { .. } = receiver.cells { receiver.cells.len() as u64 } else { 0 };
                    receivers.push(receiver);
                }
                Err(e) => errors.push(e.placed(*place)),
            }
            if before <= MOST_CELLS && cells > MOST_CELLS {
                let found = format!("the receiver `{}`, with which there are {cells} cells", spec.name());
                let required = "at most 2^26 cells in all receivers of a scene";
                errors.push(Diagnostic::new(Kind::Limit, found, required).placed(*place));
            }
        }
        let (mut emitter_names, mut emitters, mut emitter_colours) = (Vec::new(), Vec::new(), Vec::new());
        let mut starts = Vec::new();
        for (name, emitter, colour, place) in self.emitters {
            match check::start(&name, &emitter, &geometry, &materials) {
                Ok(start) => starts.push(start),
                Err(e) => errors.push(e.placed(place)),
            }
            emitter_names.push(name);
            emitters.push(emitter);
            emitter_colours.push(colour);
        }
        match Emitters::new(emitters) {
            Ok(emitters) if errors.is_empty() => Ok(Scene {
                geometry,
                emitters,
                receivers,
                emitter_names,
                compared_reflections: self.compared_reflections,
                camera: self.camera,
                identity: Identity::default(),
                warnings: Vec::new(),
                materials,
                starts,
                emitter_colours,
            }),
            Ok(_) => Err(errors),
            Err(e) => {
                errors.push(e.into());
                Err(errors)
            }
        }
    }

    /// An error for each name of emitters or receivers that is another's. (Surfaces' names are the geometry's to check.)
    fn names_used_twice(&self) -> Vec<Diagnostic> {
        let emitters = self.emitters.iter().map(|(name, _, _, place)| ("emitter", name.clone(), place));
        // Cases are not told apart: some file systems don't, and these names become file names.
        let receivers = self.receivers.iter().map(|(r, place)| ("receiver", r.name().to_lowercase(), place));
        let mut known = BTreeSet::new();
        let again = emitters.chain(receivers).filter(|(what, name, _)| !known.insert((*what, name.clone())));
        again
            .map(|(what, name, place)| {
                let found = format!("the {what} name `{name}` a second time");
                let required = format!("a name of its own for every {what}");
                Diagnostic::new(Kind::Range, found, required).placed(*place)
            })
            .collect()
    }
}
