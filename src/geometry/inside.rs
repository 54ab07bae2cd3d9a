//! On which side of a closed surface a point lies, from geometry alone: asked once, where a photon starts.

use glam::DVec3;

use super::{Geometry, Mesh, Shape, SurfaceId};

impl Geometry {
    /// Whether `point` [m] is behind a surface, opposite to where the outward normal points. An open surface has
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

    /// All closed surfaces a point is behind: the start of [`super::Whereabouts`].
    pub fn all_behind(&self, point: DVec3) -> Vec<SurfaceId> {
        let ids = (0..self.surfaces.len() as u32).map(SurfaceId);
        ids.filter(|&s| self.is_behind(point, s)).collect()
    }
}

/// How often the surface winds around the point: the sum of signed solid angles over 4 pi.
///
/// Solid angle of a triangle: A. van Oosterom, J. Strackee, IEEE Trans. Biomed. Eng. 30 (1983) 125.
fn winding_number(mesh: &Mesh, point: DVec3) -> f64 {
    let mut half_angle = 0.0;
    for face in 0..mesh.triangles().len() {
        let [a, b, c] = mesh.triangle(face).map(|v| v - point);
        let (la, lb, lc) = (a.length(), b.length(), c.length());
        let numerator = a.dot(b.cross(c));
        let denominator = la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb;
        half_angle += libm::atan2(numerator, denominator);
    }
    half_angle / std::f64::consts::TAU
}
