//! The sum over the photons about a point: those within a radius, or the k nearest.

use glam::DVec3;

use crate::estimate::replicates::FEWEST_HITS;
use crate::geometry::Hit;
use crate::picture::photon_map::{Photon, PhotonMap};
use crate::scene::camera::Kernel;
use crate::surface::luminance_of;

use super::SECOND;
use super::footprint::Footprint;
use super::gathered::Gathered;
use super::kernel::disc_m2;
use super::surfaces::{BySurface, Wanted};

/// A point that light is gathered at. `F` is the surface's BSDF towards the eye: (direction of travel,
/// arrived on the front) -> 1/sr.
pub(crate) struct Point<'a, const C: usize, F> {
    pub map: &'a PhotonMap<C>,
    /// Flux of one photon, lm.
    pub photon_lm: f64,
    pub kernel: Kernel,
    pub at: &'a Hit,
    pub footprint: Footprint<'a>,
    /// The side whose photons count, front or back; `None`: both.
    pub side: Option<bool>,
    pub weight: [f64; C],
    pub value_of: F,
}

/// What a sum was made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    /// Photons within the first bandwidth that brought something.
    pub hits: u64,
    /// What one of them may count for at most, 1/m2.
    pub height: f64,
}

impl<const C: usize, F: FnMut(DVec3, bool) -> [f64; C]> Point<'_, C, F> {
    /// Whether a photon is on the part of the surface, and the side, that count.
    #[inline(always)]
    fn holds(&self, photon: &Photon<C>) -> bool {
        self.side.is_none_or(|front| photon.is_front() == front)
            && self.footprint.holds(photon.primitive, || self.map.position(photon))
    }

    /// Whether there are so many photons within the radius, m.
    pub fn holds_at_least(&self, radius_m: f64, least: usize) -> bool {
        self.map.has_within(self.at.position, radius_m, least, |photon| self.holds(photon))
    }

    /// 1 / (pi r^2) over what of the kernel lies on the surface, 1/m2, for two radii.
    #[inline]
    fn heights(&self, radii_m: [f64; 2]) -> [f64; 2] {
        radii_m.map(|r| 1.0 / (disc_m2(r) * self.footprint.integral(self.kernel, r)))
    }

    /// All photons within a radius (m), one for each replicate or the same for all.
    #[inline]
    pub fn sum_within(&mut self, radii: &[f64], into: &mut Gathered<C>) -> Found {
        let mut heights = std::mem::take(&mut into.room.heights);
        heights.clear();
        heights.extend(radii.iter().map(|r| self.heights([*r, SECOND * r])));
        let widest = radii.iter().copied().fold(0.0, f64::max);
        let mut hits = 0;
        let same = radii.len() == 1;
        let map = self.map;
        map.within(self.at.position, SECOND * widest, |photon, d2| {
            let set = if same { 0 } else { photon.replicate().min(radii.len() - 1) };
            let radius = radii[set];
            let t = d2 / (radius * radius);
            if t >= SECOND * SECOND || !self.holds(photon) {
                return;
            }
            let brings = self.add(photon, [t, t / (SECOND * SECOND)], heights[set], into);
            hits += u64::from(brings && t < 1.0);
        });
        // Of several radii the narrowest has the highest kernel: what one photon owes is never less than what
        // it would bring.
        let height = heights.iter().fold(0.0, |most: f64, [first, _]| most.max(*first));
        into.room.heights = heights;
        Found { hits, height }
    }

    /// The k nearest photons. That at the distance r_k itself is left out: given r_k the k - 1 within are
    /// evenly spread, so (k - 1) / (pi r_k^2) is unbiased for independent photons, with any kernel. `area_m2`
    /// is asked for where the surface has none.
    #[inline]
    pub fn sum_nearest(
        &mut self,
        all: &BySurface<C>,
        (k, guess_m): (usize, f64),
        area_m2: impl FnOnce() -> f64,
        into: &mut Gathered<C>,
    ) -> Found {
        let surface = self.at.surface.0 as usize;
        let number = k.saturating_mul(2);
        let wanted = Wanted { number, guess_m, sought_m: into.sought_m };
        let mut room = std::mem::take(&mut into.room);
        all.nearest(self.map, (surface, self.side), &self.footprint, wanted, &mut room);
        let found = &room.neighbours;
        // Positions are no finer than the frame's steps, and no neighbourhood is.
        let least = self.map.frame().steps_m().max_element();
        let Some(farthest) = found.last() else {
            let area_m2 = area_m2();
            into.reach_m = area_m2.sqrt();
            into.room = room;
            return Found { hits: 0, height: 1.0 / area_m2 };
        };
        let farthest_m = farthest.d2.sqrt();
        into.sought_m = farthest_m;
        let first = found[k.clamp(1, found.len()) - 1].d2.sqrt().max(least);
        let second = if found.len() == number { farthest_m } else { farthest_m.max(SECOND * first) };
        let second = second.max(least);
        into.reach_m = first;
        let heights = self.heights([first, second]);
        let before = luminance_of(&into.value);
        let mut hits = 0;
        for neighbour in found {
            let photon = all.photon(self.map, surface, neighbour);
            let t = [neighbour.d2 / (first * first), neighbour.d2 / (second * second)];
            let brings = self.add(photon, t, heights, into);
            hits += u64::from(brings && t[0] < 1.0);
        }
        into.room = room;
        into.nearest_bias += (luminance_of(&into.value) - before).abs() / (2.0 * k as f64 - 1.0).max(1.0);
        Found { hits, height: heights[0] }
    }

    /// One photon, at d^2 / r^2 = t of either bandwidth. Whether it brings anything.
    #[inline(always)]
    fn add(&mut self, photon: &Photon<C>, t: [f64; 2], heights: [f64; 2], into: &mut Gathered<C>) -> bool {
        let f = (self.value_of)(photon.direction(), photon.is_front());
        let brought: [f64; C] =
            std::array::from_fn(|c| self.weight[c] * f[c] * f64::from(photon.weight[c]) * self.photon_lm);
        let at = |i: usize| if t[i] < 1.0 { heights[i] * self.kernel.shape(t[i]) } else { 0.0 };
        let [first, second] = [at(0), at(1)];
        for (c, l) in brought.iter().enumerate() {
            into.value[c] += l * first;
            into.second[c] += l * second;
        }
        if let Some(sum) = into.by_replicate.get_mut(photon.replicate()) {
            *sum += luminance_of(&brought) * first;
        }
        f != [0.0; C]
    }

    /// Adds the error that is owed where too few photons brought something for their spread to say anything:
    /// that of one photon more, along the normal, on the side of those that count that shows it brighter.
    #[inline]
    pub fn owe(&mut self, found: Found, into: &mut Gathered<C>) {
        if found.hits >= FEWEST_HITS {
            return;
        }
        let mut of_one: f64 = 0.0;
        for front in [false, true].into_iter().filter(|front| self.side.is_none_or(|side| side == *front)) {
            let travel = if front { -self.at.normal } else { self.at.normal };
            let f = (self.value_of)(travel, front);
            let one: [f64; C] =
                std::array::from_fn(|c| self.weight[c] * f[c] * self.photon_lm * found.height);
            of_one = of_one.max(luminance_of(&one).abs());
        }
        into.sparse += of_one * ((found.hits + 1) as f64).sqrt();
    }
}
