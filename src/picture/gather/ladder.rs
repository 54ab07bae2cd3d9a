//! What photons about a photon say of a density at each of a ladder of radii.

use crate::picture::photon_map::{Photon, PhotonMap};
use crate::scene::camera::Kernel;

use super::BIAS_PER_DIFFERENCE;
use super::footprint::{Footprint, Footprints};
use super::kernel::disc_m2;

/// Steps of the ladder in which a radius grows by sqrt 2, the ratio of the two bandwidths.
pub(super) const SECOND_STEPS: usize = 2;

/// Rungs: radii over a factor 2^(20 / 4) = 32, numbers of neighbours over a factor 1024.
pub(super) const RUNGS: usize = 21;

/// Median number of neighbours within the widest radius of the ladder, and so twice that of the widest that
/// can be chosen: beyond it a picture takes too long.
const MOST_NEIGHBOURS: usize = 1024;

/// Part of all photons that a bandwidth holds at most: one that holds more says nothing of a place.
pub(super) const MOST_OF_ALL: f64 = 1.0 / 32.0;

/// Neighbours that are not too many, however few photons there are.
pub(super) const FEWEST_LOCAL: u32 = 16;

/// Photons below which none of this is told from them.
const FEWEST: usize = 64;

/// Neighbours from which a point's own density is told.
const ENOUGH: f64 = 48.0;

/// Replicates beyond which their spread is not kept; the variance is then that of independent photons.
const MOST_REPLICATES: usize = 256;

/// Radii from narrow to wide, each 2^(1/4) times the last.
pub(super) struct Ladder {
    pub(super) radii_m: [f64; RUNGS],
    /// Replicates whose spread is used; 1: none.
    replicates: usize,
}

/// What is found about one photon, by rung.
#[derive(Default)]
pub(super) struct Point {
    pub(super) count: [f64; RUNGS],
    pub(super) variance: [f64; RUNGS],
    /// Difference that the second bandwidth makes, and its variance.
    pub(super) difference: [f64; RUNGS],
    pub(super) noise: [f64; RUNGS],
    /// The density, 1/m2, at the narrowest radius that has enough photons to tell.
    pub(super) density: f64,
}

impl Point {
    pub(super) fn relative_variance(&self, rung: usize) -> f64 {
        self.variance[rung] / (self.density * self.density)
    }

    /// Square of the bias, less what noise adds to it.
    pub(super) fn relative_bias2(&self, rung: usize) -> f64 {
        let difference2 = self.difference[rung] * self.difference[rung] - self.noise[rung];
        difference2 * (BIAS_PER_DIFFERENCE * BIAS_PER_DIFFERENCE) / (self.density * self.density)
    }
}

impl Ladder {
    /// About photons of this map; `None` where there are too few to have neighbours.
    pub(super) fn new<const C: usize>(
        footprints: &Footprints<'_>,
        map: &PhotonMap<C>,
        replicates: u32,
    ) -> Option<Self> {
        if map.photons().len() < FEWEST {
            return None;
        }
        // The widest that can be chosen has half the area of the widest of the ladder. One more: the photon
        // itself is among them.
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

    pub(super) fn point<const C: usize>(
        &self,
        footprints: &Footprints<'_>,
        map: &PhotonMap<C>,
        kernel: Kernel,
        place: usize,
    ) -> Option<Point> {
        let own = &map.photons()[place];
        let centre = map.position(own);
        let about = footprints.of_primitive(centre, own.primitive)?;
        // Kernels are linear in d^2: photons between two rungs are kept as their number and the sum of their
        // d^2.
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
        let mut point = Point::default();
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
                // Independent photons; between kernels of areas 1 and 2 the covariance is that of their
                // product.
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
pub(super) fn moments(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let n = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / n;
    let squares = values.map(|v| (v - mean) * (v - mean)).sum::<f64>();
    (mean, if n > 1.0 { squares / (n - 1.0) } else { 0.0 })
}

fn holds<const C: usize>(about: &Footprint<'_>, map: &PhotonMap<C>, photon: &Photon<C>) -> bool {
    about.holds(photon.primitive, || map.position(photon))
}

/// At most `most` of `n` places, evenly spread.
pub(super) fn places(n: usize, most: usize) -> Vec<usize> {
    let count = n.min(most);
    (0..count).map(|i| ((2 * i + 1) as u128 * n as u128 / (2 * count) as u128) as usize).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn estimates_come_from_the_spread_of_all_replicates_but_one() {
        let ladder = Ladder { radii_m: [1.0; RUNGS], replicates: 3 };
        let mut rings = vec![[(0.0, 0.0); RUNGS]; 3];
        // Within rung 0: 4 and 2 photons; within rung 1 and wider: 5 each. The third replicate is left out.
        (rings[0][0].0, rings[1][0].0) = (4.0, 2.0);
        (rings[0][1].0, rings[1][1].0) = (1.0, 3.0);
        rings[2][0].0 = 1000.0;
        let point = ladder.estimates(&rings, 2, Kernel::Flat, &[1.0; RUNGS]);
        // Three replicates for two: 9 and 15 photons.
        assert_eq!((point.count[0], point.count[1], point.density), (9.0, 15.0, 15.0));
        // s^2 of 4 and 2 is 2; of the differences 1 and 3, mean 2, as well.
        assert_eq!((point.variance[0], point.variance[1]), (6.0, 0.0));
        assert_eq!((point.difference[0], point.difference[1]), (6.0, 0.0));
        assert_eq!((point.noise[0], point.noise[1]), (9.0 / 2.0 * 2.0, 0.0));
        let unit = BIAS_PER_DIFFERENCE * BIAS_PER_DIFFERENCE / 225.0;
        assert!((point.relative_bias2(0) - 27.0 * unit).abs() < 1e-12);
        assert!((point.relative_variance(0) - 6.0 / 225.0).abs() < 1e-15);
        // Of one replicate the variance is that of independent photons.
        let alone = Ladder { radii_m: [1.0; RUNGS], replicates: 1 };
        let point = alone.estimates(&rings[..1], usize::MAX, Kernel::Flat, &[1.0; RUNGS]);
        assert_eq!((point.count[0], point.variance[0], point.noise[0]), (4.0, 4.0, 1.0));
    }

    #[test]
    fn places_are_spread_evenly_and_moments_are_those_of_the_textbook() {
        assert_eq!(places(8, 4), [1, 3, 5, 7]);
        assert_eq!(places(3, 10), [0, 1, 2]);
        assert_eq!(moments([1.0, 2.0, 6.0].into_iter()), (3.0, 7.0));
        assert_eq!(moments([5.0].into_iter()), (5.0, 0.0));
    }
}
