//! The order in which photons are traced. It changes no result (sums are order-free), only how well the search tree's
//! nodes stay in the cache and how well the processor guesses the way through it.

use std::ops::Range;

use glam::DVec3;

use crate::emitter::Emission;

/// The order in which a range of indices is taken: by bit-reversed offset.
///
/// The first coordinate of a Sobol' point is the bit-reversed index, scrambled digit by digit, so in this order
/// neighbours have neighbouring first coordinates: the same emitter, the same table cell, nearly the same ray. They visit
/// the same nodes of the search tree while these are in the cache. The sums do not depend on the order.
pub(super) struct Order {
    start: u64,
    length: u64,
    bits: u32,
}

impl Order {
    pub(super) fn new(range: &Range<u64>) -> Self {
        let length = range.end.saturating_sub(range.start);
        Self { start: range.start, length, bits: length.max(2).next_power_of_two().trailing_zeros() }
    }

    /// Slots of the order: a power of two, some of them empty where the range is not one.
    pub(super) fn slots(&self) -> u64 {
        1 << self.bits
    }

    pub(super) fn indices(&self, slots: Range<u64>) -> impl Iterator<Item = u64> + use<> {
        let Self { start, length, bits } = *self;
        slots
            .map(move |slot| slot.reverse_bits() >> (64 - bits))
            .filter(move |offset| *offset < length)
            .map(move |offset| start + offset)
    }
}

/// Indices of the emissions of a batch in an order in which neighbours follow each other: along the Morton curve of the
/// points that they reach at this distance, within the box that the batch's points fill.
pub(super) fn neighbours(emissions: impl Iterator<Item = Emission> + Clone, distance_m: f64) -> Vec<u64> {
    let reach = |e: Emission| e.origin + e.direction * distance_m;
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for e in emissions.clone() {
        let p = reach(e);
        (low, high) = (low.min(p), high.max(p));
    }
    // A direction in which the box has no extent maps to 0 (the cast of NaN or a clamped infinity).
    let scale = DVec3::splat(f64::from(SIDE)) / (high - low);
    let mut keys: Vec<u64> = emissions
        .enumerate()
        .map(|(i, e)| {
            let cell = (reach(e) - low) * scale;
            u64::from(morton(cell.to_array().map(|x| (x as u32).min(SIDE - 1)))) << 32 | i as u64
        })
        .collect();
    keys.sort_unstable();
    keys.iter_mut().for_each(|key| *key &= u64::from(u32::MAX));
    keys
}

/// Cells of the Morton curve along each axis.
const SIDE: u32 = 1 << 10;

/// Interleaves three numbers of 10 bits.
fn morton(cell: [u32; 3]) -> u32 {
    let spread = |x: u32| {
        let x = (x | x << 16) & 0x0300_00ff;
        let x = (x | x << 8) & 0x0300_f00f;
        let x = (x | x << 4) & 0x030c_30c3;
        (x | x << 2) & 0x0924_9249
    };
    spread(cell[0]) | spread(cell[1]) << 1 | spread(cell[2]) << 2
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn morton_interleaves() {
        assert_eq!(morton([1023, 0, 0]), 0x0924_9249);
        assert_eq!(morton([0b11, 0b01, 0b10]), 0b101_011);
    }

    #[test]
    fn neighbours_visits_every_emission_once_and_mostly_in_small_steps() {
        let golden =
            |i: u64| f64::from((i.wrapping_mul(2_654_435_769) & 0xffff_ffff) as u32) / 4_294_967_296.0;
        let emissions: Vec<Emission> = (0..4096)
            .map(|i| {
                let direction = DVec3::new(golden(i) - 0.5, golden(i * i + 7) - 0.5, -1.0).normalize();
                Emission { origin: DVec3::Z, direction }
            })
            .collect();
        let order: Vec<usize> =
            neighbours(emissions.iter().copied(), 2.0).into_iter().map(|i| i as usize).collect();
        let mut seen = order.clone();
        seen.sort_unstable();
        assert_eq!(seen, (0..4096).collect::<Vec<_>>());
        let step = |a: usize, b: usize| (emissions[a].direction - emissions[b].direction).length();
        let total = |order: &[usize]| order.windows(2).map(|w| step(w[0], w[1])).sum::<f64>();
        assert!(total(&order) < 0.1 * total(&(0..4096).collect::<Vec<_>>()));
        // All at one place and in one direction: any order, but all of them.
        let same = vec![emissions[0]; 5];
        assert_eq!(neighbours(same.into_iter(), 2.0).len(), 5);
        assert_eq!(neighbours([].into_iter(), 2.0).len(), 0);
    }

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
