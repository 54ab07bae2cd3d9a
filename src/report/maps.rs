//! The files of each receiver: an EXR for every one, a false-colour PNG where the cells lie in a plane or a (u, v) map, a
//! CSV and a PLY where they are faces of a mesh.

use std::io::Write;
use std::path::Path;

use crate::error::Result;
use crate::files::atomic::write_atomically;
use crate::files::exr::{Channel, Data, Light, write_maps};
use crate::plot::false_colour::{FalseColour, Quantity};
use crate::plot::scale::Scale;
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::receiver::{Cells, Receiver};

use super::attributes::attributes;
use super::ply::write_ply;
use super::statistics::ReceiverStatistics;
use super::text::{grouped, rounded, with_error};

/// Writes the files of one receiver into a directory that exists; their names.
///
/// # Errors
/// A file that cannot be written; files written before it stay.
pub fn write_receiver(
    directory: &Path,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<Vec<String>> {
    let mut files = vec![format!("{}.exr", receiver.name)];
    write_exr(&directory.join(&files[0]), scene, outcome, receiver, statistics)?;
    match receiver.cells {
        Cells::Grid { nu, nv } => {
            let name = format!("{}.png", receiver.name);
            picture(outcome, receiver, statistics, [nu as usize, nv as usize])
                .write_png(directory.join(&name))?;
            files.push(name);
        }
        Cells::Faces { .. } => {
            let name = format!("{}.csv", receiver.name);
            write_faces(&directory.join(&name), scene, receiver, statistics)?;
            files.push(name);
            let name = format!("{}.ply", receiver.name);
            if write_ply(&directory.join(&name), scene, outcome, receiver, statistics)? {
                files.push(name);
            }
        }
    }
    Ok(files)
}

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

fn write_exr(
    path: &Path,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<()> {
    let (width, height) = exr_size(receiver.cells);
    let floats = |values: &[f64]| -> Vec<f32> {
        let mut out: Vec<f32> = values.iter().map(|v| *v as f32).collect();
        out.resize(width * height, f32::NAN);
        out
    };
    let illuminance = floats(&statistics.illuminance_lx);
    let error = floats(&statistics.standard_error_lx);
    let mut hits: Vec<u32> = statistics.hits.iter().map(|h| u32::try_from(*h).unwrap_or(u32::MAX)).collect();
    hits.resize(width * height, 0);
    let channels = [
        Channel { name: "illuminance", data: Data::F32(&illuminance) },
        Channel { name: "standard_error", data: Data::F32(&error) },
        Channel { name: "hits", data: Data::U32(&hits) },
    ];
    write_maps(
        path,
        [width, height],
        &channels,
        &attributes(scene, outcome, receiver, statistics),
        Light::Other,
    )
}

fn picture<'a>(
    outcome: &Outcome,
    receiver: &'a Receiver,
    s: &'a ReceiverStatistics,
    [width, height]: [usize; 2],
) -> FalseColour<'a> {
    let error = match s.expected_nrms {
        Some(nrms) => format!("cell error {} % of the mean (rms)", rounded(100.0 * nrms, 3)),
        None => "no standard error (one replicate)".to_string(),
    };
    let flux = format!("flux {}", with_error(s.flux_lm.value, s.flux_lm.standard_error, "lm"));
    FalseColour {
        title: &receiver.name,
        width,
        height,
        quantity: Quantity::Illuminance,
        values: &s.illuminance_lx,
        size_m: receiver.size_m,
        scale: Scale::Auto,
        isolux: true,
        footer: vec![flux, format!("{} photons, {error}", grouped(outcome.photons))],
    }
}

/// One row a face: number, centroid, area, illuminance, standard error, hits.
fn write_faces(
    path: &Path,
    scene: &Scene,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<()> {
    let shape = &scene.geometry.surfaces()[receiver.surface.0 as usize].shape;
    write_atomically(path, |out| {
        writeln!(out, "face,x_m,y_m,z_m,area_m2,illuminance_lx,standard_error_lx,hits")?;
        for face in 0..receiver.cells.len() {
            let Some([a, b, c]) = shape.triangle(face) else { continue };
            let m = (a + b + c) / 3.0;
            let error = statistics.standard_error_lx[face];
            let error = if error.is_nan() { String::new() } else { error.to_string() };
            writeln!(
                out,
                "{face},{},{},{},{},{},{error},{}",
                m.x,
                m.y,
                m.z,
                receiver.area_m2(face),
                statistics.illuminance_lx[face],
                statistics.hits[face]
            )?;
        }
        Ok(())
    })
}
