//! One emitter, material or surface as its table says it.

use glam::DVec3;

use super::loader::Make;
use super::table::Placed;
use crate::emitter::{Colour, Emitter};
use crate::geometry::Shape;
use crate::scene::SurfaceOptions;
use crate::scene::media::Medium;
use crate::surface::Material;

pub(super) struct EmitterPart {
    pub name: String,
    pub colour: Colour,
    pub make: Make<Emitter>,
    /// The medium it stands in, where the scene names one; looked up when the materials are known.
    pub medium_name: Option<Placed<String>>,
    pub medium: Option<Medium>,
}

pub(super) struct MaterialPart {
    pub make: Make<Material>,
    /// The direction from which a table's azimuths are counted, where the scene gives one.
    pub reference: Option<DVec3>,
    /// Refractive index of a material that can name a medium.
    pub ior: Option<f64>,
}

pub(super) struct SurfacePart {
    pub name: String,
    /// Index of its material.
    pub material: usize,
    /// What counts what its file asks for.
    pub ask: Option<Make<()>>,
    pub shape: Make<Shape>,
    /// The word for a shape on which a receiver has a value a face.
    pub of_faces: Option<&'static str>,
    pub options: SurfaceOptions,
}
