//! Receivers of weighted photons: sums of weights by channel in the cells of a scene's receivers.
//!
//! A weight is a fixed-point integer: the quantum is a power of two chosen before tracing, from the number of
//! photons and of arrivals a photon can make, so that no sum can overflow. Integers may be added in any
//! order, by any thread, and give the same bits; each arrival is rounded by at most half a quantum.

use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::words::limit;
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::Geometry;
use crate::scene::receiver::Receiver;
use crate::surface::Fixed;
use crate::transport::{Arrival, Sink};

use super::receiver::Routes;

/// Most cells of a weighted tally: 24 bytes each.
pub const MOST_WEIGHTED_CELLS: usize = 1 << 24;

/// Most bits after the point: a weight of 1 is then exact as an f64, too.
const MOST_FRACTION_BITS: u32 = 52;
/// Fewest: an arrival is rounded by at most 2^-33 of the flux of a photon.
const FEWEST_FRACTION_BITS: u32 = 32;

/// The sums of all receivers of a scene.
#[derive(Debug)]
pub struct WeightedReceivers<'s> {
    routes: Routes<'s>,
    /// Where each receiver's cells begin.
    first: Vec<usize>,
    sums: Vec<[AtomicU64; 3]>,
    fraction_bits: u32,
}

impl<'s> WeightedReceivers<'s> {
    /// Sums at zero for these receivers. The tally must not see more than `photons` photons, each with at
    /// most `arrivals` arrivals of weights from 0 to 1.
    ///
    /// # Errors
    /// More than [`MOST_WEIGHTED_CELLS`] cells; so many photons that less than 32 bits are left after the
    /// point.
    pub fn new(
        geometry: &'s Geometry,
        receivers: &'s [Receiver],
        photons: u64,
        arrivals: u32,
    ) -> Result<Self> {
        // Every arrival might fall into one cell: its sum stays below 2^64.
        let most = u128::from(photons) * u128::from(arrivals);
        let whole_bits = u128::BITS - most.leading_zeros();
        let fraction_bits = u64::BITS.saturating_sub(whole_bits).min(MOST_FRACTION_BITS);
        if fraction_bits < FEWEST_FRACTION_BITS {
            return Err(Diagnostic::new(
                Kind::Limit,
                format!("{photons} weighted photons of {arrivals} arrivals"),
                "fewer than 2^32 arrivals, so that their weights keep 32 bits after the point",
            ));
        }
        let mut cells = 0;
        let mut first = Vec::with_capacity(receivers.len());
        for receiver in receivers {
            first.push(cells);
            cells += receiver.cells.len();
        }
        if cells > MOST_WEIGHTED_CELLS {
            return Err(Diagnostic::new(
                Kind::Limit,
                format!("{cells} cells of receivers for weighted photons"),
                format!("at most {}", limit(MOST_WEIGHTED_CELLS as u64)),
            ));
        }
        let sums = (0..cells).map(|_| std::array::from_fn(|_| AtomicU64::new(0))).collect();
        Ok(Self { routes: Routes::new(geometry, receivers), first, sums, fraction_bits })
    }

    /// A handle for one batch of photons; all handles add to the same sums.
    pub fn sink(&self) -> ChannelSink<'_, 's> {
        ChannelSink { receivers: self, scale: self.scale() }
    }

    /// Sum of the weights that arrived in a cell, by channel, in photons.
    pub fn weight(&self, cell: usize) -> [f64; 3] {
        self.sums[cell].each_ref().map(|sum| sum.load(Ordering::Relaxed) as f64 / self.scale())
    }

    fn scale(&self) -> f64 {
        (1u64 << self.fraction_bits) as f64
    }
}

/// Adds weighted arrivals to a scene's receivers.
#[derive(Debug, Clone, Copy)]
pub struct ChannelSink<'r, 's> {
    receivers: &'r WeightedReceivers<'s>,
    scale: f64,
}

impl Sink<Fixed> for ChannelSink<'_, '_> {
    #[inline]
    fn arrive(&mut self, arrival: &Arrival<'_, Fixed>) {
        let all = self.receivers;
        // Rounded to the nearest quantum; at most `scale`, because weights are at most 1.
        let quanta = arrival.carried.weight().map(|w| (w * self.scale + 0.5) as u64);
        let add = |receiver: usize, cell: usize| {
            for (sum, quanta) in all.sums[all.first[receiver] + cell].iter().zip(quanta) {
                sum.fetch_add(quanta, Ordering::Relaxed);
            }
        };
        all.routes.each_cell(arrival, add, |_, _| {});
    }
}

#[cfg(test)]
mod tests {
    use super::super::receiver::tests::{BOTH, receiver, send, square_and_box};
    use super::*;
    use crate::surface::Throughput;

    #[test]
    fn weights_add_up_by_channel_and_receiver() {
        let geometry = square_and_box();
        let all = [[2, 1], [1, 1]].map(|cells| receiver(&geometry, "square", Some(cells), BOTH));
        let tally = WeightedReceivers::new(&geometry, &all, 4, 1).unwrap();
        let mut sink = tally.sink();
        send(&geometry, &mut sink, &Fixed::white(0), (0.2, 0.5, 0.5), 0);
        let tinted = Fixed::white(0).tinted([1.0, 0.5, 0.25]);
        send(&geometry, &mut sink, &tinted, (0.7, 0.5, -0.5), 1);
        send(&geometry, &mut sink, &tinted, (0.7, 0.5, 0.5), 1);
        assert_eq!(tally.weight(0), [1.0; 3]);
        assert_eq!(tally.weight(1), [2.0, 1.0, 0.5]);
        assert_eq!(tally.weight(2), [3.0, 2.0, 1.5]);
    }

    #[test]
    fn an_arrival_is_rounded_to_the_nearest_quantum() {
        let geometry = square_and_box();
        let all = [receiver(&geometry, "square", Some([1, 1]), BOTH)];
        let tally = WeightedReceivers::new(&geometry, &all, (1 << 32) - 1, 1).unwrap();
        let quantum = 1.0 / (1u64 << 32) as f64;
        let carried = Fixed::white(0).tinted([0.49, 0.51, 1.2].map(|w| w * quantum));
        send(&geometry, &mut tally.sink(), &carried, (0.5, 0.5, 0.5), 0);
        assert_eq!(tally.weight(0), [0.0, quantum, quantum]);
    }

    #[test]
    fn too_many_cells_are_refused() {
        let geometry = square_and_box();
        let all = [[1 << 12, 1 << 12], [1, 1]].map(|cells| receiver(&geometry, "square", Some(cells), BOTH));
        assert_eq!(WeightedReceivers::new(&geometry, &all, 1, 1).unwrap_err().kind(), Kind::Limit);
    }

    #[test]
    fn the_quantum_leaves_room_for_every_arrival() {
        let geometry = Geometry::build(Vec::new()).unwrap();
        let bits = |photons, arrivals| WeightedReceivers::new(&geometry, &[], photons, arrivals);
        for (photons, arrivals, expected) in [
            (1, 1, 52),
            (10_000_000, 5, 38), // 5e7 < 2^26
            ((1 << 24) - 1, 1, 40),
            (1 << 24, 1, 39),
            ((1 << 32) - 1, 1, 32),
        ] {
            let tally = bits(photons, arrivals).unwrap();
            assert_eq!(tally.fraction_bits, expected, "{photons} x {arrivals}");
            let most = (u128::from(photons) * u128::from(arrivals)) << tally.fraction_bits;
            assert!(most <= u128::from(u64::MAX));
        }
        assert!(bits(1 << 32, 1).is_err());
        assert!(bits(u64::MAX, u32::MAX).is_err());
    }
}
