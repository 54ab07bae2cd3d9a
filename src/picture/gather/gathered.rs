//! What is gathered for a pixel, and what was gathered before at places of the same pixel.

use crate::geometry::Hit;
use crate::surface::luminance_of;

use super::surfaces::Room;

/// What is gathered for one pixel: sums over its samples. `C` channels: 1 or 3.
#[derive(Debug, Clone, PartialEq)]
pub struct Gathered<const C: usize> {
    /// Luminance by channel, cd/m2.
    pub value: [f64; C],
    /// The same at the second bandwidth, from which the bias is told.
    pub second: [f64; C],
    /// Luminance (Y) that each replicate's photons make; they add up to that of `value`.
    pub by_replicate: Vec<f64>,
    /// Standard error (Y) owed to places with fewer than ten photons, whose spread says nothing: that of (photons + 1).
    pub sparse: f64,
    /// Upper bound on the k-NN bias in Y: (k - 1) / (pi r^2) is unbiased only for independent photons; for QMC points the
    /// factor lies between k - 1 and k - 1/2.
    pub nearest_bias: f64,
    /// Room for the gather in hand.
    pub(crate) room: Room,
    /// Radius of the last gather, m.
    pub(crate) reach_m: f64,
    /// How far the last ones were sought, m: where the next search begins; what it finds does not depend on it.
    pub(crate) sought_m: f64,
    /// What was gathered evenly since the last [`Self::clear`].
    pub(crate) places: Places<C>,
}

impl<const C: usize> Gathered<C> {
    /// Nothing, of this many replicates.
    pub fn new(replicates: usize) -> Self {
        Self {
            value: [0.0; C],
            second: [0.0; C],
            by_replicate: vec![0.0; replicates],
            sparse: 0.0,
            nearest_bias: 0.0,
            room: Room::default(),
            reach_m: 0.0,
            sought_m: 0.0,
            places: Places::default(),
        }
    }

    /// Nothing again.
    pub fn clear(&mut self) {
        self.value = [0.0; C];
        self.second = [0.0; C];
        self.by_replicate.fill(0.0);
        self.sparse = 0.0;
        self.nearest_bias = 0.0;
        self.places.used = 0;
    }

    /// Adds what was found for a weight of 1, times `weight`. The parts of the replicates are those of the luminance found.
    pub(crate) fn add_weighted(&mut self, found: &Self, weight: [f64; C]) {
        let weighted: [f64; C] = std::array::from_fn(|c| weight[c] * found.value[c]);
        let y = luminance_of(&found.value);
        let of_luminance = if y > 0.0 { luminance_of(&weighted) / y } else { 0.0 };
        for c in 0..C {
            self.value[c] += weighted[c];
            self.second[c] += weight[c] * found.second[c];
        }
        for (sum, part) in self.by_replicate.iter_mut().zip(&found.by_replicate) {
            *sum += of_luminance * part;
        }
        self.sparse += luminance_of(&weight).abs() * found.sparse;
        self.nearest_bias += of_luminance * found.nearest_bias;
    }
}

/// How far, in radii, a place may be from one where light was gathered evenly to take the same: its kernels are the same but for a
/// eighth of their radius.
const SAME_PLACE: f64 = 1.0 / 8.0;

/// Places of one pixel that are remembered of each density.
const MOST_PLACES: usize = 32;

/// Places where light was gathered evenly, with what was found there. Those in use come first; the others are kept for their room.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Places<const C: usize> {
    all: Vec<Place<C>>,
    used: usize,
}

impl<const C: usize> Default for Places<C> {
    fn default() -> Self {
        Self { all: Vec::new(), used: 0 }
    }
}

/// A place and what was found there for a weight of 1.
#[derive(Debug, Clone, PartialEq)]
struct Place<const C: usize> {
    density: usize,
    at: Hit,
    found: Gathered<C>,
}

impl<const C: usize> Places<C> {
    /// What a density found at a place near enough to this.
    pub fn near(&self, density: usize, at: &Hit) -> Option<&Gathered<C>> {
        let same = |place: &&Place<C>| {
            let there = &place.at;
            place.density == density
                && (there.surface, there.front) == (at.surface, at.front)
                && there.normal == at.normal
                && there.position.distance(at.position) <= SAME_PLACE * place.found.reach_m
        };
        self.all[..self.used].iter().find(same).map(|place| &place.found)
    }

    /// Room for what a density finds at this place, cleared; `None` where enough are remembered.
    pub fn remember(&mut self, density: usize, at: &Hit, replicates: usize) -> Option<&mut Gathered<C>> {
        let used = &self.all[..self.used];
        if used.iter().filter(|place| place.density == density).count() == MOST_PLACES {
            return None;
        }
        if self.all.len() == self.used {
            self.all.push(Place { density, at: *at, found: Gathered::new(replicates) });
        }
        let place = &mut self.all[self.used];
        self.used += 1;
        (place.density, place.at) = (density, *at);
        place.found.clear();
        Some(&mut place.found)
    }
}
