//! What a run keeps of every replicate, and whether there is room for it.

use crate::error::{Diagnostic, Kind, Result};
use crate::scene::Scene;
use crate::scene::receiver::Receiver;

use super::plan::{DEFAULT_REPLICATES, Plan};

/// Most counters of all replicates together: 2^27 of 8 bytes, a gibibyte.
const MOST_COUNTERS: u64 = 1 << 27;

/// Whether the replicates of a run advance together: unless their maps take more than a gibibyte, or the points are
/// made for their number, so that a first part of them is no sample.
pub fn is_together(scene: &Scene, plan: &Plan) -> bool {
    are_kept(scene, plan) && !plan.algorithm().sequence.needs_number()
}

/// Whether there is room for the maps of all replicates.
pub(super) fn are_kept(scene: &Scene, plan: &Plan) -> bool {
    counters(scene, plan) <= MOST_COUNTERS
}

/// Bytes that the sums of a run of eight replicates take: its counters, their sums over replicates, and of far fields and spots
/// what each replicate counted again, with the tables that are made of it.
pub fn memory_bytes(scene: &Scene) -> u64 {
    /// Sum, sum of squares and sum over half of the replicates.
    const OF_CELL: u64 = 2 * size_of::<u64>() as u64 + size_of::<u128>() as u64;
    /// Measured: with the counters 42 to 48 bytes a node and replicate.
    const OF_NODE: u64 = 40;
    const COUNTER: u64 = size_of::<u64>() as u64;
    let cells = cells(scene);
    let (nodes, fine) = always_kept(scene);
    let all = (cells + nodes + fine).saturating_mul(DEFAULT_REPLICATES.into());
    // Replicates in turn have one set of counters.
    let counters = if scene.camera.is_some() || all > MOST_COUNTERS { cells + nodes + fine } else { all };
    let of_replicates = (nodes * OF_NODE + fine * COUNTER).saturating_mul(DEFAULT_REPLICATES.into());
    counters.saturating_mul(COUNTER).saturating_add(cells * OF_CELL).saturating_add(of_replicates)
}

/// Cells of receivers and of their evaluation grids.
fn cells(scene: &Scene) -> u64 {
    let grid = |receiver: &Receiver| receiver.grid.map_or(0, |grid| grid.cells() as u64);
    scene.receivers.iter().map(|r| r.cells.len() as u64 + grid(r)).sum()
}

/// Counters of all replicates.
pub(super) fn counters(scene: &Scene, plan: &Plan) -> u64 {
    let (nodes, fine) = always_kept(scene);
    (cells(scene) + nodes + fine).saturating_mul(u64::from(plan.replicates()))
}

/// Nodes of far fields and fine cells of spots: their errors need those of every replicate.
fn always_kept(scene: &Scene) -> (u64, u64) {
    let fine = scene.receivers.iter().filter_map(|receiver| receiver.spot);
    let nodes = scene.far_fields.iter().map(|field| field.nodes.count() as u64);
    (nodes.sum(), fine.map(|spot| spot.cells() as u64).sum())
}

/// That there is room for the far fields and spots of every replicate.
///
/// # Errors
/// More than 2^27 nodes and fine cells.
pub(super) fn check_kept(scene: &Scene, plan: &Plan) -> Result<()> {
    let (nodes, fine) = always_kept(scene);
    let replicates = plan.replicates();
    if (nodes + fine).saturating_mul(u64::from(replicates)) <= MOST_COUNTERS {
        return Ok(());
    }
    let (found, required) = if fine == 0 {
        (
            format!("{replicates} replicates of {nodes} nodes in far fields, half steps included"),
            "at most 2^27 nodes in all: fewer replicates, or wider steps",
        )
    } else {
        (
            format!("{replicates} replicates of {fine} fine cells of spots and {nodes} nodes of far fields"),
            "at most 2^27 in all: fewer replicates, or fewer receivers with `spot`",
        )
    };
    Err(Diagnostic::new(Kind::Limit, found, required))
}
