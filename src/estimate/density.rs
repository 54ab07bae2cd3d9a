//! Density estimation: luminance from the photons about a point, with its spread over replicates and its bias.
//!
//! The luminance towards the eye is the sum over photons near of f(wi, wo) w photon_lm K(d), f the surface's BSDF, w the photon's
//! weight and K a kernel of integral 1 over the part of the surface within the ball ([`super::footprint`]). Photons arriving are
//! flux per area already, so no cosine appears (H. W. Jensen, Global Illumination Using Photon Maps, 1996).

use std::sync::Arc;

use glam::DVec3;

use crate::bsdf::luminance_of;
use crate::geometry::{Geometry, Hit};
use crate::scene::camera::{Bandwidth, CameraSpec, FEWEST_NEIGHBOURS, Kernel};
use crate::tally::photon_map::{Photon, PhotonMap, by_distance};

use super::bandwidth::{self, Chosen};
use super::footprint::{Footprint, Footprints};
use super::kernel::disc_m2;
use super::replicates::FEWEST_HITS;

/// The second bandwidth, in units of the first: twice the area.
pub const SECOND: f64 = std::f64::consts::SQRT_2;

/// What the difference between the two bandwidths is multiplied with for the bias of the narrower: exact for a bias that grows
/// as the radius (at an edge), 1 / (sqrt 2 - 1); too large for one that grows as its square (where the density is smooth), 1.
pub const BIAS_PER_DIFFERENCE: f64 = 1.0 / (SECOND - 1.0);

/// Progressive radii shrink so that r_(i+1)^2 / r_i^2 = (i + alpha) / (i + 1) (C. Knaus, M. Zwicker: Progressive Photon
/// Mapping: A Probabilistic Approach, ACM TOG 30 (3), 2011).
pub const PROGRESSIVE_ALPHA: f64 = 2.0 / 3.0;

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
    /// Bias (Y) that no bandwidth tells: that of the factor k - 1 of k nearest under points that are not independent, at most
    /// that of k - 1/2.
    pub nearest_bias: f64,
    /// Kernel heights (1/m2) at both bandwidths by replicate, of the gather in hand.
    heights: Vec<[f64; 2]>,
    /// Radius of the last gather, m.
    reach_m: f64,
    /// Neighbours found, of the gather in hand.
    found: Vec<(f64, u32)>,
    /// What was gathered evenly since the last [`Self::clear`]: the first so many are in use.
    places: Vec<Place<C>>,
    places_used: usize,
    /// How far the last ones were sought, m: where the next search begins; what it finds does not depend on it.
    sought_m: f64,
}

/// Where light was gathered evenly, and what was found for a weight of 1.
#[derive(Debug, Clone, PartialEq)]
struct Place<const C: usize> {
    density: usize,
    at: Hit,
    found: Gathered<C>,
}

/// How far, in radii, a place may be from one where light was gathered evenly to take the same: its kernels are the same but for a
/// 16th of their radius.
const SAME_PLACE: f64 = 1.0 / 16.0;

/// Radius of the coarse map in radii of the fine one.
const COARSE: f64 = 16.0;

/// Places of one pixel that are remembered of each density.
const MOST_PLACES: usize = 8;

impl<const C: usize> Gathered<C> {
    /// Nothing, of this many replicates.
    pub fn new(replicates: usize) -> Self {
        Self {
            value: [0.0; C],
            second: [0.0; C],
            by_replicate: vec![0.0; replicates],
            sparse: 0.0,
            nearest_bias: 0.0,
            heights: Vec::new(),
            reach_m: 0.0,
            found: Vec::new(),
            places: Vec::new(),
            places_used: 0,
            sought_m: 0.0,
        }
    }

    /// Nothing again.
    pub fn clear(&mut self) {
        self.value = [0.0; C];
        self.second = [0.0; C];
        self.by_replicate.fill(0.0);
        self.sparse = 0.0;
        self.nearest_bias = 0.0;
        self.places_used = 0;
    }

    /// Adds what was found for a weight of 1, times `weight`. The parts of the replicates are those of the luminance found.
    fn add_weighted(&mut self, found: &Self, weight: [f64; C]) {
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

    /// Estimated size of the bias of `value`'s luminance, cd/m2: [`BIAS_PER_DIFFERENCE`] times what the second bandwidth
    /// makes of it.
    pub fn bias(&self) -> f64 {
        (luminance_of(&self.second) - luminance_of(&self.value)).abs() * BIAS_PER_DIFFERENCE
            + self.nearest_bias
    }

    /// Standard error of `value`'s luminance as the photons have it, given the bandwidth, cd/m2: from the spread of the
    /// replicates, and no less than that of (photons + 1) where there were hardly any. `None` for one replicate.
    pub fn standard_error(&self) -> Option<f64> {
        let n = self.by_replicate.len();
        if n < 2 {
            return None;
        }
        let mean = self.by_replicate.iter().sum::<f64>() / n as f64;
        let squares = self.by_replicate.iter().map(|s| (s - mean) * (s - mean)).sum::<f64>();
        let variance = n as f64 / (n - 1) as f64 * squares;
        Some((variance + self.sparse * self.sparse).sqrt())
    }
}

/// How densities are made.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Choice {
    /// Which photons count.
    pub bandwidth: Bandwidth,
    /// How they are weighted.
    pub kernel: Kernel,
    /// Replicates of the run.
    pub replicates: u32,
}

impl Choice {
    /// As a camera asks for it.
    pub fn of(camera: &CameraSpec, replicates: u32) -> Self {
        Self { bandwidth: camera.bandwidth, kernel: camera.kernel, replicates }
    }
}

/// Which photons about a point count.
#[derive(Debug, Clone)]
enum Reach {
    /// All within this radius (m) by replicate; one entry where it is the same for all.
    Radii(Vec<f64>),
    /// All within the radius (m), but this many nearest at least.
    AtLeast(f64, usize),
    /// This many nearest; and a radius (m) to begin the search with.
    Nearest(usize, f64),
}

/// A photon map with a bandwidth.
#[derive(Debug)]
pub struct Density<'m, const C: usize> {
    footprints: Arc<Footprints<'m>>,
    map: &'m PhotonMap<C>,
    /// The same photons surface by surface, sorted for the wide radii of few neighbours; empty where nobody asks.
    coarse: Vec<PhotonMap<C>>,
    /// Flux of one photon, lm.
    photon_lm: f64,
    kernel: Kernel,
    reach: Reach,
    chosen: Option<Chosen>,
}

impl<'m, const C: usize> Density<'m, C> {
    /// A density of this map; `photon_lm` is the flux of one photon, lm.
    pub fn new(geometry: &'m Geometry, map: &'m PhotonMap<C>, photon_lm: f64, choice: Choice) -> Self {
        Self::on(Arc::new(Footprints::new(geometry)), map, photon_lm, choice)
    }

    /// The same on surfaces that another density has prepared ([`Density::footprints`]).
    pub fn on(
        footprints: Arc<Footprints<'m>>,
        map: &'m PhotonMap<C>,
        photon_lm: f64,
        choice: Choice,
    ) -> Self {
        let mut chosen = None;
        let reach = match choice.bandwidth {
            Bandwidth::Radius(radius_m) => Reach::Radii(vec![radius_m]),
            Bandwidth::Progressive(radius_m) => Reach::Radii(progressive(radius_m, choice.replicates)),
            Bandwidth::Nearest(k) => Reach::Nearest(k as usize, map.built_for_m()),
            Bandwidth::AtLeast { radius_m, neighbours } => Reach::AtLeast(radius_m, neighbours as usize),
            Bandwidth::Automatic => {
                let found = bandwidth::choose(&footprints, map, choice.kernel, choice.replicates, 1.0);
                let radius_m = found.radius_m;
                chosen = Some(found);
                Reach::AtLeast(radius_m, FEWEST_NEIGHBOURS as usize)
            }
        };
        let coarse = match reach {
            Reach::AtLeast(radius_m, _) => by_surface(footprints.geometry(), map, COARSE * radius_m),
            Reach::Radii(_) | Reach::Nearest(..) => Vec::new(),
        };
        Self { footprints, map, coarse, photon_lm, kernel: choice.kernel, reach, chosen }
    }

    /// All photons within this radius, m.
    pub fn fixed(geometry: &'m Geometry, map: &'m PhotonMap<C>, photon_lm: f64, radius_m: f64) -> Self {
        let choice =
            Choice { bandwidth: Bandwidth::Radius(radius_m), kernel: Kernel::default(), replicates: 1 };
        Self::new(geometry, map, photon_lm, choice)
    }

    /// The surfaces as prepared for this density.
    pub fn footprints(&self) -> Arc<Footprints<'m>> {
        Arc::clone(&self.footprints)
    }

    /// What the automatic bandwidth was chosen by; `None` where the scene names one.
    pub fn chosen(&self) -> Option<&Chosen> {
        self.chosen.as_ref()
    }

    /// The (first) radius, m; `None` for k nearest.
    pub fn radius_m(&self) -> Option<f64> {
        match &self.reach {
            Reach::Radii(radii) => radii.first().copied(),
            Reach::AtLeast(radius_m, _) => Some(*radius_m),
            Reach::Nearest(..) => None,
        }
    }

    /// Adds the luminance at a point of a scattering surface, times `weight`. `value_of(direction of travel, arrived on the
    /// front)` is the surface's BSDF towards the eye, 1/sr; photons of both sides are offered. Once more it is asked, for light
    /// along the normal, where there are too few photons to tell an error from them.
    pub fn gather(
        &self,
        at: &Hit,
        weight: [f64; C],
        mut value_of: impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) {
        let footprint = self.footprints.at(at);
        let mut heights = std::mem::take(&mut into.heights);
        let mut found = std::mem::take(&mut into.found);
        heights.clear();
        into.reach_m = self.narrowest_m();
        let (hits, one_photon) = match &self.reach {
            Reach::Radii(radii) => {
                for &radius_m in radii {
                    heights.push(self.heights(&footprint, [radius_m, SECOND * radius_m]));
                }
                self.sum_within(&footprint, radii, &heights, at, weight, &mut value_of, into)
            }
            Reach::AtLeast(radius_m, least) => {
                if self.holds_at_least(&footprint, *radius_m, *least, at) {
                    heights.push(self.heights(&footprint, [*radius_m, SECOND * radius_m]));
                    self.sum_within(&footprint, &[*radius_m], &heights, at, weight, &mut value_of, into)
                } else {
                    let guess_m = SECOND * radius_m;
                    self.sum_nearest(
                        (*least, guess_m),
                        &footprint,
                        &mut found,
                        at,
                        weight,
                        &mut value_of,
                        into,
                    )
                }
            }
            Reach::Nearest(k, guess_m) => {
                self.sum_nearest((*k, *guess_m), &footprint, &mut found, at, weight, &mut value_of, into)
            }
        };
        if hits < FEWEST_HITS {
            let down = if at.front { -at.normal } else { at.normal };
            let f = value_of(down, at.front);
            let one: [f64; C] = std::array::from_fn(|c| weight[c] * f[c] * self.photon_lm * one_photon);
            into.sparse += luminance_of(&one).abs() * ((hits + 1) as f64).sqrt();
        }
        into.heights = heights;
        into.found = found;
    }

    /// Adds the luminance at a point of a surface whose BSDF is 1 for all light that arrives on the side seen and 0 for other, times
    /// `weight`. A pixel's samples lie close together against a wide radius: what was gathered for one, since `into` was last
    /// cleared, serves those within a 16th of the radius on the same side of the same surface.
    pub fn gather_evenly(&self, at: &Hit, weight: [f64; C], into: &mut Gathered<C>) {
        let of_side = |_, front: bool| [if front == at.front { 1.0 } else { 0.0 }; C];
        let density = std::ptr::from_ref(self.map).addr();
        let same = |place: &Place<C>| {
            let there = &place.at;
            place.density == density
                && (there.surface, there.front) == (at.surface, at.front)
                && there.normal == at.normal
                && there.position.distance(at.position) <= SAME_PLACE * place.found.reach_m
        };
        let mut places = std::mem::take(&mut into.places);
        let used = into.places_used;
        match places[..used].iter().find(|place| same(place)) {
            Some(place) => into.add_weighted(&place.found, weight),
            None if places[..used].iter().filter(|place| place.density == density).count() == MOST_PLACES => {
                self.gather(at, weight, of_side, into);
            }
            None => {
                if places.len() == used {
                    places.push(Place { density, at: *at, found: Gathered::new(into.by_replicate.len()) });
                }
                let place = &mut places[used];
                (place.density, place.at) = (density, *at);
                place.found.clear();
                self.gather(at, [1.0; C], of_side, &mut place.found);
                into.add_weighted(&place.found, weight);
                into.places_used = used + 1;
            }
        }
        into.places = places;
    }

    /// The narrowest radius, m; 0 where that is a matter of the neighbours.
    fn narrowest_m(&self) -> f64 {
        match &self.reach {
            Reach::Radii(radii) => radii.iter().copied().fold(f64::INFINITY, f64::min),
            Reach::AtLeast(radius_m, _) => *radius_m,
            Reach::Nearest(..) => 0.0,
        }
    }

    /// Whether there are so many photons within the radius.
    fn holds_at_least(&self, footprint: &Footprint<'_>, radius_m: f64, least: usize, at: &Hit) -> bool {
        let mut number = 0;
        self.map.within(at.position, radius_m, |photon, _| {
            // Whether the surface holds it is asked no more often than needed.
            number += usize::from(
                number < least && footprint.holds(photon.primitive, || self.map.position(photon)),
            );
        });
        number >= least
    }

    /// 1 / (pi r^2) over what of the kernel lies on the surface, 1/m2, for two radii.
    #[inline]
    fn heights(&self, footprint: &Footprint<'_>, radii_m: [f64; 2]) -> [f64; 2] {
        radii_m.map(|r| 1.0 / (disc_m2(r) * footprint.integral(self.kernel, r)))
    }

    /// All photons within a radius. Gives their number and what one photon would be, 1/m2.
    #[inline]
    #[allow(clippy::too_many_arguments)]
    fn sum_within(
        &self,
        footprint: &Footprint<'_>,
        radii: &[f64],
        heights: &[[f64; 2]],
        at: &Hit,
        weight: [f64; C],
        value_of: &mut impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) -> (u64, f64) {
        let (Some(&widest), Some(&[height, _])) = (radii.first(), heights.first()) else { return (0, 0.0) };
        let mut hits = 0;
        let same = radii.len() == 1;
        self.map.within(at.position, SECOND * widest, |photon, d2| {
            let set = if same { 0 } else { photon.replicate().min(radii.len() - 1) };
            let radius = radii[set];
            let t = d2 / (radius * radius);
            if t >= SECOND * SECOND || !footprint.holds(photon.primitive, || self.map.position(photon)) {
                return;
            }
            hits += u64::from(t < 1.0);
            self.add(photon, t, heights[set], weight, value_of, into);
        });
        (hits, height)
    }

    /// The k nearest photons. That at the distance r_k itself is left out: given r_k the k - 1 within are evenly spread, so
    /// (k - 1) / (pi r_k^2) is unbiased for independent photons, with any kernel.
    #[inline]
    #[allow(clippy::too_many_arguments)]
    fn sum_nearest(
        &self,
        (k, guess_m): (usize, f64),
        footprint: &Footprint<'_>,
        found: &mut Vec<(f64, u32)>,
        at: &Hit,
        weight: [f64; C],
        value_of: &mut impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) -> (u64, f64) {
        let map = self.coarse.get(at.surface.0 as usize).unwrap_or(self.map);
        // Where there are no more, no search for more.
        let twice = k.saturating_mul(2).min(map.photons().len());
        // A little more than the last time, pixels being neighbours; never so much that a dense place is read in vain.
        let guess_m = if into.sought_m > 0.0 { (1.1 * into.sought_m).min(2.0 * guess_m) } else { guess_m };
        let holds = |p: &Photon<C>| footprint.holds(p.primitive, || map.position(p));
        map.nearest(at.position, twice, guess_m, holds, found);
        found.sort_unstable_by_key(by_distance);
        // Positions are no finer than the frame's steps, and no neighbourhood is.
        let least = map.frame().steps_m().max_element();
        let Some(&(farthest2, _)) = found.last() else {
            let area = self.footprints.geometry().surfaces()[at.surface.0 as usize].shape.area();
            into.reach_m = area.sqrt();
            return (0, 1.0 / area);
        };
        into.sought_m = farthest2.sqrt();
        let kth2 = found[k.clamp(1, found.len()) - 1].0;
        let first = kth2.sqrt().max(least);
        let second = if found.len() == k.saturating_mul(2) {
            farthest2.sqrt()
        } else {
            farthest2.sqrt().max(SECOND * first)
        };
        let second = second.max(least);
        into.reach_m = first;
        let heights = self.heights(footprint, [first, second]);
        let before = luminance_of(&into.value);
        let mut hits = 0;
        for &(d2, place) in found.iter() {
            let photon = &map.photons()[place as usize];
            let (t1, t2) = (d2 / (first * first), d2 / (second * second));
            hits += u64::from(t1 < 1.0);
            self.add_two(photon, [t1, t2], heights, weight, value_of, into);
        }
        into.nearest_bias += (luminance_of(&into.value) - before).abs() / (2.0 * k as f64 - 1.0).max(1.0);
        (hits, heights[0])
    }

    /// One photon at d^2 / r^2 = t, the second radius being [`SECOND`] times the first.
    #[inline(always)]
    fn add(
        &self,
        photon: &Photon<C>,
        t: f64,
        heights: [f64; 2],
        weight: [f64; C],
        value_of: &mut impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) {
        self.add_two(photon, [t, t / (SECOND * SECOND)], heights, weight, value_of, into);
    }

    #[inline(always)]
    fn add_two(
        &self,
        photon: &Photon<C>,
        t: [f64; 2],
        heights: [f64; 2],
        weight: [f64; C],
        value_of: &mut impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) {
        let f = value_of(photon.direction(), photon.is_front());
        let brought: [f64; C] =
            std::array::from_fn(|c| weight[c] * f[c] * f64::from(photon.weight[c]) * self.photon_lm);
        let at = |i: usize| if t[i] < 1.0 { heights[i] * self.kernel.shape(t[i]) } else { 0.0 };
        let [first, second] = [at(0), at(1)];
        for (c, l) in brought.iter().enumerate() {
            into.value[c] += l * first;
            into.second[c] += l * second;
        }
        if let Some(sum) = into.by_replicate.get_mut(photon.replicate()) {
            *sum += luminance_of(&brought) * first;
        }
    }
}

/// The photons of every surface by themselves, sorted for at least this radius, m: where there are few, a search for some of them
/// does not go through the many of another surface.
fn by_surface<const C: usize>(geometry: &Geometry, map: &PhotonMap<C>, radius_m: f64) -> Vec<PhotonMap<C>> {
    let mut surface_of = Vec::with_capacity(geometry.primitive_count());
    for (i, surface) in geometry.surfaces().iter().enumerate() {
        surface_of.extend(std::iter::repeat_n(i, surface.shape.face_count()));
    }
    let surface_of = |photon: &Photon<C>| surface_of.get(photon.primitive as usize).copied();
    // Counted first: vectors that grow would take three times the photons for a while.
    let mut number = vec![0; geometry.surfaces().len()];
    for surface in map.photons().iter().filter_map(surface_of) {
        number[surface] += 1;
    }
    let mut photons: Vec<Vec<_>> = number.into_iter().map(Vec::with_capacity).collect();
    for photon in map.photons() {
        if let Some(surface) = surface_of(photon) {
            photons[surface].push(*photon);
        }
    }
    let sorted = |photons: Vec<Photon<C>>| {
        let guessed = PhotonMap::build(photons, *map.frame(), 0.0);
        if guessed.built_for_m() < radius_m { guessed.rebuilt(radius_m) } else { guessed }
    };
    photons.into_iter().map(sorted).collect()
}

/// The radius (m) of every replicate.
fn progressive(radius_m: f64, replicates: u32) -> Vec<f64> {
    let mut square = radius_m * radius_m;
    let mut radii = Vec::with_capacity(replicates.min(1 << 16) as usize);
    for i in 1..=replicates.clamp(1, 1 << 16) {
        radii.push(square.sqrt());
        square *= (f64::from(i) + PROGRESSIVE_ALPHA) / (f64::from(i) + 1.0);
    }
    radii
}
