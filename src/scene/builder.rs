//! Scenes from their parts.

use std::collections::BTreeSet;
use std::sync::OnceLock;

use crate::emitter::{Colour, Emitter, Emitters};
use crate::error::warning::Warning;
use crate::error::{Diagnostic, Kind, Place};
use crate::geometry::{Bond, Geometry, Mesh, Shape, Surface};
use crate::surface::Material;

use super::camera::Camera;
use super::far_field::{FarField, FarFieldSpec};
use super::media::{Media, Medium};
use super::options::SurfaceOptions;
use super::receiver::{MOST_CELLS, Receiver, ReceiverSpec};
use super::{Identity, Scene, check, contacts, endless, found};

#[derive(Debug)]
struct EmitterPart {
    name: String,
    emitter: Emitter,
    colour: Colour,
    /// The medium it stands in, where that is told.
    medium: Option<Medium>,
    place: Option<Place>,
}

/// The parts of a scene so far. [`SceneBuilder::build`] makes the scene of them, or tells all that is wrong.
#[derive(Debug, Default)]
pub struct SceneBuilder {
    surfaces: Vec<(Surface, Material, SurfaceOptions, Option<Place>)>,
    emitters: Vec<EmitterPart>,
    receivers: Vec<(ReceiverSpec, Option<Place>)>,
    far_fields: Vec<(FarFieldSpec, Option<Place>)>,
    camera: Option<Camera>,
    camera_medium: Option<Medium>,
    ambient: Option<Medium>,
    compared_reflections: Option<u32>,
    told: Vec<Warning>,
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
        self.surface_with(name, shape, material, SurfaceOptions::default())
    }

    /// A surface that says how it goes with others.
    pub fn surface_with(
        &mut self,
        name: impl Into<String>,
        shape: Shape,
        material: Material,
        options: SurfaceOptions,
    ) -> &mut Self {
        self.surfaces.push((Surface { name: name.into(), shape }, material, options, self.place));
        self
    }

    /// The medium in which the scene lies, instead of air.
    pub fn ambient(&mut self, medium: Medium) -> &mut Self {
        self.ambient = Some(medium);
        self
    }

    /// The medium in which the last emitter stands, where it is behind an open transparent surface. (In a body it need not
    /// be told.)
    pub fn emitter_in(&mut self, medium: Medium) -> &mut Self {
        if let Some(part) = self.emitters.last_mut() {
            part.medium = Some(medium);
        }
        self
    }

    /// The medium in which the camera stands, likewise.
    pub fn camera_in(&mut self, medium: Medium) -> &mut Self {
        self.camera_medium = Some(medium);
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
        let (name, place) = (name.into(), self.place);
        self.emitters.push(EmitterPart { name, emitter, colour, medium: None, place });
        self
    }

    /// A receiver.
    pub fn receiver(&mut self, receiver: ReceiverSpec) -> &mut Self {
        self.receivers.push((receiver, self.place));
        self
    }

    /// A far field.
    pub fn far_field(&mut self, far_field: FarFieldSpec) -> &mut Self {
        self.far_fields.push((far_field, self.place));
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

    /// A warning of every run of the scene, beside what is found when it is built.
    pub(crate) fn tell(&mut self, warning: Warning) -> &mut Self {
        self.told.push(warning);
        self
    }

    /// The scene of these parts.
    ///
    /// # Errors
    /// All that is wrong: names used twice, geometry that cannot be traced, surfaces in one place or bodies that overlap where
    /// no rule says which is first, an emitter on a surface or across one, light that never ends, a receiver without area
    /// or on no surface, too many cells, no flux.
    pub fn build(self) -> Result<Scene, Vec<Diagnostic>> {
        let mut errors = self.names_used_twice();
        let (mut surfaces, mut materials) = (Vec::new(), Vec::new());
        let (mut options, mut places, mut bonds) = (Vec::new(), Vec::new(), Vec::new());
        for (surface, material, option, place) in self.surfaces {
            let is_clear = material.is_transparent();
            surfaces.push(if is_clear { outward(surface) } else { surface });
            materials.push(material);
            bonds.push(Bond { is_glued: contacts::is_glued(&option), is_clear });
            options.push(option);
            places.push(place);
        }
        let geometry = match Geometry::joined(surfaces, &bonds) {
            Ok(geometry) => geometry,
            Err(e) => {
                errors.push(e);
                return Err(errors);
            }
        };
        for (surface, e) in contacts::errors(&geometry, &materials, &options) {
            errors.push(e.placed(places[surface.0 as usize]));
        }
        let warnings = contacts::warnings(&geometry, &materials, &options);
        let warnings = warnings.into_iter().map(|(s, w)| w.placed(places[s.0 as usize])).collect();
        let ambient = self.ambient.unwrap_or_else(Medium::air);
        let mut media = Media::new(ambient, &geometry, &materials, &options);
        let (mut receivers, mut cells) = (Vec::new(), 0u64);
        for (spec, place) in &self.receivers {
            match Receiver::new(spec, &geometry) {
                Ok(receiver) => {
                    cells += receiver.cells.len() as u64;
                    cells += receiver.grid.map_or(0, |grid| grid.cells() as u64);
                    cells += receiver.spot.map_or(0, |spot| spot.cells() as u64);
                    receivers.push(receiver);
                }
                Err(e) => errors.push(e.placed(*place)),
            }
            // Those after it would take memory for nothing.
            if cells > MOST_CELLS {
                let found = format!("the receiver `{}`, with which there are {cells} cells", spec.name());
                let required = "at most 2^26 cells in all receivers of a scene";
                errors.push(Diagnostic::new(Kind::Limit, found, required).placed(*place));
                break;
            }
        }
        let (mut far_fields, mut nodes) = (Vec::new(), 0u64);
        for (spec, place) in &self.far_fields {
            match FarField::new(spec, &geometry) {
                Ok(far_field) => {
                    nodes += far_field.nodes.count() as u64;
                    far_fields.push(far_field);
                }
                Err(e) => errors.push(e.placed(*place)),
            }
            if nodes > MOST_CELLS {
                let found = format!("the far field `{}`, with which there are {nodes} nodes", spec.name());
                let required = "at most 2^26 nodes in all far fields of a scene";
                errors.push(Diagnostic::new(Kind::Limit, found, required).placed(*place));
                break;
            }
        }
        let (mut emitter_names, mut emitters, mut emitter_colours) = (Vec::new(), Vec::new(), Vec::new());
        let mut starts = Vec::new();
        for EmitterPart { name, emitter, colour, medium, place } in self.emitters {
            let ambient = medium.map_or(0, |medium| media.number(medium));
            match check::start(&name, &emitter, &geometry) {
                Ok(start) => starts.push(start.in_ambient(ambient)),
                Err(e) => errors.push(e.placed(place)),
            }
            let endless = endless::refusal(&name, &emitter, &geometry, &materials);
            errors.extend(endless.map(|e| e.placed(place)));
            emitter_names.push(name);
            emitters.push(emitter);
            emitter_colours.push(colour);
        }
        let camera_ambient = self.camera_medium.map_or(0, |medium| media.number(medium));
        match Emitters::new(emitters) {
            Ok(emitters) if errors.is_empty() => {
                let mut scene = Scene {
                    geometry,
                    emitters,
                    receivers,
                    far_fields,
                    emitter_names,
                    compared_reflections: self.compared_reflections,
                    camera: self.camera,
                    identity: Identity::default(),
                    warnings,
                    found: Vec::new(),
                    clashes: Vec::new(),
                    media,
                    trap_limit: OnceLock::new(),
                    camera_ambient,
                    materials,
                    starts,
                    emitter_colours,
                };
                // Paths of a fixed number of reflections end.
                if self.compared_reflections.is_none()
                    && let Some((surface, e)) = endless::of_room(&scene)
                {
                    return Err(vec![e.placed(places[surface.0 as usize])]);
                }
                (scene.clashes, scene.found) = found::look(&scene, &options);
                scene.found.extend(self.told);
                Ok(scene)
            }
            Ok(_) => Err(errors),
            Err(e) => {
                errors.push(e.into());
                Err(errors)
            }
        }
    }

    /// An error for each name of emitters or receivers that is another's. (Surfaces' names are the geometry's to check.)
    fn names_used_twice(&self) -> Vec<Diagnostic> {
        let emitters =
            self.emitters.iter().map(|part| ("emitter", part.name.clone(), part.name.as_str(), &part.place));
        // Cases are not told apart: some file systems don't, and these names become file names.
        let receivers =
            self.receivers.iter().map(|(r, place)| ("receiver", r.name().to_uppercase(), r.name(), place));
        let far_fields =
            self.far_fields.iter().map(|(f, place)| ("far field", f.name().to_uppercase(), f.name(), place));
        let mut known = BTreeSet::new();
        let all = emitters.chain(receivers).chain(far_fields);
        let again = all.filter(|(what, key, ..)| !known.insert((*what == "emitter", key.clone())));
        again
            .map(|(what, _, name, place)| {
                let found = format!("the {what} name `{name}` a second time");
                let required = format!("a name of its own for every {what}");
                Diagnostic::new(Kind::Range, found, required).placed(*place)
            })
            .collect()
    }
}

/// The surface of a body with its front outside, which is the same body.
fn outward(surface: Surface) -> Surface {
    let is_inward = |mesh: &Mesh| mesh.topology().is_closed() && mesh.topology().signed_volume_m3 < 0.0;
    match surface.shape {
        Shape::Mesh(mesh) if is_inward(&mesh) => Surface { shape: mesh.reversed().into(), ..surface },
        shape => Surface { shape, ..surface },
    }
}
