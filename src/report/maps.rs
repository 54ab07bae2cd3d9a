//! The files of a receiver: EXR and CSV for every one; PLY and VTP ([`super::ply`], [`super::vtp`]) where the cells are faces
//! of a mesh.

use std::io::{self, Write};
use std::path::Path;

use crate::error::Result;
use crate::files::atomic::write_atomically;
use crate::files::exr::{Channel, Light, floats, write_maps};
use crate::geometry::Shape;
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::evaluation::middle;
use crate::scene::receiver::{Cells, Receiver};

use super::attributes::attributes;
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

/// Most rows of a table of cells: what a spreadsheet takes. Larger maps have their EXR.
const MOST_ROWS: usize = 1 << 20;

/// Whether a receiver's cells are written as CSV: faces always, a grid up to 2^20 cells.
pub fn has_csv(receiver: &Receiver) -> bool {
    matches!(receiver.cells, Cells::Faces { .. }) || receiver.cells.len() <= MOST_ROWS
}

/// Writes a receiver's map as EXR: `Y` (illuminance) and `standard_error` in lx, `hits`, all as floats, since common readers take
/// no other channels beside them; everything needed to repeat the run as
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
    // Where one is rounded, an attribute says so.
    let mut hits: Vec<f32> = statistics.hits.iter().map(|hits| *hits as f32).collect();
    hits.resize(width * height, 0.0);
    let channels = [
        Channel { name: "Y", data: &illuminance },
        Channel { name: "standard_error", data: &error },
        Channel { name: "hits", data: &hits },
    ];
    let attributes = attributes(scene, outcome, receiver, statistics);
    write_maps(path, [width, height], &channels, &attributes, Light::Other)
}

/// Writes a receiver's cells as CSV; false, and no file, where a grid has more than 2^20 of them.
///
/// A grid has one row a cell, in the order of the EXR's pixels: the cell's middle (m), its (u, v), illuminance and standard error
/// (lx, empty where unknown), hits. A mesh has one row a face: number, centroid (m), area (m2), and the same numbers.
///
/// # Errors
/// A file that cannot be written.
pub fn write_csv(
    path: &Path,
    scene: &Scene,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<bool> {
    if !has_csv(receiver) {
        return Ok(false);
    }
    let shape = &scene.geometry.surfaces()[receiver.surface.0 as usize].shape;
    let numbers = Numbers::of(statistics);
    write_atomically(path, |out| match receiver.cells {
        Cells::Faces { count } => {
            writeln!(out, "face,x_m,y_m,z_m,area_m2,{NUMBERS}")?;
            let mut decimals = Decimals::new();
            for face in 0..count {
                let Some([a, b, c]) = shape.triangle(face) else { continue };
                let m = (a + b + c) / 3.0;
                write!(out, "{face},")?;
                for value in [m.x, m.y, m.z, receiver.area_m2(face)] {
                    decimals.write(out, value)?;
                }
                numbers.write(out, &mut decimals, face)?;
            }
            Ok(())
        }
        Cells::Grid { nu, nv } => {
            write_cells(out, shape, receiver.cells.len(), |cell| middle([nu, nv], cell), &numbers)
        }
    })?;
    Ok(true)
}

/// Writes the cells of a receiver's evaluation grid as CSV, the columns those of a map's; false, and no file, where it has no grid.
///
/// # Errors
/// A file that cannot be written.
pub fn write_grid_csv(
    path: &Path,
    scene: &Scene,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Result<bool> {
    let (Some(grid), Some(of)) = (&receiver.grid, &statistics.grid) else { return Ok(false) };
    let shape = &scene.geometry.surfaces()[receiver.surface.0 as usize].shape;
    let numbers = Numbers {
        illuminance_lx: &of.illuminance_lx,
        standard_error_lx: &of.standard_error_lx,
        hits: &of.hits,
    };
    write_atomically(path, |out| write_cells(out, shape, grid.cells(), |cell| grid.middle(cell), &numbers))?;
    Ok(true)
}

const NUMBERS: &str = "illuminance_lx,standard_error_lx,hits";

/// What a table says of each cell.
struct Numbers<'a> {
    illuminance_lx: &'a [f64],
    standard_error_lx: &'a [f64],
    hits: &'a [u64],
}

impl<'a> Numbers<'a> {
    fn of(statistics: &'a ReceiverStatistics) -> Self {
        let ReceiverStatistics { illuminance_lx, standard_error_lx, hits, .. } = statistics;
        Self { illuminance_lx, standard_error_lx, hits }
    }

    /// The end of a cell's row.
    fn write(&self, out: &mut impl Write, decimals: &mut Decimals, cell: usize) -> io::Result<()> {
        decimals.write(out, self.illuminance_lx[cell])?;
        let error = self.standard_error_lx[cell];
        if error.is_finite() {
            decimals.write(out, error)?
        } else {
            out.write_all(b",")?
        }
        serde_json::to_writer(&mut *out, &self.hits[cell])?;
        out.write_all(b"\n")
    }
}

/// The shortest decimals that read back as the same numbers, each with a comma, by serde_json, which is several times as
/// fast as the standard library. Lately told ones are remembered: rows and columns of a map repeat its coordinates, and
/// cells of few hits their values.
struct Decimals {
    told: Vec<Told>,
}

#[derive(Clone, Copy)]
struct Told {
    bits: u64,
    length: u8,
    text: [u8; LONGEST],
}

/// Characters of the longest number, and a comma.
const LONGEST: usize = 32;
/// Numbers remembered, by their hash.
const REMEMBERED_BITS: u32 = 12;

impl Decimals {
    fn new() -> Self {
        // The first look at a place finds nothing there.
        Self { told: vec![Told { bits: 0, length: 0, text: [0; LONGEST] }; 1 << REMEMBERED_BITS] }
    }

    fn write(&mut self, out: &mut impl Write, value: f64) -> io::Result<()> {
        /// 2^64 over the golden ratio (Knuth, "The Art of Computer Programming", 6.4).
        const SPREAD: u64 = 0x9e37_79b9_7f4a_7c15;
        let bits = value.to_bits();
        let place = bits.wrapping_mul(SPREAD) >> (u64::BITS - REMEMBERED_BITS);
        let told = &mut self.told[place as usize];
        if told.bits != bits || told.length == 0 {
            let mut rest = &mut told.text[..];
            serde_json::to_writer(&mut rest, &value)?;
            rest.write_all(b",")?;
            let left = rest.len();
            (told.bits, told.length) = (bits, (LONGEST - left) as u8);
        }
        out.write_all(&told.text[..told.length.into()])
    }
}

/// The cells of a grid, row by row from the top left; `middle` gives the (u, v) of one.
fn write_cells(
    out: &mut impl Write,
    shape: &Shape,
    cells: usize,
    middle: impl Fn(usize) -> (f64, f64),
    numbers: &Numbers<'_>,
) -> io::Result<()> {
    writeln!(out, "x,y,z,u,v,{NUMBERS}")?;
    let mut decimals = Decimals::new();
    for cell in 0..cells {
        let (u, v) = middle(cell);
        let Some(m) = shape.at(u, v) else { continue };
        for value in [m.x, m.y, m.z, u, v] {
            decimals.write(out, value)?;
        }
        numbers.write(out, &mut decimals, cell)?;
    }
    Ok(())
}
