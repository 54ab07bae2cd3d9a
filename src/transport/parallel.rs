//! Ranges of photon indices over threads.
//!
//! A photon's numbers belong to its index, a sink's sums are exact and order-free, and so any division of the indices
//! among threads (or machines) gives the same bits.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::sample::coordinates::Coordinates;
use crate::scene::Scene;
use crate::sequence::Points;

use super::census::Census;
use super::ledger::Ledger;
use super::walk::{Sink, walk};

/// Photons of one task: large enough that its bookkeeping costs nothing, small enough for an even load and a prompt
/// end on interruption.
const BATCH: u64 = 1 << 14;

/// What a range of photons left beside the sink's sums.
#[derive(Debug, Clone)]
pub struct Traced {
    /// Where they began and ended.
    pub ledger: Ledger,
    /// Coordinates and exceptions.
    pub census: Census,
    /// False where the interrupt came before all photons were traced.
    pub complete: bool,
}

/// How a range of photons is to be traced.
#[derive(Clone, Copy)]
pub struct How<'a> {
    /// Renormalisation on (METHOD 2).
    pub reuse: bool,
    /// Set from outside to stop; looked at between batches.
    pub interrupt: &'a AtomicBool,
    /// Told the number of photons after each batch.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// Traces the photons of these indices; `sink` makes one handle a batch, all of which add to the same sums.
pub fn trace_range<P: Points, S: Sink>(
    scene: &Scene,
    points: &P,
    range: Range<u64>,
    how: How<'_>,
    sink: impl Fn() -> S + Sync,
) -> Traced {
    let empty = || Traced {
        ledger: Ledger::new(scene.emitters.as_slice().len(), scene.geometry.surfaces().len()),
        census: Census::default(),
        complete: true,
    };
    let batches = (range.end - range.start).div_ceil(BATCH);
    (0..batches)
        .into_par_iter()
        .fold(empty, |mut traced, batch| {
            if how.interrupt.load(Ordering::Relaxed) {
                traced.complete = false;
                return traced;
            }
            let start = range.start + batch * BATCH;
            let end = range.end.min(start + BATCH);
            trace_batch(scene, points, start..end, how.reuse, &mut sink(), &mut traced);
            (how.progress)(end - start);
            traced
        })
        .reduce(empty, |mut a, b| {
            a.ledger.merge(&b.ledger);
            a.census.merge(&b.census);
            a.complete &= b.complete;
            a
        })
}

fn trace_batch<P: Points, S: Sink>(
    scene: &Scene,
    points: &P,
    range: Range<u64>,
    reuse: bool,
    sink: &mut S,
    traced: &mut Traced,
) {
    for index in range {
        let mut coordinates = Coordinates::new(points, index, reuse);
        let (emitter, emission) = scene.emitters.emit(&mut coordinates);
        traced.ledger.begin(emitter);
        let exceptions = &mut traced.census.exceptions;
        let end = walk(scene, emission, scene.start(emitter), &mut coordinates, sink, exceptions);
        traced.ledger.end(end);
        traced.census.count(coordinates.drawn(), coordinates.drawn_for());
    }
}
