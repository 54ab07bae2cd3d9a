//! On which side of a closed surface a point lies, from geometry alone: asked once, where a photon starts.

use std::collections::BTreeMap;

use glam::DVec3;

use super::openings::part_of;
use super::{Body, Geometry, Mesh, Shape, SurfaceId};

impl Geometry {
    /// Whether `point` (m) is behind a surface, opposite to where the outward normal points. An open surface has
    /// nobody behind it. A closed mesh whose normals point inward has its outside behind it.
    pub fn is_behind(&self, point: DVec3, surface: SurfaceId) -> bool {
        if !self.is_closed(surface) {
            return false;
        }
        match &self.surfaces[surface.0 as usize].shape {
            Shape::Sphere(s) => (point - s.centre()).length() < s.radius(),
            Shape::Mesh(m) => {
                // 0 outside and 1 inside, or 0 outside and -1 inside: behind is the greater of the two.
                let turns = winding_number(m, point);
                if m.topology().signed_volume_m3 < 0.0 { turns > -0.5 } else { turns > 0.5 }
            }
            Shape::Rectangle(_) | Shape::Paraboloid(_) => false,
        }
    }

    /// All closed surfaces a point is behind, one of several layers as often as it winds around the point: the start of
    /// [`super::Whereabouts`].
    pub fn all_behind(&self, point: DVec3) -> Vec<SurfaceId> {
        let ids = (0..self.surfaces.len() as u32).map(SurfaceId);
        ids.flat_map(|s| std::iter::repeat_n(s, self.times_behind(point, s))).collect()
    }

    fn times_behind(&self, point: DVec3, surface: SurfaceId) -> usize {
        match (&self.surfaces[surface.0 as usize].shape, self.info[surface.0 as usize].body) {
            (Shape::Mesh(m), Body::Layered) if m.topology().signed_volume_m3 >= 0.0 => {
                winding_number(m, point).round().max(0.0) as usize
            }
            _ => usize::from(self.is_behind(point, surface)),
        }
    }
}

/// Parts of a mesh that are looked at, and faces of each.
const MOST_PARTS: usize = 8;
const FACES_OF_A_PART: usize = 4;

impl Geometry {
    /// Whether a mesh has a part that lies inside another one and is wound the same way: behind each of its faces
    /// the mesh winds around a point once more than before it, where that is inside already.
    pub fn has_nested_part(&self, surface: SurfaceId) -> bool {
        let (Shape::Mesh(mesh), Body::Layered) =
            (&self.surfaces[surface.0 as usize].shape, self.info[surface.0 as usize].body)
        else {
            return false;
        };
        let mut faces_of: BTreeMap<u32, Vec<usize>> = BTreeMap::new();
        for (face, part) in part_of(mesh.vertices().len(), mesh.triangles()).into_iter().enumerate() {
            faces_of.entry(part).or_default().push(face);
        }
        let sign = mesh.topology().signed_volume_m3.signum();
        faces_of.values().take(MOST_PARTS).any(|faces| {
            let step = faces.len().div_ceil(FACES_OF_A_PART);
            faces.iter().step_by(step).all(|&face| {
                let [a, b, c] = mesh.triangle(face);
                // The face itself sees half of everything on either side: n + 1/2 is between n and n + 1.
                sign * winding_of_all_but(mesh, (a + b + c) / 3.0, Some(face)) > 1.25
            })
        })
    }
}

fn winding_number(mesh: &Mesh, point: DVec3) -> f64 {
    winding_of_all_but(mesh, point, None)
}

/// How often the surface, without one face, winds around the point: the sum of signed solid angles over 4 pi.
///
/// Solid angle of a triangle: A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
fn winding_of_all_but(mesh: &Mesh, point: DVec3, left_out: Option<usize>) -> f64 {
    let mut half_angle = 0.0;
    for face in (0..mesh.triangles().len()).filter(|face| Some(*face) != left_out) {
        let [a, b, c] = mesh.triangle(face).map(|v| v - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let numerator = a.dot(b.cross(c));
        let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        half_angle += libm::atan2(numerator, denominator);
    }
    half_angle / std::f64::consts::TAU
}

impl Geometry {
    /// The surface on which a point (m) lies, to the rounding of its coordinates, if there is one.
    ///
    /// Exhaustive over all faces: meant for emitters, once each.
    pub fn surface_at(&self, point: DVec3) -> Option<SurfaceId> {
        let size = self.bounds.0.abs().max(self.bounds.1.abs()).max(point.abs()).max_element();
        let rounding = 16.0 * f64::EPSILON * size;
        let on = |shape: &Shape| match shape {
            Shape::Sphere(s) => ((point - s.centre()).length() - s.radius()).abs() <= rounding,
            Shape::Paraboloid(p) => {
                let foot = p.project(point);
                let rim = (foot - p.vertex()).reject_from_normalized(p.axis()).length();
                (foot - point).length() <= rounding && rim <= p.radius()
            }
            Shape::Mesh(_) | Shape::Rectangle(_) => (0..shape.face_count())
                .filter_map(|face| shape.triangle(face))
                .any(|t| distance_to_triangle(point, t) <= rounding),
        };
        self.surfaces.iter().position(|s| on(&s.shape)).map(|i| SurfaceId(i as u32))
    }
}

/// Distance of a point from a triangle (m). (C. Ericson, Real-Time Collision Detection, 2005, section 5.1.5.)
pub(super) fn distance_to_triangle(p: DVec3, [a, b, c]: [DVec3; 3]) -> f64 {
    let (ab, ac) = (b - a, c - a);
    let normal = ab.cross(ac);
    let area = normal.length();
    let from_edge = |p0: DVec3, p1: DVec3| {
        let e = p1 - p0;
        let length2 = e.length_squared();
        let t = if length2 > 0.0 { ((p - p0).dot(e) / length2).clamp(0.0, 1.0) } else { 0.0 };
        (p - (p0 + e * t)).length()
    };
    let edges = from_edge(a, b).min(from_edge(b, c)).min(from_edge(c, a));
    let within = |p0: DVec3, p1: DVec3| normal.dot((p1 - p0).cross(p - p0)) >= 0.0;
    if area > 0.0 && within(a, b) && within(b, c) && within(c, a) {
        ((p - a).dot(normal) / area).abs().min(edges)
    } else {
        edges
    }
}
