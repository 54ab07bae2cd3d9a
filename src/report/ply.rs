//! Receivers on meshes as PLY: the mesh with its numbers on every face, for viewers of meshes.
//!
//! Binary, little-endian. Vertices: `x`, `y`, `z` (m, double). Faces, in the order of the CSV: `vertex_indices`; `quality` and
//! `illuminance_lx` (the same number: MeshLab knows `quality` by itself, others show names as they are); `standard_error_lx`
//! (NaN where there is none); `hits`; `red`, `green`, `blue`: false colours of illuminance, for viewers such as ParaView, whose
//! reader of PLY takes colours of faces and no other numbers.

use std::io::Write;
use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;
use crate::geometry::{Mesh, Shape};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::receiver::Receiver;

use super::colour::map::value_colour;
use super::colour::scale::Axis;
use super::statistics::ReceiverStatistics;

/// Writes the faces of one receiver; false, and no file, where its surface is no mesh.
///
/// # Errors
/// More hits of a face than the format holds; a file that cannot be written.
pub fn write_ply(
    path: &Path,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<bool> {
    let Some(mesh) = mesh_of(scene, receiver) else { return Ok(false) };
    let mut comments = comments(scene, outcome, receiver).to_vec();
    comments.push("quality = illuminance_lx; lengths in metres".to_string());
    if let Some(most) = statistics.hits.iter().find(|hits| u32::try_from(**hits).is_err()) {
        let (found, required) = (format!("{most} hits of a face"), "at most 4294967295, which PLY holds");
        return Err(Diagnostic::new(Kind::Limit, found, required)
            .hint("the .csv and the .vtp of the same receiver have them")
            .in_file(path));
    }
    write_atomically(path, |out| {
        out.write_all(header(mesh, &comments).as_bytes())?;
        for vertex in mesh.vertices() {
            for x in vertex.to_array() {
                out.write_all(&x.to_le_bytes())?;
            }
        }
        let axis = Axis::fit(&statistics.illuminance_lx);
        for face in 0..mesh.triangles().len() {
            out.write_all(&face_bytes(mesh, statistics, &axis, face))?;
        }
        Ok(())
    })?;
    Ok(true)
}

/// The mesh that a receiver is on, where it is on one.
pub(super) fn mesh_of<'s>(scene: &'s Scene, receiver: &Receiver) -> Option<&'s Mesh> {
    match &scene.geometry.surfaces()[receiver.surface.0 as usize].shape {
        Shape::Mesh(mesh) => Some(mesh),
        _ => None,
    }
}

/// Where the numbers of a mesh's file come from, a line each.
pub(super) fn comments(scene: &Scene, outcome: &Outcome, receiver: &Receiver) -> [String; 4] {
    [
        format!("caustix {}", env!("CARGO_PKG_VERSION")),
        format!("receiver {} on surface {}", receiver.name, scene.geometry.name(receiver.surface)),
        format!("{} photons, seed {}", outcome.photons, outcome.plan.seed()),
        format!("scene sha256 {}", scene.identity.sha256),
    ]
}

fn header(mesh: &Mesh, comments: &[String]) -> String {
    let comments: String = comments.iter().map(|comment| format!("comment {comment}\n")).collect();
    let (vertices, faces) = (mesh.vertices().len(), mesh.triangles().len());
    format!(
        "ply\nformat binary_little_endian 1.0\n{comments}\
         element vertex {vertices}\nproperty double x\nproperty double y\nproperty double z\n\
         element face {faces}\nproperty list uchar int vertex_indices\n\
         property float quality\nproperty float illuminance_lx\nproperty float standard_error_lx\n\
         property uint hits\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
    )
}

/// Corners, numbers and colour of one face.
fn face_bytes(mesh: &Mesh, s: &ReceiverStatistics, axis: &Axis, face: usize) -> Vec<u8> {
    let mut bytes = Vec::with_capacity(32);
    bytes.push(3);
    for corner in mesh.triangles()[face] {
        // An index as int: meshes are capped far below 2^31 vertices.
        bytes.extend(corner.to_le_bytes());
    }
    let lux = s.illuminance_lx[face];
    for number in [lux, lux, s.standard_error_lx[face]] {
        bytes.extend((number as f32).to_le_bytes());
    }
    bytes.extend(u32::try_from(s.hits[face]).unwrap_or(u32::MAX).to_le_bytes());
    bytes.extend(value_colour(lux, axis).to_srgb());
    bytes
}
