//! A box as a closed mesh.

use glam::DVec3;

use super::{COORDINATE, LENGTH, Mesh, MeshParts, Smoothing};
use crate::error::Invalid;

/// The closed axis-parallel box between two corners (m): 12 triangles, normals outward, faces in the order
/// -x, +x, -y, +y, -z, +z, two triangles each.
///
/// # Errors
/// Corners out of range, or a box without volume.
pub fn box_mesh(min: DVec3, max: DVec3) -> Result<Mesh, Invalid> {
    COORDINATE.vector("min", min)?;
    COORDINATE.vector("max", max)?;
    let extent = max - min;
    if !(LENGTH.contains(extent.min_element()) && LENGTH.contains(extent.max_element())) {
        return Err(Invalid::Shape {
            what: "max",
            found: format!("a box from {min} to {max}"),
            required: "each coordinate of max from 1e-9 to 1e9 m above that of min",
        });
    }
    // Vertex number: bit 0 for x, bit 1 for y, bit 2 for z at the maximum.
    let pick = |bit: usize, lo: f64, hi: f64| if bit == 0 { lo } else { hi };
    let vertices = (0..8)
        .map(|i: usize| {
            DVec3::new(pick(i & 1, min.x, max.x), pick(i & 2, min.y, max.y), pick(i & 4, min.z, max.z))
        })
        .collect();
    let quads = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let triangles = quads.iter().flat_map(|&[a, b, c, d]| [[a, b, c], [a, c, d]]).collect();
    let parts = MeshParts { vertices, triangles, ..MeshParts::default() };
    Ok(Mesh::new(parts, Smoothing::Flat, true)?.0)
}
