//! A point that emits alike in all directions.
//!
//! Scene text: `type = "isotropic"`, `position`, `flux_lm`.

use std::f64::consts::PI;

use glam::DVec3;

use super::Emission;
use crate::math::trig::sin_cos;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sequence::{Points, to_unit_f64};

/// A point emitter of constant intensity flux / (4 pi).
#[derive(Debug, Clone, Copy)]
pub struct Isotropic {
    /// Where it is.
    pub position: DVec3,
    /// Luminous flux, lm.
    pub flux_lm: f64,
}

impl Isotropic {
    /// A photon's start: cos(theta) and phi uniform.
    #[inline]
    pub fn emit<P: Points>(&self, u: Reusable, coordinates: &mut Coordinates<'_, P>) -> Emission {
        let u1 = coordinates.rest(u, Purpose::EmissionTheta);
        let u2 = to_unit_f64(coordinates.draw(Purpose::EmissionPhi));
        let cos_theta = 1.0 - 2.0 * u1;
        // sin^2 = 4 u (1 - u): no cancellation towards either pole.
        let sin_theta = 2.0 * (u1 * (1.0 - u1)).sqrt();
        let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u2);
        Emission {
            origin: self.position,
            direction: DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta),
        }
    }
}
