//! The leaf test: a triangle against a ray, watertight, in f64.
//!
//! Edge functions have exact signs ([`super::exact`]) and edges and vertices belong to every triangle that has them.
//! Seen along the ray a mesh is therefore a consistent planar map, and a line cannot pass between two triangles that
//! share an edge.

use super::exact::{exact_difference, signed_difference};
use super::ray::{Ray, Sheared};

/// Triangles a leaf holds at most.
pub(crate) const LANES: usize = 4;

/// Factor of a rounding bound: 16 half-ulps cover the subtraction of the origin, the shear, and the rounding of the
/// origin itself, which is a hit position computed from other vertices of the same size.
const GAMMA: f64 = 16.0 * 0.5 * f64::EPSILON;

/// A leaf: up to four primitives, coordinates inline.
#[derive(Debug, Clone)]
#[repr(align(32))]
pub(crate) struct Block {
    /// `[vertex][axis][lane]` in metres; NaN for lanes that are no triangle.
    pub v: [[[f64; LANES]; 3]; 3],
    /// Primitive number, counted through all surfaces.
    pub primitive: [u32; LANES],
    /// The surface of each lane.
    pub surface: [u32; LANES],
    /// Lanes in use.
    pub count: u32,
    /// Bit per lane: an analytic shape, not a triangle.
    pub analytic: u32,
}

impl Block {
    /// A block without primitives.
    pub const EMPTY: Self = Self {
        v: [[[f64::NAN; LANES]; 3]; 3],
        primitive: [0; LANES],
        surface: [0; LANES],
        count: 0,
        analytic: 0,
    };

    /// The triangle in a lane.
    #[inline(always)]
    pub fn triangle(&self, lane: usize) -> [[f64; 3]; 3] {
        let corner = |k: usize| [self.v[k][0][lane], self.v[k][1][lane], self.v[k][2][lane]];
        [corner(0), corner(1), corner(2)]
    }

    /// The lanes in the ray's frame, and a bit for each that is not surely missed. An edge function that is zero in
    /// rounded arithmetic, or NaN, rules nothing out, so this agrees with the exact test on every lane it clears.
    #[inline(always)]
    pub fn candidates(&self, ray: &Ray) -> (Lanes, u32) {
        let [mut x, mut y, mut depths] = [[[0.0; LANES]; 3]; 3];
        let (ox, oy, oz) = (ray.o[ray.kx], ray.o[ray.ky], ray.o[ray.kz]);
        for k in 0..3 {
            let (vx, vy, vz) = (&self.v[k][ray.kx], &self.v[k][ray.ky], &self.v[k][ray.kz]);
            for l in 0..LANES {
                let depth = vz[l] - oz;
                depths[k][l] = depth;
                x[k][l] = (vx[l] - ox) - ray.sx * depth;
                y[k][l] = (vy[l] - oy) - ray.sy * depth;
            }
        }
        let mut positive = [0u64; LANES];
        let mut negative = [0u64; LANES];
        for (i, j) in [(2, 1), (0, 2), (1, 0)] {
            for l in 0..LANES {
                let (p, q) = (x[i][l] * y[j][l], y[i][l] * x[j][l]);
                positive[l] |= if p > q { u64::MAX } else { 0 };
                negative[l] |= if p < q { u64::MAX } else { 0 };
            }
        }
        let mut mask = 0;
        for l in 0..LANES {
            mask |= u32::from(positive[l] & negative[l] == 0) << l;
        }
        (Lanes { x, y, depth: depths }, mask & ((1 << self.count) - 1))
    }
}

/// The triangles of a leaf as the ray sees them, `[vertex][lane]`: what [`Ray::shear`] gives.
pub(crate) struct Lanes {
    x: [[f64; LANES]; 3],
    y: [[f64; LANES]; 3],
    /// Along the ray's main axis, not yet times [`Ray::sz`].
    depth: [[f64; LANES]; 3],
}

impl Lanes {
    /// One of them.
    #[inline(always)]
    pub fn view(&self, lane: usize, ray: &Ray) -> View {
        let corner =
            |k: usize| Sheared { x: self.x[k][lane], y: self.y[k][lane], z: ray.sz * self.depth[k][lane] };
        View::of([corner(0), corner(1), corner(2)])
    }
}

/// Where a ray's line meets a triangle.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Crossing {
    /// Ray parameter [m], of either sign.
    pub t: f64,
    /// Barycentric weights of the second and third corner.
    pub weights: [f64; 2],
    /// The ray arrives on the side the right-handed normal points to.
    pub front: bool,
}

/// A triangle in the ray's frame.
#[derive(Debug, Clone, Copy)]
pub(crate) struct View {
    corners: [Sheared; 3],
    /// Edge functions opposite the corners, of exact sign.
    edge: [f64; 3],
}

impl View {
    /// A view for what is no triangle.
    pub const NONE: Self = Self { corners: [Sheared { x: 0.0, y: 0.0, z: 0.0 }; 3], edge: [0.0; 3] };

    /// The triangle as the ray sees it.
    #[inline(always)]
    pub fn new(triangle: &[[f64; 3]; 3], ray: &Ray) -> Self {
        Self::of([ray.shear(triangle[0]), ray.shear(triangle[1]), ray.shear(triangle[2])])
    }

    #[inline(always)]
    fn of([a, b, c]: [Sheared; 3]) -> Self {
        let edge = [
            signed_difference(c.x, b.y, c.y, b.x),
            signed_difference(a.x, c.y, a.y, c.x),
            signed_difference(b.x, a.y, b.y, a.x),
        ];
        Self { corners: [a, b, c], edge }
    }

    /// The crossing, if the line meets the triangle; a triangle seen exactly edge-on is never met.
    #[inline(always)]
    pub fn crossing(&self) -> Option<Crossing> {
        let [u, v, w] = self.edge;
        let outside = (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0);
        let sum = u + v + w;
        if outside || sum == 0.0 {
            return None;
        }
        // Cancellation in the edge functions of a sliver would put the point beside the line; take them exactly then.
        let size = self.extent();
        if sum.abs() < size * size * (1.0 / 1_048_576.0) {
            return Some(self.clamped(self.refined()));
        }
        Some(self.interpolate(self.edge))
    }

    /// The crossing if the line meets the triangle or misses it by no more than rounding; weights are clamped.
    pub fn lenient_crossing(&self, coordinate_error: f64) -> Option<Crossing> {
        let error = self.edge_error(coordinate_error);
        let edge = self.refined();
        let sum: f64 = edge[0] + edge[1] + edge[2];
        let towards = sum.signum();
        if sum == 0.0 || edge.iter().any(|e| e * towards < -error) {
            return None;
        }
        Some(self.clamped(edge.map(|e| if e * towards < 0.0 { 0.0 } else { e })))
    }

    fn refined(&self) -> [f64; 3] {
        let [a, b, c] = &self.corners;
        [
            exact_difference(c.x, b.y, c.y, b.x),
            exact_difference(a.x, c.y, a.y, c.x),
            exact_difference(b.x, a.y, b.y, a.x),
        ]
    }

    #[inline(always)]
    fn interpolate(&self, [u, v, w]: [f64; 3]) -> Crossing {
        let [a, b, c] = &self.corners;
        let sum = u + v + w;
        let t = (u * a.z + v * b.z + w * c.z) / sum;
        Crossing { t, weights: [v / sum, w / sum], front: sum > 0.0 }
    }

    /// The same for a sliver, whose point rounding must not carry beyond its corners.
    #[cold]
    fn clamped(&self, edge: [f64; 3]) -> Crossing {
        let [a, b, c] = &self.corners;
        let crossing = self.interpolate(edge);
        let t = crossing.t.max(a.z.min(b.z).min(c.z)).min(a.z.max(b.z).max(c.z));
        Crossing { t, ..crossing }
    }

    /// Largest coordinate across the ray.
    #[inline(always)]
    fn extent(&self) -> f64 {
        self.corners.iter().fold(0.0, |m, s| larger(larger(s.x.abs(), s.y.abs()), m))
    }

    /// Bound of the error of an edge function whose coordinates are each wrong by at most `coordinate_error`.
    fn edge_error(&self, coordinate_error: f64) -> f64 {
        4.0 * coordinate_error * (self.extent() + coordinate_error)
    }

    /// Bound of the error of `t`: the weights' errors times the spread of the corners, and the corners' own.
    pub fn bound(&self, ray: &Ray, coordinate_error: f64) -> f64 {
        let [a, b, c] = &self.corners;
        let spread = larger(larger((a.z - b.z).abs(), (b.z - c.z).abs()), (c.z - a.z).abs());
        let sum = (self.edge[0] + self.edge[1] + self.edge[2]).abs();
        let weights = 3.0 * self.edge_error(coordinate_error) / sum;
        weights.min(1.0) * spread + 2.0 * coordinate_error * ray.sz.abs()
    }
}

/// The larger number: one instruction, where `f64::max` with its care for NaN takes four.
#[inline(always)]
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// Bound of the rounding error [m] of a sheared coordinate of this triangle.
#[inline(always)]
pub(crate) fn coordinate_error(triangle: &[[f64; 3]; 3], ray: &Ray) -> f64 {
    let [a, b, c] = triangle;
    let largest = |v: &[f64; 3]| larger(larger(v[0].abs(), v[1].abs()), v[2].abs());
    let size = larger(larger(largest(a), largest(b)), larger(largest(c), largest(&ray.o)));
    // |v - o| is at most twice the largest coordinate.
    GAMMA * 3.0 * size
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    /// Numbers in [-1, 1) without pattern.
    fn number(state: &mut u64) -> f64 {
        *state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    #[test]
    fn a_line_through_a_closed_fan_meets_it_whatever_rounding_does() {
        let mut s = 1;
        let mut point = |scale: f64| DVec3::new(number(&mut s), number(&mut s), number(&mut s)) * scale;
        for i in 0..300_000 {
            // Eight triangles about a vertex; the line passes the vertex or a spoke, give or take rounding.
            let rim: Vec<DVec3> = (0..8)
                .map(|k| {
                    let (sin, cos) = (f64::from(k) * 0.785).sin_cos();
                    DVec3::new(cos, sin, 0.0) + point(0.1)
                })
                .collect();
            let hub = point(0.05);
            let aim = if i % 2 == 0 { hub } else { hub + (rim[i % 8] - hub) * (0.9 * point(0.5).x.abs()) };
            let direction = (point(0.5) - DVec3::Z).normalize();
            let ray = Ray::new(aim - direction * 3.0, direction).unwrap();
            let fan = (0..8).map(|k| [hub, rim[k], rim[(k + 1) % 8]].map(|v| v.to_array()));
            let hits = fan.filter_map(|t| View::new(&t, &ray).crossing()).count();
            assert!(hits >= 1, "{i}");
        }
    }
}
