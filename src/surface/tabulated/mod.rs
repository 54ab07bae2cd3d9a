//! Scattering by a table (METHOD 4): two coordinates, by inverse functions.
//!
//! Scene text: `type = "tabulated"`, `file`, `side`, `rotation_deg`, `energy`, `specular_remainder`.
//!
//! **Contract.** Directions wi and wo are unit and point away from the surface; [`crate::scattering::table`] defines the frames
//! of the table. Light from wi is scattered with the probability [`Tabulated::albedo`], the integral of f cos(theta_o), into wo
//! with the density [`Tabulated::pdf_omega`] = f cos(theta_o) / albedo. The rest is absorbed or, on demand, mirrored (passes
//! straight on, where the table transmits).
//!
//! **Between angles.** The slices about (theta_i, phi_i) mix linearly in the frame of the actual incidence, in which the lobe
//! stands still; before the first and beyond the last theta_i that slice holds. Albedo, value, density and sample are those of
//! the mixture.
//!
//! **Horizon.** A cell that crosses the horizon, or a lobe that turned with the incidence, sends light where there is only the
//! surface: it is absorbed and counted. [`Tabulated::pdf_omega`] covers that part too, so it integrates to 1 over all wo, not
//! over the hemisphere; f is 0 there.
//!
//! **Normals.** The facet's normal is used, as for Lambertian surfaces.

mod arrival;
mod branch;
pub(crate) mod energy;
mod eye;
mod layer;

use std::sync::Arc;

use glam::DVec3;

use crate::error::{Diagnostic, Kind, Result};
use crate::math::solve::Solver;
use crate::sample::coordinates::Chooser;
use crate::scattering::{Quantity, ScatterTable};
use crate::surface::throughput::Fate;
use crate::surface::{Event, Incidence, Reference, Reflectance, Throughput};
use crate::units::LUMINANCE_OF_RGB;

use arrival::Arrival;
use branch::{Branches, Given, Left, Lobes};
use layer::Layer;

/// What is done about albedos above 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Energy {
    /// They are an error.
    #[default]
    Refuse,
    /// Incidences with an albedo above 1 are scaled to 1, with a warning.
    Scale,
}

/// Which side of the surface a table's lobes are for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Sides {
    /// The table's front is the side the outward normal points to. A side for which the table has no lobe absorbs.
    Front,
    /// The table's front is the other side.
    Back,
    /// As [`Self::Front`], and a side for which the table has no lobe is like the other one.
    #[default]
    Both,
}

/// How a table is put on a surface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// What is done about albedos above 1.
    pub energy: Energy,
    /// Which side is which.
    pub sides: Sides,
    /// The surface's reference direction. Only tables with several phi_i depend on it.
    pub reference: Reference,
    /// Turn of the table's reference direction against the surface's, counter-clockwise seen from the tip of the outward
    /// normal.
    pub rotation_deg: f64,
    /// What the table leaves of the light goes on: straight through where the table transmits light of this side, mirrored
    /// where it only reflects it.
    pub specular_remainder: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self {
            energy: Energy::default(),
            sides: Sides::default(),
            reference: Reference::default(),
            rotation_deg: 0.0,
            specular_remainder: false,
        }
    }
}

/// A surface made of a scattering table. Copies share the table.
#[derive(Debug, Clone)]
pub struct Tabulated {
    layers: Arc<[Layer]>,
    /// For light from the front and from the back.
    faces: [Face; 2],
    reference: Reference,
    /// (sin, cos) of the rotation.
    turn: (f64, f64),
}

/// What happens to light from one side.
#[derive(Debug, Clone, Copy, Default)]
struct Face {
    /// Which layers reflect and transmit it.
    layers: [Option<usize>; 2],
    coloured: bool,
    /// Whether theta_i and phi_i matter.
    has_angles: bool,
    has_azimuths: bool,
    /// Where what the table leaves goes on to; `None` where it is absorbed.
    rest: Option<Quantity>,
}

/// A direction into which light was scattered.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Scattered {
    /// Unit, pointing away from the surface.
    pub wo: DVec3,
    /// Whether it is reflected or transmitted: the side that wo belongs to, whether or not it lies there.
    pub quantity: Quantity,
    /// Whether wo lies below the horizon, so that the light is absorbed.
    pub below_horizon: bool,
}

impl Tabulated {
    /// Builds the samplers of a table; the warnings are those of its energy.
    ///
    /// # Errors
    /// An albedo above 1, unless `energy` allows it; a reference without direction or a rotation that is not finite; a table too large.
    pub fn new(table: &ScatterTable, options: &Options) -> Result<(Self, Vec<Diagnostic>)> {
        if !options.rotation_deg.is_finite() {
            let found = format!("rotation_deg {}", options.rotation_deg);
            return Err(Diagnostic::new(Kind::Range, found, "a finite angle"));
        }
        let mut layers = table.lobes.iter().map(Layer::new).collect::<Result<Vec<_>>>()?;
        let faces = faces(table, &layers, options);
        let warnings = energy::check(&mut layers, &faces, options.energy)?;
        let turn = libm::sincos(options.rotation_deg.to_radians());
        let this = Self { layers: layers.into(), faces, reference: Reference::default(), turn };
        Ok((this.with_reference(options.reference)?, warnings))
    }

    /// The same table on a surface with another reference direction.
    ///
    /// # Errors
    /// A reference without direction.
    pub fn with_reference(&self, reference: Reference) -> Result<Self> {
        Ok(Self { reference: reference.normalised()?, ..self.clone() })
    }

    /// Whether it treats channels differently.
    pub fn is_coloured(&self) -> bool {
        self.faces.iter().any(|face| face.coloured)
    }

    /// Whether light from a side is let through.
    pub fn transmits(&self, from_front: bool) -> bool {
        self.face(from_front).layers[1].is_some()
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
        let (theta, phi) = Self::angles(face, arrival, along);
        let layer = |k: Option<usize>| k.map(|k| (&self.layers[k], self.layers[k].mix(theta, phi)));
        Lobes { arrival, lobes: face.layers.map(layer) }
    }

    /// Scatters what the throughput lets be scattered. (Kept out of the walk, whose other surfaces need few registers.)
    #[inline(never)]
    pub fn scatter<C: Chooser, T: Throughput>(
        &self,
        at: &Incidence,
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        let face = self.face(at.front);
        let along = || self.along(if at.front { at.facet } else { -at.facet });
        let arrival = Arrival::new(-at.direction, at.facet, along);
        let angles = Self::angles(face, &arrival, along);
        if face.coloured {
            self.scatter_coloured(face, &arrival, angles, chooser, carried)
        } else {
            self.scatter_grey(face, &arrival, angles, chooser, carried)
        }
    }

    #[inline(always)]
    fn scatter_grey<C: Chooser, T: Throughput>(
        &self,
        face: &Face,
        arrival: &Arrival,
        (theta, phi): (f64, f64),
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        let layers = face.layers.map(|k| k.map(|k| &self.layers[k]));
        let mut branches = Branches::none();
        let albedo = branches.add_grey(layers, theta, phi);
        let fate = if face.rest.is_some() {
            carried.scatter([albedo; 3], true, chooser)
        } else if carried.reflect(&Reflectance::of_table(albedo), chooser) {
            Fate::Scattered(LUMINANCE_OF_RGB)
        } else {
            Fate::Ends
        };
        if !matches!(fate, Fate::Scattered(_)) {
            return unscattered(face, arrival, fate);
        }
        match branches.decide(chooser) {
            Some(branch) => match layers[branch.lobe as usize] {
                Some(layer) => outcome(&branch::leave(arrival, layer, branch.slice as usize, chooser).0),
                None => Event::Absorbed,
            },
            None => Event::Absorbed,
        }
    }

    #[inline(always)]
    fn scatter_coloured<C: Chooser, T: Throughput>(
        &self,
        face: &Face,
        arrival: &Arrival,
        (theta, phi): (f64, f64),
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        let layer = |k: Option<usize>| k.map(|k| (&self.layers[k], self.layers[k].mix(theta, phi)));
        let lobes = Lobes { arrival, lobes: face.layers.map(layer) };
        let albedo = lobes.albedo(true);
        let fate = carried.scatter(albedo, face.rest.is_some(), chooser);
        let Fate::Scattered(shares) = fate else {
            return unscattered(face, arrival, fate);
        };
        let Some(left) = lobes.sample(Some(shares), chooser) else {
            return Event::Absorbed;
        };
        let part = if face.rest.is_some() { 1.0 } else { crate::surface::reflectance::luminance(albedo) };
        carried.scattered(left.values, part);
        outcome(&left)
    }
}

/// What becomes of a photon that the table does not scatter.
fn unscattered(face: &Face, arrival: &Arrival, fate: Fate) -> Event {
    match (fate, face.rest) {
        (Fate::GoesOn, Some(quantity)) => {
            let direction = arrival.specular(quantity).normalize();
            Event::Leaves { direction, through: quantity == Quantity::Transmission, corrected: false }
        }
        _ => Event::Absorbed,
    }
}

/// What becomes of one that it scatters.
#[inline(always)]
fn outcome(left: &Left) -> Event {
    if left.below_horizon {
        return Event::BelowHorizon;
    }
    let through = left.quantity == Quantity::Transmission;
    Event::Leaves { direction: left.wo.normalize(), through, corrected: false }
}

/// The same in a local frame: z the normal on the side that light comes from, x the table's reference direction on it. wi is
/// unit with wi.z >= 0.
impl Tabulated {
    fn local<R>(&self, from_front: bool, wi: DVec3, then: impl FnOnce(&Face, &Lobes<'_>) -> R) -> R {
        let face = self.face(from_front);
        let arrival = Arrival::new(wi, DVec3::Z, || DVec3::X);
        then(face, &self.lobes(face, &arrival, || DVec3::X))
    }

    /// Parts of the light from wi that are scattered, by channel, below the horizon included.
    pub fn albedo(&self, from_front: bool, wi: DVec3) -> [f64; 3] {
        self.local(from_front, wi, |face, lobes| lobes.albedo(face.coloured))
    }

    /// The same of one lobe.
    pub fn albedo_of(&self, from_front: bool, wi: DVec3, quantity: Quantity) -> [f64; 3] {
        self.local(from_front, wi, |_, lobes| lobes.albedo_of(quantity))
    }

    /// f, 1/sr, by channel, for wo of either side.
    pub fn eval(&self, from_front: bool, wi: DVec3, wo: DVec3) -> [f64; 3] {
        let quantity = if wo.z > 0.0 { Quantity::Reflection } else { Quantity::Transmission };
        if wo.z == 0.0 {
            return [0.0; 3];
        }
        self.eval_cos(from_front, wi, wo, quantity).map(|g| g / wo.z.abs())
    }

    /// g, 1/sr, by channel: f cos(theta_o) of one lobe, also where that lobe reaches below its horizon. Its integral over all wo
    /// is the lobe's albedo.
    pub fn eval_cos(&self, from_front: bool, wi: DVec3, wo: DVec3, quantity: Quantity) -> [f64; 3] {
        self.local(from_front, wi, |_, lobes| lobes.eval_cos(quantity, wo))
    }

    /// Density of [`Self::sample`] in solid angle for white light, 1/sr: that it gives wo as light of this lobe. Over all wo
    /// and both lobes it integrates to 1, the part below the horizon included.
    pub fn pdf_omega(&self, from_front: bool, wi: DVec3, wo: DVec3, quantity: Quantity) -> f64 {
        self.local(from_front, wi, |_, lobes| {
            let all = crate::surface::reflectance::luminance(lobes.albedo(true));
            let g = crate::surface::reflectance::luminance(lobes.eval_cos(quantity, wo));
            if g > 0.0 { g / all } else { 0.0 }
        })
    }

    /// The direction of white light that is scattered, for two coordinates, the first a 64-bit fraction that also chooses
    /// the lobe, the slice, the channel and the cell. `None` where nothing is scattered.
    pub fn sample(&self, from_front: bool, wi: DVec3, u1: u64, u2: f64, solver: Solver) -> Option<Scattered> {
        self.local(from_front, wi, |face, lobes| {
            let shares = face.coloured.then_some(LUMINANCE_OF_RGB);
            let left = lobes.sample(shares, &mut Given::new(u1, u2, solver))?;
            Some(Scattered { wo: left.wo, quantity: left.quantity, below_horizon: left.below_horizon })
        })
    }

    /// The coordinates whose sample is wo as light of this lobe: one pair for each slice and channel that reaches it, so
    /// several between the table's angles. The sum over them of 1 / Jacobian is the density.
    pub fn invert(&self, from_front: bool, wi: DVec3, wo: DVec3, quantity: Quantity) -> Vec<(u64, f64)> {
        self.local(from_front, wi, |face, lobes| {
            lobes.invert(face.coloured.then_some(LUMINANCE_OF_RGB), quantity, wo)
        })
    }
}

/// Which layers serve which side.
fn faces(table: &ScatterTable, layers: &[Layer], options: &Options) -> [Face; 2] {
    let index = |quantity: Quantity, from_front: bool| {
        let lobe = table.lobe(quantity, from_front)?;
        table.lobes.iter().position(|other| std::ptr::eq(lobe, other))
    };
    let of_side = |from_front| [Quantity::Reflection, Quantity::Transmission].map(|q| index(q, from_front));
    let (mut front, mut back) = (of_side(true), of_side(false));
    match options.sides {
        Sides::Front => {}
        Sides::Back => std::mem::swap(&mut front, &mut back),
        Sides::Both if front == [None; 2] => front = back,
        Sides::Both if back == [None; 2] => back = front,
        Sides::Both => {}
    }
    [front, back].map(|indices: [Option<usize>; 2]| {
        let has = |test: fn(&Layer) -> bool| indices.into_iter().flatten().any(|k| test(&layers[k]));
        let rest = match indices {
            [None, None] => None,
            [_, Some(_)] => Some(Quantity::Transmission),
            [Some(_), None] => Some(Quantity::Reflection),
        };
        Face {
            layers: indices,
            coloured: has(|layer| layer.channels == 3),
            has_angles: has(Layer::has_angles),
            has_azimuths: has(Layer::has_azimuths),
            rest: rest.filter(|_| options.specular_remainder),
        }
    })
}
