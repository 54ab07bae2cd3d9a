//! The map of a receiver whose cells are a grid, as a false-colour PNG.

use std::path::Path;

use crate::error::Result;
use crate::report::numbers::{grouped, rounded, with_error};
use crate::report::statistics::ReceiverStatistics;
use crate::run::Outcome;
use crate::scene::receiver::{Cells, Receiver};

use super::false_colour::{FalseColour, Quantity};

/// Writes the map in false colours, with scale, axes and isolux lines; false, and no file, where its cells are no grid.
///
/// # Errors
/// A file that cannot be written.
pub fn write_png(
    path: &Path,
    outcome: &Outcome,
    receiver: &Receiver,
    s: &ReceiverStatistics,
) -> Result<bool> {
    let Cells::Grid { nu, nv } = receiver.cells else { return Ok(false) };
    let error = match s.expected_nrms {
        Some(nrms) => format!("cell error {} % of the mean (rms)", rounded(100.0 * nrms, 3)),
        None => "no standard error (one replicate)".to_string(),
    };
    let flux = format!("flux {}", with_error(s.flux_lm, s.flux_standard_error_lm, "lm"));
    let picture = FalseColour {
        title: &receiver.name,
        width: nu as usize,
        height: nv as usize,
        quantity: Quantity::Illuminance,
        values: &s.illuminance_lx,
        size_m: receiver.size_m,
        isolux: true,
        footer: vec![flux, format!("{} photons, {error}", grouped(outcome.photons))],
    };
    picture.render().write_png(path)?;
    Ok(true)
}
