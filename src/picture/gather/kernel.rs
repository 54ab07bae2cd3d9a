//! Kernels of density estimation, and their integrals over what is left of a surface within the ball.
//!
//! A kernel is K(d) = k(d^2 / r^2) / (pi r^2), a function of the distance d in space, with the integral 1
//! over a plane disc of radius r. A ball cuts of a sphere exactly the area pi r^2, evenly in d^2: there the
//! integral is 1 as well, for any such k.

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use crate::scene::camera::Kernel;

impl Kernel {
    /// k(t) at t = d^2 / r^2 < 1: the kernel in units of 1 / (pi r^2).
    #[inline(always)]
    pub fn shape(self, t: f64) -> f64 {
        match self {
            Self::Flat => 1.0,
            Self::Epanechnikov => 2.0 * (1.0 - t),
        }
    }

    /// The kernel's integral over the part of its own disc with d^2 / r^2 < t, for t in [0, 1].
    pub fn within(self, t: f64) -> f64 {
        match self {
            Self::Flat => t,
            Self::Epanechnikov => t * (2.0 - t),
        }
    }

    /// Integral of k^2 over the disc, over (pi r^2)^2: the variance of n independent photons is n times this
    /// over pi r^2.
    pub fn roughness(self) -> f64 {
        match self {
            Self::Flat => 1.0,
            Self::Epanechnikov => 4.0 / 3.0,
        }
    }

    /// The kernel's integral over a flat convex or concave polygon, by Green's theorem: exact. `corners` in
    /// the plane of the unit vector `normal`, right-handed about it, relative to the ball's centre in units
    /// of its radius.
    ///
    /// With p the centre's foot in the plane, an edge adds the integral over the triangle of p and the edge:
    /// in polar coordinates about p the integral along a ray is a polynomial in its length, and becomes one
    /// in the place t along the edge, since dphi = h dt / (h^2 + t^2), h the distance of the edge from p.
    /// Beyond the disc only the angle counts.
    pub fn over_polygon(self, corners: &[DVec3], normal: DVec3) -> f64 {
        let Some(last) = corners.last() else { return 0.0 };
        let height = last.dot(normal);
        let disc2 = 1.0 - height * height;
        if disc2 <= 0.0 {
            return 0.0;
        }
        // G(rho) = integral of k rho / pi from 0 to rho: a rho^2 - b rho^4.
        let (a, b) = match self {
            Self::Flat => (0.5 * FRAC_1_PI, 0.0),
            Self::Epanechnikov => (FRAC_1_PI * disc2, 0.5 * FRAC_1_PI),
        };
        let beyond = a * disc2 - b * disc2 * disc2;
        let foot = normal * height;
        let mut sum = 0.0;
        let mut from = *last - foot;
        for corner in corners {
            let to = *corner - foot;
            sum += edge(from, to, normal, disc2, [a, b, beyond]);
            from = to;
        }
        sum
    }

    /// The kernel's integral over a flat face that lies wholly within the ball: area, and mean of d^2 over
    /// the face, both in units of the radius.
    #[inline]
    pub fn over_whole(self, area: f64, mean_d2: f64) -> f64 {
        area * FRAC_1_PI * self.shape(mean_d2)
    }
}

/// What the edge between two points of the plane adds.
fn edge(from: DVec3, to: DVec3, normal: DVec3, disc2: f64, [a, b, beyond]: [f64; 3]) -> f64 {
    let along = to - from;
    let length = along.length();
    if length == 0.0 {
        return 0.0;
    }
    let along = along / length;
    let (t0, t1) = (from.dot(along), to.dot(along));
    let h = normal.dot(from.cross(along));
    let h2 = h * h;
    let reach = (disc2 - h2).max(0.0).sqrt();
    let (s0, s1) = (t0.clamp(-reach, reach), t1.clamp(-reach, reach));
    let primitive = |t: f64| ((a - b * h2) - b * t * t / 3.0) * t;
    let mut sum = h * (primitive(s1) - primitive(s0));
    if s0 > t0 || s1 < t1 {
        // atan(t / h), continued; an edge through p subtends no angle.
        let angle = |t: f64| if h == 0.0 { 0.0 } else { libm::atan2(t, h.abs()).copysign(t * h) };
        sum += beyond * ((angle(s0) - angle(t0)) + (angle(t1) - angle(s1)));
    }
    sum
}

/// Area of a disc of this radius (m), m2.
#[inline]
pub(crate) fn disc_m2(radius_m: f64) -> f64 {
    PI * radius_m * radius_m
}
