//! Numbers of one receiver: flux, least, mean and greatest illuminance, uniformity, typical error of a cell.

use serde::Serialize;

use crate::run::Outcome;
use crate::scene::evaluation::Grid;
use crate::scene::receiver::{Cells, Receiver};

use super::spot::{MapCells, SpotStatistics};
use super::uniformity::Uniformity;

/// A receiver's map in lux, and the numbers that sum it up. Names are those of report.json: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct ReceiverStatistics {
    /// Illuminance of every cell, lx, row by row from the top left or face by face.
    #[serde(skip)]
    pub illuminance_lx: Vec<f64>,
    /// Standard error of every cell, lx; NaN where one replicate leaves it unknown.
    #[serde(skip)]
    pub standard_error_lx: Vec<f64>,
    /// Photons counted in every cell.
    #[serde(skip)]
    pub hits: Vec<u64>,
    /// Flux that arrived, lm.
    pub flux_lm: f64,
    /// Its standard error, lm; `None` for one replicate.
    pub flux_standard_error_lm: Option<f64>,
    /// Least illuminance of a cell, lx, noise included.
    pub min_lx: f64,
    /// Flux over area, lx.
    pub mean_lx: f64,
    /// Greatest illuminance of a cell, lx, noise included.
    pub max_lx: f64,
    /// `min_lx / mean_lx`, noise included; `None` where nothing arrived.
    pub uniformity_u0: Option<f64>,
    /// The extremes of its cells.
    #[serde(flatten)]
    pub uniformity: Uniformity,
    /// The evaluation grid, where the receiver has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub grid: Option<GridStatistics>,
    /// The figures of its spot, where they are asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spot: Option<SpotStatistics>,
    /// Area of all cells, m2.
    pub area_m2: f64,
    /// Number of cells.
    pub cells: usize,
    /// Cells along u and v, where a pilot run chose them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cells_by_pilot: Option<[u32; 2]>,
    /// sqrt(area-weighted mean of the squared standard errors of the cells) / mean illuminance: what nRMS to expect against the truth.
    pub expected_nrms: Option<f64>,
}

/// Numbers of an evaluation grid.
#[derive(Debug, Clone, Serialize)]
pub struct GridStatistics {
    /// Illuminance of every cell, lx, row by row from the top left.
    #[serde(skip)]
    pub illuminance_lx: Vec<f64>,
    /// Standard error of every cell, lx; NaN where one replicate leaves it unknown.
    #[serde(skip)]
    pub standard_error_lx: Vec<f64>,
    /// Photons counted in every cell.
    #[serde(skip)]
    pub hits: Vec<u64>,
    /// Cells along u.
    pub nu: u32,
    /// Cells along v.
    pub nv: u32,
    /// Width left out on each side, m.
    pub border_m: f64,
    /// Mean illuminance of its cells, lx.
    pub mean_lx: f64,
    /// Its standard error, lx.
    pub mean_standard_error_lx: Option<f64>,
    /// The extremes of the means over its cells.
    #[serde(flatten)]
    pub uniformity: Uniformity,
}

impl GridStatistics {
    fn new(outcome: &Outcome, index: usize, grid: &Grid) -> Self {
        let (nu, nv, unit) = (grid.nu, grid.nv, outcome.photon_lm);
        let (mean, extremes) = outcome.grid(index, grid.area_m2);
        let cells = (0..grid.cells()).map(|cell| outcome.grid_illuminance_lx(index, cell, grid.area_m2));
        let cells = cells.map(|cell| (cell.value, cell.standard_error.unwrap_or(f64::NAN)));
        let (illuminance_lx, standard_error_lx) = cells.unzip();
        Self {
            illuminance_lx,
            standard_error_lx,
            hits: outcome.grid_cells(index).sum.clone(),
            nu,
            nv,
            border_m: grid.border_m,
            mean_lx: mean.value * unit,
            mean_standard_error_lx: mean.standard_error.map(|error| error * unit),
            uniformity: Uniformity::new(extremes, Cells::Grid { nu, nv }, "grid", outcome),
        }
    }
}

/// Cells along u and v of a map that has them.
fn grid_of(cells: Cells) -> Option<[u32; 2]> {
    match cells {
        Cells::Grid { nu, nv } => Some([nu, nv]),
        Cells::Faces { .. } => None,
    }
}

impl ReceiverStatistics {
    /// The most photons in a cell whose number a 32-bit float (an EXR's) rounds: all up to 2^24 are exact, and some beyond.
    pub fn rounded_hits(&self) -> Option<u64> {
        let is_rounded = |hits: &u64| *hits as f32 as u64 != *hits;
        self.hits.iter().copied().filter(is_rounded).max()
    }

    /// The numbers of receiver number `index`.
    pub fn new(outcome: &Outcome, receiver: &Receiver, index: usize) -> Self {
        let cells = receiver.cells.len();
        let mut illuminance_lx = Vec::with_capacity(cells);
        let mut standard_error_lx = Vec::with_capacity(cells);
        let mut variance = 0.0;
        for cell in 0..cells {
            let area = receiver.area_m2(cell);
            let estimate = outcome.illuminance_lx(index, cell, area);
            let error = estimate.standard_error.unwrap_or(f64::NAN);
            variance += area * error * error;
            illuminance_lx.push(estimate.value);
            standard_error_lx.push(error);
        }
        let flux = outcome.receiver_flux_lm(index);
        let area_m2 = receiver.total_area_m2();
        let mean_lx = flux.value / area_m2;
        let min_lx = illuminance_lx.iter().copied().fold(f64::INFINITY, f64::min);
        let max_lx = illuminance_lx.iter().copied().fold(0.0, f64::max);
        let lit = mean_lx > 0.0;
        let extremes = outcome.extremes(index, receiver.areas_m2());
        // An evaluation grid leaves the map as fine as it is.
        let key = if receiver.size_m.is_some() { "grid" } else { "cells" };
        let uniformity = Uniformity::new(extremes, receiver.cells, key, outcome);
        let spot = receiver.spot.as_ref().zip(grid_of(receiver.cells)).map(|(spot, counts)| {
            let maximum = outcome.peak_lx(index, receiver.areas_m2());
            let (lx, errors, hits) = (&illuminance_lx, &standard_error_lx, &outcome.cells()[index].sum);
            SpotStatistics::new(spot, outcome, index, &MapCells { counts, lx, errors, hits, maximum })
        });
        Self {
            hits: outcome.cells()[index].sum.clone(),
            flux_lm: flux.value,
            flux_standard_error_lm: flux.standard_error,
            min_lx,
            mean_lx,
            max_lx,
            uniformity_u0: lit.then(|| min_lx / mean_lx),
            uniformity,
            spot,
            grid: receiver.grid.map(|grid| GridStatistics::new(outcome, index, &grid)),
            area_m2,
            cells,
            cells_by_pilot: receiver.cells_by_pilot(),
            expected_nrms: (lit && outcome.replicates > 1).then(|| (variance / area_m2).sqrt() / mean_lx),
            illuminance_lx,
            standard_error_lx,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_of_photons_that_a_float_rounds_are_found() {
        let most = |hits: Vec<u64>| {
            let numbers = ReceiverStatistics {
                illuminance_lx: Vec::new(),
                standard_error_lx: Vec::new(),
                hits,
                flux_lm: 0.0,
                flux_standard_error_lm: None,
                min_lx: 0.0,
                mean_lx: 0.0,
                max_lx: 0.0,
                uniformity_u0: None,
                uniformity: Uniformity::default(),
                grid: None,
                spot: None,
                area_m2: 1.0,
                cells: 1,
                cells_by_pilot: None,
                expected_nrms: None,
            };
            numbers.rounded_hits()
        };
        assert_eq!(most((0..=1 << 24).step_by(4095).chain([1 << 24, 1 << 45]).collect()), None);
        assert_eq!(most(vec![7, (1 << 24) + 1, (1 << 24) + 2]), Some(16_777_217));
    }
}
