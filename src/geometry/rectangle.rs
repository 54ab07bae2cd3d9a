//! A flat rectangle.

use glam::DVec3;

use super::transform::{Transform, check_point};
use crate::error::{Diagnostic, Kind, Result};

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
    /// Edges that are not finite, have no length, or are not perpendicular to 1e-9 of their lengths.
    pub fn new(corner: DVec3, edge_u: DVec3, edge_v: DVec3) -> Result<Self> {
        for (what, v) in [("corner", corner), ("edge_u", edge_u), ("edge_v", edge_v)] {
            check_point(what, v)?;
        }
        let (lu, lv) = (edge_u.length(), edge_v.length());
        if !(lu * lv > 0.0) {
            return Err(Diagnostic::new(
                Kind::Geometry,
                format!("a rectangle of edges {lu} m and {lv} m"),
                "two edges of positive length",
            ));
        }
        let cosine = (edge_u / lu).dot(edge_v / lv);
        if !(cosine.abs() <= 1e-9) {
            return Err(Diagnostic::new(
                Kind::Geometry,
                format!("rectangle edges at {:.6} degrees", libm::acos(cosine.clamp(-1.0, 1.0)).to_degrees()),
                "perpendicular edges",
            )
            .hint("use a mesh for a parallelogram"));
        }
        let corners = [corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v];
        let flat = |i: usize, j: usize| corners[i] == corners[j];
        if flat(0, 1) || flat(1, 2) || flat(2, 3) || flat(3, 0) {
            return Err(Diagnostic::new(
                Kind::Geometry,
                "a rectangle whose edges vanish in the rounding of its corner",
                "edges longer than the precision of the corner's coordinates",
            ));
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

    /// The rectangle, moved.
    ///
    /// # Errors
    /// See [`Rectangle::new`].
    pub fn transformed(&self, by: &Transform) -> Result<Self> {
        Self::new(by.point(self.corners[0]), by.vector(self.edge_u), by.vector(self.edge_v))
    }

    /// Half 0 (corner, u, u + v) or 1 (corner, u + v, v); the shared corners are the same bits.
    pub(crate) fn triangle(&self, face: usize) -> [DVec3; 3] {
        let [a, b, c, d] = self.corners;
        if face == 0 { [a, b, c] } else { [a, c, d] }
    }
}
