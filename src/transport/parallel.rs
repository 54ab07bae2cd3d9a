//! Ranges of photon indices over threads.
//!
//! A photon's numbers belong to its index, a sink's sums are exact and order-free, and so any division of the indices
//! among threads (or machines) gives the same bits.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::emitter::Emission;
use crate::sample::coordinates::Coordinates;
use crate::scene::Scene;
use crate::sequence::Points;

use super::census::Census;
use super::ledger::Ledger;
use super::order::{Order, neighbours};
use super::walk::{Sink, walk};

/// Photons of one task: large enough that its bookkeeping costs nothing, small enough for an even load and a prompt
/// end on interruption.
const BATCH: u64 = 1 << 12;

/// Photons of one set, all of which are traced or none. Inside a set photons go by their first coordinate, so a part of
/// a set is light from a part of the emission only: an interrupt waits for the end of the set, under a second.
const SET: u64 = 1 << 18;

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
    /// Set from outside to stop; looked at between sets.
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
    let mut traced = empty();
    let mut start = range.start;
    while start < range.end {
        if how.interrupt.load(Ordering::Relaxed) {
            traced.complete = false;
            break;
        }
        let set = start..range.end.min(start.saturating_add(SET));
        start = set.end;
        traced.absorb(&trace_set(scene, points, set, how, &sink, &empty));
    }
    traced
}

/// Traces one set to its end, batch by batch over the threads.
fn trace_set<P: Points, S: Sink>(
    scene: &Scene,
    points: &P,
    set: Range<u64>,
    how: How<'_>,
    sink: &(impl Fn() -> S + Sync),
    empty: &(impl Fn() -> Traced + Sync),
) -> Traced {
    let order = Order::new(&set);
    (0..order.slots().div_ceil(BATCH))
        .into_par_iter()
        .fold(empty, |mut traced, batch| {
            let slots = batch * BATCH..order.slots().min((batch + 1) * BATCH);
            let before = traced.ledger.total_emitted();
            trace_batch(scene, points, order.indices(slots), how.reuse, &mut sink(), &mut traced);
            (how.progress)(traced.ledger.total_emitted() - before);
            traced
        })
        .reduce(empty, |mut a, b| {
            a.absorb(&b);
            a
        })
}

impl Traced {
    fn absorb(&mut self, other: &Self) {
        self.ledger.merge(&other.ledger);
        self.census.merge(&other.census);
        self.complete &= other.complete;
    }
}

/// Emits the photons of a batch, puts neighbours together, and walks them.
fn trace_batch<P: Points, S: Sink>(
    scene: &Scene,
    points: &P,
    indices: impl Iterator<Item = u64>,
    reuse: bool,
    sink: &mut S,
    traced: &mut Traced,
) {
    let mut started: Vec<Started<'_, P>> = Vec::with_capacity(BATCH as usize);
    for index in indices {
        let mut coordinates = Coordinates::new(points, index, reuse);
        let (emitter, emission) = scene.emitters.emit(&mut coordinates);
        traced.ledger.begin(emitter);
        started.push(Started { emitter, emission, coordinates });
    }
    let (low, high) = scene.geometry.bounds();
    for at in neighbours(started.iter().map(|s| s.emission), (high - low).length()) {
        let Started { emitter, emission, coordinates } = &mut started[at as usize];
        let exceptions = &mut traced.census.exceptions;
        let end = walk(scene, *emission, scene.start(*emitter), coordinates, sink, exceptions);
        traced.ledger.end(end);
        traced.census.count(coordinates.drawn(), coordinates.drawn_for());
    }
}

/// A photon that has been emitted and waits for its walk.
struct Started<'p, P> {
    emitter: usize,
    emission: Emission,
    coordinates: Coordinates<'p, P>,
}
