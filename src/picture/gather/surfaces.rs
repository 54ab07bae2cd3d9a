//! The photons of a map by surface and side, for searches of the nearest.
//!
//! Where a surface, or a side of it, has few photons, a search for some of them must not go through the many
//! of another.

use crate::picture::photon_map::{Photon, PhotonMap, by_distance};

use super::footprint::{Footprint, Footprints};

/// A map's photons by surface and side (back, front): a map for each; none for a side that has all, so that no photon
/// is copied.
#[derive(Debug)]
pub(crate) struct BySurface<const C: usize> {
    sides: Vec<[Option<PhotonMap<C>>; 2]>,
}

/// A photon found: squared distance (m2), the side it came from, its place in that side's map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Neighbour {
    pub d2: f64,
    front: bool,
    place: u32,
}

/// What a gather works with, kept so that it need not be allocated again.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Room {
    /// Kernel heights (1/m2) at both bandwidths by replicate.
    pub heights: Vec<[f64; 2]>,
    /// Neighbours found on one side, and all.
    pub found: Vec<(f64, u32)>,
    pub neighbours: Vec<Neighbour>,
}

impl Neighbour {
    /// Distance, then place, then side.
    fn order(&self) -> (u128, bool) {
        (by_distance(&(self.d2, self.place)), self.front)
    }
}

impl<const C: usize> BySurface<C> {
    /// Those of every side sorted for at least this radius (m), and for no less than their number suggests.
    pub fn new(footprints: &Footprints<'_>, map: &PhotonMap<C>, radius_m: f64) -> Self {
        let group = |photon: &Photon<C>| {
            let (surface, _) = footprints.surface_of(photon.primitive)?;
            Some(2 * surface + usize::from(photon.is_front()))
        };
        // Counted first: vectors that grow would take three times the photons for a while.
        let mut number = vec![0; 2 * footprints.geometry().surfaces().len()];
        for group in map.photons().iter().filter_map(group) {
            number[group] += 1;
        }
        let total = map.photons().len();
        let split = number.iter().all(|n| *n < total);
        let room = |n: &usize| Vec::with_capacity(if split { *n } else { 0 });
        let mut photons: Vec<Vec<_>> = number.iter().map(room).collect();
        if split {
            for photon in map.photons() {
                if let Some(group) = group(photon) {
                    photons[group].push(*photon);
                }
            }
        }
        let sorted = |photons: Vec<Photon<C>>| {
            let guessed = PhotonMap::build(photons, *map.frame(), 0.0);
            if guessed.built_for_m() < radius_m { guessed.rebuilt(radius_m) } else { guessed }
        };
        let mut side =
            photons.into_iter().zip(number).map(|(photons, n)| (n != total).then(|| sorted(photons)));
        Self { sides: std::iter::from_fn(|| Some([side.next()?, side.next()?])).collect() }
    }

    /// The photons of a side of a surface of this map.
    fn side<'s>(&'s self, map: &'s PhotonMap<C>, surface: usize, front: bool) -> &'s PhotonMap<C> {
        self.sides.get(surface).and_then(|sides| sides[usize::from(front)].as_ref()).unwrap_or(map)
    }

    /// A photon that was found on a surface of this map.
    #[inline]
    pub fn photon<'s>(&'s self, map: &'s PhotonMap<C>, surface: usize, found: &Neighbour) -> &'s Photon<C> {
        &self.side(map, surface, found.front).photons()[found.place as usize]
    }

    /// Of the photons in a footprint on a surface, of one side or (`None`) of both, those wanted, the nearest
    /// first.
    pub fn nearest(
        &self,
        map: &PhotonMap<C>,
        (surface, side): (usize, Option<bool>),
        footprint: &Footprint<'_>,
        wanted: Wanted,
        room: &mut Room,
    ) {
        let Room { found, neighbours, .. } = room;
        neighbours.clear();
        for front in [false, true].into_iter().filter(|front| side.is_none_or(|side| side == *front)) {
            let map = self.side(map, surface, front);
            // Where there are no more, no search for more.
            let k = wanted.number.min(map.photons().len());
            let holds = |p: &Photon<C>| footprint.holds(p.primitive, || map.position(p));
            map.nearest(footprint.centre(), k, wanted.first_m(map), holds, found);
            neighbours.extend(found.iter().map(|&(d2, place)| Neighbour { d2, front, place }));
        }
        neighbours.sort_unstable_by_key(Neighbour::order);
        neighbours.truncate(wanted.number);
    }
}

/// How many neighbours are wanted, and how far they may be: what is found does not depend on that.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Wanted {
    /// All where there are no more.
    pub number: usize,
    /// A guess, m; 0: what the photons' number suggests.
    pub guess_m: f64,
    /// Where those about the last point were found, m; 0 where there was none.
    pub sought_m: f64,
}

impl Wanted {
    /// The radius that a search begins with, m: a little more than the last time, pixels being neighbours;
    /// never so much that a dense place is read in vain.
    fn first_m<const C: usize>(&self, map: &PhotonMap<C>) -> f64 {
        let guess_m = if self.guess_m > 0.0 { self.guess_m } else { map.built_for_m() };
        if self.sought_m > 0.0 { (1.1 * self.sought_m).min(2.0 * guess_m) } else { guess_m }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::geometry::{Geometry, Rectangle, Shape, Surface};
    use crate::picture::photon_map::Frame;
    use crate::picture::photon_map::record::FRONT;

    fn sheets() -> Geometry {
        let sheet = |z: f64| {
            let shape = Shape::Rectangle(Rectangle::new(DVec3::Z * z, DVec3::X, DVec3::Y).unwrap());
            Surface { name: format!("at {z}"), shape }
        };
        Geometry::build(vec![sheet(0.0), sheet(1.0)]).unwrap()
    }

    /// Photons in a row on a primitive.
    fn row(n: u32, primitive: u32, tag: u32) -> Vec<Photon<1>> {
        let cell = |i: u32| [i << 16, i << 15, if primitive < 2 { 0 } else { u32::MAX }];
        (0..n).map(|i| Photon { cell: cell(i), direction: 0, primitive, tag, weight: [1.0] }).collect()
    }

    #[test]
    fn a_search_reads_the_photons_of_its_side_of_its_surface_alone() {
        let geometry = sheets();
        let footprints = Footprints::new(&geometry);
        let photons = [row(5, 0, FRONT), row(1000, 1, 0), row(300, 2, FRONT), row(20, 3, FRONT)].concat();
        let (low, high) = geometry.bounds();
        let map = PhotonMap::build(photons, Frame::new(low, high), 0.0);
        for radius_m in [0.0, 0.5] {
            let sorted = BySurface::new(&footprints, &map, radius_m);
            let number = |surface, front| sorted.side(&map, surface, front).photons().len();
            assert_eq!([number(0, true), number(0, false)], [5, 1000]);
            assert_eq!([number(1, true), number(1, false)], [320, 0]);
            let side = sorted.side(&map, 0, true);
            assert!(side.photons().iter().all(|p| p.primitive == 0 && p.is_front()));
            assert!(side.built_for_m() >= radius_m);
        }
    }

    #[test]
    fn nothing_is_copied_where_one_side_of_one_surface_has_all() {
        let geometry = sheets();
        let footprints = Footprints::new(&geometry);
        let (low, high) = geometry.bounds();
        let map = PhotonMap::build([row(7, 2, 0), row(9, 3, 0)].concat(), Frame::new(low, high), 0.0);
        let sorted = BySurface::new(&footprints, &map, 0.5);
        assert!(std::ptr::eq(sorted.side(&map, 1, false), &map));
        for (surface, front) in [(0, false), (0, true), (1, true)] {
            assert!(sorted.side(&map, surface, front).photons().is_empty());
        }
    }
}
