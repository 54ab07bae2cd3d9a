//! Receivers: arrivals on a surface, sorted into cells.
//!
//! A receiver counts flux arriving before the event, whatever the material, on the sides and of the history it asks for.
//! A rectangle, sphere or paraboloid has cells in its (u, v); the pixel of row 0, column 0 is the (u = 0, v = 1) corner. A
//! mesh has a cell a face.

use crate::geometry::{Geometry, Hit};
use crate::scene::receiver::{Cells, Receiver, ReceiverEvents, ReceiverSide};
use crate::surface::Throughput;
use crate::transport::{Arrival, Sink};

use super::counts::Counts;

/// Which cells of which receivers an arrival falls into.
#[derive(Debug)]
pub(super) struct Routes<'s> {
    geometry: &'s Geometry,
    receivers: &'s [Receiver],
    /// Receivers on each surface.
    on_surface: Vec<Vec<u32>>,
}

/// The counters of all receivers of a scene, for one replicate.
#[derive(Debug)]
pub struct Receivers<'s> {
    routes: Routes<'s>,
    counts: Vec<Counts>,
}

impl<'s> Routes<'s> {
    pub(super) fn new(geometry: &'s Geometry, receivers: &'s [Receiver]) -> Self {
        let mut on_surface = vec![Vec::new(); geometry.surfaces().len()];
        for (i, receiver) in receivers.iter().enumerate() {
            on_surface[receiver.surface.0 as usize].push(i as u32);
        }
        Self { geometry, receivers, on_surface }
    }

    /// Calls `add(receiver, cell)` for every receiver that the arrival counts for.
    #[inline(always)]
    pub(super) fn each_cell<T>(&self, arrival: &Arrival<'_, T>, mut add: impl FnMut(usize, usize)) {
        for &i in &self.on_surface[arrival.hit.surface.0 as usize] {
            let receiver = &self.receivers[i as usize];
            let side = match receiver.side {
                ReceiverSide::Both => true,
                ReceiverSide::Front => arrival.hit.front,
                ReceiverSide::Back => !arrival.hit.front,
            };
            let history = match receiver.events {
                ReceiverEvents::All => true,
                ReceiverEvents::Direct => arrival.events == 0,
                ReceiverEvents::Indirect => arrival.events > 0,
            };
            if side
                && history
                && let Some(cell) = self.cell(receiver, arrival.hit)
            {
                add(i as usize, cell);
            }
        }
    }

    fn cell(&self, receiver: &Receiver, hit: &Hit) -> Option<usize> {
        match receiver.cells {
            Cells::Faces { count } => ((hit.face as usize) < count).then_some(hit.face as usize),
            Cells::Grid { nu, nv } => {
                let shape = &self.geometry.surfaces()[hit.surface.0 as usize].shape;
                let (u, v) = shape.uv(hit.position)?;
                let column = ((u * f64::from(nu)) as u32).min(nu - 1);
                let row = nv - 1 - ((v * f64::from(nv)) as u32).min(nv - 1);
                Some(row as usize * nu as usize + column as usize)
            }
        }
    }
}

impl<'s> Receivers<'s> {
    /// Counters at zero for these receivers.
    pub fn new(geometry: &'s Geometry, receivers: &'s [Receiver]) -> Self {
        let counts = receivers.iter().map(|r| Counts::new(r.cells.len())).collect();
        Self { routes: Routes::new(geometry, receivers), counts }
    }

    /// A handle for one batch of photons; all handles add to the same counters.
    pub fn sink(&self) -> ReceiverSink<'_, 's> {
        ReceiverSink { receivers: self }
    }

    /// A handle for weighted photons, one of weight 1 counting as `units_per_photon`.
    pub fn fixed_point_sink(&self, units_per_photon: f64) -> FixedPointSink<'_, 's> {
        FixedPointSink { receivers: self, units_per_photon, amount: 0 }
    }

    /// Counts of a receiver, row by row from the top left, or face by face.
    pub fn counts(&self, receiver: usize) -> &Counts {
        &self.counts[receiver]
    }

    /// Sets everything to zero, for the next replicate.
    pub fn clear(&mut self) {
        self.counts.iter_mut().for_each(Counts::clear);
    }
}

/// Adds arrivals to a scene's receivers. Every photon counts one, whatever it carries: of coloured ones the luminance is 1.
#[derive(Debug, Clone, Copy)]
pub struct ReceiverSink<'r, 's> {
    receivers: &'r Receivers<'s>,
}

impl<T> Sink<T> for ReceiverSink<'_, '_> {
    #[inline]
    fn arrive(&mut self, arrival: &Arrival<'_, T>) {
        let all = self.receivers;
        all.routes.each_cell(arrival, |receiver, cell| all.counts[receiver].add(cell));
    }
}

/// Adds arrivals of photons that start with a weight to a scene's receivers, in units of a fixed fraction of a photon:
/// integers, so that sums do not depend on the order.
#[derive(Debug, Clone, Copy)]
pub struct FixedPointSink<'r, 's> {
    receivers: &'r Receivers<'s>,
    units_per_photon: f64,
    amount: u64,
}

impl<T> Sink<T> for FixedPointSink<'_, '_> {
    #[inline]
    fn arrive(&mut self, arrival: &Arrival<'_, T>) {
        let all = self.receivers;
        all.routes.each_cell(arrival, |receiver, cell| all.counts[receiver].add_amount(cell, self.amount));
    }

    #[inline]
    fn start(&mut self, weight: f64) {
        self.amount = (weight * self.units_per_photon + 0.5) as u64;
    }
}
