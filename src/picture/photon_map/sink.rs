//! Keeping photons: what the walk's arrivals leave for the camera.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use glam::DVec3;

use crate::geometry::SurfaceId;
use crate::scene::Scene;
use crate::surface::{Grey, Material, Rgb, Throughput};
use crate::transport::{Arrival, Sink};

use crate::picture::photon_map::record::{FRONT, Frame, Photon, SCATTERED, pack};
use crate::tally::receiver::ReceiverSink;

/// What a photon carries, as the weights of so many channels: their luminance is 1.
pub trait Channels<const C: usize>: Throughput {
    /// The weights.
    fn channels(&self) -> [f64; C];
}

impl Channels<1> for Grey {
    #[inline(always)]
    fn channels(&self) -> [f64; 1] {
        [1.0]
    }
}

impl Channels<3> for Rgb {
    #[inline(always)]
    fn channels(&self) -> [f64; 3] {
        self.weight()
    }
}

/// Which surfaces of a scene scatter: those where photons are kept, and where the eye's path ends.
pub fn scattering_surfaces(scene: &Scene) -> Vec<bool> {
    scene.materials().iter().map(Material::scatters).collect()
}

/// Photons that a handle collects before it gives them to the store.
const HANDFUL: usize = 1 << 8;

/// Most photons of a block. A full one is large enough for allocators to map it by itself, so that its memory
/// is the system's again when it is dropped; many small ones would stay with the process beside the map that
/// they were copied into.
const BLOCK: usize = 1 << 21;

/// Photons kept, in blocks; any number of threads add to it, and the order of the blocks means nothing.
#[derive(Debug)]
pub struct PhotonStore<const C: usize> {
    frame: Frame,
    scatters: Vec<bool>,
    /// Not scattered before, and scattered before.
    blocks: [Mutex<Vec<Vec<Photon<C>>>>; 2],
    kept: AtomicUsize,
    most: usize,
    overflowed: AtomicBool,
}

/// Photons taken out of a store: those that were not scattered before (light of L S+ D), and those that were.
pub type Kept<const C: usize> = [Vec<Vec<Photon<C>>>; 2];

impl<const C: usize> PhotonStore<C> {
    /// An empty store for a scene.
    pub fn new(scene: &Scene) -> Self {
        let (low, high) = scene.geometry.bounds();
        Self {
            frame: Frame::new(low, high),
            scatters: scattering_surfaces(scene),
            blocks: Default::default(),
            kept: AtomicUsize::new(0),
            most: usize::MAX,
            overflowed: AtomicBool::new(false),
        }
    }

    /// In which steps it holds positions.
    pub fn frame(&self) -> Frame {
        self.frame
    }

    /// Bounds the number of photons it takes from here on until [`Self::take`], give or take two blocks a
    /// thread.
    pub fn limit(&mut self, most: usize) {
        self.most = most;
    }

    /// Takes all photons out. `None` where there were more than the limit: what it holds is then no fair
    /// sample and is dropped.
    pub fn take(&mut self) -> Option<Kept<C>> {
        let all = [0, 1].map(|k| {
            let blocks = self.blocks[k].get_mut().unwrap_or_else(PoisonError::into_inner);
            if let Some(last) = blocks.last_mut() {
                last.shrink_to_fit();
            }
            std::mem::take(blocks)
        });
        *self.kept.get_mut() = 0;
        (!std::mem::take(self.overflowed.get_mut())).then_some(all)
    }

    /// A handle for one batch of photons of a replicate, which counts them on receivers as well.
    pub fn sink<'r, 's>(&'r self, receivers: ReceiverSink<'r, 's>, replicate: u32) -> PhotonSink<'r, 's, C> {
        let kept = Default::default();
        PhotonSink { receivers, store: self, replicate: replicate & 0xffff, scattered: false, kept }
    }

    fn put(&self, scattered: usize, photons: &[Photon<C>]) {
        if self.kept.fetch_add(photons.len(), Ordering::Relaxed) + photons.len() > self.most {
            self.overflowed.store(true, Ordering::Relaxed);
        }
        // Once too many, all are dropped: the range is traced again in parts.
        if !self.overflowed.load(Ordering::Relaxed) {
            add(&mut self.blocks[scattered].lock().unwrap_or_else(PoisonError::into_inner), photons);
        }
    }
}

/// Adds photons to the last block, and to new ones when it is full. A block is as large as all before it, so
/// none is ever copied to grow, and at most half of them is empty.
fn add<const C: usize>(blocks: &mut Vec<Vec<Photon<C>>>, mut photons: &[Photon<C>]) {
    while !photons.is_empty() {
        let room = blocks.last().map_or(0, |block| block.capacity() - block.len());
        if room == 0 {
            let held: usize = blocks.iter().map(Vec::len).sum();
            blocks.push(Vec::with_capacity(held.clamp(HANDFUL, BLOCK)));
            continue;
        }
        let (now, later) = photons.split_at(room.min(photons.len()));
        if let Some(block) = blocks.last_mut() {
            block.extend_from_slice(now);
        }
        photons = later;
    }
}

/// Keeps the photons of one batch that arrive on scattering surfaces, but for those that no event preceded,
/// and adds all arrivals to a scene's receivers.
#[derive(Debug)]
pub struct PhotonSink<'r, 's, const C: usize> {
    receivers: ReceiverSink<'r, 's>,
    store: &'r PhotonStore<C>,
    replicate: u32,
    /// Whether the photon on its way has met a scattering surface. Where a table let it pass unscattered this
    /// says so too: it tells which density a photon belongs to, never whether it counts.
    scattered: bool,
    kept: [Vec<Photon<C>>; 2],
}

impl<T: Channels<C>, const C: usize> Sink<T> for PhotonSink<'_, '_, C> {
    #[inline]
    fn arrive(&mut self, arrival: &Arrival<'_, T>) {
        self.receivers.arrive(arrival);
        if arrival.events == 0 {
            self.scattered = false;
        }
        let hit = arrival.hit;
        if !self.store.scatters[hit.surface.0 as usize] {
            return;
        }
        if arrival.events > 0 {
            self.keep(Photon {
                cell: self.store.frame.cell(hit.position),
                direction: pack(arrival.direction),
                primitive: hit.primitive,
                tag: self.replicate
                    | if hit.front { FRONT } else { 0 }
                    | if self.scattered { SCATTERED } else { 0 },
                weight: arrival.carried.channels().map(|w| w as f32),
            });
        }
        self.scattered = true;
    }

    #[inline]
    fn emerge(&mut self, surface: SurfaceId, direction: DVec3) {
        <ReceiverSink<'_, '_> as Sink<T>>::emerge(&mut self.receivers, surface, direction);
    }

    #[inline]
    fn escape(&mut self, direction: DVec3) {
        <ReceiverSink<'_, '_> as Sink<T>>::escape(&mut self.receivers, direction);
    }
}

impl<const C: usize> PhotonSink<'_, '_, C> {
    #[inline]
    fn keep(&mut self, photon: Photon<C>) {
        let scattered = usize::from(photon.is_scattered());
        let some = &mut self.kept[scattered];
        some.push(photon);
        if some.len() == HANDFUL {
            self.store.put(scattered, some);
            some.clear();
        }
    }
}

impl<const C: usize> Drop for PhotonSink<'_, '_, C> {
    fn drop(&mut self) {
        for (scattered, some) in self.kept.iter().enumerate() {
            self.store.put(scattered, some);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Rectangle, Shape, Surface, Whereabouts};
    use crate::tally::Receivers;

    /// Sheets at z = 0, which scatters, and z = 1, which does not.
    fn sheets() -> Geometry {
        let sheet = |z: f64| {
            let shape = Shape::Rectangle(Rectangle::new(DVec3::Z * z, DVec3::X, DVec3::Y).unwrap());
            Surface { name: format!("at {z}"), shape }
        };
        Geometry::build(vec![sheet(0.0), sheet(1.0)]).unwrap()
    }

    fn frame_of(geometry: &Geometry) -> Frame {
        let (low, high) = geometry.bounds();
        Frame::new(low, high)
    }

    fn store(geometry: &Geometry) -> PhotonStore<1> {
        PhotonStore {
            frame: frame_of(geometry),
            scatters: vec![true, false],
            blocks: Default::default(),
            kept: AtomicUsize::new(0),
            most: usize::MAX,
            overflowed: AtomicBool::new(false),
        }
    }

    /// An arrival from above or below a sheet.
    fn arrive(geometry: &Geometry, sink: &mut PhotonSink<'_, '_, 1>, from_z: f64, events: u32) {
        let direction = if from_z > 0.0 { DVec3::NEG_Z } else { DVec3::Z };
        let whereabouts = Whereabouts::default();
        let hit = geometry.nearest(DVec3::new(0.3, 0.4, from_z), direction, &whereabouts, &mut 0).unwrap();
        sink.arrive(&Arrival { hit: &hit, direction, events, carried: &Grey, whereabouts: &whereabouts });
    }

    #[test]
    fn kept_is_what_scatters_and_is_not_direct_by_what_happened_before() {
        let geometry = sheets();
        let mut store = store(&geometry);
        let nobody = Receivers::new(&geometry, &[]);
        let mut sink = store.sink(nobody.sink(), 5);
        // Photon 1: direct on the floor, then off the sheet above, and on the floor from below.
        arrive(&geometry, &mut sink, 0.5, 0);
        arrive(&geometry, &mut sink, 1.5, 1);
        arrive(&geometry, &mut sink, -0.5, 2);
        // Photon 2: off the sheet above and on the floor for the first time, then again.
        arrive(&geometry, &mut sink, 1.5, 0);
        arrive(&geometry, &mut sink, 0.5, 1);
        arrive(&geometry, &mut sink, 0.5, 2);
        drop(sink);
        let [caustic, diffuse] = store.take().unwrap().map(|blocks| blocks.concat());
        assert_eq!(caustic.iter().map(|p| p.tag).collect::<Vec<_>>(), [5 | FRONT]);
        assert_eq!(diffuse.iter().map(|p| p.tag).collect::<Vec<_>>(), [5 | SCATTERED, 5 | FRONT | SCATTERED]);
        let photon = caustic[0];
        assert!((store.frame().position(photon.cell) - DVec3::new(0.3, 0.4, 0.0)).length() < 1e-9);
        assert!((photon.direction() - DVec3::NEG_Z).length() < 1e-4 && photon.weight == [1.0]);
        assert_eq!(store.take().unwrap().map(|blocks| blocks.len()), [0, 0]);
    }

    #[test]
    fn photons_beyond_the_limit_leave_nothing_and_the_next_range_starts_afresh() {
        let geometry = sheets();
        let mut store = store(&geometry);
        let nobody = Receivers::new(&geometry, &[]);
        let fill = |store: &PhotonStore<1>, n: usize| {
            let mut sink = store.sink(nobody.sink(), 0);
            (0..n).for_each(|_| arrive(&geometry, &mut sink, 0.5, 1));
        };
        let number = |kept: Kept<1>| kept.iter().flatten().map(Vec::len).sum::<usize>();
        store.limit(1000);
        fill(&store, 600);
        fill(&store, 400);
        assert_eq!(store.take().map(number), Some(1000));
        fill(&store, 600);
        fill(&store, 401);
        assert_eq!(store.take().map(number), None);
        fill(&store, 1000);
        assert_eq!(store.take().map(number), Some(1000));
    }

    #[test]
    fn blocks_double_and_lose_nothing() {
        let geometry = sheets();
        let photon = |tag: u32| {
            let cell = frame_of(&geometry).cell(DVec3::ZERO);
            Photon::<1> { cell, direction: 0, primitive: 0, tag, weight: [1.0] }
        };
        let mut blocks = Vec::new();
        let all: Vec<Photon<1>> = (0..5000).map(photon).collect();
        all.chunks(700).for_each(|some| add(&mut blocks, some));
        assert!(blocks.concat() == all);
        assert_eq!(blocks[0].capacity(), HANDFUL);
        assert!(blocks.windows(2).all(|two| two[0].len() == two[0].capacity()));
        assert!(blocks.len() < 8, "{}", blocks.len());
    }
}
