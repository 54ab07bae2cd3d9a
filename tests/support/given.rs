//! Coordinates that a test chooses.

use caustix::math::solve::Solver;
use caustix::sample::cell::GridPoint;
use caustix::sample::choose::Reusable;
use caustix::sample::compact::CompactGrids;
use caustix::sample::coordinates::{Chooser, Purpose};
use caustix::sample::grid::Grid;
use caustix::sample::method::Sampling;

/// A chooser with one coordinate for all events and others in order. It has no more than is given, so a test
/// also counts what is drawn; and however little is left of a coordinate, it serves.
#[derive(Debug, Clone)]
pub struct Script {
    event: Reusable,
    /// The last one comes first.
    rest: Vec<u64>,
    reuse: bool,
}

impl Script {
    pub fn new(event: u64, coordinates: &[u64]) -> Self {
        let rest = coordinates.iter().rev().copied().collect();
        Self { event: Reusable::fresh(event), rest, reuse: true }
    }

    /// The same where a coordinate does not go on after a choice.
    pub fn without_reuse(self) -> Self {
        Self { reuse: false, ..self }
    }
}

impl Chooser for Script {
    fn happens(&mut self, probability: f64) -> bool {
        if probability <= 0.0 || probability >= 1.0 {
            return probability >= 1.0;
        }
        self.event.happens(probability)
    }

    fn uniform(&mut self, purpose: Purpose) -> f64 {
        caustix::sequence::to_unit_f64(self.reusable(purpose).bits())
    }

    fn reusable(&mut self, _: Purpose) -> Reusable {
        Reusable::fresh(self.rest.pop().unwrap())
    }

    fn rest(&mut self, u: Reusable, _: Purpose) -> f64 {
        caustix::sequence::to_unit_f64(u.bits())
    }

    fn reuses(&self) -> bool {
        self.reuse
    }

    fn decide<R>(&mut self, _: Purpose, choice: impl FnOnce(&mut Reusable) -> R) -> R {
        choice(&mut self.event)
    }

    fn left(&mut self, left: f64, _: f64, _: Purpose) -> f64 {
        left
    }
}

/// The direction of a luminaire's table for two coordinates, the first of which chooses the cell too.
pub fn of_grid(grid: &Grid, u1: u64, u2: u64, solver: Solver) -> GridPoint {
    grid.draw(Sampling::Inverse(solver), Reusable::fresh(u1), &mut Script::new(0, &[u2])).unwrap()
}

/// The direction of a slice for two coordinates, of which the first chooses the row too, the second the
/// column.
pub fn of_slice(grids: &CompactGrids, slice: usize, u1: u64, u2: u64) -> GridPoint {
    grids.draw(slice, &mut Script::new(0, &[u1, u2])).0
}

/// A number in [0, 1] as a 64-bit fraction.
pub fn fraction(u: f64) -> u64 {
    (u * 2f64.powi(64)) as u64
}
