//! Scattering by a table (METHOD 4): two coordinates, by inverse functions.
//!
//! Scene text: `type = "tabulated"`, `file`, `side`, `rotation_deg`, `energy`, `specular_remainder`.
//!
//! **Contract.** Directions wi and wo are unit and point away from the surface; [`crate::scattering::table`]
//! defines the frames of the table. Light from wi is scattered with the probability [`Tabulated::albedo`],
//! the integral of g = f cos(theta_o), into wo with the density g / albedo per steradian
//! ([`Tabulated::projected`]). The rest is absorbed or, on demand, mirrored (passes straight on, where the
//! table transmits).
//!
//! **Between angles.** The slices about (theta_i, phi_i) mix linearly in the frame of the actual incidence,
//! in which the lobe stands still; before the first and beyond the last theta_i that slice holds. Albedo,
//! value, density and sample are those of the mixture.
//!
//! **Horizon.** A cell that crosses the horizon, or a lobe that turned with the incidence, sends light where
//! there is only the surface: it is absorbed and counted. The density covers that part too, so it integrates
//! to 1 over all wo, not over the hemisphere; f is 0 there.
//!
//! **Normals.** The facet's normal is used, as for Lambertian surfaces.

mod arrival;
mod branch;
pub(crate) mod energy;
mod face;
mod layer;
mod model;
mod options;
mod scatter;

use std::sync::Arc;

use glam::DVec3;

use crate::error::{Diagnostic, Kind, Result};
use crate::scattering::ScatterTable;
use crate::scattering::reciprocity::{self, WithCosine};
use crate::surface::Reference;

use arrival::Arrival;
use branch::Lobes;
use face::{Face, faces};
use layer::Layer;

pub use options::{Energy, Options, Sides};

/// A surface made of a scattering table. Copies share the table.
#[derive(Debug, Clone)]
pub struct Tabulated {
    layers: Arc<[Layer]>,
    /// For light from the front and from the back.
    faces: [Face; 2],
    reference: Reference,
    /// (sin, cos) of the rotation.
    turn: (f64, f64),
    /// What speaks for values that were multiplied by the cosine.
    with_cosine: Option<WithCosine>,
}

impl Tabulated {
    /// Builds the samplers of a table; the warnings are those of its energy.
    ///
    /// # Errors
    /// An albedo above 1, unless `energy` allows it; a reference without direction or a rotation that is not
    /// finite; a table too large.
    pub fn new(table: &ScatterTable, options: &Options) -> Result<(Self, Vec<Diagnostic>)> {
        if !options.rotation_deg.is_finite() {
            let found = format!("rotation_deg {}", options.rotation_deg);
            return Err(Diagnostic::new(Kind::Range, found, "a finite angle"));
        }
        let mut layers = table.lobes.iter().map(Layer::new).collect::<Result<Vec<_>>>()?;
        let faces = faces(table, &layers, options);
        let warnings = energy::check(&mut layers, &faces, options.energy)?;
        let turn = libm::sincos(options.rotation_deg.to_radians());
        let (reference, with_cosine) = (Reference::default(), reciprocity::with_cosine(table));
        let this = Self { layers: layers.into(), faces, reference, turn, with_cosine };
        Ok((this.with_reference(options.reference)?, warnings))
    }

    /// Where the table breaks reciprocity as one that holds f times the cosine does.
    pub fn with_cosine(&self) -> Option<WithCosine> {
        self.with_cosine
    }

    /// The same table on a surface with another reference direction.
    ///
    /// # Errors
    /// A reference without direction.
    pub fn with_reference(&self, reference: Reference) -> Result<Self> {
        Ok(Self { reference: reference.normalised()?, ..self.clone() })
    }

    fn face(&self, from_front: bool) -> &Face {
        &self.faces[usize::from(!from_front)]
    }

    /// The table's reference direction on a facet with this outward normal, of any length.
    #[inline]
    fn along(&self, outward: DVec3) -> DVec3 {
        let x = self.reference.along(outward);
        let (sin, cos) = self.turn;
        cos * x + sin * outward.cross(x)
    }

    /// (theta_i, phi_i), as far as they matter.
    #[inline(always)]
    fn angles(face: &Face, arrival: &Arrival, along: impl FnOnce() -> DVec3) -> (f64, f64) {
        let theta = if face.has_angles { arrival.theta() } else { 0.0 };
        let phi = if face.has_azimuths { arrival.phi(along()) } else { 0.0 };
        (theta, phi)
    }

    #[inline]
    fn lobes<'a>(&'a self, face: &Face, arrival: &'a Arrival, along: impl FnOnce() -> DVec3) -> Lobes<'a> {
        self.mixed(face, arrival, Self::angles(face, arrival, along))
    }

    #[inline(always)]
    fn mixed<'a>(&'a self, face: &Face, arrival: &'a Arrival, (theta, phi): (f64, f64)) -> Lobes<'a> {
        let layer = |k: Option<usize>| k.map(|k| (&self.layers[k], self.layers[k].mix(theta, phi)));
        Lobes { arrival, lobes: face.layers.map(layer) }
    }
}
