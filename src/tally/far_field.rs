//! Far fields: what leaves in a direction, scored on the nodes around it with bilinear weights (METHOD 8).
//!
//! A photon is so many units, of which each node gets a whole number: sums do not depend on the order, and those of all nodes
//! are the photons, exactly.

use glam::DVec3;

use crate::geometry::SurfaceId;
use crate::scene::far_field::FarField;

use super::counts::Counts;

/// Most bits of a photon: a score is rounded by at most 2^-25 of it.
const MOST_BITS: u32 = 24;
/// Bits that are kept for the photons of a replicate, and for those that come out of a surface several times.
const SPARE_BITS: u32 = 60;

/// The sums of one replicate.
#[derive(Debug)]
pub struct FarFields<'s> {
    fields: &'s [FarField],
    nodes: Vec<Counts>,
    /// Photons outside the nodes of each.
    outside: Counts,
    /// Photons that each saw, in or outside.
    seen: Counts,
    one: u64,
}

impl<'s> FarFields<'s> {
    /// Zeros, for replicates of this many photons.
    pub(super) fn new(fields: &'s [FarField], photons: u64) -> Self {
        let [outside, seen] = [0; 2].map(|_| Counts::new(fields.len()));
        let nodes = fields.iter().map(|field| Counts::new(field.nodes.count())).collect();
        Self { fields, nodes, outside, seen, one: units_of_a_photon(photons) }
    }

    #[inline]
    pub(super) fn emerge(&self, surface: SurfaceId, direction: DVec3) {
        self.add_where(|field| field.surface == Some(surface), direction);
    }

    #[inline]
    pub(super) fn escape(&self, direction: DVec3) {
        self.add_where(|field| field.surface.is_none(), direction);
    }

    #[inline]
    fn add_where(&self, is_concerned: impl Fn(&FarField) -> bool, direction: DVec3) {
        let concerned = self.fields.iter().enumerate().filter(|(_, field)| is_concerned(field));
        for (i, field) in concerned {
            self.seen.add(i, 1);
            match field.weights(direction, self.one) {
                None => self.outside.add(i, 1),
                Some(weights) => {
                    for (node, units) in weights.into_iter().filter(|(_, units)| *units > 0) {
                        self.nodes[i].add(node, units);
                    }
                }
            }
        }
    }

    /// Units on the nodes of a far field.
    pub fn nodes(&self, field: usize) -> &Counts {
        &self.nodes[field]
    }

    /// Photons outside the nodes of each far field.
    pub fn outside(&self) -> &Counts {
        &self.outside
    }

    /// Photons that each far field saw, in and outside its nodes.
    pub fn seen(&self) -> &Counts {
        &self.seen
    }

    /// All of its counters, in a fixed order.
    pub(super) fn counts(&self) -> impl Iterator<Item = &Counts> {
        self.nodes.iter().chain([&self.outside, &self.seen])
    }

    /// Units of a photon.
    pub fn units_of_a_photon(&self) -> u64 {
        self.one
    }

    /// Zeros again.
    pub(super) fn clear(&mut self) {
        self.outside.clear();
        self.seen.clear();
        self.nodes.iter_mut().for_each(Counts::clear);
    }
}

/// Units of a photon, of replicates of so many.
pub fn units_of_a_photon(photons: u64) -> u64 {
    let bits = u64::BITS - photons.leading_zeros();
    1 << SPARE_BITS.saturating_sub(bits).min(MOST_BITS)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_leave_room_for_every_photon() {
        assert_eq!(units_of_a_photon(1 << 20), 1 << 24);
        for photons in [1u64, 1 << 35, 1 << 36, (1 << 48) - 1, 1 << 48] {
            assert!(
                u128::from(photons) * u128::from(units_of_a_photon(photons)) <= 1 << SPARE_BITS,
                "{photons}"
            );
        }
        assert_eq!(units_of_a_photon(1 << 48), 1 << 11);
    }
}
