//! Lambertian area lights: a flat shape of equal luminance at all its points and in all directions on the side of its aim,
//! dark on the other side. It is light, not geometry: photons pass it unhindered.

use std::f64::consts::PI;

use glam::{DMat3, DVec3};

use super::{AimFrame, DirectLight, Emission, Emits, EmitterKind, FLUX};
use crate::error::Invalid;
use crate::geometry::COORDINATE;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sample::method::Sampling;
use crate::sequence::{Points, to_unit_f64};
use crate::surface::lambertian::cosine_direction;

/// A convex shape in the plane of a light, about the light's position. Places are (x, y) in metres along aim x up and up.
///
/// To add one: a file that implements this, and its lines in [`super::Emitter`].
pub trait LitShape: Copy {
    /// As [`EmitterKind::noun`].
    const NOUN: &'static str;
    /// As [`EmitterKind::requires`].
    const REQUIRES: (u8, &'static str);

    /// Pi times the area, m2 sr: flux over luminance.
    fn etendue_m2_sr(&self) -> f64;

    /// The longest side or the diameter, m.
    fn extent_m(&self) -> f64;

    /// The place for a point of the unit square: an area-preserving map, one to one, no rejection, so that a net stays a net.
    fn sample_point(&self, u: [f64; 2]) -> [f64; 2];

    /// Whether a place of the plane belongs to the shape.
    fn contains(&self, place: [f64; 2]) -> bool;

    /// Places of the edge in order around: corners of a polygon that is the shape or approaches it from inside. Their number
    /// is a multiple of 8.
    fn outline(&self) -> Vec<[f64; 2]>;

    /// For a point over the place `foot`, `height_m` away from the plane: a place of the shape, and the reciprocal of the
    /// density (in solid angle) that it is drawn with, sr. `None` where a place uniform over the area serves better.
    fn sample_direction(&self, foot: [f64; 2], height_m: f64, u: [f64; 2]) -> Option<([f64; 2], f64)>;
}

/// A flat shape of constant luminance flux / (pi area).
#[derive(Debug, Clone, Copy)]
pub struct AreaLight<S> {
    centre: DVec3,
    /// Columns: aim x up, up, aim; unit.
    axes: DMat3,
    shape: S,
    flux_lm: f64,
}

impl<S: LitShape> AreaLight<S> {
    /// A light about `centre` (m) that shines towards the aim of a frame.
    ///
    /// # Errors
    /// A position or flux out of range or not a number.
    pub fn new(centre: DVec3, frame: AimFrame, shape: S, flux_lm: f64) -> Result<Self, Invalid> {
        let (centre, flux_lm) = (COORDINATE.vector("position", centre)?, FLUX.check("flux_lm", flux_lm)?);
        Ok(Self { centre, axes: frame.axes(), shape, flux_lm })
    }

    /// Luminance of the lit side, cd/m2.
    #[inline]
    pub fn luminance_cd_m2(&self) -> f64 {
        self.flux_lm / self.shape.etendue_m2_sr()
    }

    #[inline]
    fn point(&self, [x, y]: [f64; 2]) -> DVec3 {
        self.centre + self.axes.x_axis * x + self.axes.y_axis * y
    }

    /// The place of the plane under a point.
    #[inline]
    fn foot(&self, point: DVec3) -> [f64; 2] {
        let from_centre = point - self.centre;
        [from_centre.dot(self.axes.x_axis), from_centre.dot(self.axes.y_axis)]
    }
}

impl<S: LitShape> Emits for AreaLight<S> {
    fn flux_lm(&self) -> f64 {
        self.flux_lm
    }

    fn position(&self) -> DVec3 {
        self.centre
    }

    /// Uniform over the area, cosine law about the aim.
    #[inline]
    fn emit<P: Points>(
        &self,
        _: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission> {
        let x = coordinates.rest(u, Purpose::BeamPosition);
        let y = to_unit_f64(coordinates.draw(Purpose::BeamPosition));
        let u1 = to_unit_f64(coordinates.draw(Purpose::EmissionTheta));
        let u2 = to_unit_f64(coordinates.draw(Purpose::EmissionPhi));
        let origin = self.point(self.shape.sample_point([x, y]));
        Some(Emission::new(origin, (self.axes * cosine_direction(u1, u2)).normalize()))
    }

    /// Near the light the place is drawn by solid angle, so that the estimate has a bound: L over the density. Far away, where
    /// the solid angle is a difference of large numbers, over the area: L A cos / d^2, cos at the light.
    fn direct_light(&self, point: DVec3, u: [f64; 2]) -> Option<DirectLight> {
        let from_centre = point - self.centre;
        let height_m = from_centre.dot(self.axes.z_axis);
        if !(height_m > 0.0 && height_m.is_finite()) {
            return None;
        }
        let is_far = from_centre.length_squared() > 16.0 * self.shape.extent_m().powi(2);
        let near = if is_far { None } else { self.shape.sample_direction(self.foot(point), height_m, u) };
        let place = near.map_or_else(|| self.shape.sample_point(u), |(place, _)| place);
        let to = self.point(place) - point;
        let distance_m = to.length();
        if !(distance_m > 0.0 && distance_m.is_finite()) {
            return None;
        }
        let illuminance_lx = match near {
            Some((_, solid_angle_sr)) => self.luminance_cd_m2() * solid_angle_sr,
            None => self.flux_lm * (height_m / distance_m) / (PI * distance_m * distance_m),
        };
        Some(DirectLight { towards: to / distance_m, distance_m, illuminance_lx })
    }

    /// Where the ray crosses the shape from its lit side.
    fn seen(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        let cosine = -direction.dot(self.axes.z_axis);
        if cosine <= 0.0 {
            return None;
        }
        let t = (origin - self.centre).dot(self.axes.z_axis) / cosine;
        if !(t > 0.0 && t.is_finite()) {
            return None;
        }
        self.shape.contains(self.foot(origin + direction * t)).then(|| (self.luminance_cd_m2(), t))
    }

    fn outline(&self) -> Vec<DVec3> {
        self.shape.outline().into_iter().map(|place| self.point(place)).collect()
    }

    #[inline]
    fn kind(&self) -> EmitterKind {
        EmitterKind { coordinates: 4, direct_coordinates: 2, ..EmitterKind::new(S::NOUN, S::REQUIRES) }
    }
}
