//! What is gathered for a pixel, and what was gathered before at places of the same pixel.

use crate::geometry::Hit;
use crate::surface::luminance_of;

use super::surfaces::Room;

/// What is gathered for one pixel: sums over its samples. `C` channels: 1 or 3.
#[derive(Debug, Clone, PartialEq)]
pub struct Gathered<const C: usize> {
    /// Luminance by channel, cd/m2.
    pub value: [f64; C],
    /// Luminance at the second bandwidth, from which the bias is told, by channel, cd/m2.
    pub second: [f64; C],
    /// Luminance (Y) that each replicate's photons make; they add up to that of `value`.
    pub by_replicate: Vec<f64>,
    /// Standard error (Y) owed to places with fewer than ten photons, whose spread says nothing: that of
    /// (photons + 1).
    pub sparse: f64,
    /// Upper bound on the k-NN bias in Y: (k - 1) / (pi r^2) is unbiased only for independent photons; for
    /// QMC points the factor lies between k - 1 and k - 1/2.
    pub nearest_bias: f64,
    /// Room for the gather in hand.
    pub(crate) room: Room,
    /// Radius of the last gather, m.
    pub(crate) reach_m: f64,
    /// How far the last ones were sought, m: where the next search begins; what it finds does not depend on
    /// it.
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

    /// Adds what was found for a weight of 1, times `weight`. The parts of the replicates are those of the
    /// luminance found.
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

/// How far, in radii, a place may be from one where light was gathered evenly to take the same: its kernels
/// are the same but for a eighth of their radius.
const SAME_PLACE: f64 = 1.0 / 8.0;

/// Places of one pixel that are remembered of each density.
const MOST_PLACES: usize = 32;

/// Places where light was gathered evenly, with what was found there. Those in use come first; the others are
/// kept for their room.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Places<const C: usize> {
    all: Vec<Place<C>>,
    used: usize,
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::SurfaceId;

    fn hit(x: f64) -> Hit {
        Hit {
            t: 1.0,
            t_bound: 0.0,
            position: DVec3::new(x, 0.0, 0.0),
            surface: SurfaceId(3),
            primitive: 0,
            face: 0,
            normal: DVec3::Z,
            shading_normal: DVec3::Z,
            front: true,
            body: crate::geometry::Body::Open,
            touch: None,
        }
    }

    #[test]
    fn weights_scale_value_and_doubts_alike() {
        let mut found = Gathered::<3>::new(2);
        found.value = [1.0, 2.0, 4.0];
        found.second = [2.0, 2.0, 2.0];
        found.by_replicate = vec![0.5, 1.5];
        (found.sparse, found.nearest_bias) = (0.25, 0.125);
        let mut sums = Gathered::<3>::new(2);
        sums.value = [10.0; 3];
        let weight = [0.5, 1.0, 0.0];
        sums.add_weighted(&found, weight);
        sums.add_weighted(&found, [0.0; 3]);
        assert_eq!(sums.value, [10.5, 12.0, 10.0]);
        assert_eq!(sums.second, [1.0, 2.0, 0.0]);
        // Of the luminance found this part is left, in every replicate and of the bias.
        let part = luminance_of(&[0.5, 2.0, 0.0]) / luminance_of(&found.value);
        assert_eq!(sums.by_replicate, [0.5 * part, 1.5 * part]);
        assert_eq!(sums.nearest_bias, 0.125 * part);
        assert_eq!(sums.sparse, 0.25 * luminance_of(&weight));
        // Nothing found: what is owed stays, and nothing is divided by 0.
        let dark = Gathered { sparse: 2.0, ..Gathered::<3>::new(2) };
        sums.add_weighted(&dark, [1.0; 3]);
        assert!(sums.by_replicate.iter().all(|y| y.is_finite()));
        assert!((sums.sparse - 0.25 * luminance_of(&weight) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn a_place_serves_what_is_near_on_the_same_side_for_the_same_density() {
        let mut places = Places::<1>::default();
        assert!(places.near(7, &hit(0.0)).is_none());
        let found = places.remember(7, &hit(0.0), 4).unwrap();
        (found.reach_m, found.value) = (0.8, [5.0]);
        // An eighth of the radius, the border included.
        assert_eq!(places.near(7, &hit(0.1)).unwrap().value, [5.0]);
        assert!(places.near(7, &hit(0.1 + 1e-12)).is_none() && places.near(7, &hit(-0.2)).is_none());
        assert!(places.near(8, &hit(0.0)).is_none());
        for other in [
            Hit { front: false, ..hit(0.0) },
            Hit { surface: SurfaceId(2), ..hit(0.0) },
            Hit { normal: DVec3::NEG_Z, ..hit(0.0) },
        ] {
            assert!(places.near(7, &other).is_none(), "{other:?}");
        }
    }

    #[test]
    fn thirty_two_places_of_each_density_are_remembered_until_cleared() {
        let mut sums = Gathered::<1>::new(1);
        for i in 0..32 {
            for density in [1, 2] {
                let found = sums.places.remember(density, &hit(f64::from(i)), 1).unwrap();
                (found.reach_m, found.value) = (1.0, [f64::from(i + 1)]);
            }
        }
        assert!(sums.places.remember(1, &hit(99.0), 1).is_none());
        assert!(sums.places.remember(3, &hit(99.0), 1).is_some());
        assert_eq!(sums.places.near(2, &hit(31.0)).unwrap().value, [32.0]);
        (sums.value, sums.second, sums.by_replicate[0]) = ([1.0], [1.0], 1.0);
        (sums.sparse, sums.nearest_bias) = (1.0, 1.0);
        sums.clear();
        assert_eq!((sums.value, sums.second, sums.by_replicate[0]), ([0.0], [0.0], 0.0));
        assert_eq!((sums.sparse, sums.nearest_bias), (0.0, 0.0));
        assert!(sums.places.near(1, &hit(0.0)).is_none());
        // Room is used again, but nothing that was in it.
        assert_eq!(sums.places.remember(1, &hit(0.0), 1).unwrap().value, [0.0]);
        assert!(sums.places.near(1, &hit(1.0)).is_none());
    }
}
