//! A flat rectangle.

use glam::DVec3;

use super::{COORDINATE, LENGTH, Transform};
use crate::error::Invalid;

/// A rectangle: a corner and two perpendicular edges; the outward normal is `edge_u x edge_v`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rectangle {
    corners: [DVec3; 4],
    edge_u: DVec3,
    edge_v: DVec3,
}

impl Rectangle {
    /// A rectangle from its (u = 0, v = 0) corner (m) and its edges (m).
    ///
    /// # Errors
    /// A corner or lengths out of range, edges that are not perpendicular to 1e-9 of their lengths or vanish in the rounding of
    /// the corner.
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Result<Self, Invalid> {
        COORDINATE.vector("corner", corner)?;
        let (lu, lv) = (length("edge_u", edge_u)?, length("edge_v", edge_v)?);
        let cosine = (edge_u / lu).dot(edge_v / lv);
        if !(cosine.abs() <= 1e-9) {
            let angle_deg = libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees();
            return Err(Invalid::Skew { what: "edge_v", to: "edge_u", angle_deg });
        }
        let corners = [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v];
        let flat = |i: usize, j: usize| corners[i] == corners[j];
        if flat(0, 1) || flat(1, 2) || flat(2, 3) || flat(3, 0) {
            return Err(Invalid::Shape {
                what: "corner",
                found: format!("a rectangle at {corner} whose edges vanish in the rounding of its corner"),
                required: "edges longer than the precision of the corner's coordinates",
            });
        }
        Ok(Self { corners, edge_u, edge_v })
    }

    /// The (u = 0, v = 0) corner (m).
    pub fn corner(&self) -> DVec3 {
        self.corners[0]
    }

    /// The edge along u (m).
    pub fn edge_u(&self) -> DVec3 {
        self.edge_u
    }

    /// The edge along v (m).
    pub fn edge_v(&self) -> DVec3 {
        self.edge_v
    }

    /// Outward unit normal.
    pub fn normal(&self) -> DVec3 {
        self.edge_u.normalize().cross(self.edge_v.normalize()).normalize()
    }

    /// Area (m2).
    pub fn area(&self) -> f64 {
        self.edge_u.length() * self.edge_v.length()
    }

    /// Fractions of the edges at a point, clamped to `[0, 1]`.
    pub fn uv(&self, position: DVec3) -> (f64, f64) {
        let d = position - self.corners[0];
        let along = |e: DVec3| (d.dot(e) / e.length_squared()).clamp(0.0, 1.0);
        (along(self.edge_u), along(self.edge_v))
    }

    /// The point of these fractions of the edges.
    pub fn at(&self, u: f64, v: f64) -> DVec3 {
        self.corners[0] + self.edge_u * u + self.edge_v * v
    }

    /// The rectangle, moved.
    ///
    /// # Errors
    /// See [`Rectangle::new`].
    pub fn transformed(&self, by: &Transform) -> Result<Self, Invalid> {
        Self::new(by.point(self.corners[0]), by.vector(self.edge_u), by.vector(self.edge_v))
    }

    /// Half 0 (corner, u, u + v) or 1 (corner, u + v, v); the shared corners are the same bits.
    pub(crate) fn triangle(&self, face: usize) -> [DVec3; 3] {
        let [a, b, c, d] = self.corners;
        if face == 0 { [a, b, c] } else { [a, c, d] }
    }
}

fn length(what: &'static str, edge: DVec3) -> Result<f64, Invalid> {
    let length = edge.length();
    if LENGTH.contains(length) {
        return Ok(length);
    }
    let found = format!("{what} of {length} m");
    Err(Invalid::Shape { what, found, required: "an edge [x, y, z] with a length from 1e-9 to 1e9 m" })
}
