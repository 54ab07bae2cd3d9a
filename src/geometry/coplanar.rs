//! Triangles in one plane, to the rounding of their corners.

use glam::DVec3;

/// Coplanar within this many half-ulps of the largest coordinate: the rounding of corners that were rotated and moved.
const COPLANAR: f64 = 64.0 * 0.5 * f64::EPSILON;

/// For triangles in one plane that share area, to the rounding of their corners: whether they look at each other.
pub fn facing(a: &[DVec3; 3], b: &[DVec3; 3]) -> Option<bool> {
    let (na, nb, rounding) = (normal(a), normal(b), rounding(a, b));
    // The plane of the larger one is the better known.
    let (plane, other) = if na.length_squared() >= nb.length_squared() { (a, b) } else { (b, a) };
    let n = normal(plane).try_normalize()?;
    let [least, greatest] = extent(other.iter().map(|v| (*v - plane[0]).dot(n)));
    if least < -rounding || greatest > rounding {
        return None;
    }
    overlap(a, b, n, rounding).then_some(na.dot(nb) < 0.0)
}

/// Whether the shadows of two triangles on the plane of this unit normal share area, by more than rounding: no edge of
/// either separates them (separating axis theorem).
pub fn overlap(a: &[DVec3; 3], b: &[DVec3; 3], n: DVec3, rounding: f64) -> bool {
    let triangles = [a, b];
    let mut edges = triangles.iter().flat_map(|t| (0..3).map(|k| t[(k + 1) % 3] - t[k]));
    edges.all(|edge| {
        let Some(across) = n.cross(edge).try_normalize() else { return false };
        let [a0, a1] = extent(a.iter().map(|v| v.dot(across)));
        let [b0, b1] = extent(b.iter().map(|v| v.dot(across)));
        a1 > b0 + rounding && b1 > a0 + rounding
    })
}

/// Outward, of twice the triangle's area.
pub fn normal(t: &[DVec3; 3]) -> DVec3 {
    (t[1] - t[0]).cross(t[2] - t[0])
}

/// By how much corners that are meant to lie in one plane may be off it, m.
pub fn rounding(a: &[DVec3; 3], b: &[DVec3; 3]) -> f64 {
    COPLANAR * a.iter().chain(b).fold(0.0f64, |m, v| m.max(v.abs().max_element()))
}

pub fn extent(values: impl Iterator<Item = f64>) -> [f64; 2] {
    values.fold([f64::INFINITY, f64::NEG_INFINITY], |[l, h], v| [l.min(v), h.max(v)])
}
