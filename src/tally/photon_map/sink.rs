//! Keeping photons: what the walk's arrivals leave for the camera.

use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use crate::bsdf::{Bsdf, Grey, Rgb, Throughput};
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::transport::{Arrival, Sink};

use super::record::{FRONT, Frame, Photon, SCATTERED, pack};
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
    scene.bsdfs().iter().map(Bsdf::scatters).collect()
}

/// Photons of one block: a handle gives them to the store together, so that what it holds is never copied to grow.
const BLOCK: usize = 1 << 8;

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

    /// Photons in it.
    pub fn len(&self) -> usize {
        self.kept.load(Ordering::Relaxed)
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Takes all photons out. `None` where there were more than the limit: what it holds is then no fair sample and is
    /// dropped.
    pub fn take(&mut self) -> Option<Kept<C>> {
        let all =
            [0, 1].map(|k| std::mem::take(self.blocks[k].get_mut().unwrap_or_else(PoisonError::into_inner)));
        *self.kept.get_mut() = 0;
        (!std::mem::take(self.overflowed.get_mut())).then_some(all)
    }

    /// A handle for one batch of photons of a replicate, which counts them on receivers as well.
    pub fn sink<'r, 's>(&'r self, receivers: ReceiverSink<'r, 's>, replicate: u32) -> PhotonSink<'r, 's, C> {
        let kept = Default::default();
        PhotonSink { receivers, store: self, replicate: replicate & 0xffff, scattered: false, kept }
    }

    fn put(&self, scattered: usize, block: Vec<Photon<C>>) {
        if block.is_empty() {
            return;
        }
        if self.kept.fetch_add(block.len(), Ordering::Relaxed) + block.len() > self.most {
            self.overflowed.store(true, Ordering::Relaxed);
        }
        // Once too many, all are dropped: the range is traced again in parts.
        if !self.overflowed.load(Ordering::Relaxed) {
            self.blocks[scattered].lock().unwrap_or_else(PoisonError::into_inner).push(block);
        }
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
        let block = &mut self.kept[scattered];
        block.push(photon);
        if block.len() == BLOCK {
            let full = std::mem::replace(block, Vec::with_capacity(BLOCK));
            self.store.put(scattered, full);
        }
    }
}

impl<const C: usize> Drop for PhotonSink<'_, '_, C> {
    fn drop(&mut self) {
        for (scattered, block) in std::mem::take(&mut self.kept).into_iter().enumerate() {
            let mut block = block;
            block.shrink_to_fit();
            self.store.put(scattered, block);
        }
    }
}
