//! Where photons start: points, beams and area lights.
//!
//! An emitter turns coordinates into a start and a direction; every photon of a scene carries the same flux, so emitters
//! are chosen in proportion to theirs ([`Emitters`], METHOD 2: the chooser's coordinate goes on to the table cell).
//!
//! To add an emitter: a file beside these that implements [`Emits`], or [`area::LitShape`] for a flat Lambertian light; its
//! lines in [`Emitter`] and in `each`; its keys in `files::scene_toml` and docs/SCENE.md.

pub mod area;
pub mod beam;
mod choice;
pub mod colour;
pub mod disc;
mod frame;
pub mod isotropic;
pub mod panel;
pub mod photometric;
mod spherical_rectangle;

use glam::DVec3;

use crate::sample::choose::Reusable;
use crate::sample::coordinates::Coordinates;
use crate::sample::grid::Grid;
use crate::sample::method::Sampling;
use crate::sequence::Points;

/// What can be an emitter, as the door shows it.
pub mod sources {
    pub use super::area::AreaLight;
    pub use super::beam::{Beam, BeamSection};
    pub use super::disc::Disc;
    pub use super::isotropic::Isotropic;
    pub use super::panel::Panel;
    pub use super::photometric::Photometric;
}

pub use choice::Emitters;
pub use colour::Colour;
pub use frame::{AimFrame, FLUX};
pub use photometric::grid_axes;
pub use sources::*;

/// The start of a photon.
#[derive(Debug, Clone, Copy)]
pub struct Emission {
    /// Where, m.
    pub origin: DVec3,
    /// Where to; unit.
    pub direction: DVec3,
    /// Flux in units of a photon's: 1, but for emitters of references ([`Emitters::with_weights`]), of which it is the mean.
    pub weight: f64,
}

impl Emission {
    #[inline]
    fn new(origin: DVec3, direction: DVec3) -> Self {
        Self { origin, direction, weight: 1.0 }
    }
}

/// Light that reaches a point from an emitter, if nothing stands between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectLight {
    /// Unit vector from the point to where the light comes from.
    pub towards: DVec3,
    /// How far away that is, m.
    pub distance_m: f64,
    /// Illuminance of a surface facing it, lx. From an area light it is an estimate: times the cosine at a surface, its mean
    /// over the coordinates is the surface's illuminance.
    pub illuminance_lx: f64,
}

impl DirectLight {
    /// From a point emitter: E = I / d^2.
    fn from_point(emitter: DVec3, point: DVec3, intensity_cd: impl FnOnce(DVec3) -> f64) -> Option<Self> {
        let to = emitter - point;
        let distance_m = to.length();
        if !(distance_m > 0.0 && distance_m.is_finite()) {
            return None;
        }
        let towards = to / distance_m;
        let illuminance_lx = intensity_cd(-towards) / (distance_m * distance_m);
        (illuminance_lx > 0.0).then_some(Self { towards, distance_m, illuminance_lx })
    }
}

/// What holds for all emitters of a kind.
#[derive(Debug, Clone, Copy)]
pub struct EmitterKind {
    /// What messages call it.
    pub noun: &'static str,
    /// What a scene with it requires, as `caustix check` says it, and the rank of that word in the list.
    pub requires: (u8, &'static str),
    /// Continuous coordinates of a start: two for a direction or a place, four for both.
    pub coordinates: u32,
    /// Continuous coordinates of [`Emits::direct_light`].
    pub direct_coordinates: u32,
    /// Whether its middle may lie on a surface, because all of its light leaves that to one side.
    pub may_touch: bool,
}

impl EmitterKind {
    /// Of a point.
    const fn new(noun: &'static str, requires: (u8, &'static str)) -> Self {
        Self { noun, requires, coordinates: 2, direct_coordinates: 0, may_touch: false }
    }
}

/// The contract of an emitter.
pub trait Emits {
    /// Luminous flux, lm.
    fn flux_lm(&self) -> f64;

    /// The point, or the middle of where photons start, m.
    fn position(&self) -> DVec3;

    /// The start of a photon. `u` is what is left of the coordinate that chose the emitter; tables are sampled in the given
    /// way. `None` where this point of the sequence gives no photon, which only rejection knows.
    fn emit<P: Points>(
        &self,
        sampling: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission>;

    /// Light at a point (m); `None` where this emitter, or the place of it that `u` in [0, 1) stands for, sends none.
    fn direct_light(&self, point: DVec3, u: [f64; 2]) -> Option<DirectLight>;

    /// The luminance (cd/m2) to an eye at `origin` (m) that looks along the unit vector `direction`, and how far away it is
    /// (m). Points and beams have no luminance: they are not seen.
    fn seen(&self, _origin: DVec3, _direction: DVec3) -> Option<(f64, f64)> {
        None
    }

    /// Corners, in order around, of the convex plane figure in which photons start, as `area::LitShape::outline`; none for a
    /// point.
    fn outline(&self) -> Vec<DVec3> {
        Vec::new()
    }

    /// The table that directions are sampled from.
    fn table(&self) -> Option<&Grid> {
        None
    }

    /// What holds for all emitters of its kind.
    fn kind(&self) -> EmitterKind;
}

/// Everything that can emit.
#[derive(Debug, Clone)]
pub enum Emitter {
    /// A point with a table of luminous intensity.
    Photometric(Photometric),
    /// A point that emits alike in all directions.
    Isotropic(Isotropic),
    /// A beam of parallel light.
    Beam(Beam),
    /// A Lambertian rectangle.
    Panel(AreaLight<Panel>),
    /// A Lambertian disc.
    Disc(AreaLight<Disc>),
}

/// Asks whatever an [`Emitter`] holds.
macro_rules! each {
    ($emitter:expr, $e:ident => $answer:expr) => {
        match $emitter {
            Emitter::Photometric($e) => $answer,
            Emitter::Isotropic($e) => $answer,
            Emitter::Beam($e) => $answer,
            Emitter::Panel($e) => $answer,
            Emitter::Disc($e) => $answer,
        }
    };
}

impl Emits for Emitter {
    fn flux_lm(&self) -> f64 {
        each!(self, e => e.flux_lm())
    }

    fn position(&self) -> DVec3 {
        each!(self, e => e.position())
    }

    #[inline]
    fn emit<P: Points>(
        &self,
        sampling: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission> {
        each!(self, e => e.emit(sampling, u, coordinates))
    }

    fn direct_light(&self, point: DVec3, u: [f64; 2]) -> Option<DirectLight> {
        each!(self, e => e.direct_light(point, u))
    }

    fn seen(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        each!(self, e => e.seen(origin, direction))
    }

    fn outline(&self) -> Vec<DVec3> {
        each!(self, e => e.outline())
    }

    fn table(&self) -> Option<&Grid> {
        each!(self, e => e.table())
    }

    #[inline]
    fn kind(&self) -> EmitterKind {
        each!(self, e => e.kind())
    }
}

impl Emitter {
    /// Bytes held beyond the enum itself.
    pub fn memory_bytes(&self) -> usize {
        self.table().map_or(0, |grid| size_of_val(grid) + grid.memory_bytes())
    }
}

#[cfg(test)]
mod tests;
