//! From sums on the nodes of a far field to luminous intensities and their errors (METHOD 8).
//!
//! The sums b of a replicate are integrals of the intensity times hats; its values solve M c = b. Both are linear, so a
//! replicate's values are an unbiased estimate of the table nearest to the light (least squares over the sphere), and their
//! spread over replicates is the standard error.

mod levels;
mod mass;
mod solve;

use std::io::{self, Read, Write};

use rayon::prelude::*;

use crate::math::varint::{put, take, take_up_to};
use crate::photometry::web::Symmetry;
use crate::scene::far_field::FarField;
use crate::scene::nodes::Nodes;
use crate::tally::far_field::units_of_a_photon;

use super::replicates::{FEWEST_HITS, standard_error_of_total};
use levels::{averaged, widened};
use mass::Mass;
use solve::{dot, solve, solve_positive};

/// What the replicates of a run counted of a far field.
#[derive(Debug, Clone, Default)]
pub struct Sums {
    /// Units on each node, by replicate.
    pub nodes: Vec<Vec<u64>>,
    /// Photons outside the nodes, by replicate.
    pub outside: Vec<u64>,
    /// Photons in and outside them, by replicate.
    pub seen: Vec<u64>,
    /// Units of a photon.
    pub one: u64,
}

impl Sums {
    /// None yet, of replicates of this many photons.
    pub fn of_photons(photons: u64) -> Self {
        Self { one: units_of_a_photon(photons), ..Self::default() }
    }

    /// Takes in a finished replicate.
    pub fn absorb(&mut self, nodes: Vec<u64>, outside: u64, seen: u64) {
        self.nodes.push(nodes);
        self.outside.push(outside);
        self.seen.push(seen);
    }

    /// Writes them.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [self.nodes.len() as u64])?;
        for ((nodes, outside), seen) in self.nodes.iter().zip(&self.outside).zip(&self.seen) {
            put(out, [*outside, *seen])?;
            put(out, nodes.iter().copied())?;
        }
        Ok(())
    }

    /// Takes those that were written, of so many replicates at most, with so many nodes.
    ///
    /// # Errors
    /// Those of the reader; more replicates.
    pub fn read(&mut self, from: &mut dyn Read, replicates: u32, nodes: usize) -> io::Result<()> {
        self.clear();
        for _ in 0..take_up_to(from, replicates.into(), "replicates of a far field")? {
            let (outside, seen) = (take(from)?, take(from)?);
            let nodes = (0..nodes).map(|_| take(from)).collect::<io::Result<_>>()?;
            self.absorb(nodes, outside, seen);
        }
        Ok(())
    }

    /// None again.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.outside.clear();
        self.seen.clear();
    }
}

/// A table and its errors.
#[derive(Debug, Clone)]
pub struct Table {
    /// Its angles.
    pub nodes: Nodes,
    /// Intensities, cd, `[gamma * planes + C]`, those of a pole in every plane; none negative.
    pub candela: Vec<f64>,
    /// Their standard errors, cd; `None` for one replicate.
    pub standard_error_cd: Option<Vec<f64>>,
    /// What one photon more makes of each, cd.
    pub photon_cd: Vec<f64>,
    /// Nodes held at 0 that would be negative else.
    pub held: usize,
    /// The table of each replicate alone times the number of replicates, before that; empty for one replicate.
    pub replicates: Vec<Vec<f64>>,
    /// Of its norm: what noise leaves unknown (root mean square over the sphere); `None` for one replicate, and where the table
    /// is all noise.
    pub noise: Option<f64>,
    /// Of its norm: what a table of half the steps follows and this one does not, noise taken off, and its standard error;
    /// likewise.
    pub unresolved: Option<(f64, f64)>,
    /// Of its norm: what was not symmetric and has been averaged away, likewise; `None` where no symmetry was asked for,
    /// too.
    pub asymmetry: Option<(f64, f64)>,
}

/// The table of a far field, of photons of this flux (lm).
pub fn table(field: &FarField, sums: &Sums, photon_lm: f64) -> Table {
    let lm = photon_lm / sums.one as f64;
    let counted: Vec<Vec<f64>> =
        sums.nodes.iter().map(|nodes| nodes.iter().map(|units| lm * *units as f64).collect()).collect();
    let levels = Levels { field, counted: &counted };
    let steps = levels.chosen();
    let fit = levels.fit(steps, field.symmetry);
    let is_known = counted.len() > 1;
    let finer = levels.fit(steps.map(|doublings| doublings - 1), field.symmetry);
    // A table that is all noise has no norm to compare with.
    let norm = |fit: &Fit| Some(fit.energy()).filter(|energy| is_known && *energy > fit.noise());
    // Of a square root; where that is all noise, of the square itself.
    let beyond = |fit: &Fit, coarser: &Fit| {
        let (norm, (energy, error)) = (norm(fit)?, fit.energy_beyond(coarser));
        let size = (energy.max(0.0) / norm).sqrt();
        Some((
            size,
            if size * size * norm > error { error / norm / (2.0 * size) } else { (error / norm).sqrt() },
        ))
    };
    let unresolved = beyond(&finer, &fit);
    let asymmetry = match field.symmetry {
        Symmetry::None => None,
        _ => beyond(&levels.fit(steps, Symmetry::None), &fit),
    };
    let photon_cd = fit.photon_cd(photon_lm, field.symmetry);
    let (candela, held) = solve_positive(&fit.mass, &fit.b);
    Table {
        standard_error_cd: is_known.then(|| fit.standard_error(&photon_cd)),
        photon_cd,
        candela: fit.spread_over_poles(candela),
        held,
        replicates: if is_known { fit.each() } else { Vec::new() },
        noise: norm(&fit).map(|norm| (fit.noise() / norm).sqrt()),
        unresolved,
        asymmetry,
        nodes: fit.nodes,
    }
}

/// What was counted, on any of its nested grids.
struct Levels<'a> {
    field: &'a FarField,
    counted: &'a [Vec<f64>],
}

impl Levels<'_> {
    fn fit(&self, doublings: [u32; 2], symmetry: Symmetry) -> Fit {
        let nodes = self.field.nodes.thinned(doublings.map(|d| 1 << d));
        let mass = Mass::new(&nodes);
        let replicates: Vec<Replicate> = self
            .counted
            .par_iter()
            .map(|b| {
                let b = averaged(&nodes, &widened(&self.field.nodes, b, doublings).1, symmetry);
                let c = solve(&mass, &b);
                Replicate { energy: dot(&b, &c), b, c }
            })
            .collect();
        let sum = |of: fn(&Replicate) -> &Vec<f64>| {
            let mut sum = vec![0.0; mass.entries()];
            for replicate in &replicates {
                sum.iter_mut().zip(of(replicate)).for_each(|(sum, x)| *sum += x);
            }
            sum
        };
        let (b, c) = (sum(|r| &r.b), sum(|r| &r.c));
        let (whole, own) = (dot(&b, &c), replicates.iter().map(|r| r.energy).sum());
        Fit { nodes, mass, b, c, whole, own, replicates }
    }

    /// How often the steps are doubled: once where the scene gives them; else the widest steps of which half would show no
    /// more than noise does, each angle by itself.
    fn chosen(&self) -> [u32; 2] {
        let mut at = self.field.doublings;
        if self.counted.len() < 2 {
            return at;
        }
        loop {
            let here = self.fit(at, self.field.symmetry);
            let gains = |angle: usize| {
                if at[angle] == 1 {
                    return false;
                }
                let mut finer = at;
                finer[angle] -= 1;
                // What chance alone would show no more often than once in some hundreds.
                const ERRORS: f64 = 3.0;
                let (gain, error) = self.fit(finer, self.field.symmetry).energy_beyond(&here);
                gain > here.noise() && gain > ERRORS * error
            };
            let gains = [gains(0), gains(1)];
            if gains == [false; 2] {
                return at;
            }
            (0..2).filter(|angle| gains[*angle]).for_each(|angle| at[angle] -= 1);
        }
    }
}

/// The least-squares table of one grid.
struct Fit {
    nodes: Nodes,
    mass: Mass,
    /// Sums and values of all replicates together.
    b: Vec<f64>,
    c: Vec<f64>,
    /// The integral of the square of the table, and the sum of those of what each replicate adds.
    whole: f64,
    own: f64,
    /// Of each: what it adds to them.
    replicates: Vec<Replicate>,
}

/// What a replicate adds to the sums and values.
struct Replicate {
    b: Vec<f64>,
    c: Vec<f64>,
    /// The integral of the square of what it adds.
    energy: f64,
}

impl Fit {
    fn count(&self) -> f64 {
        self.replicates.len() as f64
    }

    /// The integral of the square of the table over the sphere, without what noise adds: the mean over pairs of different
    /// replicates of the product of their tables, which is unbiased.
    fn energy(&self) -> f64 {
        let r = self.count();
        r / (r - 1.0) * (self.whole - self.own)
    }

    /// What noise adds to it: the integral of the variance.
    fn noise(&self) -> f64 {
        let r = self.count();
        r / (r - 1.0) * (self.own - self.whole / r)
    }

    /// The energy that a coarser table leaves out, and its standard error: the jackknife over replicates.
    fn energy_beyond(&self, coarser: &Self) -> (f64, f64) {
        let without = |replicate: usize| {
            let of = |fit: &Self| {
                let r = fit.count() - 1.0;
                let one = &fit.replicates[replicate];
                let rest = fit.whole - 2.0 * dot(&one.b, &fit.c) + one.energy;
                let own = fit.own - one.energy;
                // Without one of R replicates the rest stand for (R - 1) / R of the light.
                let scale = (fit.count() / r) * (fit.count() / r);
                scale * r / (r - 1.0).max(1.0) * (rest - own)
            };
            of(self) - of(coarser)
        };
        let gain = self.energy() - coarser.energy();
        if self.replicates.len() < 3 {
            return (gain, self.noise());
        }
        let each: Vec<f64> = (0..self.replicates.len()).map(without).collect();
        (gain, jackknife_error(&each))
    }

    /// Spread of the replicates. A node with few hits, whose spread says little, has at least the error of (hits + 1), as
    /// a cell of a receiver has.
    fn standard_error(&self, photon_cd: &[f64]) -> Vec<f64> {
        let r = self.count();
        let solid = self.mass.solid_angles_sr();
        let of = |entry: usize| {
            let mean = self.c[entry] / r;
            let squares: f64 =
                self.replicates.iter().map(|one| (one.c[entry] - mean) * (one.c[entry] - mean)).sum();
            let spread = (r / (r - 1.0) * squares).sqrt();
            let hits = self.b[entry] / solid[entry] / photon_cd[entry];
            let fewest = if hits < FEWEST_HITS as f64 { (hits + 1.0).sqrt() * photon_cd[entry] } else { 0.0 };
            spread.max(fewest)
        };
        let all = (0..self.mass.entries()).map(|e| if self.mass.is_node(e) { of(e) } else { 0.0 }).collect();
        self.spread_over_poles(all)
    }

    /// What one photon more makes of each node's intensity, cd; an averaged node has those of all that are equal to it.
    fn photon_cd(&self, photon_lm: f64, symmetry: Symmetry) -> Vec<f64> {
        let planes = self.nodes.planes();
        let equal: Vec<f64> =
            (0..planes).map(|plane| levels::count_of_equals(&self.nodes, plane, symmetry)).collect();
        let of = |(entry, solid): (usize, f64)| match self.nodes.is_pole(entry / planes) {
            true => photon_lm / solid,
            false => photon_lm / (equal[entry % planes] * solid),
        };
        self.spread_over_poles(self.mass.solid_angles_sr().into_iter().enumerate().map(of).collect())
    }

    /// The tables of the replicates, each as if it were all.
    fn each(&self) -> Vec<Vec<f64>> {
        let r = self.count();
        let of = |one: &Replicate| self.spread_over_poles(one.c.iter().map(|c| r * c).collect());
        self.replicates.iter().map(of).collect()
    }

    /// A pole's value in every plane.
    fn spread_over_poles(&self, mut values: Vec<f64>) -> Vec<f64> {
        let planes = self.nodes.planes();
        for row in (0..self.nodes.gamma_deg.len()).filter(|row| self.nodes.is_pole(*row)) {
            let value = values[row * planes];
            values[row * planes..][..planes].fill(value);
        }
        values
    }
}

/// The standard error of a number from what it is without each replicate in turn (Quenouille and Tukey's jackknife).
pub fn jackknife_error(without_each: &[f64]) -> f64 {
    let r = without_each.len() as f64;
    let mean = without_each.iter().sum::<f64>() / r;
    let squares: f64 = without_each.iter().map(|x| (x - mean) * (x - mean)).sum();
    ((r - 1.0) / r * squares).sqrt()
}

impl Table {
    /// The greatest intensity, its standard error (cd) and where it is. Noise chooses the greatest of many values, too, so the
    /// first, third, ... replicate choose a node and the others value it, and the other way round; the mean of both is given.
    pub fn maximum(&self) -> (f64, Option<f64>, usize) {
        let greatest = |c: &[f64]| {
            // Planes that a symmetry makes equal are so but for rounding.
            (0..c.len()).fold(0, |best, i| if c[i] > c[best] + 1e-12 * c[best].abs() { i } else { best })
        };
        let Some(errors) = &self.standard_error_cd else {
            let at = greatest(&self.candela);
            return (self.candela[at], None, at);
        };
        let halves = [0, 1].map(|first| {
            let half: Vec<_> = self.replicates.iter().skip(first).step_by(2).collect();
            let mean = |i: usize| half.iter().map(|c| c[i]).sum::<f64>() / half.len() as f64;
            (0..self.candela.len()).map(mean).collect::<Vec<f64>>()
        });
        // Nodes of which little is known are not chosen for it. How little is taken from the half that chooses, where a photon
        // stands for two: from the spread of both, nodes at which they agree would be chosen.
        let surely = |c: &[f64], photons: f64| {
            let less =
                |(c, one): (&f64, &f64)| c - 2.0 * (photons * one * (c.max(0.0) + photons * one)).sqrt();
            greatest(&c.iter().zip(&self.photon_cd).map(less).collect::<Vec<f64>>())
        };
        let [a, b] = [surely(&halves[0], 2.0), surely(&halves[1], 2.0)];
        let at = surely(&self.candela, 1.0);
        let value = 0.5 * (halves[1][a] + halves[0][b]);
        (value.max(0.0), Some((0.5 * (errors[a] * errors[a] + errors[b] * errors[b])).sqrt()), at)
    }

    /// The table without each of the replicates in turn, negative values among it.
    pub fn without_each(&self) -> impl Iterator<Item = Vec<f64>> + '_ {
        let r = self.replicates.len() as f64;
        let entries = self.candela.len();
        let all: Vec<f64> = (0..entries).map(|i| self.replicates.iter().map(|c| c[i]).sum()).collect();
        self.replicates
            .iter()
            .map(move |one| all.iter().zip(one).map(|(all, one)| (all - one) / (r - 1.0)).collect())
    }
}

/// Photons in all replicates and their standard error: of those seen, or outside.
pub fn total(by_replicate: &[u64]) -> (u64, Option<f64>) {
    let sum = by_replicate.iter().sum();
    let square = by_replicate.iter().map(|n| u128::from(*n) * u128::from(*n)).sum();
    (sum, standard_error_of_total(sum, square, by_replicate.len() as u32))
}
