//! Receivers on meshes as VTK XML PolyData: the mesh with its numbers on every face, for VTK, ParaView and PyVista.
//!
//! Arrays of the faces, in the order of the CSV: `Y` (illuminance) and `standard_error` in lx, doubles (NaN where there is none), and
//! `hits`, whole numbers. Everything is in the one file: base64 of little-endian bytes, each array after its length in bytes.

use std::io::{self, Write};
use std::path::Path;

use crate::error::Result;
use crate::files::atomic::write_atomically;
use crate::files::base64::base64;
use crate::geometry::Mesh;
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::receiver::Receiver;

use super::ply::{comments, mesh_of};
use super::statistics::ReceiverStatistics;

/// Writes the faces of one receiver; false, and no file, where its surface is no mesh.
///
/// # Errors
/// A file that cannot be written.
pub fn write_vtp(
    path: &Path,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<bool> {
    let Some(mesh) = mesh_of(scene, receiver) else { return Ok(false) };
    // Two hyphens end a comment of XML.
    let comments = comments(scene, outcome, receiver).join("\n").replace("--", "- -");
    write_atomically(path, |out| write(out, mesh, statistics, &comments))?;
    Ok(true)
}

fn write(out: &mut impl Write, mesh: &Mesh, s: &ReceiverStatistics, comments: &str) -> io::Result<()> {
    let (points, faces) = (mesh.vertices(), mesh.triangles());
    let corners = |face: &[u32; 3]| face.map(i64::from);
    let header = "type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"";
    writeln!(out, "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<!--\n{comments}\n-->\n<VTKFile {header}>")?;
    let (vertices, triangles) = (points.len(), faces.len());
    let none = "NumberOfVerts=\"0\" NumberOfLines=\"0\" NumberOfStrips=\"0\"";
    let sizes = format!("NumberOfPoints=\"{vertices}\" NumberOfPolys=\"{triangles}\" {none}");
    writeln!(out, "<PolyData>\n<Piece {sizes}>\n<Points>")?;
    let position = points.iter().flat_map(|point| point.to_array()).flat_map(f64::to_le_bytes);
    array(out, "Float64", "Points\" NumberOfComponents=\"3", position)?;
    writeln!(out, "</Points>\n<Polys>")?;
    array(out, "Int64", "connectivity", faces.iter().flat_map(corners).flat_map(i64::to_le_bytes))?;
    array(out, "Int64", "offsets", (1..=triangles as i64).map(|face| 3 * face).flat_map(i64::to_le_bytes))?;
    writeln!(out, "</Polys>\n<CellData Scalars=\"Y\">")?;
    for (name, values) in [("Y", &s.illuminance_lx), ("standard_error", &s.standard_error_lx)] {
        array(out, "Float64", name, values.iter().copied().flat_map(f64::to_le_bytes))?;
    }
    array(out, "Int64", "hits", s.hits.iter().copied().flat_map(u64::to_le_bytes))?;
    writeln!(out, "</CellData>\n</Piece>\n</PolyData>\n</VTKFile>")
}

/// An array in base64: its length in bytes, then these.
fn array(out: &mut impl Write, kind: &str, name: &str, bytes: impl Iterator<Item = u8>) -> io::Result<()> {
    let bytes: Vec<u8> = bytes.collect();
    let all = [&(bytes.len() as u64).to_le_bytes(), &bytes[..]].concat();
    writeln!(
        out,
        "<DataArray type=\"{kind}\" Name=\"{name}\" format=\"binary\">\n{}\n</DataArray>",
        base64(&all)
    )
}
