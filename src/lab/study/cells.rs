//! The grids of cells that errors are measured on, all filled by one run.

use std::ops::Range;

use crate::error::{Diagnostic, Kind, Result};
use crate::scene::Scene;
use crate::scene::receiver::{Cells, Receiver, ReceiverSpec};

/// Cells along one side that a grid may have: 4096 x 4096 cells take 128 MB a set of counters.
pub const MOST_CELLS: u32 = 4096;

/// Receivers divided into several grids.
#[derive(Debug)]
pub struct Grids {
    /// Every receiver once for each grid, grid by grid.
    pub receivers: Vec<Receiver>,
    /// What a grid is called: cells along each side, or, of a scene that has meshes only, the number of faces.
    pub labels: Vec<u32>,
    /// Names of the scene's receivers that take part.
    pub names: Vec<String>,
    /// What is left out, and why.
    pub warnings: Vec<String>,
    /// Receivers of each grid.
    ranges: Vec<Range<usize>>,
}

impl Grids {
    /// The receivers of a scene with `k` x `k` cells for each `k`; where it has none with cells, its meshes by faces.
    ///
    /// # Errors
    /// No receiver, no grid, a grid of no cells or more than [`MOST_CELLS`] a side.
    pub fn new(scene: &Scene, cells: &[u32]) -> Result<Self> {
        let fail = |found: String, required: String| Err(Diagnostic::new(Kind::Range, found, required));
        if scene.receivers.is_empty() {
            return fail("a scene without receivers".into(), "a [[receiver]] to measure errors on".into());
        }
        if let Some(bad) = cells.iter().find(|k| **k == 0 || **k > MOST_CELLS) {
            return fail(format!("grids of {bad} x {bad} cells"), format!("1 to {MOST_CELLS} cells a side"));
        }
        let (mut divided, mut faces) = (Vec::new(), Vec::new());
        for receiver in &scene.receivers {
            match receiver.cells {
                Cells::Grid { .. } => divided.push(receiver),
                Cells::Faces { .. } => faces.push(receiver),
            }
        }
        let mut grids =
            Self { receivers: vec![], labels: vec![], names: vec![], warnings: vec![], ranges: vec![] };
        if divided.is_empty() {
            grids.names = faces.iter().map(|r| r.name.clone()).collect();
            let count: usize = faces.iter().map(|r| r.cells.len()).sum();
            grids.push(count as u32, faces.into_iter().cloned().collect());
            return Ok(grids);
        }
        if cells.is_empty() {
            return fail("no grids".into(), "at least one number of cells a side".into());
        }
        if let [first, ..] = faces.as_slice() {
            grids.warnings.push(format!(
                "receivers on meshes (\"{}\") are left out: errors are measured on those with cells",
                first.name
            ));
        }
        grids.names = divided.iter().map(|r| r.name.clone()).collect();
        for &k in cells {
            let receivers = divided.iter().map(|receiver| {
                let surface = &scene.geometry.surfaces()[receiver.surface.0 as usize].name;
                let spec = ReceiverSpec::new(&receiver.name, surface)?.with_cells([k, k])?;
                Receiver::new(&spec.on_side(receiver.side).of_events(receiver.events), &scene.geometry)
            });
            let receivers = receivers.collect::<Result<Vec<_>>>()?;
            grids.push(k, receivers);
        }
        Ok(grids)
    }

    fn push(&mut self, label: u32, receivers: Vec<Receiver>) {
        let start = self.receivers.len();
        self.receivers.extend(receivers);
        self.labels.push(label);
        self.ranges.push(start..self.receivers.len());
    }

    /// Number of cells of all grids together.
    pub fn cell_count(&self) -> usize {
        self.receivers.iter().map(|r| r.cells.len()).sum()
    }

    /// Where the cells of each grid lie among the cells of all receivers in their order.
    pub fn cell_ranges(&self) -> Vec<Range<usize>> {
        let mut start = 0;
        self.ranges
            .iter()
            .map(|range| {
                let cells: usize = self.receivers[range.clone()].iter().map(|r| r.cells.len()).sum();
                start += cells;
                start - cells..start
            })
            .collect()
    }

    /// Area of every cell of all grids, m2.
    pub fn areas_m2(&self) -> Vec<f64> {
        self.receivers.iter().flat_map(|r| (0..r.cells.len()).map(|cell| r.area_m2(cell))).collect()
    }
}
