//! Photons that start with a weight, for references: directions uniform in solid angle, weighted by the intensity there.
//!
//! Of the sampler under test this uses the surfaces' part only: no cell equation, no choice by flux inside a luminaire. A
//! photon of weight zero is not followed.

use std::ops::Range;
use std::sync::atomic::Ordering;

use rayon::prelude::*;

use crate::emitter::WeightedEmitters;
use crate::sample::coordinates::Coordinates;
use crate::scene::Scene;
use crate::sequence::Points;
use crate::surface::{Grey, Rgb, Throughput};

use super::census::Exceptions;
use super::parallel::{How, Order};
use super::walk::{Sink, walk};

/// A sink that is told the weight of the photon that follows.
pub trait Weighing<T: Throughput>: Sink<T> {
    /// Arrivals from here on are of a photon that started with this weight (1 on average).
    fn weigh(&mut self, weight: f64);
}

/// Traces the photons of these indices with weights; false after an interrupt.
pub fn trace_weighted<P: Points, S: Weighing<Grey> + Weighing<Rgb>>(
    scene: &Scene,
    emitters: &WeightedEmitters<'_>,
    points: &P,
    range: Range<u64>,
    how: How<'_>,
    sink: impl Fn() -> S + Sync,
) -> bool {
    let order = Order::new(&range);
    order.batches().all(|slots| {
        let indices = order.indices(slots);
        if scene.is_coloured() {
            trace_batch(scene, emitters, points, indices, Rgb::WHITE, how, &mut sink())
        } else {
            trace_batch(scene, emitters, points, indices, Grey, how, &mut sink())
        }
    })
}

fn trace_batch<P: Points, T: Throughput, S: Weighing<T>>(
    scene: &Scene,
    emitters: &WeightedEmitters<'_>,
    points: &P,
    indices: impl Iterator<Item = u64>,
    carried: T,
    how: How<'_>,
    sink: &mut S,
) -> bool {
    let mut exceptions = Exceptions::default();
    let mut photons = 0;
    for index in indices {
        if how.interrupt.load(Ordering::Relaxed) {
            return false;
        }
        let mut coordinates = Coordinates::new(points, index, how.reuse);
        let (emitter, emission, weight) = emitters.emit(&mut coordinates);
        if weight > 0.0 {
            sink.weigh(weight);
            let start = scene.start(emitter);
            let carried = carried.tinted(scene.emitter_colour(emitter));
            walk(scene, emission, start, carried, &mut coordinates, sink, &mut exceptions);
        }
        photons += 1;
    }
    (how.progress)(photons);
    true
}
