//! The files of a receiver: EXR for every one, CSV (and PLY, [`super::ply`]) where the cells are faces of a mesh.

use std::io::Write;
use std::path::Path;

use crate::error::Result;
use crate::files::atomic::write_atomically;
use crate::files::exr::{Channel, Data, Light, floats, write_maps};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::receiver::{Cells, Receiver};

use super::attributes::attributes;
use super::numbers::bare;
use super::statistics::ReceiverStatistics;

/// Pixels of a receiver's EXR.
fn exr_size(cells: Cells) -> (usize, usize) {
    match cells {
        Cells::Grid { nu, nv } => (nu as usize, nv as usize),
        Cells::Faces { count } => {
            let width = (count as f64).sqrt().ceil().max(1.0) as usize;
            (width, count.div_ceil(width))
        }
    }
}

/// Writes a receiver's map as EXR: `illuminance` and `standard_error` in lx, `hits`; everything needed to repeat the run as
/// attributes. The faces of a mesh fill rows of equal length, NaN beyond the last.
///
/// # Errors
/// A number beyond a 32-bit float; a file that cannot be written.
pub fn write_exr(
    path: &Path,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<()> {
    let (width, height) = exr_size(receiver.cells);
    let padded = |values: &[f64]| -> Result<Vec<f32>> {
        let mut out = floats(values.iter().copied()).map_err(|e| e.in_file(path))?;
        out.resize(width * height, f32::NAN);
        Ok(out)
    };
    let illuminance = padded(&statistics.illuminance_lx)?;
    let error = padded(&statistics.standard_error_lx)?;
    let mut hits: Vec<u32> = statistics.hits.iter().map(|h| u32::try_from(*h).unwrap_or(u32::MAX)).collect();
    hits.resize(width * height, 0);
    let channels = [
        Channel { name: "illuminance", data: Data::F32(&illuminance) },
        Channel { name: "standard_error", data: Data::F32(&error) },
        Channel { name: "hits", data: Data::U32(&hits) },
    ];
    let attributes = attributes(scene, outcome, receiver, statistics);
    write_maps(path, [width, height], &channels, &attributes, Light::Other)
}

/// Writes a receiver's faces as CSV, one row a face: number, centroid (m), area (m2), illuminance and standard error (lx,
/// empty where unknown), hits; false, and no file, where its cells are no faces.
///
/// # Errors
/// A file that cannot be written.
pub fn write_csv(
    path: &Path,
    scene: &Scene,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<bool> {
    let Cells::Faces { count } = receiver.cells else { return Ok(false) };
    let shape = &scene.geometry.surfaces()[receiver.surface.0 as usize].shape;
    write_atomically(path, |out| {
        writeln!(out, "face,x_m,y_m,z_m,area_m2,illuminance_lx,standard_error_lx,hits")?;
        for face in 0..count {
            let Some([a, b, c]) = shape.triangle(face) else { continue };
            let m = (a + b + c) / 3.0;
            let (area, lux) = (receiver.area_m2(face), statistics.illuminance_lx[face]);
            let (error, hits) = (bare(Some(statistics.standard_error_lx[face])), statistics.hits[face]);
            writeln!(out, "{face},{},{},{},{area},{lux},{error},{hits}", m.x, m.y, m.z)?;
        }
        Ok(())
    })?;
    Ok(true)
}
