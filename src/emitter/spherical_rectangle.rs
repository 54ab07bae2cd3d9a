//! Points of a rectangle, uniform in the solid angle that it fills from a point.
//!
//! Near a panel a point uniform over its area makes an estimate of illuminance whose variance has no bound; uniform in solid
//! angle it has one. (C. Urena, M. Fajardo, A. King, "An Area-Preserving Parametrization for Spherical Rectangles", Computer
//! Graphics Forum 32 (4), 2013.)

use glam::DVec3;

use crate::math::trig::sin_cos;

/// A rectangle in a frame whose origin is the point: x and y along its edges, z = -height.
#[derive(Debug, Clone, Copy)]
pub(super) struct SphericalRectangle {
    x: [f64; 2],
    y: [f64; 2],
    /// Distance of the point from the rectangle's plane, m.
    height: f64,
    solid_angle_sr: f64,
    /// The part of the sum of angles that belongs to the two edges along y.
    k: f64,
    b: [f64; 2],
}

impl SphericalRectangle {
    /// A rectangle from (x0, y0) to (x1, y1) in a plane at a positive height.
    pub fn new(x: [f64; 2], y: [f64; 2], height: f64) -> Self {
        let corner = |i: usize, j: usize| DVec3::new(x[i], y[j], -height);
        let corners = [corner(0, 0), corner(1, 0), corner(1, 1), corner(0, 1)];
        let normals: [DVec3; 4] = std::array::from_fn(|i| corners[i].cross(corners[(i + 1) % 4]).normalize());
        // The angle between neighbouring sides; by the arc tangent, because an arc cosine loses half its digits near 0 and pi.
        let angles: [f64; 4] = std::array::from_fn(|i| {
            let (a, b) = (normals[i], normals[(i + 1) % 4]);
            libm::atan2(a.cross(b).length(), -a.dot(b))
        });
        let k = 2.0 * std::f64::consts::PI - angles[2] - angles[3];
        Self { x, y, height, solid_angle_sr: angles[0] + angles[1] - k, k, b: [normals[0].z, normals[2].z] }
    }

    /// The solid angle, sr.
    pub fn solid_angle_sr(&self) -> f64 {
        self.solid_angle_sr
    }

    /// The point (x, y) for a point of the unit square.
    pub fn sample(&self, u: [f64; 2]) -> [f64; 2] {
        let (sin, cos) = sin_cos(u[0] * self.solid_angle_sr + self.k);
        let [b0, b1] = self.b;
        let f = (cos * b0 - b1) / sin;
        let c = (1f64.copysign(f) / (f * f + b0 * b0).sqrt()).clamp(-1.0, 1.0);
        // At c = +-1 infinite, and held by the edges.
        let x = (c * self.height / ((1.0 - c) * (1.0 + c)).sqrt()).clamp(self.x[0], self.x[1]);
        let d2 = x * x + self.height * self.height;
        let [h0, h1] = self.y.map(|y| y / (d2 + y * y).sqrt());
        let h = h0 + u[1] * (h1 - h0);
        let y = (h * (d2 / ((1.0 - h) * (1.0 + h))).sqrt()).clamp(self.y[0], self.y[1]);
        [x, y]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Solid angle of a rectangle from (0, 0): atan(x y / (h sqrt(x^2 + y^2 + h^2))), with signs.
    fn solid_angle(x: [f64; 2], y: [f64; 2], h: f64) -> f64 {
        let corner = |x: f64, y: f64| (x * y / (h * (x * x + y * y + h * h).sqrt())).atan();
        corner(x[1], y[1]) - corner(x[0], y[1]) - corner(x[1], y[0]) + corner(x[0], y[0])
    }

    #[test]
    fn solid_angles_are_those_of_the_formula() {
        for (x, y, h) in [
            ([-1.0, 1.0], [-1.0, 1.0], 1.0),
            ([0.0, 1.0], [0.0, 1.0], 1.0),
            ([0.5, 3.0], [-2.0, -1.0], 0.01),
            ([-0.1, 0.1], [0.2, 9.0], 2.0),
            ([-1.0, 1.0], [-1.0, 1.0], 1e-9),
        ] {
            let s = SphericalRectangle::new(x, y, h).solid_angle_sr();
            assert!((s - solid_angle(x, y, h)).abs() < 1e-13, "{s}");
        }
    }

    #[test]
    fn every_part_gets_its_share_of_the_solid_angle() {
        for (x, y, h) in
            [([-1.0, 0.5], [-0.2, 2.0], 0.3), ([1.0, 2.0], [0.5, 4.0], 1.0), ([-1.0, 1.0], [0.0, 1.0], 1e-3)]
        {
            let rectangle = SphericalRectangle::new(x, y, h);
            let n = 1000;
            for part in [[0.5, 0.5], [0.2, 1.0], [1.0, 0.3]] {
                let end = [x[0] + part[0] * (x[1] - x[0]), y[0] + part[1] * (y[1] - y[0])];
                let mut inside = 0;
                for i in 0..n {
                    for j in 0..n {
                        let u = [(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n)];
                        let p = rectangle.sample(u);
                        assert!(p[0] >= x[0] && p[0] <= x[1] && p[1] >= y[0] && p[1] <= y[1]);
                        inside += i32::from(p[0] < end[0] && p[1] < end[1]);
                    }
                }
                let share = solid_angle([x[0], end[0]], [y[0], end[1]], h) / solid_angle(x, y, h);
                assert!((f64::from(inside) / f64::from(n * n) - share).abs() < 4e-3, "{share}");
            }
        }
    }

    #[test]
    fn the_ends_of_the_unit_square_stay_inside() {
        let last = 1.0 - f64::EPSILON / 2.0;
        for h in [1e-12, 1e-3, 1.0, 1e3] {
            let rectangle = SphericalRectangle::new([-1.0, 2.0], [0.0, 1.0], h);
            for u in [[0.0, 0.0], [last, 0.0], [0.0, last], [last, last], [0.5, 0.5]] {
                let [x, y] = rectangle.sample(u);
                assert!((-1.0..=2.0).contains(&x) && (0.0..=1.0).contains(&y), "{h} {u:?}");
            }
        }
    }
}
