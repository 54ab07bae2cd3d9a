//! What a surface does with a photon.
//!
//! Contract of every model. A photon arrives along `direction` (unit, pointing the way it travels) on the side that the
//! normals of [`Incidence`] look to; the model decides by the chooser whether it is absorbed and, if not, where it
//! goes: away from the surface on the side of arrival, or `through` it. A photon carries flux, so the chance of going on
//! is the albedo and no cosine or eta^2 factor is left over; what a reflectance does to a photon with weights is told by its
//! [`Throughput`]. Coordinates are drawn only where there is more than one outcome.
//!
//! To add a model: a file beside these, a line in [`Material`] and an arm in [`Material::scatter`]; the scene file's name for it
//! is given in `scene`.

pub mod dielectric;
pub mod eye;
pub mod lambertian;
pub mod mirror;
pub mod reference;
pub mod reflectance;
pub mod tabulated;
pub mod throughput;
pub mod value;

use glam::DVec3;

use crate::sample::coordinates::Chooser;

pub use dielectric::Dielectric;
pub use eye::EyeWeight;
pub use reference::Reference;
pub use reflectance::{Reflectance, luminance, luminance_of};
pub use tabulated::Tabulated;
pub use throughput::{Fixed, Grey, Rgb, Throughput};

/// A photon at a surface.
#[derive(Debug, Clone, Copy)]
pub struct Incidence {
    /// Where the photon is heading; unit.
    pub direction: DVec3,
    /// Normal of the facet, unit, on the side of arrival: direction . facet < 0.
    pub facet: DVec3,
    /// Smooth normal, unit, on the same side of the surface as the outward normal that `facet` is plus or minus.
    pub smooth: DVec3,
    /// Whether the side of arrival is the one the outward normal points to.
    pub front: bool,
}

/// What became of the photon.
#[derive(Debug, Clone, Copy)]
pub enum Event {
    /// It ends here.
    Absorbed,
    /// It ends here because a table sent it below the horizon, where there is nothing but the surface (METHOD 4).
    BelowHorizon,
    /// It goes on.
    Leaves {
        /// Where to; unit.
        direction: DVec3,
        /// Whether it crossed to the other side.
        through: bool,
        /// Whether a smooth normal made an exception necessary (METHOD 1): the photon arrived behind the smooth normal,
        /// or was sent to the wrong side of the facet and mirrored back.
        corrected: bool,
    },
}

/// Everything a surface can be made of.
#[derive(Debug, Clone)]
pub enum Material {
    /// A smooth interface between two transparent media.
    Dielectric(Dielectric),
    /// A mirror of this reflectance at every angle.
    Mirror {
        /// Part of the flux that is reflected.
        reflectance: Reflectance,
    },
    /// Perfectly diffuse on the side of arrival.
    Lambertian {
        /// Part of the flux that is reflected.
        reflectance: Reflectance,
    },
    /// Scatters as a table says.
    Tabulated(Box<Tabulated>),
    /// Ends every photon.
    Absorber,
}

impl Material {
    /// Decides what happens to a photon that arrived, and to what it carries.
    #[inline]
    pub fn scatter<C: Chooser, T: Throughput>(
        &self,
        at: &Incidence,
        chooser: &mut C,
        carried: &mut T,
    ) -> Event {
        match self {
            Self::Dielectric(dielectric) => dielectric.scatter(at, chooser),
            Self::Mirror { reflectance } => mirror::scatter(reflectance, at, chooser, carried),
            Self::Lambertian { reflectance } => lambertian::scatter(reflectance, at, chooser, carried),
            Self::Tabulated(table) => table.scatter(at, chooser, carried),
            Self::Absorber => Event::Absorbed,
        }
    }

    /// Whether it treats channels differently.
    pub fn is_coloured(&self) -> bool {
        match self {
            Self::Mirror { reflectance } | Self::Lambertian { reflectance } => reflectance.is_coloured(),
            Self::Tabulated(table) => table.is_coloured(),
            Self::Dielectric(_) | Self::Absorber => false,
        }
    }

    /// Whether photons pass into another medium. (What a table lets through is in the same medium: a thin sheet.)
    pub fn is_transparent(&self) -> bool {
        matches!(self, Self::Dielectric(_))
    }
}

/// The smooth normal where the photon arrives in front of it, else the facet's; true in the second case.
#[inline]
fn working_normal(at: &Incidence) -> (DVec3, bool) {
    if at.direction.dot(at.smooth) < 0.0 { (at.smooth, false) } else { (at.facet, true) }
}

/// A direction that left on the wrong side of the facet, mirrored in the facet's plane (METHOD 1); `towards` is the
/// facet normal on the side where the photon must be. True where it was mirrored.
#[inline]
fn keep_side(direction: DVec3, towards: DVec3) -> (DVec3, bool) {
    let along = direction.dot(towards);
    if along < 0.0 { (direction - 2.0 * along * towards, true) } else { (direction, false) }
}

#[cfg(test)]
pub(crate) mod script {
    //! A chooser that follows a script: for tests of single events.
    use crate::sample::coordinates::{Chooser, Purpose};

    /// Events and uniforms in order; panics when it runs out, so a test also counts what is asked for.
    #[derive(Debug, Default)]
    pub struct Script {
        pub events: Vec<bool>,
        pub uniforms: Vec<f64>,
        pub asked: Vec<f64>,
    }

    impl Chooser for Script {
        fn happens(&mut self, probability: f64) -> bool {
            if probability <= 0.0 || probability >= 1.0 {
                return probability >= 1.0;
            }
            self.asked.push(probability);
            self.events.remove(0)
        }

        fn uniform(&mut self, _: Purpose) -> f64 {
            self.uniforms.remove(0)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_side_is_mirrored_in_the_facet() {
        let d = DVec3::new(0.6, 0.0, -0.8);
        assert_eq!(keep_side(d, DVec3::Z), (DVec3::new(0.6, 0.0, 0.8), true));
        assert_eq!(keep_side(d, -DVec3::Z), (d, false));
    }

    #[test]
    fn photon_behind_the_smooth_normal_uses_the_facet() {
        let at = Incidence {
            direction: DVec3::new(0.8, 0.0, -0.6),
            facet: DVec3::Z,
            smooth: DVec3::new(0.8, 0.0, 0.6),
            front: true,
        };
        assert_eq!(working_normal(&at), (DVec3::Z, true));
    }
}
