//! Surfaces that lie in one another: which of two a photon meets first would be decided by rounding.

use glam::DVec3;

use super::{Rectangle, Shape, Surface};
use crate::error::{Diagnostic, Kind};

/// Every pair of surfaces that coincide, by number, and a diagnostic about it: a triangle of equal corners (to the
/// bit), equal spheres or paraboloids, rectangles that overlap in one plane.
pub fn coincident_surfaces(surfaces: &[Surface]) -> Vec<([usize; 2], Diagnostic)> {
    let mut pairs = equal_triangles(surfaces);
    for (j, b) in surfaces.iter().enumerate() {
        for (i, a) in surfaces[..j].iter().enumerate() {
            let coincide = match (&a.shape, &b.shape) {
                (Shape::Sphere(a), Shape::Sphere(b)) => a == b,
                (Shape::Paraboloid(a), Shape::Paraboloid(b)) => a == b,
                (Shape::Rectangle(a), Shape::Rectangle(b)) => overlap(a, b),
                _ => false,
            };
            if coincide {
                pairs.push((i, j));
            }
        }
    }
    pairs.sort_unstable();
    pairs.dedup();
    let message = |&(i, j): &(usize, usize)| {
        let found =
            format!("surfaces \"{}\" and \"{}\" in the same place", surfaces[i].name, surfaces[j].name);
        let diagnostic = Diagnostic::new(Kind::Geometry, found, "surfaces that do not coincide")
            .hint("leave one of them out, or move them apart");
        ([i, j], diagnostic)
    };
    pairs.iter().map(message).collect()
}

fn equal_triangles(surfaces: &[Surface]) -> Vec<(usize, usize)> {
    let mut keys: Vec<([[u64; 3]; 3], usize)> = Vec::new();
    for (i, s) in surfaces.iter().enumerate() {
        for face in 0..s.shape.face_count() {
            let Some(corners) = s.shape.triangle(face) else { continue };
            // Adding zero makes -0 and 0 the same key.
            let mut key = corners.map(|v| (v + DVec3::ZERO).to_array().map(f64::to_bits));
            key.sort_unstable();
            keys.push((key, i));
        }
    }
    keys.sort_unstable();
    let mut pairs = Vec::new();
    for group in keys.chunk_by(|a, b| a.0 == b.0) {
        let mut owners: Vec<usize> = group.iter().map(|k| k.1).collect();
        owners.dedup();
        pairs.extend(owners.windows(2).map(|w| (w[0], w[1])));
    }
    pairs
}

/// Rectangles in one plane, to the rounding of their coordinates, that share area.
fn overlap(a: &Rectangle, b: &Rectangle) -> bool {
    let corners = |r: &Rectangle| {
        let (c, u, v) = (r.corner(), r.edge_u(), r.edge_v());
        [c, c + u, c + u + v, c + v]
    };
    let (p, q) = (corners(a), corners(b));
    let size = p.iter().chain(&q).fold(0.0f64, |m, v| m.max(v.abs().max_element()));
    let rounding = 16.0 * f64::EPSILON * size;
    let apart = |n: DVec3, in_plane: bool| {
        let n = n.normalize();
        let range = |r: &[DVec3; 4]| {
            r.iter()
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v.dot(n)), hi.max(v.dot(n))))
        };
        let ((a0, a1), (b0, b1)) = (range(&p), range(&q));
        if in_plane {
            a1 <= b0 + rounding || b1 <= a0 + rounding
        } else {
            (a1.max(b1) - a0.min(b0)) > rounding
        }
    };
    // One plane, and no edge direction separates them (separating axis theorem).
    !apart(a.normal(), false)
        && ![a.edge_u(), a.edge_v(), b.edge_u(), b.edge_v()].into_iter().any(|n| apart(n, true))
}

#[cfg(test)]
mod tests {
    use super::super::{Sphere, box_mesh};
    use super::*;

    fn named(name: &str, shape: Shape) -> Surface {
        Surface { name: name.into(), shape }
    }

    fn rectangle(x: f64, y: f64, z: f64, tilt: f64) -> Shape {
        let (u, v) = (DVec3::new(1.0, 0.0, tilt), DVec3::Y);
        Shape::Rectangle(Rectangle::new(DVec3::new(x, y, z), u, v).unwrap())
    }

    #[test]
    fn pairs_are_named_and_neighbours_are_not() {
        let ball = |r| Shape::Sphere(Sphere::new(DVec3::ONE, r).unwrap());
        let cube = || Shape::Mesh(box_mesh(DVec3::ZERO, DVec3::ONE).unwrap());
        let surfaces = [
            named("a", rectangle(0.0, 0.0, 2.0, 0.0)),
            named("beside", rectangle(1.0, 0.0, 2.0, 0.0)),
            named("above", rectangle(0.0, 0.0, 2.001, 0.0)),
            named("tilted", rectangle(0.0, 0.0, 2.0, 0.01)),
            named("over", rectangle(0.5, 0.5, 2.0, 0.0)),
            named("s", ball(1.0)),
            named("t", ball(1.0)),
            named("u", ball(1.1)),
            named("cube", cube()),
            named("die", cube()),
        ];
        let found: Vec<String> =
            coincident_surfaces(&surfaces).iter().map(|(_, d)| d.found().to_owned()).collect();
        let expected = [("a", "over"), ("beside", "over"), ("s", "t"), ("cube", "die")];
        assert_eq!(found.len(), expected.len(), "{found:?}");
        for (text, (a, b)) in found.iter().zip(expected) {
            assert!(text.contains(&format!("\"{a}\" and \"{b}\"")), "{text}");
        }
    }
}
