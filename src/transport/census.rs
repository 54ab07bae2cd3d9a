//! What a batch of photons did beside hitting receivers: coordinates used, exceptions made.

use std::collections::BTreeMap;

use crate::geometry::SurfaceId;
use crate::sample::coordinates::Purpose;

/// Longest constructive dimension with a bar of its own in the histogram; longer ones share the last.
pub const LONGEST_DIMENSION: usize = 64;

/// Things that geometry and smooth normals make necessary now and then, counted so that they are never hidden.
#[derive(Debug, Clone, PartialEq, Eq, Default, serde::Serialize)]
pub struct Exceptions {
    /// Candidate hits that were the crossing just made, seen again through rounding.
    pub skipped_crossings: u64,
    /// Directions mirrored back to their side of the facet, and arrivals behind the smooth normal (METHOD 1), by surface.
    #[serde(serialize_with = "in_all")]
    pub corrected_directions: BTreeMap<SurfaceId, u64>,
    /// Photons that a scattering table sent below the horizon, absorbed there (METHOD 4).
    pub below_horizon: u64,
    /// Arrivals at transparent surfaces in another medium than the scene says is there.
    #[serde(skip)]
    pub contradicted: BTreeMap<SurfaceId, u64>,
    /// Photons that met no further surface while they were inside these bodies.
    #[serde(skip)]
    pub lost: BTreeMap<SurfaceId, u64>,
    /// Arrivals after which photons went on, but for total reflections.
    #[serde(skip)]
    pub events: u64,
    /// Surfaces that photons met, a bit each; from the 65th on they share those of the first.
    #[serde(skip)]
    pub met: u64,
}

impl Exceptions {
    /// A surface is met.
    #[inline]
    pub fn meets(&mut self, surface: SurfaceId) {
        self.met |= 1 << (surface.0 % u64::BITS);
    }

    /// Whether a photon may have met a surface: surely not, where this is false.
    pub fn may_have_met(&self, surface: SurfaceId) -> bool {
        self.met >> (surface.0 % u64::BITS) & 1 == 1
    }
}

/// Counts of surfaces, as the count of all of them.
fn in_all<S: serde::Serializer>(counts: &BTreeMap<SurfaceId, u64>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_u64(counts.values().sum())
}

impl Exceptions {
    /// Corrected directions on all surfaces.
    pub fn corrected(&self) -> u64 {
        self.corrected_directions.values().sum()
    }
}

/// Adds counts by what they are of.
fn add<K: Copy + Ord>(to: &mut BTreeMap<K, u64>, more: &BTreeMap<K, u64>) {
    more.iter().for_each(|(of, count)| *to.entry(*of).or_default() += count);
}

/// Counts over photons; all integers, so merging is exact in any order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Census {
    /// Photons by the number of coordinates they consumed (0 to 64, the last also beyond).
    pub dimension_histogram: Vec<u64>,
    /// Most coordinates one photon consumed.
    pub dimension_max: u32,
    /// Coordinates consumed in all, by purpose in the order of `Purpose::LABELS`.
    pub drawn_for: [u64; Purpose::LABELS.len()],
    /// Exceptions.
    pub exceptions: Exceptions,
    /// Photons that met nothing at all, by emitter.
    pub missed: BTreeMap<usize, u64>,
}

impl Default for Census {
    fn default() -> Self {
        Self {
            dimension_histogram: vec![0; LONGEST_DIMENSION + 1],
            dimension_max: 0,
            drawn_for: [0; Purpose::LABELS.len()],
            exceptions: Exceptions::default(),
            missed: BTreeMap::new(),
        }
    }
}

impl Census {
    /// Counts a photon that consumed `drawn` coordinates.
    #[inline]
    pub fn count(&mut self, drawn: u32, drawn_for: &[u32; Purpose::LABELS.len()]) {
        self.dimension_histogram[(drawn as usize).min(LONGEST_DIMENSION)] += 1;
        self.dimension_max = self.dimension_max.max(drawn);
        for (sum, n) in self.drawn_for.iter_mut().zip(drawn_for) {
            *sum += u64::from(*n);
        }
    }

    /// Counts the coordinates of a point that gave no photon: they are part of what the photons cost.
    #[inline]
    pub fn count_rejected(&mut self, drawn_for: &[u32; Purpose::LABELS.len()]) {
        for (sum, n) in self.drawn_for.iter_mut().zip(drawn_for) {
            *sum += u64::from(*n);
        }
    }

    /// Photons counted.
    pub fn photons(&self) -> u64 {
        self.dimension_histogram.iter().sum()
    }

    /// Mean constructive dimension, coordinates a photon; 0 for no photons.
    pub fn dimension_mean(&self) -> f64 {
        let photons = self.photons();
        if photons == 0 { 0.0 } else { self.drawn_for.iter().sum::<u64>() as f64 / photons as f64 }
    }

    /// Adds another census.
    pub fn merge(&mut self, other: &Self) {
        for (a, b) in self.dimension_histogram.iter_mut().zip(&other.dimension_histogram) {
            *a += b;
        }
        self.dimension_max = self.dimension_max.max(other.dimension_max);
        for (a, b) in self.drawn_for.iter_mut().zip(&other.drawn_for) {
            *a += b;
        }
        self.exceptions.skipped_crossings += other.exceptions.skipped_crossings;
        self.exceptions.below_horizon += other.exceptions.below_horizon;
        add(&mut self.exceptions.corrected_directions, &other.exceptions.corrected_directions);
        add(&mut self.exceptions.contradicted, &other.exceptions.contradicted);
        add(&mut self.exceptions.lost, &other.exceptions.lost);
        self.exceptions.events += other.exceptions.events;
        self.exceptions.met |= other.exceptions.met;
        add(&mut self.missed, &other.missed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn mean_and_maximum_come_from_all_photons_even_beyond_the_histogram() {
        let mut census = Census::default();
        census.count(3, &[1, 0, 1, 0, 1, 0, 0]);
        census.count(101, &[1, 0, 1, 0, 49, 50, 0]);
        assert_eq!((census.photons(), census.dimension_max, census.dimension_mean()), (2, 101, 52.0));
        let mut twice = census.clone();
        twice.merge(&census);
        assert_eq!((twice.photons(), twice.dimension_mean()), (4, 52.0));
        assert_eq!(twice.dimension_histogram[LONGEST_DIMENSION], 2);
    }
}
