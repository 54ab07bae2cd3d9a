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
    // Never so narrow that hardly any photons are left.
    let best = cheapest(&costs(&points, fraction), |i| count(i) * fraction.recip() >= LEAST_NEIGHBOURS);
    ChosenRadius { radius_m: ladder.radii_m[best], mean_neighbours: count(best), neighbours }
}

/// The nearest that are taken at least, of so many photons in all.
fn least_neighbours(photons: f64) -> u32 {
    ((photons * MOST_OF_ALL) as u32).clamp(FEWEST_LOCAL, FEWEST_NEIGHBOURS)
}

/// The rung of least cost among those allowed, of equals the widest; the widest of all where none is.
fn cheapest(costs: &[f64], allowed: impl Fn(usize) -> bool) -> usize {
    (0..costs.len())
        .filter(|&i| allowed(i))
        .min_by(|&a, &b| costs[a].total_cmp(&costs[b]).then(b.cmp(&a)))
        .unwrap_or(costs.len() - 1)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::gather::BIAS_PER_DIFFERENCE;

    #[test]
    fn the_cheapest_is_taken_of_equals_the_widest() {
        assert_eq!(cheapest(&[3.0, 1.0, 2.0, 1.0, 4.0], |_| true), 3);
        assert_eq!(cheapest(&[3.0, 1.0, 2.0], |i| i != 1), 2);
        assert_eq!(cheapest(&[3.0, 1.0, 2.0], |_| false), 2);
    }

    #[test]
    fn a_cost_is_variance_of_the_run_and_the_bias_beyond_noise() {
        // Density 2; variance 8 and no bias at first, then a difference of 3 with a noise of 1, then noise alone.
        let mut point = Point {
            count: [1.0; RUNGS],
            variance: [8.0; RUNGS],
            difference: [0.0; RUNGS],
            noise: [0.0; RUNGS],
            density: 2.0,
        };
        (point.difference[1], point.noise[1]) = (3.0, 1.0);
        point.noise[2] = 50.0;
        let costs = costs(&[point], 0.25);
        let bias2 = (9.0 - 1.0) / 4.0 * BIAS_PER_DIFFERENCE * BIAS_PER_DIFFERENCE;
        assert_eq!(costs.len(), RUNGS - SECOND_STEPS);
        assert_eq!(costs[0], 0.25 * 2.0);
        // What a narrow radius proves of the bias holds for wider ones.
        for cost in &costs[1..] {
            assert!((cost - 0.5 - bias2).abs() < 1e-12 * bias2, "{costs:?}");
        }
    }

    #[test]
    fn neighbours_are_a_part_of_all_between_sixteen_and_sixty_four() {
        assert_eq!([0.0, 1000.0, 1024.0, 1e9].map(least_neighbours), [16, 31, 32, 64]);
    }
}
