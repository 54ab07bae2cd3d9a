//! Photons kept where they arrived: what density estimation and the camera read.
//!
//! A photon is kept at each arrival on a surface that scatters (Lambertian or tabulated) except the first
//! when no event preceded it: that light is direct, and the camera finds it by shadow rays.
//!
//! The structure is the order of the photons itself: rows of cells, sorted along the row, so that a search
//! reads a few runs of neighbours, found by bisection. It holds nothing but the photons (28 bytes of one
//! channel, 36 of three) and a guide of 12 bytes for every 64 of them. Empty cells cost nothing, so neither
//! stray photons far away nor a radius that is small against the scene do; a search for another radius than
//! the map was built for gives the same answer, slower.

mod saved;
mod order;
pub mod record;
pub mod sink;

use glam::DVec3;
use rayon::prelude::*;

use order::{Key, Order};
pub use record::{Frame, Photon};
pub use saved::SavedMap;
pub use sink::{Channels, Kept, PhotonStore};

/// Photons for which the guide has one entry.
const BLOCK: usize = 64;

/// Neighbours that cells are made for where no radius is known.
const GUESSED_NEIGHBOURS: f64 = 64.0;

/// Photons that can be asked for by place. `C` channels: 1 or 3.
#[derive(Debug, Clone)]
pub struct PhotonMap<const C: usize> {
    photons: Vec<Photon<C>>,
    frame: Frame,
    order: Order,
    /// The key of every [`BLOCK`]th photon: cells and integers along the row.
    guide: (Vec<u64>, Vec<u32>),
    built_for_m: f64,
}

impl<const C: usize> PhotonMap<C> {
    /// Sorts photons for searches of about this radius (m); one that is not positive: for a guess from the
    /// number of photons and their bounds. The same bits for any order of `photons` and any number of
    /// threads.
    pub fn build(mut photons: Vec<Photon<C>>, frame: Frame, radius_m: f64) -> Self {
        photons.shrink_to_fit();
        let built_for_m = if radius_m > 0.0 { radius_m } else { guessed_radius(&photons, &frame) };
        let order = Order::new(&photons, &frame, built_for_m);
        order.sort(&mut photons);
        let keys: Vec<Key> = photons.par_iter().step_by(BLOCK).map(|p| order.key(p.cell)).collect();
        let guide = keys.iter().map(|k| (k.cell, k.run)).unzip();
        Self { photons, frame, order, guide, built_for_m }
    }

    /// The same photons sorted for another radius, m.
    #[must_use]
    pub fn rebuilt(self, radius_m: f64) -> Self {
        Self::build(self.photons, self.frame, radius_m)
    }

    /// All photons, in the map's order.
    pub fn photons(&self) -> &[Photon<C>] {
        &self.photons
    }

    /// What positions are counted in.
    pub fn frame(&self) -> &Frame {
        &self.frame
    }

    /// The radius that its cells were made for, m.
    pub fn built_for_m(&self) -> f64 {
        self.built_for_m
    }

    /// Where a photon lies.
    #[inline]
    pub fn position(&self, photon: &Photon<C>) -> DVec3 {
        self.frame.position(photon.cell)
    }

    /// Calls `take(photon, squared distance)` for every photon nearer than `radius_m` to `centre`, in the
    /// map's order.
    #[inline]
    pub fn within(&self, centre: DVec3, radius_m: f64, mut take: impl FnMut(&Photon<C>, f64)) {
        self.visit(centre, radius_m, |_, photon, d2| {
            take(photon, d2);
            true
        });
    }

    /// Whether `accept` takes so many photons nearer than `radius_m` to `centre`. No more are looked at than
    /// that takes.
    #[inline]
    pub fn has_within(
        &self,
        centre: DVec3,
        radius_m: f64,
        least: usize,
        mut accept: impl FnMut(&Photon<C>) -> bool,
    ) -> bool {
        let mut number = 0;
        self.visit(centre, radius_m, |_, photon, _| {
            number += usize::from(accept(photon));
            number < least
        });
        number >= least
    }

    /// Calls `take(place, photon, squared distance)` in the map's order until it gives false.
    #[inline]
    fn visit(&self, centre: DVec3, radius_m: f64, mut take: impl FnMut(usize, &Photon<C>, f64) -> bool) {
        let r2 = radius_m * radius_m;
        let order = self.order;
        let (low, high) = self.frame.cells_about(centre, radius_m);
        let (first_row, last_row) = (order.row_of(low[order.row]), order.row_of(high[order.row]));
        let last_slab = order.slab_of(high[order.slab]);
        let (first_run, last_run) = (low[order.run], high[order.run]);
        let start = |slab: u32| Key { cell: order.pack(slab, first_row), run: first_run };
        let mut target = start(order.slab_of(low[order.slab]));
        let mut at = 0;
        loop {
            at = self.lower_bound(at, target);
            let Some(photon) = self.photons.get(at) else { return };
            let found = order.key(photon.cell);
            let (slab, row) = ((found.cell >> 32) as u32, found.cell as u32);
            if slab > last_slab {
                return;
            }
            // The next photon may be in a row that the ball does not reach: on to the first that it can.
            target = if row < first_row {
                start(slab)
            } else if row > last_row {
                if slab == last_slab {
                    return;
                }
                start(slab + 1)
            } else if found.run < first_run {
                Key { cell: found.cell, run: first_run }
            } else {
                for photon in &self.photons[at..] {
                    let key = order.key(photon.cell);
                    if key.cell != found.cell || key.run > last_run {
                        break;
                    }
                    let d2 = (self.frame.position(photon.cell) - centre).length_squared();
                    if d2 < r2 && !take(at, photon, d2) {
                        return;
                    }
                    at += 1;
                }
                if row == last_row {
                    if slab == last_slab {
                        return;
                    }
                    start(slab + 1)
                } else {
                    Key { cell: found.cell + 1, run: first_run }
                }
            };
        }
    }

    /// Of the photons that `accept` takes, the `k` nearest (all, where there are no more than `k`): squared
    /// distance (m2) and place in [`PhotonMap::photons`]; the last is the farthest, the others stand in no
    /// order. The search begins within `guess_m` and doubles until there are enough or all have been seen.
    pub fn nearest(
        &self,
        centre: DVec3,
        k: usize,
        guess_m: f64,
        mut accept: impl FnMut(&Photon<C>) -> bool,
        found: &mut Vec<(f64, u32)>,
    ) {
        found.clear();
        if k == 0 || self.photons.is_empty() {
            return;
        }
        let farthest = self.frame.farthest_m(centre);
        // All in one place, in a scene without extent: any radius finds them.
        let starts = [guess_m, self.built_for_m, farthest / 1024.0];
        let mut radius = starts.into_iter().find(|r| *r > 0.0).unwrap_or(1.0);
        loop {
            found.clear();
            self.visit(centre, radius, |place, photon, d2| {
                if accept(photon) {
                    found.push((d2, place as u32));
                }
                true
            });
            if found.len() >= k || radius > farthest {
                break;
            }
            radius *= 2.0;
        }
        if !found.is_empty() {
            let last = k.min(found.len()) - 1;
            found.select_nth_unstable_by_key(last, by_distance);
            found.truncate(last + 1);
        }
    }

    /// The first photon from place `from` on that does not stand before `key`.
    #[inline]
    fn lower_bound(&self, from: usize, key: Key) -> usize {
        let (cells, runs) = &self.guide;
        let mut low = from / BLOCK;
        // Blocks whose first photon stands before the key: double steps, since the next row is near.
        let before = |block: usize| Key { cell: cells[block], run: runs[block] } < key;
        let mut step = 1;
        while low + step < cells.len() && before(low + step) {
            low += step;
            step *= 2;
        }
        let mut size = step.min(cells.len().saturating_sub(low));
        while size > 1 {
            let half = size / 2;
            if before(low + half) {
                low += half;
            }
            size -= half;
        }
        let begin = (low * BLOCK).max(from);
        let end = ((low + 1) * BLOCK).min(self.photons.len()).max(begin);
        begin + self.photons[begin..end].partition_point(|p| self.order.key(p.cell) < key)
    }
}

/// Distance, then place, as one integer: squares are not negative, and bits of such numbers stand in their
/// order.
#[inline(always)]
pub fn by_distance(&(d2, place): &(f64, u32)) -> u128 {
    u128::from(d2.to_bits()) << 32 | u128::from(place)
}

/// A radius that holds some tens of photons if they lie evenly on the largest face of their bounds.
fn guessed_radius<const C: usize>(photons: &[Photon<C>], frame: &Frame) -> f64 {
    let mut length = order::lengths_m(photons, frame);
    length.sort_by(f64::total_cmp);
    let area = length[2] * length[1].max(length[2] / 64.0);
    (GUESSED_NEIGHBOURS * area / (std::f64::consts::PI * photons.len().max(1) as f64)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bytes_of<const C: usize>(n: u32) -> usize {
        let frame = Frame::new(DVec3::ZERO, DVec3::ONE);
        let photon = |i: u32| {
            let cell = [i.wrapping_mul(2_654_435_769), i.wrapping_mul(40_503 << 13), 0];
            Photon { cell, direction: 0, primitive: 0, tag: 0, weight: [1.0; C] }
        };
        let PhotonMap { photons, guide, .. } = PhotonMap::build((0..n).map(photon).collect(), frame, 0.01);
        photons.capacity() * size_of::<Photon<C>>() + guide.0.capacity() * 8 + guide.1.capacity() * 4
    }

    #[test]
    fn a_map_takes_no_more_than_forty_bytes_a_photon() {
        let n = 200_000;
        assert!(bytes_of::<1>(n) <= 29 * n as usize && bytes_of::<3>(n) <= 37 * n as usize);
        assert_eq!((size_of::<Photon<1>>(), size_of::<Photon<3>>()), (28, 36));
        assert_eq!(bytes_of::<1>(0), 0);
    }
}
