//! The grids of cells that errors are measured on, all filled by one run.

use std::ops::Range;

use crate::error::{Diagnostic, Kind, Result};
use crate::scene::Scene;
use crate::scene::receiver::{Cells, Receiver, ReceiverSpec};

/// Most cells along one side of a grid: 4096 x 4096 cells take 128 MB a set of counters.
pub const MOST_CELLS: u32 = 4096;

/// The receivers of a scene, divided into several grids.
#[derive(Debug)]
pub struct Grids<'s> {
    pub(crate) scene: &'s Scene,
    /// Every receiver once for each grid, grid by grid.
    pub(crate) receivers: Vec<Receiver>,
    /// What each grid is called: cells along a side, or, of a scene that has meshes only, the number of
    /// faces.
    pub(crate) labels: Vec<u32>,
    /// Names of the scene's receivers that take part.
    pub(crate) names: Vec<String>,
    /// What is left out, and why.
    pub(crate) warnings: Vec<String>,
}

impl<'s> Grids<'s> {
    /// The receivers of a scene with `k` x `k` cells for each `k`; where it has none with cells, its meshes
    /// by faces.
    ///
    /// # Errors
    /// No receiver, no grid, a grid of no cells or more than `MOST_CELLS` a side.
    pub fn new(scene: &'s Scene, cells: &[u32]) -> Result<Self> {
        let fail = |found: &str, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
        if scene.receivers.is_empty() {
            return fail("a scene without receivers", "a [[receiver]] to measure errors on");
        }
        if let Some(bad) = cells.iter().find(|k| !(1..=MOST_CELLS).contains(*k)) {
            let found = format!("grids of {bad} x {bad} cells");
            return fail(&found, &format!("1 to {MOST_CELLS} cells a side"));
        }
        let is_divided = |r: &&Receiver| matches!(r.cells, Cells::Grid { .. });
        let (divided, meshes): (Vec<&Receiver>, Vec<_>) = scene.receivers.iter().partition(is_divided);
        let names = |of: &[&Receiver]| of.iter().map(|r| r.name.clone()).collect();
        if divided.is_empty() {
            let labels = vec![meshes.iter().map(|r| r.cells.len()).sum::<usize>() as u32];
            let receivers = meshes.iter().copied().cloned().collect();
            return Ok(Self { scene, receivers, labels, names: names(&meshes), warnings: Vec::new() });
        }
        if cells.is_empty() {
            return fail("no grids", "at least one number of cells a side");
        }
        let divide = |(k, receiver): (u32, &Receiver)| {
            let surface = scene.geometry.name(receiver.surface);
            let spec = ReceiverSpec::new(&receiver.name, surface)?.with_cells([k, k])?;
            Receiver::new(&spec.on_side(receiver.side).of_events(receiver.events), &scene.geometry)
        };
        let each = cells.iter().flat_map(|&k| divided.iter().map(move |r| (k, *r)));
        let left_out = |first: &&Receiver| {
            let name = &first.name;
            format!("receivers on meshes (\"{name}\") are left out: errors are measured on those with cells")
        };
        Ok(Self {
            scene,
            receivers: each.map(divide).collect::<Result<_>>()?,
            labels: cells.to_vec(),
            names: names(&divided),
            warnings: meshes.first().map(left_out).into_iter().collect(),
        })
    }

    /// Number of cells of all grids together.
    pub fn cell_count(&self) -> usize {
        self.receivers.iter().map(|r| r.cells.len()).sum()
    }

    /// Where the cells of each grid lie among all cells.
    pub(super) fn cell_ranges(&self) -> impl Iterator<Item = Range<usize>> + '_ {
        // Every grid has as many receivers.
        self.receivers.chunks(self.receivers.len() / self.labels.len()).scan(0, |end, grid| {
            let start = *end;
            *end += grid.iter().map(|r| r.cells.len()).sum::<usize>();
            Some(start..*end)
        })
    }
}

/// Area of every cell of these receivers, one receiver after another, m2.
pub(crate) fn areas_m2(receivers: &[Receiver]) -> Vec<f64> {
    receivers.iter().flat_map(|r| (0..r.cells.len()).map(|cell| r.area_m2(cell))).collect()
}
