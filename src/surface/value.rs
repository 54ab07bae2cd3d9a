//! The value of a surface's BSDF: what a camera needs where light is scattered into its eye.

use std::f64::consts::FRAC_1_PI;

use glam::DVec3;

use crate::surface::Material;

/// A direction away from a surface, and the side it is on: state where it is known, because next to edge-on the sign of a
/// product may disagree by rounding.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Leg {
    /// Unit, pointing away from the surface.
    pub direction: DVec3,
    /// Whether it is on the side the outward normal points to.
    pub front: bool,
}

impl Leg {
    /// A direction, its side by its sign with the outward normal.
    #[inline]
    pub fn new(direction: DVec3, outward: DVec3) -> Self {
        Self { direction, front: direction.dot(outward) > 0.0 }
    }
}

impl Material {
    /// Whether it spreads light over a solid angle: there photons are kept, and eye paths end.
    #[inline]
    pub fn scatters(&self) -> bool {
        match self {
            Self::Lambertian { reflectance } => reflectance.luminous() > 0.0,
            Self::Tabulated(_) => true,
            Self::Dielectric(_) | Self::Mirror { .. } | Self::Absorber => false,
        }
    }

    /// f without the cosine, 1/sr, by channel: luminance towards wo per illuminance from wi. Both are unit and point away from
    /// the surface, whose facet's outward normal is `outward`. What goes on specularly has no value: 0.
    #[inline]
    pub fn value(&self, outward: DVec3, wi: DVec3, wo: DVec3) -> [f64; 3] {
        self.eval(outward, Leg::new(wi, outward), Leg::new(wo, outward))
    }

    /// The same where it is known which side each direction is on.
    #[inline]
    pub fn eval(&self, outward: DVec3, wi: Leg, wo: Leg) -> [f64; 3] {
        match self {
            Self::Lambertian { reflectance } if wi.front == wo.front => {
                reflectance.by_channel().map(|part| part * FRAC_1_PI)
            }
            Self::Tabulated(table) => table.eval(outward, wi, wo),
            Self::Lambertian { .. } | Self::Dielectric(_) | Self::Mirror { .. } | Self::Absorber => [0.0; 3],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Reflectance;

    #[test]
    fn a_lambertian_surface_is_equally_bright_from_its_lit_side() {
        let wall = Material::Lambertian { reflectance: Reflectance::rgb([0.5, 0.25, 1.0]) };
        let (wi, wo) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.8, 0.6));
        assert_eq!(wall.value(DVec3::Z, wi, wo), [0.5 * FRAC_1_PI, 0.25 * FRAC_1_PI, FRAC_1_PI]);
        assert_eq!(wall.value(-DVec3::Z, wi, wo), wall.value(DVec3::Z, wi, wo));
        assert_eq!(wall.value(DVec3::Z, wi, -wo), [0.0; 3]);
        assert!(wall.scatters());
        assert!(!Material::Lambertian { reflectance: Reflectance::grey(0.0) }.scatters());
        assert!(!Material::Absorber.scatters());
    }
}
