//! An exact sphere.

use std::f64::consts::TAU;

use glam::DVec3;

use super::ray::Ray;
use super::{COORDINATE, LENGTH, Transform};
use crate::error::Invalid;
use crate::math::trig::sin_cos;

/// A sphere; the outward normal points away from the centre.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Sphere {
    centre: DVec3,
    radius: f64,
}

/// A root of an exact shape: distance, its rounding bound, and whether the ray arrives at the front.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Root {
    pub t: f64,
    pub bound: f64,
    pub front: bool,
}

/// 16 half-ulps, as for triangles.
pub(super) const GAMMA: f64 = 16.0 * 0.5 * f64::EPSILON;

impl Sphere {
    /// A sphere of positive radius (m).
    ///
    /// # Errors
    /// A centre or radius out of range.
    pub fn new(centre: DVec3, radius: f64) -> Result<Self, Invalid> {
        COORDINATE.vector("center", centre)?;
        LENGTH.check("radius", radius)?;
        Ok(Self { centre, radius })
    }

    /// The centre (m).
    pub fn centre(&self) -> DVec3 {
        self.centre
    }

    /// The radius (m).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Area (m2).
    pub fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * self.radius * self.radius
    }

    /// Lambert's equal-area cylindrical map: u = azimuth about z from x, over 2 pi; v = (1 + z / radius) / 2.
    pub fn uv(&self, position: DVec3) -> (f64, f64) {
        let d = position - self.centre;
        let u = libm::atan2(d.y, d.x) / TAU;
        let v = 0.5 + 0.5 * d.z / d.length();
        (if u < 0.0 { (u + 1.0).min(1.0) } else { u }, v.clamp(0.0, 1.0))
    }

    /// The point of these coordinates: the inverse of [`Sphere::uv`].
    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        let z = 2.0 * v - 1.0;
        let across = ((1.0 - z) * (1.0 + z)).max(0.0).sqrt();
        let (sin, cos) = sin_cos(TAU * u);
        self.centre + DVec3::new(across * cos, across * sin, z) * self.radius
    }

    /// The sphere, moved.
    ///
    /// # Errors
    /// A scale that is not uniform.
    pub fn transformed(&self, by: &Transform) -> Result<Self, Invalid> {
        Self::new(by.point(self.centre), self.radius * by.uniform_scale()?)
    }

    /// Outward unit normal at a point of the surface.
    pub(crate) fn normal(&self, position: DVec3) -> DVec3 {
        (position - self.centre).normalize()
    }

    /// The point of the surface next to one that is on it but for rounding.
    pub(crate) fn project(&self, position: DVec3) -> DVec3 {
        self.centre + self.normal(position) * self.radius
    }

    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        let r = DVec3::splat(self.radius);
        (self.centre - r, self.centre + r)
    }

    /// The roots, nearest first. From a point `on` the sphere one root is 0 by definition and is divided out; the
    /// other remains.
    ///
    /// Without cancellation: the discriminant from the distance of the centre to the line, and the smaller root as a
    /// quotient (E. Haines et al., Precision Improvements for Ray/Sphere Intersection, Ray Tracing Gems 7, 2019).
    pub(crate) fn roots(&self, ray: &Ray, on: bool) -> [Option<Root>; 2] {
        let d = ray.direction;
        let oc = ray.origin - self.centre;
        let a = d.length_squared();
        let b = oc.dot(d);
        let size = ray.origin.abs().max_element().max(self.centre.abs().max_element()) + self.radius;
        let error = GAMMA * size;
        if on {
            let front = b > 0.0;
            return [Some(Root { t: -2.0 * b / a, bound: 4.0 * error, front }), None];
        }
        let across = (oc - d * (b / a)).length();
        let square = (self.radius - across) * (self.radius + across);
        if !(square >= 0.0) {
            return [None, None];
        }
        let half_chord = (square / a).sqrt();
        let distance = oc.length();
        let c = (distance - self.radius) * (distance + self.radius);
        let q = -(b + (a * half_chord).copysign(b));
        let (t0, t1) = if q == 0.0 { (0.0, 0.0) } else { (q / a, c / q) };
        let slant = (self.radius + across) / half_chord;
        let bound = (error * slant).min(2.0 * half_chord + error.sqrt() * self.radius.sqrt()) + error;
        let near = Root { t: t0.min(t1), bound, front: true };
        [Some(near), Some(Root { t: t0.max(t1), bound, front: false })]
    }

    /// The far end of the chord, for a ray that is inside by decree.
    pub(crate) fn exit(&self, ray: &Ray) -> Root {
        let oc = ray.origin - self.centre;
        let b = oc.dot(ray.direction);
        let across = (oc - ray.direction * b).length();
        let half_chord = ((self.radius - across) * (self.radius + across)).max(0.0).sqrt();
        let bound = GAMMA * (ray.origin.abs().max_element() + self.radius);
        Root { t: (half_chord - b).max(0.0), bound, front: false }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn area_map_has_equal_cells() {
        // The band between v1 and v2 has the area 2 pi R (z2 - z1) (Archimedes).
        let s = Sphere::new(DVec3::new(1.0, 2.0, 3.0), 2.0).unwrap();
        let (_, v) = s.uv(s.centre + DVec3::new(3f64.sqrt(), 0.0, 1.0));
        assert!((v - 0.75).abs() < 1e-15);
        let (u, _) = s.uv(s.centre + DVec3::new(0.0, -2.0, 0.0));
        assert!((u - 0.75).abs() < 1e-15);
        // Half-way up to the pole in area, at azimuth 60 degrees: z = R / 2 and x = R cos(60) sqrt(3) / 2.
        let at = s.at(1.0 / 6.0, 0.75) - s.centre;
        assert!((at - 2.0 * DVec3::new(3f64.sqrt() / 4.0, 0.75, 0.5)).length() < 1e-15);
        let (u, v) = s.uv(s.at(0.9, 0.03));
        assert!((u - 0.9).abs() < 1e-15 && (v - 0.03).abs() < 1e-15);
    }

    #[test]
    fn roots_do_not_cancel() {
        // From 1e8 radii away the near root is b - sqrt(b^2 - c): catastrophic in the textbook form.
        let s = Sphere::new(DVec3::ZERO, 1.0).unwrap();
        let ray = Ray::new(DVec3::new(-1e8, 0.0, 0.6), DVec3::X).unwrap();
        let [near, far] = s.roots(&ray, false).map(Option::unwrap);
        assert_eq!((near.t, far.t), (1e8 - 0.8, 1e8 + 0.8));
        // From 1e-9 outside the surface: the exact near root is 1e-9 / cos to first order.
        let h = 2f64.powi(-30);
        let ray = Ray::new(DVec3::new(0.0, 0.0, 1.0 + h), DVec3::new(0.8, 0.0, -0.6)).unwrap();
        let [near, _] = s.roots(&ray, false).map(Option::unwrap);
        // t = (1+h) 0.6 - sqrt(0.36 - (0.64)(2h + h^2)), as a series in h to third order.
        let e = 0.64 * (2.0 * h + h * h);
        let series =
            0.6 * h + 0.6 * (0.5 * (e / 0.36) + 0.125 * (e / 0.36).powi(2) + 0.0625 * (e / 0.36).powi(3));
        assert!((near.t / series - 1.0).abs() < 1e-9, "{} {series}", near.t);
    }

    #[test]
    fn from_the_surface_the_other_root_is_the_chord() {
        let s = Sphere::new(DVec3::ZERO, 2.0).unwrap();
        let ray = Ray::new(DVec3::new(0.0, 0.0, 2.0), DVec3::new(0.6, 0.0, -0.8)).unwrap();
        let [root, none] = s.roots(&ray, true);
        assert_eq!(none, None);
        let root = root.unwrap();
        assert!((root.t - 3.2).abs() < 1e-15 && !root.front);
    }
}
