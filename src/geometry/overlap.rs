//! Whether two closed surfaces overlap in part: then neither is inside the other.

use glam::DVec3;

use super::{Geometry, Shape, Sphere, SurfaceId};

/// Points of a mesh that are looked for in another body. (Faces that cut one another are all found, [`super::contact`].)
const MOST_POINTS: usize = 64;

/// What lies within this share of a body's size beside its surface, is on it.
const ON_SURFACE: f64 = 1e-9;

impl Geometry {
    /// Whether some of one body is in the other, but none is all in the other.
    pub fn overlap_in_part(&self, a: SurfaceId, b: SurfaceId) -> bool {
        if self.cuts().contains(&[a.min(b), a.max(b)]) {
            return true;
        }
        let shape = |s: SurfaceId| &self.surfaces()[s.0 as usize].shape;
        match (shape(a), shape(b)) {
            (Shape::Sphere(p), Shape::Sphere(q)) => spheres_cut(p, q),
            (Shape::Sphere(sphere), mesh) | (mesh, Shape::Sphere(sphere)) => cuts_sphere(mesh, sphere),
            (p, q) => self.is_divided(p, b) || self.is_divided(q, a),
        }
    }

    /// Whether an opaque surface passes through the faces of a clear body.
    pub fn is_cut_by(&self, body: SurfaceId, solid: SurfaceId) -> bool {
        let shape = |s: SurfaceId| &self.surfaces()[s.0 as usize].shape;
        match (shape(body), shape(solid)) {
            (Shape::Sphere(p), Shape::Sphere(q)) => spheres_cut(p, q),
            // Nothing is known of a paraboloid's.
            (_, Shape::Paraboloid(_)) => false,
            (Shape::Sphere(sphere), mesh) | (mesh, Shape::Sphere(sphere)) => cuts_sphere(mesh, sphere),
            _ => self.solid_cuts().contains(&[body, solid]),
        }
    }

    /// Whether points of a mesh are inside the body as well as outside.
    fn is_divided(&self, mesh: &Shape, body: SurfaceId) -> bool {
        let faces = mesh.face_count();
        let step = faces.div_ceil(MOST_POINTS);
        let (mut inside, mut outside) = (false, false);
        for face in (0..faces).step_by(step) {
            let Some(corners) = mesh.triangle(face) else { return false };
            let middle = (corners[0] + corners[1] + corners[2]) / 3.0;
            for point in [middle, corners[0]] {
                match self.contains_surely(body, point) {
                    Some(true) => inside = true,
                    Some(false) => outside = true,
                    None => {}
                }
            }
            if inside && outside {
                return true;
            }
        }
        false
    }

    /// Whether a point is inside a body; `None` for one on its surface, or next to it.
    pub(crate) fn contains_surely(&self, body: SurfaceId, point: DVec3) -> Option<bool> {
        let shape = &self.surfaces()[body.0 as usize].shape;
        let (low, high) = shape.bounds();
        let near = ON_SURFACE * (high - low).max_element() + 64.0 * f64::EPSILON * point.abs().max_element();
        if point.cmplt(low - near).any() || point.cmpgt(high + near).any() {
            return Some(false);
        }
        let is_on = (0..shape.face_count())
            .filter_map(|face| shape.triangle(face))
            .any(|triangle| super::inside::distance_to_triangle(point, triangle) <= near);
        (!is_on).then(|| self.is_behind(point, body))
    }
}

fn spheres_cut(p: &Sphere, q: &Sphere) -> bool {
    let (d, sum) = ((p.centre() - q.centre()).length(), p.radius() + q.radius());
    let rounding = ON_SURFACE * sum;
    d < sum - rounding && d > (p.radius() - q.radius()).abs() + rounding
}

/// Whether a face of a mesh has points inside a sphere as well as outside.
fn cuts_sphere(mesh: &Shape, sphere: &Sphere) -> bool {
    let (centre, radius) = (sphere.centre(), sphere.radius());
    let rounding = ON_SURFACE * radius;
    (0..mesh.face_count()).filter_map(|face| mesh.triangle(face)).any(|triangle| {
        let farthest = triangle.iter().map(|v| (*v - centre).length()).fold(0.0, f64::max);
        farthest > radius + rounding
            && super::inside::distance_to_triangle(centre, triangle) < radius - rounding
    })
}
