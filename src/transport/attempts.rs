//! How many points of a sequence give a number of photons, where rejected points give none.

use std::ops::Range;
use std::sync::atomic::Ordering;

use rayon::prelude::*;

use crate::sample::coordinates::Coordinates;
use crate::scene::Scene;
use crate::sequence::Points;

use super::parallel::How;

/// Points of one task.
const BATCH: u64 = 1 << 14;
/// Tasks counted at once: enough for any number of threads, few enough that little is counted in vain.
const BATCHES: u64 = 64;

/// The first index at or after `start` before which `wanted` points from `start` on give a photon. Emission alone is
/// evaluated. After an interrupt: any index.
pub fn advance<P: Points>(scene: &Scene, points: &P, how: &How<'_>, start: u64, wanted: u64) -> u64 {
    let gives = |index: u64| {
        let mut coordinates = Coordinates::new(points, index, how.reuse);
        scene.emitters.emit(how.sampling, &mut coordinates).is_some()
    };
    let (mut at, mut left) = (start, wanted);
    while left > 0 && !how.interrupt.load(Ordering::Relaxed) {
        let batches: Vec<Range<u64>> = (0..BATCHES).map(|k| at + k * BATCH..at + (k + 1) * BATCH).collect();
        let counts: Vec<u64> = batches
            .par_iter()
            .map(|range| range.clone().filter(|index| gives(*index)).count() as u64)
            .collect();
        for (range, count) in batches.into_iter().zip(counts) {
            at = range.end;
            if count < left {
                left -= count;
                continue;
            }
            // The last photon is in this batch: find it.
            at = range.start;
            while left > 0 {
                left -= u64::from(gives(at));
                at += 1;
            }
            break;
        }
    }
    at
}
