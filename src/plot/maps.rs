//! The map of a receiver whose cells are a grid, as a false-colour PNG.

use std::path::Path;

use crate::error::Result;
use crate::geometry::Shape;
use crate::report::numbers::{digits, grouped, rounded, with_error};
use crate::report::statistics::{GridStatistics, ReceiverStatistics};
use crate::report::uniformity::Uniformity;
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::evaluation::Grid;
use crate::scene::receiver::{Cells, Receiver};

use super::false_colour::{Axes, FalseColour, Points, Quantity};

/// Writes the map in false colours, with scale, axes and isolux lines, and the values of an evaluation grid at its points; false,
/// and no file, where its cells are no grid.
///
/// # Errors
/// A file that cannot be written.
pub fn write_png(
    path: &Path,
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    s: &ReceiverStatistics,
) -> Result<bool> {
    let Cells::Grid { nu, nv } = receiver.cells else { return Ok(false) };
    let axes = match (&scene.geometry.surfaces()[receiver.surface.0 as usize].shape, receiver.size_m) {
        (_, Some(size_m)) => Axes::Metres(size_m),
        (Shape::Sphere(_), _) => Axes::Sphere,
        _ => Axes::Round,
    };
    let picture = FalseColour {
        title: &receiver.name,
        width: nu as usize,
        height: nv as usize,
        quantity: Quantity::Illuminance,
        values: &s.illuminance_lx,
        axes,
        points: receiver.grid.as_ref().zip(s.grid.as_ref()).map(|(grid, of)| points(grid, of)),
        isolux: true,
        footer: caption(outcome, s),
    };
    picture.render().write_png(path)?;
    Ok(true)
}

fn points(grid: &Grid, of: &GridStatistics) -> Points {
    let values = of.illuminance_lx.iter().enumerate().map(|(cell, lx)| (grid.middle(cell), *lx));
    Points { counts: [grid.nu as usize, grid.nv as usize], values: values.collect() }
}

/// Mean and flux with their errors; extremes and uniformity of the grid, or else of the cells, where they are known.
fn caption(outcome: &Outcome, s: &ReceiverStatistics) -> Vec<String> {
    let mean_error = s.flux_standard_error_lm.map(|error| error / s.area_m2);
    let [mean, flux] = [(s.mean_lx, mean_error, "lx"), (s.flux_lm, s.flux_standard_error_lm, "lm")]
        .map(|(value, error, unit)| with_error(value, error, unit));
    let mut lines = vec![format!("mean {mean}    flux {flux}")];
    lines.extend(extremes("cells", &s.uniformity));
    if let Some(grid) = &s.grid {
        let mean = with_error(grid.mean_lx, grid.mean_standard_error_lx, "lx");
        lines.push(format!("evaluation grid: mean {mean}"));
        lines.extend(extremes("evaluation grid", &grid.uniformity));
    }
    let error = match s.expected_nrms {
        Some(nrms) => format!("cell error {} % of the mean (rms)", rounded(100.0 * nrms, 3)),
        None => "no standard error (one replicate)".to_string(),
    };
    lines.push(format!("{} photons, {error}", grouped(outcome.photons)));
    lines
}

fn extremes(of: &str, uniformity: &Uniformity) -> Option<String> {
    let Uniformity { u0: Some(u0), minimum: Some(minimum), maximum: Some(maximum), .. } = uniformity else {
        return None;
    };
    Some(format!(
        "{of}: min {} lx    max {} lx    U0 = min/mean {:.3} ({:.3} to {:.3})",
        digits(minimum.value),
        digits(maximum.value),
        u0.value,
        u0.low,
        u0.high
    ))
}
