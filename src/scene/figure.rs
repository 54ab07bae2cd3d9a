//! The plane figure in which photons of a beam or an area light start, and the surfaces that it meets.

use glam::DVec3;

use crate::emitter::{Emits, Emitter};
use crate::geometry::{Geometry, Shape, SurfaceId};
use crate::math::frame::unit;

/// How a surface meets a figure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Contact {
    /// A part of it lies in the figure's plane, on the figure.
    Flush,
    /// It is closed and crosses or touches the figure.
    Cut,
}

/// What meets only the outermost billionth of a figure, stands beside it: a panel from wall to wall is no error.
const SHRUNK: f64 = 1.0 - 1e-9;

/// A convex polygon.
pub(super) struct Figure {
    centre: DVec3,
    /// Unit; the corners go around it counter-clockwise.
    normal: DVec3,
    /// From the centre, m.
    corners: Vec<DVec3>,
}

impl Figure {
    /// Of an emitter that is not a point.
    pub fn new(emitter: &Emitter) -> Option<Self> {
        let centre = emitter.position();
        let corners: Vec<DVec3> = emitter.outline().iter().map(|p| (*p - centre) * SHRUNK).collect();
        let normal = unit(corners.first()?.cross(*corners.get(corners.len() / 4)?))?;
        Some(Self { centre, normal, corners })
    }

    /// Eight points of the edge.
    pub fn rim(&self) -> impl Iterator<Item = DVec3> {
        self.corners.iter().step_by(self.corners.len() / 8).map(|corner| self.centre + *corner)
    }

    /// The first surface that meets it in this way.
    pub fn met(&self, geometry: &Geometry, contact: Contact) -> Option<SurfaceId> {
        let (low, high) = geometry.bounds();
        let size = low.abs().max(high.abs()).max(self.centre.abs()).max_element();
        let rounding = 16.0 * f64::EPSILON * size;
        let ids = (0..geometry.surfaces().len() as u32).map(SurfaceId);
        ids.filter(|id| contact == Contact::Flush || geometry.is_closed(*id)).find(|id| {
            let shape = &geometry.surfaces()[id.0 as usize].shape;
            match shape {
                Shape::Sphere(s) => contact == Contact::Cut && self.meets_sphere(s.centre(), s.radius()),
                Shape::Paraboloid(_) => false, // Curved and open.
                Shape::Mesh(_) | Shape::Rectangle(_) => (0..shape.face_count())
                    .filter_map(|face| shape.triangle(face))
                    .any(|triangle| self.meets_triangle(triangle, rounding) == Some(contact)),
            }
        })
    }

    /// How the part of a triangle in the plane, thick by rounding (m), meets the figure.
    fn meets_triangle(&self, triangle: [DVec3; 3], rounding: f64) -> Option<Contact> {
        let triangle = triangle.map(|p| p - self.centre);
        let heights = triangle.map(|p| p.dot(self.normal));
        let is_in_plane = heights.map(|h| h.abs() <= rounding);
        if is_in_plane == [true; 3] {
            let meets = (0..3).any(|i| self.meets_segment(triangle[i], triangle[(i + 1) % 3]));
            return meets.then_some(Contact::Flush);
        }
        if heights.iter().all(|h| *h > rounding) || heights.iter().all(|h| *h < -rounding) {
            return None;
        }
        let mut ends = Vec::with_capacity(3);
        for i in 0..3 {
            let j = (i + 1) % 3;
            let crosses = !is_in_plane[i] && !is_in_plane[j] && (heights[i] < 0.0) != (heights[j] < 0.0);
            ends.extend(is_in_plane[i].then_some(triangle[i]));
            let share = heights[i] / (heights[i] - heights[j]);
            ends.extend(crosses.then(|| triangle[i] + (triangle[j] - triangle[i]) * share));
        }
        let meets = self.meets_segment(*ends.first()?, *ends.last()?);
        meets.then_some(Contact::Cut)
    }

    /// Whether a segment of the plane meets the figure. (M. Cyrus, J. Beck, "Generalized two- and three-dimensional clipping",
    /// Computers & Graphics 3 (1978) 23.)
    fn meets_segment(&self, from: DVec3, to: DVec3) -> bool {
        let (mut low, mut high) = (0.0f64, 1.0f64);
        for [p, q] in self.edges() {
            let inward = self.normal.cross(q - p);
            let (inside, along) = ((from - p).dot(inward), (to - from).dot(inward));
            if along > 0.0 {
                low = low.max(-inside / along);
            } else if along < 0.0 {
                high = high.min(-inside / along);
            } else if inside < 0.0 {
                return false;
            }
        }
        low <= high
    }

    /// Whether the circle in which a sphere cuts the plane meets the figure: some of that is within it, but not all.
    fn meets_sphere(&self, centre: DVec3, radius: f64) -> bool {
        let height = (centre - self.centre).dot(self.normal);
        if height.abs() > radius {
            return false;
        }
        let r2 = (radius - height) * (radius + height);
        let foot = centre - self.centre - self.normal * height;
        let is_within = |[p, q]: [DVec3; 2]| {
            let share = ((foot - p).dot(q - p) / (q - p).length_squared()).clamp(0.0, 1.0);
            (p + (q - p) * share - foot).length_squared() <= r2
        };
        let reaches = self.meets_segment(foot, foot) || self.edges().any(is_within);
        reaches && self.corners.iter().any(|corner| (*corner - foot).length_squared() > r2)
    }

    fn edges(&self) -> impl Iterator<Item = [DVec3; 2]> {
        let next = self.corners.iter().cycle().skip(1);
        self.corners.iter().zip(next).map(|(p, q)| [*p, *q])
    }
}
