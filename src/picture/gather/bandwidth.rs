//! The radius of a density estimate, chosen once from all photons.
//!
//! At up to a thousand of the photons themselves, for a ladder of radii: the variance of the estimate from the spread of the
//! replicates, and its bias from what the second bandwidth makes of it, less what noise contributes to that. The radius with
//! the least mean of (variance + bias^2) over the squared density is taken. The photon that the estimate is made at belongs to one
//! replicate, whose other photons keep away from it (they are a net); that replicate is left out.
//!
//! The points are photons, so each weighs what it contributes to the picture's light: a dense caustic counts more than the
//! thinly lit table around it.

use rayon::prelude::*;

use crate::picture::photon_map::{Photon, PhotonMap};
use crate::scene::camera::{Bandwidth, FEWEST_NEIGHBOURS, Kernel};

use super::BIAS_PER_DIFFERENCE;
use super::footprint::{Footprint, Footprints};
use super::kernel::disc_m2;

/// Photons that the choice is made at.
const POINTS: usize = 1024;

/// Steps of the ladder in which a radius grows by sqrt 2, the ratio of the two bandwidths.
const SECOND_STEPS: usize = 2;

/// Rungs: radii over a factor 2^(20 / 4) = 32, numbers of neighbours over a factor 1024.
const RUNGS: usize = 21;

/// Median number of neighbours within the widest radius of the ladder, and so twice that of the widest that can be chosen:
/// beyond it a picture takes too long.
const MOST_NEIGHBOURS: usize = 1024;

/// Part of all photons that a bandwidth holds at most: one that holds more says nothing of a place.
const MOST_OF_ALL: f64 = 1.0 / 32.0;

/// Neighbours that are not too many, however few photons there are.
const FEWEST_LOCAL: u32 = 16;

/// Fewest neighbours in the mean that a radius may have.
const LEAST_NEIGHBOURS: f64 = 8.0;

/// Photons below which none of this is told from them.
const FEWEST: usize = 64;

/// Neighbours from which a point's own density is told.
const ENOUGH: f64 = 48.0;

/// Replicates beyond which their spread is not kept; the variance is then that of independent photons.
const MOST_REPLICATES: usize = 256;

/// What was chosen and what it costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chosen {
    /// The radius, m.
    pub radius_m: f64,
    /// Mean number of photons within it, about a photon of this map.
    pub mean_neighbours: f64,
    /// The nearest that are taken at least, of all photons of the run.
    pub neighbours: u32,
}

impl Chosen {
    /// As a density is to have it.
    pub fn bandwidth(&self) -> Bandwidth {
        Bandwidth::AtLeast { radius_m: self.radius_m, neighbours: self.neighbours }
    }
}

/// The radius with the least mean squared relative error for 1 / `fraction` times the photons of this map: a run that is
/// traced in passes chooses once, from the first. `replicates` is how many the photons of this map are numbered by.
pub fn choose<const C: usize>(
    footprints: &Footprints<'_>,
    map: &PhotonMap<C>,
    kernel: Kernel,
    replicates: u32,
    fraction: f64,
) -> Chosen {
    let ladder = Ladder::new(footprints, map, replicates);
    let neighbours = least_neighbours(map.photons().len() as f64 / fraction);
    let Some(ladder) = ladder else {
        let mean_neighbours = map.photons().len() as f64;
        return Chosen { radius_m: without_photons(footprints, map), mean_neighbours, neighbours };
    };
    let places = places(map.photons().len(), POINTS);
    let points: Vec<Point> =
        places.into_par_iter().filter_map(|i| ladder.point(footprints, map, kernel, i)).collect();
    let count = |rung: usize| points.iter().map(|p| p.count[rung]).sum::<f64>() / points.len().max(1) as f64;
    let candidates = RUNGS - SECOND_STEPS;
    let costs = costs(&points, fraction);
    // Of equals the widest; never so narrow that hardly any photons are left.
    let best = (0..candidates)
        .filter(|&i| count(i) * fraction.recip() >= LEAST_NEIGHBOURS)
        .min_by(|&a, &b| costs[a].total_cmp(&costs[b]).then(b.cmp(&a)))
        .unwrap_or(candidates - 1);
    Chosen { radius_m: ladder.radii_m[best], mean_neighbours: count(best), neighbours }
}

/// The nearest that are taken at least, of so many photons in all.
fn least_neighbours(photons: f64) -> u32 {
    ((photons * MOST_OF_ALL) as u32).clamp(FEWEST_LOCAL, FEWEST_NEIGHBOURS)
}

/// Mean squared relative error of every rung.
///
/// What is finer than both bandwidths neither of them sees: the bias of a radius is taken to be no less than what narrower ones
/// show, as far as that is more than their noise.
fn costs(points: &[Point], fraction: f64) -> Vec<f64> {
    let n = points.len().max(1) as f64;
    let mut proven = 0.0f64;
    let cost = |rung: usize| {
        let variance = points.iter().map(|p| p.relative_variance(rung)).sum::<f64>() / n;
        let (bias2, spread) = moments(points.iter().map(|p| p.relative_bias2(rung)));
        let own = bias2.max(proven).max(0.0);
        proven = proven.max(bias2 - 3.0 * (spread / n).sqrt());
        fraction * variance + own
    };
    (0..RUNGS - SECOND_STEPS).map(cost).collect()
}

/// Radii from narrow to wide, each 2^(1/4) times the last.
struct Ladder {
    radii_m: [f64; RUNGS],
    /// Replicates whose spread is used; 1: none.
    replicates: usize,
}

/// What is found about one photon, by rung.
struct Point {
    count: [f64; RUNGS],
    variance: [f64; RUNGS],
    /// Difference that the second bandwidth makes, and its variance.
    difference: [f64; RUNGS],
    noise: [f64; RUNGS],
    /// The density, 1/m2, at the narrowest radius that has enough photons to tell.
    density: f64,
}

impl Point {
    fn relative_variance(&self, rung: usize) -> f64 {
        self.variance[rung] / (self.density * self.density)
    }

    /// Square of the bias, less what noise adds to it.
    fn relative_bias2(&self, rung: usize) -> f64 {
        let difference2 = self.difference[rung] * self.difference[rung] - self.noise[rung];
        difference2 * (BIAS_PER_DIFFERENCE * BIAS_PER_DIFFERENCE) / (self.density * self.density)
    }
}

impl Ladder {
    /// About photons of this map; `None` where there are too few to have neighbours.
    fn new<const C: usize>(footprints: &Footprints<'_>, map: &PhotonMap<C>, replicates: u32) -> Option<Self> {
        if map.photons().len() < FEWEST {
            return None;
        }
        // The widest that can be chosen has half the area of the widest of the ladder. One more: the photon itself is among them.
        let local = (2.0 * MOST_OF_ALL * map.photons().len() as f64) as usize;
        let k = MOST_NEIGHBOURS.min(local.max(FEWEST_LOCAL as usize)) + 1;
        let mut found = Vec::new();
        let mut reach: Vec<f64> = Vec::new();
        for place in places(map.photons().len(), 63) {
            let photon = &map.photons()[place];
            let centre = map.position(photon);
            let Some(about) = footprints.of_primitive(centre, photon.primitive) else { continue };
            let holds = |p: &Photon<C>| p.is_front() == photon.is_front() && holds(&about, map, p);
            map.nearest(centre, k, map.built_for_m(), holds, &mut found);
            reach.extend(found.last().map(|f| f.0.sqrt()).filter(|r| *r > 0.0));
        }
        reach.sort_by(f64::total_cmp);
        let widest = reach.get(reach.len() / 2).copied()?;
        // A power of 2^(1/4) each, by multiplication: the same bits everywhere.
        let step = std::f64::consts::SQRT_2.sqrt();
        let mut radii_m = [widest; RUNGS];
        for i in (0..RUNGS - 1).rev() {
            radii_m[i] = radii_m[i + 1] / step;
        }
        let replicates = replicates as usize;
        Some(Self {
            radii_m,
            replicates: if (3..=MOST_REPLICATES).contains(&replicates) { replicates } else { 1 },
        })
    }

    fn point<const C: usize>(
        &self,
        footprints: &Footprints<'_>,
        map: &PhotonMap<C>,
        kernel: Kernel,
        place: usize,
    ) -> Option<Point> {
        let own = &map.photons()[place];
        let centre = map.position(own);
        let about = footprints.of_primitive(centre, own.primitive)?;
        // Kernels are linear in d^2: photons between two rungs are kept as their number and the sum of their d^2.
        let mut rings = vec![[(0.0, 0.0); RUNGS]; self.replicates];
        let widest = self.radii_m[RUNGS - 1];
        let squares = self.radii_m.map(|r| r * r);
        let mut self_seen = false;
        map.within(centre, widest, |photon, d2| {
            if photon.is_front() != own.is_front() || !holds(&about, map, photon) {
                return;
            }
            if !self_seen && photon == own {
                self_seen = true;
                return;
            }
            let ring = squares.partition_point(|r2| *r2 <= d2).min(RUNGS - 1);
            let (count, sum) = &mut rings[photon.replicate() % self.replicates][ring];
            *count += 1.0;
            *sum += d2;
        });
        let left_out = if self.replicates > 1 { own.replicate() % self.replicates } else { usize::MAX };
        let heights = self.radii_m.map(|r| 1.0 / (disc_m2(r) * about.integral(kernel, r)));
        Some(self.estimates(&rings, left_out, kernel, &heights))
    }

    /// Density, variance and differences of all rungs from the rings of every replicate but one.
    fn estimates(
        &self,
        rings: &[[(f64, f64); RUNGS]],
        left_out: usize,
        kernel: Kernel,
        heights: &[f64; RUNGS],
    ) -> Point {
        let used: Vec<[(f64, f64); RUNGS]> = rings
            .iter()
            .enumerate()
            .filter(|(i, _)| *i != left_out)
            .map(|(_, rings)| {
                let mut within = *rings;
                for i in 1..RUNGS {
                    within[i] = (within[i].0 + within[i - 1].0, within[i].1 + within[i - 1].1);
                }
                within
            })
            .collect();
        let (m, all) = (used.len() as f64, self.replicates as f64);
        let value = |within: &[(f64, f64); RUNGS], i: usize| {
            let (count, sum) = within[i];
            let mean_t = if count > 0.0 { sum / count / (self.radii_m[i] * self.radii_m[i]) } else { 0.0 };
            count * kernel.shape(mean_t) * heights[i]
        };
        let mut point = Point {
            count: [0.0; RUNGS],
            variance: [0.0; RUNGS],
            difference: [0.0; RUNGS],
            noise: [0.0; RUNGS],
            density: 0.0,
        };
        for i in 0..RUNGS {
            let second = (i + SECOND_STEPS).min(RUNGS - 1);
            let counted: f64 = used.iter().map(|w| w[i].0).sum();
            point.count[i] = counted * all / m;
            let (mean, spread) = moments(used.iter().map(|w| value(w, i)));
            let (change, change_spread) = moments(used.iter().map(|w| value(w, second) - value(w, i)));
            point.difference[i] = all * change;
            if used.len() > 1 {
                point.variance[i] = all * spread;
                point.noise[i] = all * all / m * change_spread;
            } else {
                // Independent photons; between kernels of areas 1 and 2 the covariance is that of their product.
                point.variance[i] = counted.max(1.0) * kernel.roughness() * heights[i] * heights[i];
                point.noise[i] = point.variance[i] * 0.25;
            }
            if point.density == 0.0 && (point.count[i] >= ENOUGH || i == RUNGS - 1) {
                point.density = (all * mean).max(heights[i]);
            }
        }
        point
    }
}

/// Mean and variance (with n - 1) of a few numbers.
fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares = values.map(|v| (v - mean) * (v - mean)).sum::<f64>();
    (mean, if n > 1.0 { squares / (n - 1.0) } else { 0.0 })
}

fn holds<const C: usize>(about: &Footprint<'_>, map: &PhotonMap<C>, photon: &Photon<C>) -> bool {
    about.holds(photon.primitive, || map.position(photon))
}

/// At most `most` of `n` places, evenly spread.
fn places(n: usize, most: usize) -> Vec<usize> {
    let count = n.min(most);
    (0..count).map(|i| ((2 * i + 1) as u128 * n as u128 / (2 * count) as u128) as usize).collect()
}

/// A radius where no photons tell one: what the map was made for, or a 64th of the scene.
fn without_photons<const C: usize>(footprints: &Footprints<'_>, map: &PhotonMap<C>) -> f64 {
    let (low, high) = footprints.geometry().bounds();
    let size = (high - low).length() / 64.0;
    if map.built_for_m() > 0.0 { map.built_for_m() } else { size.max(f64::MIN_POSITIVE) }
}
