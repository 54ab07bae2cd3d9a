//! What surfaces do with light: one contract for all materials, and a file for each.
//!
//! **Directions** are unit vectors in world space. That of [`Incidence`] points the way the photon travels,
//! towards the surface, and the normals beside it stand on the side of arrival. wi and wo ([`Leg`]) both
//! point away from the surface: light comes from wi and leaves along wo; `outward` is the facet's outward
//! normal. Sides are state: `front` is the side that the outward normal points to.
//!
//! **Measures.** A photon carries flux: [`Material::scatter`] lets it go on with the probability of the
//! albedo, and no cosine and no eta^2 is left over; what that does to a weight per channel is a matter of its
//! [`Throughput`]. [`Material::eval`] is f, the BSDF without a cosine, and [`Material::pdf`] the density of
//! scattered directions in solid angle; both leave out what goes on specularly, which [`Material::specular`]
//! tells for eye paths, in luminance. Coordinates are drawn only where there is more than one outcome.
//!
//! To add a material: a file beside these that answers [`Model`], its lines in [`models`], in [`Material`] and in `ask`
//! below it, its keys in `files/scene_toml/material` and docs/SCENE.md.

mod absorber;
pub mod dielectric;
pub mod diffuse_transmission;
pub mod eye;
pub mod incidence;
pub mod lambertian;
pub mod mirror;
pub mod reference;
pub mod reflectance;
pub mod tabulated;
#[cfg(test)]
pub(crate) mod tests;
pub mod throughput;

use std::collections::BTreeMap;

use glam::DVec3;

use crate::sample::coordinates::Chooser;

/// The models, as the door shows them.
pub mod models {
    pub use super::dielectric::Dielectric;
    pub use super::diffuse_transmission::DiffuseTransmission;
    pub use super::lambertian::Lambertian;
    pub use super::mirror::Mirror;
    pub use super::tabulated::Tabulated;
}

pub use eye::EyeWeight;
pub use incidence::{Incidence, Leg};
pub use models::*;
pub use reference::Reference;
pub use reflectance::{Reflectance, luminance, luminance_of};
pub use throughput::{Fixed, Grey, Rgb, Throughput};

/// Everything a surface can be made of.
#[derive(Debug, Clone)]
pub enum Material {
    /// A smooth interface between two transparent media.
    Dielectric(Dielectric),
    /// A mirror of one reflectance at every angle.
    Mirror(Mirror),
    /// Perfectly diffuse on the side of arrival.
    Lambertian(Lambertian),
    /// A thin sheet, perfectly diffuse on both sides.
    DiffuseTransmission(DiffuseTransmission),
    /// Scatters as a table says.
    Tabulated(Box<Tabulated>),
    /// Ends every photon.
    Absorber,
}

/// `ask!(material, question(arguments))`: what the material's model answers.
macro_rules! ask {
    ($material:expr, $question:ident($($argument:expr),*)) => {
        match $material {
            Material::Dielectric(model) => Model::$question(model, $($argument),*),
            Material::Mirror(model) => Model::$question(model, $($argument),*),
            Material::Lambertian(model) => Model::$question(model, $($argument),*),
            Material::DiffuseTransmission(model) => Model::$question(model, $($argument),*),
            Material::Tabulated(model) => Model::$question(&**model, $($argument),*),
            Material::Absorber => Model::$question(&absorber::Absorber, $($argument),*),
        }
    };
}

/// What became of a photon at a surface.
#[derive(Debug, Clone, Copy)]
pub enum Event {
    /// It ends here.
    Absorbed,
    /// It ends here because a table sent it below the horizon, where there is nothing but the surface (METHOD
    /// 4).
    BelowHorizon,
    /// It goes on.
    Leaves {
        /// Where to; unit, on the side that it leaves on.
        direction: DVec3,
        /// Whether it crossed to the other side.
        through: bool,
        /// Whether a smooth normal made an exception necessary (METHOD 1): the photon arrived behind the
        /// smooth normal, or was sent to the wrong side of the facet and mirrored back.
        corrected: bool,
    },
}

/// What a material does with light, as far as the ways on are concerned.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Kind {
    /// Light goes on in single directions.
    Specular,
    /// Light is spread over a solid angle: there photons are kept, and eye paths see light.
    Scattering,
    /// None goes on.
    Absorbing,
}

/// A specular way on for an eye path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Way {
    /// Where the path goes on to; unit.
    pub direction: DVec3,
    /// Part of the flux of light on this way, towards the eye, that goes on to the eye, by channel.
    pub part: [f64; 3],
    /// (n_i / n_t)^2, of the media before and behind the surface: luminance seen from the first is that part
    /// of the luminance in the second. 1 where the medium is the same.
    pub luminance_factor: f64,
}

/// The specular ways on for an eye path.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Ways {
    /// On the side of arrival.
    pub mirrored: Option<Way>,
    /// On the other side.
    pub through: Option<Way>,
    /// Nothing is absorbed: the parts sum to 1, each the same for all channels.
    pub lossless: bool,
}

/// The contract of [`Material`], for one model. Where there is a default it is that of a model that has no
/// such thing.
pub trait Model {
    /// [`Material::requires`], of one that lets light go on.
    const REQUIRES: &[(u8, &'static str)];
    /// [`Material::kind`].
    fn kind(&self) -> Kind;
    /// [`Material::requires`].
    fn requires(&self) -> &'static [(u8, &'static str)] {
        if self.kind() == Kind::Absorbing { &[] } else { Self::REQUIRES }
    }
    /// [`Material::is_coloured`].
    fn is_coloured(&self) -> bool;
    /// [`Material::scatter`].
    fn scatter<C: Chooser, T: Throughput>(&self, at: &Incidence, chooser: &mut C, carried: &mut T) -> Event;
    /// [`Material::eval`].
    fn eval(&self, _outward: DVec3, _wi: Leg, _wo: Leg) -> [f64; 3] {
        [0.0; 3]
    }
    /// [`Material::even_value`].
    fn even_value(&self) -> Option<[f64; 3]> {
        None
    }
    /// [`Material::specular`].
    fn specular(&self, _at: &Incidence) -> Ways {
        Ways::default()
    }
    /// [`Material::indices`].
    fn indices(&self) -> Option<(f64, Option<f64>)> {
        None
    }
    /// [`Material::is_opaque`].
    fn is_opaque(&self) -> bool;
    /// [`Material::keeps_all`].
    fn keeps_all(&self) -> bool {
        false
    }
    /// [`Material::proposals`].
    fn proposals(&self, _at: &Incidence) -> [f64; 2] {
        [0.0; 2]
    }
    /// Bytes of its table, by an address that all copies share.
    fn table_bytes(&self) -> Option<(usize, usize)> {
        None
    }
}

impl Material {
    /// Which of three kinds it is.
    pub fn kind(&self) -> Kind {
        ask!(self, kind())
    }

    /// Whether it spreads light over a solid angle.
    #[inline]
    pub fn scatters(&self) -> bool {
        self.kind() == Kind::Scattering
    }

    /// The machinery it needs, each with its place in reports.
    pub fn requires(&self) -> &'static [(u8, &'static str)] {
        ask!(self, requires())
    }

    /// Whether it treats channels differently.
    pub fn is_coloured(&self) -> bool {
        ask!(self, is_coloured())
    }

    /// Of a material through which light passes into another medium: the refractive index behind the outward normal, and
    /// the one before it where that is stated. (A sheet that scatters light through it has the same medium on both sides.)
    pub fn indices(&self) -> Option<(f64, Option<f64>)> {
        ask!(self, indices())
    }

    /// Whether light passes into another medium.
    pub fn is_transparent(&self) -> bool {
        self.indices().is_some()
    }

    /// Whether surely no light gets through. (A table may send some.)
    pub fn is_opaque(&self) -> bool {
        ask!(self, is_opaque())
    }

    /// Whether it absorbs nothing, in any channel.
    pub fn keeps_all(&self) -> bool {
        ask!(self, keeps_all())
    }

    /// What happens to a photon that arrived, and to what it carries.
    #[inline]
    pub fn scatter<C: Chooser, T: Throughput>(
        &self,
        at: &Incidence,
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        ask!(self, scatter(at, chooser, carried))
    }

    /// f, 1/sr, by channel: luminance towards wo per illuminance from wi. What goes on specularly has no
    /// value: 0.
    #[inline]
    pub fn eval(&self, outward: DVec3, wi: Leg, wo: Leg) -> [f64; 3] {
        ask!(self, eval(outward, wi, wo))
    }

    /// f where it is the same for all wi and wo of one side and 0 for those of different sides, 1/sr, by
    /// channel.
    pub fn even_value(&self) -> Option<[f64; 3]> {
        ask!(self, even_value())
    }

    /// Density, 1/sr in solid angle, of the directions into which [`Self::scatter`] sends photons of white
    /// light from wi, times the probability that it scatters them: the luminance of f times the cosine of wo.
    /// Its integral over all wo is the luminous albedo, less what goes on specularly or below the horizon.
    pub fn pdf(&self, outward: DVec3, wi: Leg, wo: Leg) -> f64 {
        luminance(self.eval(outward, wi, wo)) * wo.direction.dot(outward).abs()
    }

    /// Where an eye path goes on to that arrived: light comes from there to the eye.
    pub fn specular(&self, at: &Incidence) -> Ways {
        ask!(self, specular(at))
    }

    /// Proposals that the scattering of a photon of white light takes by rejection, on average over whether
    /// it is scattered: inside the cells of a table, and against a slice's largest value. 0 where no table is
    /// sampled.
    pub fn proposals(&self, at: &Incidence) -> [f64; 2] {
        ask!(self, proposals(at))
    }
}

/// Bytes held by the tables of these materials; copies share theirs.
pub fn memory_bytes(materials: &[Material]) -> usize {
    let tables: BTreeMap<_, _> =
        materials.iter().filter_map(|material| ask!(material, table_bytes())).collect();
    tables.values().sum()
}
