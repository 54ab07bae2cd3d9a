//! An exact paraboloid of revolution, clipped at its rim.

use std::f64::consts::TAU;

use glam::DVec3;

use super::exact::exact_difference;
use super::ray::Ray;
use super::sphere::{GAMMA, Root};
use super::{COORDINATE, LENGTH, Transform};
use crate::error::Invalid;
use crate::math::frame::unit;
use crate::math::trig::sin_cos;

/// A bowl: points at height `r^2 / (4 f)` over the vertex along the axis, out to the rim radius. The outward normal
/// points to the side of the focus. Open.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Paraboloid {
    vertex: DVec3,
    axis: DVec3,
    focal_length: f64,
    radius: f64,
    /// Unit vectors that make a right-handed frame with the axis.
    x: DVec3,
    y: DVec3,
}

impl Paraboloid {
    /// Vertex (m), axis (towards the focus, any length), focal length (m) and rim radius (m).
    ///
    /// # Errors
    /// An axis without direction, coordinates or lengths out of range.
    pub fn new(vertex: DVec3, axis: DVec3, focal_length: f64, radius: f64) -> Result<Self, Invalid> {
        let unit = unit(axis).ok_or(Invalid::NoDirection { what: "axis", value: axis })?;
        Self::about(vertex, unit, focal_length, radius)
    }

    /// The same about an axis of length 1 but for rounding.
    fn about(vertex: DVec3, axis: DVec3, focal_length: f64, radius: f64) -> Result<Self, Invalid> {
        COORDINATE.vector("vertex", vertex)?;
        LENGTH.check("focal_length", focal_length)?;
        LENGTH.check("radius", radius)?;
        let axis = axis.normalize();
        let x = perpendicular(axis);
        Ok(Self { vertex, axis, focal_length, radius, x, y: axis.cross(x) })
    }

    /// The vertex (m).
    pub fn vertex(&self) -> DVec3 {
        self.vertex
    }

    /// The unit axis, from the vertex to the focus.
    pub fn axis(&self) -> DVec3 {
        self.axis
    }

    /// Distance from vertex to focus (m).
    pub fn focal_length(&self) -> f64 {
        self.focal_length
    }

    /// Radius of the rim (m).
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// The focus (m).
    pub fn focus(&self) -> DVec3 {
        self.vertex + self.axis * self.focal_length
    }

    /// Area (m2): (8 pi f^2 / 3) ((1 + R^2 / 4 f^2)^(3/2) - 1).
    pub fn area(&self) -> f64 {
        let f = self.focal_length;
        8.0 * std::f64::consts::PI / 3.0 * f * f * self.area_fraction(self.radius)
    }

    /// Equal-area map: u = azimuth about the axis over 2 pi, v = area up to this radius over the whole. The azimuth
    /// starts at the axis crossed with the coordinate axis it is least along.
    pub fn uv(&self, position: DVec3) -> (f64, f64) {
        let d = position - self.vertex;
        let (x, y) = (d.dot(self.x), d.dot(self.y));
        let u = libm::atan2(y, x) / TAU;
        let v = self.area_fraction((x * x + y * y).sqrt()) / self.area_fraction(self.radius);
        (if u < 0.0 { (u + 1.0).min(1.0) } else { u }, v.clamp(0.0, 1.0))
    }

    /// The point of these coordinates: the inverse of [`Paraboloid::uv`].
    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        let within = v * self.area_fraction(self.radius);
        let r = 2.0 * self.focal_length * libm::expm1(libm::log1p(within) / 1.5).sqrt();
        let (sin, cos) = sin_cos(TAU * u);
        let along = 0.25 * r * r / self.focal_length;
        self.vertex + self.x * (r * cos) + self.y * (r * sin) + self.axis * along
    }

    /// The paraboloid, moved.
    ///
    /// # Errors
    /// A scale that is not uniform.
    pub fn transformed(&self, by: &Transform) -> Result<Self, Invalid> {
        let s = by.uniform_scale()?;
        Self::about(by.point(self.vertex), by.rotate(self.axis), self.focal_length * s, self.radius * s)
    }

    /// (1 + r^2 / 4 f^2)^(3/2) - 1 without cancellation for shallow bowls.
    fn area_fraction(&self, r: f64) -> f64 {
        let s = 0.5 * r / self.focal_length;
        libm::expm1(1.5 * libm::log1p(s * s))
    }

    fn local(&self, v: DVec3) -> DVec3 {
        DVec3::new(v.dot(self.x), v.dot(self.y), v.dot(self.axis))
    }

    /// Unit normal towards the focus side at a point of the surface.
    pub(crate) fn normal(&self, position: DVec3) -> DVec3 {
        let p = self.local(position - self.vertex);
        (self.axis * (2.0 * self.focal_length) - self.x * p.x - self.y * p.y).normalize()
    }

    /// The point of the surface above the same (x, y) as one that is on it but for rounding.
    pub(crate) fn project(&self, position: DVec3) -> DVec3 {
        let p = self.local(position - self.vertex);
        let z = (p.x * p.x + p.y * p.y) / (4.0 * self.focal_length);
        self.vertex + self.x * p.x + self.y * p.y + self.axis * z
    }

    /// The bowl as triangles with their corners on it, outward as it is itself: `rings` rings of equal width, and three times
    /// as many sectors.
    pub(crate) fn facets(&self, rings: u32) -> Vec<[DVec3; 3]> {
        let sectors = 3 * rings.max(1);
        let point = |i: u32, j: u32| {
            let radius = self.radius * f64::from(i) / f64::from(rings);
            let phi = TAU * f64::from(j % sectors) / f64::from(sectors);
            let across = self.x * libm::cos(phi) + self.y * libm::sin(phi);
            self.project(self.vertex + across * radius)
        };
        let mut facets = Vec::new();
        for i in 0..rings {
            for j in 0..sectors {
                let [a, b, c, d] = [point(i, j), point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)];
                facets.push([a, b, c]);
                if i > 0 {
                    facets.push([a, c, d]);
                }
            }
        }
        facets
    }

    /// Rounding bound (m) of a distance along this ray, where it is not grazing.
    pub(crate) fn bound(&self, ray: &Ray) -> f64 {
        let size = ray.origin.abs().max_element().max(self.vertex.abs().max_element());
        GAMMA * (size + self.radius + self.focal_length)
    }

    pub(crate) fn bounds(&self) -> (DVec3, DVec3) {
        // The rim disc and the vertex span it; the bowl lies in their convex hull's box.
        let depth = self.radius * self.radius / (4.0 * self.focal_length);
        let rim = self.vertex + self.axis * depth;
        let across = |a: f64| self.radius * (1.0 - a * a).max(0.0).sqrt();
        let half = DVec3::new(across(self.axis.x), across(self.axis.y), across(self.axis.z));
        let room = DVec3::splat(GAMMA * (self.radius + depth + self.vertex.abs().max_element()));
        let (lo, hi) = ((rim - half).min(self.vertex), (rim + half).max(self.vertex));
        // Where a coordinate axis is nearly across, the bowl bulges past the chord from vertex to rim.
        let bulge = DVec3::from_array(std::array::from_fn(|k| self.bulge(k)));
        (lo.min(self.vertex - bulge) - room, hi.max(self.vertex + bulge) + room)
    }

    /// Furthest the bowl goes from its vertex against the axis direction along coordinate `k`: the minimum of
    /// `a r^2 / 4f - s r` over r, with a, s the cosine and sine between axis and coordinate.
    fn bulge(&self, k: usize) -> f64 {
        let a = self.axis[k].abs();
        let s = (1.0 - a * a).max(0.0).sqrt();
        let r = if a * self.radius > 2.0 * self.focal_length * s {
            2.0 * self.focal_length * s / a
        } else {
            self.radius
        };
        s * r - a * r * r / (4.0 * self.focal_length)
    }

    /// The roots within the rim. From a point `on` the surface one root is 0 by definition and is divided out.
    ///
    /// The ray is first moved next to the bowl, so that far origins cost no more than their own rounding; then
    /// A t^2 + 2 B t + C = 0 with its discriminant rounded once from the exact value.
    pub(crate) fn roots(&self, ray: &Ray, on: bool) -> [Option<Root>; 2] {
        let f = self.focal_length;
        let d = self.local(ray.direction);
        let from_vertex = ray.origin - self.vertex;
        let shift = if on { 0.0 } else { -from_vertex.dot(ray.direction) };
        let o = self.local(from_vertex + ray.direction * shift);
        let error = self.bound(ray);
        let a = d.x * d.x + d.y * d.y;
        let b = o.x * d.x + o.y * d.y - 2.0 * f * d.z;
        let at = |t: f64| {
            let (x, y) = (o.x + t * d.x, o.y + t * d.y);
            // Half the rate at which x^2 + y^2 - 4 f z, negative on the focus side, grows.
            let slope = a * t + b;
            let gradient = (x * x + y * y + 4.0 * f * f).sqrt();
            let bound = error * (gradient / slope.abs()).min(1.0 / f64::EPSILON);
            let inside = x * x + y * y <= self.radius * self.radius && t.is_finite();
            inside.then_some(Root { t: t + shift, bound, front: slope > 0.0 })
        };
        if on {
            let other = (a > 0.0).then(|| at(-2.0 * b / a)).flatten();
            return [other, None];
        }
        let c = o.x * o.x + o.y * o.y - 4.0 * f * o.z;
        let discriminant = exact_difference(b, b, a, c);
        if !(discriminant >= 0.0) {
            return [None, None];
        }
        let q = -(b + discriminant.sqrt().copysign(b));
        if q == 0.0 {
            return [at(0.0), None];
        }
        let (first, second) = (at(c / q), if a > 0.0 { at(q / a) } else { None });
        [first, second]
    }
}

/// A unit vector across a unit vector: crossed with the coordinate axis it is least along.
fn perpendicular(n: DVec3) -> DVec3 {
    let m = n.abs();
    let axis = if m.x <= m.y && m.x <= m.z {
        DVec3::X
    } else if m.y <= m.z {
        DVec3::Y
    } else {
        DVec3::Z
    };
    n.cross(axis).normalize()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dish() -> Paraboloid {
        Paraboloid::new(DVec3::new(0.1, -0.2, 0.3), DVec3::new(1.0, 2.0, 2.0), 0.25, 0.8).unwrap()
    }

    #[test]
    fn rays_along_the_axis_meet_where_the_formula_says() {
        let p = dish();
        for r in [0.0, 0.1, 0.5, 0.79] {
            let start = p.vertex + p.x * r + p.axis * 7.0;
            let ray = Ray::new(start, -p.axis).unwrap();
            let [root, other] = p.roots(&ray, false);
            let root = root.or(other).unwrap();
            assert!((root.t - (7.0 - r * r)).abs() < 1e-14, "{r}: {}", root.t);
            assert!(root.front);
        }
        let ray = Ray::new(p.vertex + p.x * 0.81 + p.axis * 7.0, -p.axis).unwrap();
        assert_eq!(p.roots(&ray, false), [None, None]);
    }

    #[test]
    fn the_reflected_axis_ray_passes_the_focus() {
        let p = dish();
        let ray = Ray::new(p.vertex + p.y * 0.6 + p.axis * 7.0, -p.axis).unwrap();
        let root = p.roots(&ray, false).into_iter().flatten().next().unwrap();
        let at = p.project(ray.origin + ray.direction * root.t);
        let n = p.normal(at);
        let out = ray.direction - n * (2.0 * ray.direction.dot(n));
        let miss = (p.focus() - at) - out * (p.focus() - at).dot(out);
        assert!(miss.length() < 1e-15);
    }

    #[test]
    fn area_map_agrees_with_quadrature() {
        // dA = r sqrt(1 + r^2 / 4 f^2) dr dphi, by Simpson's rule.
        let p = dish();
        let integral = |r: f64| {
            let n = 2000;
            let g = |x: f64| TAU * x * (1.0 + x * x / (4.0 * p.focal_length.powi(2))).sqrt();
            let h = r / f64::from(n);
            (0..=n)
                .map(|i| {
                    let w = if i == 0 || i == n { 1.0 } else { 2.0 + 2.0 * f64::from(i % 2) };
                    w * g(h * f64::from(i)) * h / 3.0
                })
                .sum::<f64>()
        };
        assert!((p.area() / integral(0.8) - 1.0).abs() < 1e-12);
        let at = p.project(p.vertex + p.x * 0.3 + p.y * 0.4);
        let (u, v) = p.uv(at);
        assert!((v - integral(0.5) / integral(0.8)).abs() < 1e-12);
        assert!((u - 4f64.atan2(3.0) / TAU).abs() < 1e-12);
        assert!((p.at(u, v) - at).length() < 1e-12);
        // A mirror as flat as a plate: area pi R^2 (1 + R^2 / 16 f^2 ...).
        let flat = Paraboloid::new(DVec3::ZERO, DVec3::Z, 1e6, 1.0).unwrap();
        assert!((flat.area() / (std::f64::consts::PI * (1.0 + 1.0 / 16e12)) - 1.0).abs() < 1e-14);
    }

    #[test]
    fn the_box_holds_the_bowl() {
        for axis in
            [DVec3::Z, DVec3::new(1.0, 2.0, 2.0), DVec3::new(-1.0, 0.1, 0.0), DVec3::new(0.3, -1.0, 0.02)]
        {
            for f in [0.05, 0.25, 3.0] {
                let p = Paraboloid::new(DVec3::new(0.1, -0.2, 0.3), axis, f, 0.8).unwrap();
                let (lo, hi) = p.bounds();
                let (mut least, mut most) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
                for i in 0..=200 {
                    for j in 0..200 {
                        let (r, a) = (0.8 * f64::from(i) / 200.0, f64::from(j) * TAU / 200.0);
                        let q = p.project(p.vertex + p.x * (r * a.cos()) + p.y * (r * a.sin()));
                        least = least.min(q);
                        most = most.max(q);
                    }
                }
                assert!((least - lo).min_element() >= 0.0 && (hi - most).min_element() >= 0.0);
            }
        }
    }
}
