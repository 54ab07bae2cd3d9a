//! Curved glass as a mesh of flat facets: each refracts like a prism, and the caustic is one of facets.

use std::collections::HashMap;

use glam::DVec3;

use crate::error::{Diagnostic, Kind};
use crate::geometry::{Mesh, Shape, Surface};

/// Between facets that stand for a curve; flatter edges bend no light that one would see, sharper ones are edges that are
/// meant.
const OF_A_CURVE_DEG: std::ops::Range<f64> = 1.0..40.0;

/// What is to be said of a transparent surface that is curved, but made of flat facets.
pub(super) fn warning(surface: &Surface) -> Option<Diagnostic> {
    let Shape::Mesh(mesh) = &surface.shape else { return None };
    if mesh.is_smooth() {
        return None;
    }
    let (edges, curved, largest) = bends(mesh);
    if curved == 0 || 2 * curved < edges {
        return None;
    }
    let found = format!(
        "the transparent mesh \"{}\" without smooth normals, of facets at angles of up to {largest:.0} degrees",
        surface.name
    );
    let required =
        "a curved surface: each facet refracts like a prism, and the light shows facets, not a caustic";
    let hint =
        "`smooth = true` computes smooth normals; an exact shape, or a finer mesh with normals, is better";
    Some(Diagnostic::new(Kind::Geometry, found, required).hint(hint))
}

/// Edges at which the surface bends, those of a curve among them, and the largest angle of these, degrees.
fn bends(mesh: &Mesh) -> (usize, usize, f64) {
    let mut first: HashMap<(u32, u32), DVec3> = HashMap::new();
    let (mut edges, mut curved, mut largest) = (0, 0, 0.0f64);
    for (face, [a, b, c]) in mesh.triangles().iter().copied().enumerate() {
        let [p, q, r] = mesh.triangle(face);
        let Some(normal) = (q - p).cross(r - p).try_normalize() else { continue };
        for (from, to) in [(a, b), (b, c), (c, a)] {
            let Some(other) = first.insert((from.min(to), from.max(to)), normal) else { continue };
            let angle_deg = libm::atan2(normal.cross(other).length(), normal.dot(other)).to_degrees();
            edges += usize::from(angle_deg >= OF_A_CURVE_DEG.start);
            if OF_A_CURVE_DEG.contains(&angle_deg) {
                curved += 1;
                largest = largest.max(angle_deg);
            }
        }
    }
    (edges, curved, largest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{MeshParts, Smoothing, box_mesh};

    /// A tube of this many flat sides.
    fn tube(sides: u32) -> Shape {
        let at = |k: u32, z: f64| {
            let (sin, cos) = (f64::from(k) * std::f64::consts::TAU / f64::from(sides)).sin_cos();
            DVec3::new(cos, sin, z)
        };
        let vertices = (0..sides).flat_map(|k| [at(k, 0.0), at(k, 1.0)]).collect();
        let quad = |k: u32| {
            let (a, b) = (2 * k, 2 * ((k + 1) % sides));
            [[a, b, b + 1], [a, b + 1, a + 1]]
        };
        let triangles = (0..sides).flat_map(quad).collect();
        let parts = MeshParts { vertices, triangles, ..MeshParts::default() };
        Mesh::new(parts, Smoothing::Flat, false).unwrap().0.into()
    }

    #[test]
    fn facets_of_a_curve_are_told_and_edges_are_not() {
        let of = |shape: Shape| warning(&Surface { name: "it".into(), shape });
        assert!(of(tube(32)).unwrap().found().contains("up to 11 degrees"));
        assert!(of(tube(6)).is_none() && of(tube(1000)).is_none());
        assert!(of(box_mesh(DVec3::ZERO, DVec3::ONE).unwrap().into()).is_none());
    }
}
