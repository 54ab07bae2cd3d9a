//! Spot figures and their errors (METHOD 9): centroid, radii, encircled flux.
//!
//! Sums of places are exact integers, so that centroid and RMS radius have no error of cells. Encircled flux comes of fine
//! cells, and what their size can hide is bounded. Errors are the jackknife's over replicates.

mod overlap;
mod rings;

use rayon::prelude::*;
use serde::Serialize;

use crate::scene::spot::Spot;
use crate::tally::spot::{PLACE_BITS, SpotCount};

use super::extremes::student;
use super::far_field::jackknife_error;
use rings::{Across, Rings};

/// Fewer photons than this say nothing of a spot.
pub const FEWEST_PHOTONS: u64 = 100;

/// Shares of D50 and D86: a half, and 1 - 1/e^2, what a Gaussian beam has within its 1/e^2 radius.
pub const SHARES: [f64; 2] = [0.5, 0.864_664_716_763_387_3];

/// Radii of the curve, to twice the radius of D86 and to the last photon, each.
const RADII: usize = 64;

/// The strip along each side that counts as edge, as a part of the side.
const EDGE: f64 = 1.0 / 64.0;

/// A number and its standard error. Names are those of report.json.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Figure {
    /// The number.
    pub value: f64,
    /// Its standard error; `None` for one replicate, or where one alone had photons.
    pub standard_error: Option<f64>,
}

/// A diameter about the centroid with some share of the photons.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Diameter {
    /// m.
    pub value: f64,
    /// Standard error by noise.
    pub standard_error: Option<f64>,
    /// Ends of the interval of 95 % that holds both noise and what the fine cells can hide.
    pub low: Option<f64>,
    /// Its upper end.
    pub high: Option<f64>,
    /// Between which diameters these photons leave it, whatever their places in the fine cells.
    pub by_cells: [f64; 2],
}

/// A point of the curve of encircled flux.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Encircled {
    /// Radius about the centroid, m.
    pub radius_m: f64,
    /// Share of the receiver's flux within.
    pub share: Figure,
    /// Least and greatest that these photons allow, whatever their places in the fine cells.
    pub by_cells: [f64; 2],
}

/// The figures of a spot.
#[derive(Debug, Clone)]
pub struct Figures {
    /// Photons.
    pub photons: u64,
    /// Centroid, m from the corner along u and v.
    pub centroid_m: [Figure; 2],
    /// Centroids without each replicate in turn.
    pub centroids_without: Vec<[f64; 2]>,
    /// RMS radius about it, m.
    pub rms_radius_m: Figure,
    /// Along u and v alone.
    pub rms_m: [Figure; 2],
    /// D50 and D86.
    pub diameters_m: [Diameter; 2],
    /// Share within a radius, by radius.
    pub encircled: Vec<Encircled>,
    /// Share of the photons in the strip of a sixty-fourth along the edges.
    pub edge_share: f64,
}

/// Why there are none.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TooFew {
    /// Photons that arrived.
    pub photons: u64,
}

/// The figures of what replicates counted.
///
/// # Errors
/// Fewer than [`FEWEST_PHOTONS`].
pub fn figures(spot: &Spot, replicates: &[SpotCount]) -> Result<Figures, TooFew> {
    let all = Places::of(spot, replicates.iter());
    if all.photons < FEWEST_PHOTONS {
        return Err(TooFew { photons: all.photons });
    }
    let others =
        |r: usize| replicates.iter().enumerate().filter(move |(i, _)| *i != r).map(|(_, count)| count);
    let without: Vec<Places> = (0..replicates.len()).map(|r| Places::of(spot, others(r))).collect();
    let is_known = without.len() > 1 && without.iter().all(|places| places.photons > 0);
    let without = if is_known { without } else { Vec::new() };
    // Rounding of places moves a mean, and a root mean square, by no more than half a unit.
    let unit_m = spot.size_m.map(|side| 0.5 * side / (1u64 << PLACE_BITS) as f64);
    let figure = |of: &dyn Fn(&Places) -> f64, least: f64| Figure {
        value: of(&all),
        standard_error: is_known
            .then(|| jackknife_error(&without.iter().map(of).collect::<Vec<_>>()).max(least)),
    };
    let lit = Lit::of(spot, replicates);
    let rings = lit.rings(all.mean_m, None);
    let curve = Curve { lit: &lit, rings: &rings, without: &without };
    Ok(Figures {
        photons: all.photons,
        centroid_m: [0, 1].map(|i| figure(&|places| places.mean_m[i], unit_m[i])),
        centroids_without: without.iter().map(|places| places.mean_m).collect(),
        rms_radius_m: figure(&Places::radius_m, libm::hypot(unit_m[0], unit_m[1])),
        rms_m: [0, 1].map(|i| figure(&|places| places.variance_m2[i].sqrt(), unit_m[i])),
        diameters_m: curve.diameters(),
        encircled: curve.points(),
        edge_share: lit.edge_share(all.photons),
    })
}

/// Where photons arrived, on average.
struct Places {
    photons: u64,
    mean_m: [f64; 2],
    variance_m2: [f64; 2],
}

impl Places {
    fn of<'a>(spot: &Spot, counts: impl Iterator<Item = &'a SpotCount>) -> Self {
        let (mut photons, mut first, mut second) = (0, [0u128; 2], [0u128; 2]);
        for count in counts {
            photons += count.photons;
            for i in 0..2 {
                first[i] += count.first[i];
                second[i] += count.second[i];
            }
        }
        let unit_m = spot.size_m.map(|side| side / (1u64 << PLACE_BITS) as f64);
        let of = [0, 1].map(|i| moments(photons, first[i], second[i]));
        Self {
            photons,
            mean_m: [0, 1].map(|i| of[i].0 * unit_m[i]),
            variance_m2: [0, 1].map(|i| of[i].1 * unit_m[i] * unit_m[i]),
        }
    }

    fn radius_m(&self) -> f64 {
        (self.variance_m2[0] + self.variance_m2[1]).sqrt()
    }
}

/// Mean, with the half unit that a place stands for, and variance of whole numbers below 2^32, from their sum and that of
/// their squares. Squares are taken about the whole part of the mean, in integers: nothing cancels.
fn moments(count: u64, first: u128, second: u128) -> (f64, f64) {
    if count == 0 {
        return (0.0, 0.0);
    }
    let n = u128::from(count);
    let (whole, rest) = (first / n, first % n);
    // sum (x - m)^2 = sum x^2 - m (sum x + rest), as n m = sum x - rest; each term is below 2^128.
    let about = second.saturating_sub(whole * (first + rest));
    let part = rest as f64 / n as f64;
    (whole as f64 + part + 0.5, (about as f64 / n as f64 - part * part).max(0.0))
}

/// Fine cells with light in them.
struct Lit<'a> {
    spot: &'a Spot,
    replicates: &'a [SpotCount],
    /// Which, and the photons of all replicates.
    cells: Vec<(usize, u64)>,
}

impl<'a> Lit<'a> {
    fn of(spot: &'a Spot, replicates: &'a [SpotCount]) -> Self {
        let sum = |cell: usize| (cell, replicates.iter().map(|count| count.cells[cell]).sum());
        let cells = (0..spot.cells()).into_par_iter().map(sum).filter(|(_, sum)| *sum > 0).collect();
        Self { spot, replicates, cells }
    }

    /// All about a centre, or all without one replicate.
    fn rings(&self, centre_m: [f64; 2], without: Option<usize>) -> Rings {
        let [width, height] = self.spot.cell_m();
        let nu = self.spot.nu as usize;
        let middle = |cell: usize| [width * ((cell % nu) as f64 + 0.5), height * ((cell / nu) as f64 + 0.5)];
        let left_out = |cell: usize| without.map_or(0, |r| self.replicates[r].cells[cell]);
        let lit = self.cells.iter().map(|&(cell, sum)| (middle(cell), sum - left_out(cell)));
        Rings::new([width, height], centre_m, lit.filter(|(_, photons)| *photons > 0))
    }

    fn edge_share(&self, photons: u64) -> f64 {
        let nu = self.spot.nu as usize;
        let is_edge = |at: usize, n: u32| {
            let strip = ((EDGE * f64::from(n)).round() as usize).max(1);
            at < strip || at + strip >= n as usize
        };
        let is_at_edge = |cell: usize| is_edge(cell % nu, self.spot.nu) || is_edge(cell / nu, self.spot.nv);
        let edge: u64 = self.cells.iter().filter(|(cell, _)| is_at_edge(*cell)).map(|(_, sum)| sum).sum();
        edge as f64 / photons as f64
    }
}

/// Encircled flux of all photons, and without each replicate.
struct Curve<'a> {
    lit: &'a Lit<'a>,
    rings: &'a Rings,
    without: &'a [Places],
}

impl Curve<'_> {
    /// Standard errors of the shares within these radii, each about the centroid of its own photons. Where some photons are
    /// in and some are out, a share is never surer than one photon.
    fn errors(&self, radii: &[f64]) -> Option<Vec<f64>> {
        let share = |rings: &Rings| -> Vec<f64> {
            radii.par_iter().map(|radius| rings.share(*radius, Across::ByArea)).collect()
        };
        let each: Vec<Vec<f64>> = (self.without.iter().enumerate())
            .map(|(r, places)| share(&self.lit.rings(places.mean_m, Some(r))))
            .collect();
        let error = |i: usize| {
            let shares: Vec<f64> = each.iter().map(|shares| shares[i]).collect();
            let is_open = shares.iter().any(|share| *share > 0.0 && *share < 1.0);
            let least = if is_open { 1.0 / self.rings.photons() as f64 } else { 0.0 };
            jackknife_error(&shares).max(least)
        };
        (!each.is_empty()).then(|| (0..radii.len()).map(error).collect())
    }

    /// Diameters of both shares: the error of the share within the radius found, carried to the radius by the curve itself, so
    /// that an interval ends where the curve reaches the ends of that of the share (Woodruff 1952).
    fn diameters(&self) -> [Diameter; 2] {
        let radii = SHARES.map(|share| self.rings.radius(share, Across::ByArea));
        let errors = self.errors(&radii);
        [0, 1].map(|i| {
            let share = SHARES[i];
            let diameter = |share: f64, across| 2.0 * self.rings.radius(share.clamp(0.0, 1.0), across);
            let error = errors.as_ref().map(|errors| errors[i]);
            let t = student((self.without.len() as u32).saturating_sub(1));
            let half =
                |e: f64| 0.5 * (diameter(share + e, Across::ByArea) - diameter(share - e, Across::ByArea));
            // A place is rounded to its unit, and so is the centre.
            let unit_m = self.lit.spot.size_m.map(|side| side / (1u64 << PLACE_BITS) as f64);
            let rounding = 2.0 * libm::hypot(unit_m[0], unit_m[1]);
            let low = |e: f64| (diameter(share - e, Across::In) - rounding).max(0.0);
            let high = |e: f64| diameter(share + e, Across::Out) + rounding;
            Diameter {
                value: 2.0 * radii[i],
                standard_error: error.map(half),
                low: error.map(|e| low(t * e)),
                high: error.map(|e| high(t * e)),
                by_cells: [low(0.0), high(0.0)],
            }
        })
    }

    fn points(&self) -> Vec<Encircled> {
        let outermost = self.rings.outermost();
        let near = (2.0 * self.rings.radius(SHARES[1], Across::ByArea)).min(outermost);
        let even = |end: f64| (0..=RADII).map(move |i| end * i as f64 / RADII as f64);
        let mut radii: Vec<f64> = even(near).chain(even(outermost)).collect();
        radii.sort_by(f64::total_cmp);
        radii.dedup();
        let errors = self.errors(&radii);
        let point = |(i, &radius_m): (usize, &f64)| Encircled {
            radius_m,
            share: Figure {
                value: self.rings.share(radius_m, Across::ByArea),
                standard_error: errors.as_ref().map(|errors| errors[i]),
            },
            by_cells: [Across::Out, Across::In].map(|across| self.rings.share(radius_m, across)),
        };
        radii.par_iter().enumerate().map(point).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::spot::tests::spot;

    #[test]
    fn moments_are_exact_where_squares_would_cancel() {
        // x = a and a + 2, as often, near the far edge: mean a + 1, variance 1. Sums of f64 would lose it.
        let (a, n) = ((1u128 << 32) - 3, 1u128 << 60);
        let (first, second) = (n * (2 * a + 2), n * (a * a + (a + 2) * (a + 2)));
        let (mean, variance) = moments(2 << 60, first, second);
        assert_eq!((mean, variance), ((a + 1) as f64 + 0.5, 1.0));
        // 1, 2, 2: mean 5 / 3, variance 2 / 9.
        let (mean, variance) = moments(3, 5, 9);
        assert!((mean - 5.0 / 3.0 - 0.5).abs() < 1e-15 && (variance - 2.0 / 9.0).abs() < 1e-15);
    }

    #[test]
    fn few_photons_are_refused_and_one_replicate_has_no_errors() {
        let spot = spot([1.0, 1.0], None).unwrap();
        let count = |photons: u64| {
            let mut cells = vec![0; spot.cells()];
            cells[5 * 1024 + 7] = photons;
            let place = |cell: u128| u128::from(photons) * (cell << 22 | 1 << 21);
            let second = |cell: u128| u128::from(photons) * (cell << 22 | 1 << 21) * (cell << 22 | 1 << 21);
            SpotCount { cells, photons, first: [place(7), place(5)], second: [second(7), second(5)] }
        };
        assert_eq!(figures(&spot, &[]).unwrap_err(), TooFew { photons: 0 });
        assert_eq!(figures(&spot, &[count(60), count(39)]).unwrap_err(), TooFew { photons: 99 });
        // All in the middle of one cell: the place is known, the diameter is anything up to the cell's and roundings of 2^-32.
        for replicates in [vec![count(100)], vec![count(100), count(0)], vec![count(70), count(80)]] {
            let of = figures(&spot, &replicates).unwrap();
            let is_known = replicates.len() == 2 && replicates[1].photons > 0;
            assert!((of.centroid_m[0].value - 7.5 / 1024.0).abs() < 1e-9 && of.rms_radius_m.value == 0.0);
            for figure in of.centroid_m.iter().chain(&of.rms_m).chain([&of.rms_radius_m]) {
                assert_eq!(figure.standard_error.is_some_and(|e| e > 0.0 && e < 1e-9), is_known);
            }
            let cell = 1.0 / 1024.0;
            for d in of.diameters_m {
                assert_eq!(d.by_cells[0], 0.0);
                assert!((d.by_cells[1] / cell - std::f64::consts::SQRT_2).abs() < 2e-6, "{d:?}");
                assert_eq!((d.low, d.high.is_some()), (is_known.then_some(0.0), is_known));
            }
            assert_eq!(of.edge_share, 1.0);
            assert!(of.encircled.iter().all(|p| p.share.value.is_finite() && p.by_cells[0] <= p.by_cells[1]));
            assert_eq!(of.encircled.last().unwrap().share.value, 1.0);
        }
    }
}
