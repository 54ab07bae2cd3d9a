//! A point that emits alike in all directions.
//!
//! Scene text: `type = "isotropic"`, `position`, `flux_lm`.

use std::f64::consts::PI;

use glam::DVec3;

use super::{DirectLight, Emission, Emits, EmitterKind, FLUX};
use crate::error::Invalid;
use crate::geometry::COORDINATE;
use crate::math::trig::sin_cos;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sample::method::Sampling;
use crate::sequence::{Points, to_unit_f64};

/// A point emitter of constant intensity flux / (4 pi).
#[derive(Debug, Clone, Copy)]
pub struct Isotropic {
    position: DVec3,
    flux_lm: f64,
}

impl Isotropic {
    /// An emitter at `position` (m).
    ///
    /// # Errors
    /// A position or flux out of range or not a number.
    pub fn new(position: DVec3, flux_lm: f64) -> Result<Self, Invalid> {
        Ok(Self {
            position: COORDINATE.vector("position", position)?,
            flux_lm: FLUX.check("flux_lm", flux_lm)?,
        })
    }
}

impl Emits for Isotropic {
    fn flux_lm(&self) -> f64 {
        self.flux_lm
    }

    fn position(&self) -> DVec3 {
        self.position
    }

    /// cos(theta) and phi uniform.
    #[inline]
    fn emit<P: Points>(
        &self,
        _: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission> {
        let u1 = coordinates.rest(u, Purpose::EmissionTheta);
        let u2 = to_unit_f64(coordinates.draw(Purpose::EmissionPhi));
        let cos_theta = 1.0 - 2.0 * u1;
        // sin^2 = 4 u (1 - u): no cancellation towards either pole.
        let sin_theta = 2.0 * (u1 * (1.0 - u1)).sqrt();
        let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u2);
        Some(Emission::new(self.position, DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, cos_theta)))
    }

    fn direct_light(&self, point: DVec3, _: [f64; 2]) -> Option<DirectLight> {
        DirectLight::from_point(self.position, point, |_| self.flux_lm / (4.0 * PI))
    }

    #[inline]
    fn kind(&self) -> EmitterKind {
        EmitterKind::new("point", (1, "isotropic emission"))
    }
}
