//! Receivers: arrivals on a surface, sorted into cells.
//!
//! A receiver counts flux arriving before the event, whatever the material, on the sides and of the history
//! it asks for. A rectangle, sphere or paraboloid has cells in its (u, v); the pixel of row 0, column 0 is
//! the (u = 0, v = 1) corner. A mesh has a cell a face.

use std::io::{self, Read, Write};

use glam::DVec3;

use crate::geometry::{Geometry, Hit, SurfaceId};
use crate::scene::Scene;
use crate::scene::far_field::FarField;
use crate::scene::receiver::{Cells, Receiver, ReceiverEvents, ReceiverSide};
use crate::transport::{Arrival, Sink};

use super::counts::Counts;
use super::far_field::FarFields;
use super::spot::SpotTally;

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
    /// Of the receivers that have an evaluation grid, its cells.
    grids: Vec<Option<Counts>>,
    /// Of those whose spot is measured, its sums.
    spots: Vec<Option<SpotTally>>,
    far_fields: FarFields<'s>,
    /// Arrivals on the side of each receiver on which it does not count.
    turned_away: Counts,
    /// Arrivals on the side of each receiver on which it counts, of a history that it does not count.
    other_events: Counts,
}

/// Why an arrival on a receiver's surface does not count.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Refused {
    Side,
    Events,
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
    pub(super) fn each_cell<T>(
        &self,
        arrival: &Arrival<'_, T>,
        mut add: impl FnMut(usize, usize),
        mut turn_away: impl FnMut(usize, Refused),
    ) {
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
            if !side {
                turn_away(i as usize, Refused::Side);
            } else if !history {
                turn_away(i as usize, Refused::Events);
            } else if let Some(cell) = self.cell(receiver, arrival.hit) {
                add(i as usize, cell);
            }
        }
    }

    /// The cell of a receiver's evaluation grid.
    fn grid_cell(&self, receiver: usize, hit: &Hit) -> Option<usize> {
        self.receivers[receiver].grid?.cell(self.uv(hit)?)
    }

    fn uv(&self, hit: &Hit) -> Option<(f64, f64)> {
        self.geometry.surfaces()[hit.surface.0 as usize].shape.uv(hit.position)
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
        Self::with_far_fields(geometry, receivers, &[], 0)
    }

    /// Those of a scene and of its far fields, for a replicate of this many photons.
    pub fn of_scene(scene: &'s Scene, photons: u64) -> Self {
        Self::with_far_fields(&scene.geometry, &scene.receivers, &scene.far_fields, photons)
    }

    fn with_far_fields(
        geometry: &'s Geometry,
        receivers: &'s [Receiver],
        far_fields: &'s [FarField],
        photons: u64,
    ) -> Self {
        let counts = receivers.iter().map(|r| Counts::new(r.cells.len())).collect();
        let grids = receivers.iter().map(|r| r.grid.map(|grid| Counts::new(grid.cells()))).collect();
        let spots = receivers.iter().map(|r| r.spot.map(SpotTally::new)).collect();
        let [turned_away, other_events] = [0; 2].map(|_| Counts::new(receivers.len()));
        let (routes, far_fields) = (Routes::new(geometry, receivers), FarFields::new(far_fields, photons));
        Self { routes, counts, grids, spots, far_fields, turned_away, other_events }
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

    /// Photons on each receiver.
    pub fn totals(&self) -> Vec<u64> {
        self.counts.iter().map(Counts::total).collect()
    }

    /// Counts of a receiver's evaluation grid, row by row from the top left.
    pub fn grid(&self, receiver: usize) -> Option<&Counts> {
        self.grids[receiver].as_ref()
    }

    /// The sums of a receiver's spot, where it is measured.
    pub fn spot(&self, receiver: usize) -> Option<&SpotTally> {
        self.spots[receiver].as_ref()
    }

    /// The sums of the scene's far fields.
    pub fn far_fields(&self) -> &FarFields<'s> {
        &self.far_fields
    }

    /// Arrivals on the side of each receiver on which it does not count.
    pub fn turned_away(&self) -> &Counts {
        &self.turned_away
    }

    /// Arrivals on the side of each receiver on which it counts, of a history that it does not count.
    pub fn other_events(&self) -> &Counts {
        &self.other_events
    }

    /// All counters but those of spots, in a fixed order.
    fn all_counts(&self) -> impl Iterator<Item = &Counts> {
        let of_receivers = self.counts.iter().chain(self.grids.iter().flatten());
        of_receivers.chain(self.far_fields.counts()).chain([&self.turned_away, &self.other_events])
    }

    /// Writes everything that was counted.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        self.all_counts().try_for_each(|counts| counts.write(out))?;
        self.spots.iter().flatten().try_for_each(|spot| spot.write(out))
    }

    /// Adds what was written, of the same receivers.
    ///
    /// # Errors
    /// Those of the reader; counters of other receivers.
    pub fn add_from(&self, from: &mut dyn Read) -> io::Result<()> {
        self.all_counts().try_for_each(|counts| counts.add_from(from))?;
        self.spots.iter().flatten().try_for_each(|spot| spot.add_from(from))
    }

    /// Sets everything to zero, for the next replicate.
    pub fn clear(&mut self) {
        self.turned_away.clear();
        self.other_events.clear();
        self.far_fields.clear();
        self.counts.iter_mut().chain(self.grids.iter_mut().flatten()).for_each(Counts::clear);
        self.spots.iter_mut().flatten().for_each(SpotTally::clear);
    }
}

/// Adds arrivals to a scene's receivers. Every photon counts one, whatever it carries: of coloured ones the
/// luminance is 1.
#[derive(Debug, Clone, Copy)]
pub struct ReceiverSink<'r, 's> {
    receivers: &'r Receivers<'s>,
}

impl<T> Sink<T> for ReceiverSink<'_, '_> {
    #[inline]
    fn arrive(&mut self, arrival: &Arrival<'_, T>) {
        let all = self.receivers;
        all.routes.each_cell(
            arrival,
            |receiver, cell| {
                all.counts[receiver].add(cell, 1);
                if let Some(grid) = &all.grids[receiver]
                    && let Some(cell) = all.routes.grid_cell(receiver, arrival.hit)
                {
                    grid.add(cell, 1);
                }
                if let Some(spot) = &all.spots[receiver]
                    && let Some(uv) = all.routes.uv(arrival.hit)
                {
                    spot.add(uv);
                }
            },
            |receiver, why| match why {
                Refused::Side => all.turned_away.add(receiver, 1),
                Refused::Events => all.other_events.add(receiver, 1),
            },
        );
    }

    #[inline]
    fn emerge(&mut self, surface: SurfaceId, direction: DVec3) {
        self.receivers.far_fields.emerge(surface, direction);
    }

    #[inline]
    fn escape(&mut self, direction: DVec3) {
        self.receivers.far_fields.escape(direction);
    }
}

/// Adds arrivals of photons that start with a weight to a scene's receivers, in units of a fixed fraction of
/// a photon: integers, so that sums do not depend on the order.
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
        let add = |receiver: usize, cell| all.counts[receiver].add(cell, self.amount);
        all.routes.each_cell(arrival, add, |_, _| {});
    }

    #[inline]
    fn start(&mut self, weight: f64) {
        self.amount = (weight * self.units_per_photon + 0.5) as u64;
    }
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::geometry::{Rectangle, Shape, Surface, Whereabouts, box_mesh};
    use crate::scene::receiver::ReceiverSpec;
    use crate::surface::Grey;

    pub const BOTH: (ReceiverSide, ReceiverEvents) = (ReceiverSide::Both, ReceiverEvents::All);

    /// The unit square at z = 0, its front up, and a box from z = 1 to 2 above it.
    pub fn square_and_box() -> Geometry {
        let square = Shape::Rectangle(Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap());
        let block = Shape::Mesh(box_mesh(DVec3::Z, DVec3::new(1.0, 1.0, 2.0)).unwrap());
        let named = |name: &str, shape| Surface { name: name.into(), shape };
        Geometry::build(vec![named("square", square), named("box", block)]).unwrap()
    }

    pub fn receiver(
        geometry: &Geometry,
        surface: &str,
        cells: Option<[u32; 2]>,
        (side, events): (ReceiverSide, ReceiverEvents),
    ) -> Receiver {
        let mut spec = ReceiverSpec::new("r", surface).unwrap().on_side(side).of_events(events);
        if let Some(cells) = cells {
            spec = spec.with_cells(cells).unwrap();
        }
        Receiver::new(&spec, geometry).unwrap()
    }

    /// Sends a photon straight down (or, from below, up) to the surface next to a point.
    pub fn send<T>(
        geometry: &Geometry,
        sink: &mut impl Sink<T>,
        carried: &T,
        (x, y, z): (f64, f64, f64),
        events: u32,
    ) {
        let whereabouts = Whereabouts::default();
        let direction = if z < 0.0 { DVec3::Z } else { DVec3::NEG_Z };
        let hit = geometry.nearest(DVec3::new(x, y, z), direction, &whereabouts, &mut 0).unwrap();
        sink.arrive(&Arrival { hit: &hit, direction, events, carried, whereabouts: &whereabouts });
    }

    fn counts(receivers: &Receivers<'_>, receiver: usize) -> Vec<u64> {
        receivers.counts(receiver).iter().collect()
    }

    #[test]
    fn cells_run_by_rows_from_the_top_left() {
        let geometry = square_and_box();
        let all = [receiver(&geometry, "square", Some([4, 2]), BOTH)];
        let mut receivers = Receivers::new(&geometry, &all);
        for (x, y, cell) in [(0.1, 0.9, 0), (0.3, 0.9, 1), (0.9, 0.6, 3), (0.1, 0.1, 4), (0.6, 0.4, 6)] {
            receivers.clear();
            send(&geometry, &mut receivers.sink(), &Grey, (x, y, 0.5), 0);
            let expected: Vec<u64> = (0..8).map(|i| u64::from(i == cell)).collect();
            assert_eq!(counts(&receivers, 0), expected, "{x} {y}");
        }
        // The far borders belong to the last cells.
        let mut hit =
            geometry.nearest(DVec3::splat(0.5), DVec3::NEG_Z, &Whereabouts::default(), &mut 0).unwrap();
        for (x, y, cell) in [(1.0, 0.0, 7), (0.0, 1.0, 0), (1.0, 1.0, 3), (0.0, 0.0, 4), (0.25, 0.5, 1)] {
            hit.position = DVec3::new(x, y, 0.0);
            assert_eq!(receivers.routes.cell(&all[0], &hit), Some(cell), "{x} {y}");
        }
    }

    #[test]
    fn sides_and_histories_count_as_asked() {
        let geometry = square_and_box();
        use ReceiverEvents::{All, Direct, Indirect};
        use ReceiverSide::{Back, Both, Front};
        // Arrivals on the front: 1 direct, 2 later ones; on the back: 4 and 8.
        let asked = [
            (Both, All, 15),
            (Both, Direct, 5),
            (Both, Indirect, 10),
            (Front, All, 3),
            (Front, Direct, 1),
            (Front, Indirect, 2),
            (Back, All, 12),
            (Back, Direct, 4),
            (Back, Indirect, 8),
        ];
        let all = asked.map(|(side, events, _)| receiver(&geometry, "square", Some([1, 1]), (side, events)));
        let receivers = Receivers::new(&geometry, &all);
        let mut sink = receivers.sink();
        for (times, z, events) in [(1, 0.5, 0), (2, 0.5, 1), (4, -0.5, 0), (8, -0.5, 3)] {
            (0..times).for_each(|_| send(&geometry, &mut sink, &Grey, (0.5, 0.5, z), events));
        }
        for (i, asked) in asked.into_iter().enumerate() {
            assert_eq!(counts(&receivers, i), [asked.2], "{asked:?}");
        }
    }

    #[test]
    fn a_mesh_has_a_cell_a_face_and_other_surfaces_do_not_count() {
        let geometry = square_and_box();
        let all = [receiver(&geometry, "box", None, BOTH), receiver(&geometry, "square", Some([1, 1]), BOTH)];
        let receivers = Receivers::new(&geometry, &all);
        let mut sink = receivers.sink();
        // Faces -x, +x, -y, +y, -z, +z, two triangles each.
        for (x, y) in [(0.2, 0.7), (0.3, 0.9), (0.8, 0.1)] {
            send(&geometry, &mut sink, &Grey, (x, y, 3.0), 1);
        }
        send(&geometry, &mut sink, &Grey, (0.5, 0.4, 0.5), 1);
        assert_eq!(counts(&receivers, 0), [0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 2]);
        assert_eq!(counts(&receivers, 1), [1]);
    }

    #[test]
    fn fixed_point_weights_are_rounded_to_the_nearest_unit() {
        let geometry = square_and_box();
        let all = [receiver(&geometry, "square", Some([2, 1]), BOTH)];
        let receivers = Receivers::new(&geometry, &all);
        let mut sink = receivers.fixed_point_sink(8.0);
        for (weight, x) in [(0.3, 0.2), (0.32, 0.2), (2.0, 0.7), (0.05, 0.7)] {
            Sink::<Grey>::start(&mut sink, weight);
            send(&geometry, &mut sink, &Grey, (x, 0.5, 0.5), 0);
        }
        assert_eq!(counts(&receivers, 0), [2 + 3, 16]);
    }
}
