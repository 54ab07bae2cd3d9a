//! Keeping photons: what the walk's arrivals leave for the camera.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::geometry::Geometry;
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

/// Most photons of a block. A full one is large enough for allocators to map it by itself, so that its memory is the system's again
/// when it is dropped; many small ones would stay with the process beside the map that they were copied into.
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
        Self {
            frame: frame_of(&scene.geometry),
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

    /// Bounds the number of photons it takes from here on until [`Self::take`], give or take two blocks a thread.
    pub fn limit(&mut self, most: usize) {
        self.most = most;
    }

    /// Takes all photons out. `None` where there were more than the limit: what it holds is then no fair sample and is
    /// dropped.
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

/// Adds photons to the last block, and to new ones when it is full. A block is as large as all before it, so none is ever copied to
/// grow, and at most half of them is empty.
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

/// The steps in which a scene's photons have their positions.
pub fn frame_of(geometry: &Geometry) -> Frame {
    let (low, high) = geometry.bounds();
    Frame::new(low, high)
}

/// Keeps the photons of one batch that arrive on scattering surfaces, but for those that no event preceded, and adds
/// all arrivals to a scene's receivers.
#[derive(Debug)]
pub struct PhotonSink<'r, 's, const C: usize> {
    receivers: ReceiverSink<'r, 's>,
    store: &'r PhotonStore<C>,
    replicate: u32,
    /// Whether the photon on its way has met a scattering surface. Where a table let it pass unscattered this says so
    /// too: it tells which density a photon belongs to, never whether it counts.
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
