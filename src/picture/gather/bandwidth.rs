//! The radius of a density estimate, chosen once from all photons.
//!
//! At up to a thousand of the photons themselves, for a ladder of radii: the variance of the estimate from
//! the spread of the replicates, and its bias from what the second bandwidth makes of it, less what noise
//! contributes to that. The radius with the least mean of (variance + bias^2) over the squared density is
//! taken. The photon that the estimate is made at belongs to one replicate, whose other photons keep away
//! from it (they are a net); that replicate is left out.
//!
//! The points are photons, so each weighs what it contributes to the picture's light: a dense caustic counts
//! more than the thinly lit table around it.

use rayon::prelude::*;

use crate::picture::photon_map::PhotonMap;
use crate::scene::camera::{Bandwidth, FEWEST_NEIGHBOURS, Kernel};

use super::footprint::Footprints;
use super::ladder::{FEWEST_LOCAL, Ladder, MOST_OF_ALL, Point, RUNGS, SECOND_STEPS, moments, places};

/// Photons that the choice is made at.
const POINTS: usize = 1024;

/// Fewest neighbours in the mean that a radius may have.
const LEAST_NEIGHBOURS: f64 = 8.0;

/// What was chosen and what it costs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ChosenRadius {
    /// The radius, m.
    pub radius_m: f64,
    /// Mean number of photons within it, about a photon of this map.
    pub mean_neighbours: f64,
    /// The nearest that are taken at least, of all photons of the run.
    pub neighbours: u32,
}

impl ChosenRadius {
    /// As a density is to have it.
    pub fn bandwidth(&self) -> Bandwidth {
        Bandwidth::AtLeast { radius_m: self.radius_m, neighbours: self.neighbours }
    }
}

/// The radius with the least mean squared relative error for 1 / `fraction` times the photons of this map: a
/// run that is traced in passes chooses once, from the first. `replicates` is how many the photons of this
/// map are numbered by.
pub fn choose<const C: usize>(
    footprints: &Footprints<'_>,
    map: &PhotonMap<C>,
    kernel: Kernel,
    replicates: u32,
    fraction: f64,
) -> ChosenRadius {
    let ladder = Ladder::new(footprints, map, replicates);
    let neighbours = least_neighbours(map.photons().len() as f64 / fraction);
    let Some(ladder) = ladder else {
        let mean_neighbours = map.photons().len() as f64;
        return ChosenRadius { radius_m: without_photons(footprints, map), mean_neighbours, neighbours };
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
    ChosenRadius { radius_m: ladder.radii_m[best], mean_neighbours: count(best), neighbours }
}

/// The nearest that are taken at least, of so many photons in all.
fn least_neighbours(photons: f64) -> u32 {
    ((photons * MOST_OF_ALL) as u32).clamp(FEWEST_LOCAL, FEWEST_NEIGHBOURS)
}

/// Mean squared relative error of every rung.
///
/// What is finer than both bandwidths neither of them sees: the bias of a radius is taken to be no less than
/// what narrower ones show, as far as that is more than their noise.
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

/// A radius where no photons tell one: what the map was made for, or a 64th of the scene.
fn without_photons<const C: usize>(footprints: &Footprints<'_>, map: &PhotonMap<C>) -> f64 {
    let (low, high) = footprints.geometry().bounds();
    let size = (high - low).length() / 64.0;
    if map.built_for_m() > 0.0 { map.built_for_m() } else { size.max(f64::MIN_POSITIVE) }
}
