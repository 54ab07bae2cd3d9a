//! Ranges of photon indices over threads.
//!
//! A photon's numbers belong to its index, a sink's sums are exact and order-free, and so any division of the indices
//! among threads (or machines) gives the same bits.

use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};

use rayon::prelude::*;

use crate::emitter::Emitters;
use crate::sample::coordinates::Coordinates;
use crate::sample::method::Sampling;
use crate::scene::Scene;
use crate::sequence::Points;
use crate::surface::Throughput;

use super::census::Census;
use super::ledger::Ledger;
use super::trap::limit;
use super::walk::{End, Sink, walk_until};

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
    /// False where the interrupt came before all photons were traced. Those that were are then no fair sample of the
    /// range: neighbours in the order have neighbouring directions.
    pub complete: bool,
}

impl Traced {
    /// No photons of this scene.
    pub fn new(scene: &Scene) -> Self {
        Self {
            ledger: Ledger::new(scene.emitters.as_slice().len(), scene.geometry.surfaces().len()),
            census: Census::default(),
            complete: true,
        }
    }

    /// Adds the photons of another range of the same scene.
    pub fn merge(&mut self, other: &Self) {
        self.ledger.merge(&other.ledger);
        self.census.merge(&other.census);
        self.complete &= other.complete;
    }
}

/// How a range of photons is to be traced.
#[derive(Clone, Copy)]
pub struct How<'a> {
    /// Renormalisation on (METHOD 2).
    pub reuse: bool,
    /// How tables are sampled.
    pub sampling: Sampling,
    /// Set from outside to stop; looked at before every photon, because some take 100,000 events.
    pub interrupt: &'a AtomicBool,
    /// Told the number of photons after each batch.
    pub progress: &'a (dyn Fn(u64) + Sync),
}

/// The order in which a range of indices is traced: by bit-reversed offset.
///
/// The first coordinate of a Sobol' point is the bit-reversed index, scrambled digit by digit, so in this order
/// neighbours have neighbouring first coordinates: the same emitter, the same table cell, nearly the same ray. They visit
/// the same nodes of the search tree while these are in the cache. The sums do not depend on the order.
struct Order {
    start: u64,
    length: u64,
    bits: u32,
}

impl Order {
    fn new(range: &Range<u64>) -> Self {
        let length = range.end.saturating_sub(range.start);
        Self { start: range.start, length, bits: length.max(2).next_power_of_two().trailing_zeros() }
    }

    /// Slots of the order: a power of two, some of them empty where the range is not one.
    fn slots(&self) -> u64 {
        1 << self.bits
    }

    /// Ranges of slots, one a task.
    fn batches(&self) -> impl ParallelIterator<Item = Range<u64>> + use<> {
        let slots = self.slots();
        let batch = move |k: u64| k * BATCH..slots.min((k + 1) * BATCH);
        (0..slots.div_ceil(BATCH)).into_par_iter().map(batch)
    }

    fn indices(&self, slots: Range<u64>) -> impl Iterator<Item = u64> + use<> {
        let Self { start, length, bits } = *self;
        slots
            .map(move |slot| slot.reverse_bits() >> (64 - bits))
            .filter(move |offset| *offset < length)
            .map(move |offset| start + offset)
    }
}

/// Traces the photons of these indices, each of which starts with the throughput `carried` in its emitter's colour:
/// [`crate::surface::Grey`] unless the scene has colour. `emitters` are the scene's, or give its light in another way
/// ([`Emitters::with_weights`]). `sink` makes one handle a batch, all of which add to the same sums.
pub fn trace_range<P: Points, S: Sink<T>, T: Throughput>(
    scene: &Scene,
    emitters: &Emitters,
    points: &P,
    range: Range<u64>,
    carried: T,
    how: How<'_>,
    sink: impl Fn() -> S + Sync,
) -> Traced {
    let empty = || Traced::new(scene);
    let order = Order::new(&range);
    order
        .batches()
        .fold(empty, |mut traced, slots| {
            let before = traced.ledger.total_emitted();
            let indices = order.indices(slots);
            trace_batch((scene, emitters), points, indices, carried, how, &mut sink(), &mut traced);
            (how.progress)(traced.ledger.total_emitted() - before);
            traced
        })
        .reduce(empty, |mut a, b| {
            a.merge(&b);
            a
        })
}

fn trace_batch<P: Points, S: Sink<T>, T: Throughput>(
    (scene, emitters): (&Scene, &Emitters),
    points: &P,
    indices: impl Iterator<Item = u64>,
    carried: T,
    how: How<'_>,
    sink: &mut S,
    traced: &mut Traced,
) {
    let trapped_after = limit(scene);
    for index in indices {
        if how.interrupt.load(Ordering::Relaxed) {
            traced.complete = false;
            return;
        }
        let mut coordinates = Coordinates::sampling_by(points, index, how.reuse, how.sampling);
        let Some((emitter, emission)) = emitters.emit(how.sampling, &mut coordinates) else {
            traced.census.count_rejected(coordinates.drawn_for());
            continue;
        };
        traced.ledger.begin(emitter);
        sink.start(emission.weight);
        let exceptions = &mut traced.census.exceptions;
        let start = scene.start(emitter);
        let carried = carried.tinted(scene.emitter_colour(emitter));
        let end =
            walk_until(trapped_after, scene, emission, start, carried, &mut coordinates, sink, exceptions);
        traced.ledger.end(end);
        if end == End::Missed {
            *traced.census.missed.entry(emitter).or_default() += 1;
        }
        traced.census.count(coordinates.drawn(), coordinates.drawn_for());
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_index_is_visited_once_whatever_the_range() {
        for range in [0..1, 0..2, 5..6, 0..1000, 7..1031, 1 << 40..(1 << 40) + 4097, 3..3] {
            let order = Order::new(&range);
            let mut seen: Vec<u64> = order.indices(0..order.slots()).collect();
            seen.sort_unstable();
            assert_eq!(seen, range.collect::<Vec<_>>());
        }
    }
}
