//! Density estimation: luminance from the photons about a point, with its spread over replicates and its
//! bias.
//!
//! The luminance towards the eye is the sum over photons near of f(wi, wo) w photon_lm K(d), f the surface's
//! BSDF, w the photon's weight and K a kernel of integral 1 over the part of the surface within the ball
//! ([`crate::picture::gather::footprint`]). Photons arriving are flux per area already, so no cosine appears
//! (H. W. Jensen, Global Illumination Using Photon Maps, 1996).
//!
//! This is the entry: photons are added up in `sum`, errors made in `error`.

use std::sync::Arc;

use glam::DVec3;

use crate::geometry::Hit;
use crate::picture::photon_map::PhotonMap;
use crate::scene::camera::{Bandwidth, Kernel};

use super::footprint::Footprints;
use super::gathered::Gathered;
use super::sum::Point;
use super::surfaces::BySurface;
use super::{SECOND, bandwidth};

/// Progressive radii shrink so that r_(i+1)^2 / r_i^2 = (i + alpha) / (i + 1) (C. Knaus, M. Zwicker:
/// Progressive Photon Mapping: A Probabilistic Approach, ACM TOG 30 (3), 2011).
pub const PROGRESSIVE_ALPHA: f64 = 2.0 / 3.0;

/// Radius that photons are sorted for where fewer lie within the bandwidth's than are wanted, in units of
/// this.
const COARSE: f64 = 16.0;

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

/// Which photons about a point count.
#[derive(Debug)]
enum Reach<const C: usize> {
    /// All within this radius (m) by replicate; one entry where it is the same for all.
    Radii(Vec<f64>),
    /// All within the radius (m), but this many nearest at least; of radius 0 so many.
    Nearest(f64, u32, BySurface<C>),
}

/// A photon map with a bandwidth.
#[derive(Debug)]
pub struct Density<'m, const C: usize> {
    footprints: Arc<Footprints<'m>>,
    map: &'m PhotonMap<C>,
    /// Flux of one photon, lm.
    photon_lm: f64,
    kernel: Kernel,
    reach: Reach<C>,
}

impl<'m, const C: usize> Density<'m, C> {
    /// A density of this map; `photon_lm` is the flux of one photon, lm. [`Bandwidth::Automatic`] is chosen
    /// from the map.
    pub fn new(
        footprints: Arc<Footprints<'m>>,
        map: &'m PhotonMap<C>,
        photon_lm: f64,
        choice: Choice,
    ) -> Self {
        let nearest = |radius_m: f64, neighbours| {
            Reach::Nearest(radius_m, neighbours, BySurface::new(&footprints, map, COARSE * radius_m))
        };
        let reach = match choice.bandwidth {
            Bandwidth::Radius(radius_m) => Reach::Radii(vec![radius_m]),
            Bandwidth::Progressive(radius_m) => Reach::Radii(progressive(radius_m, choice.replicates)),
            Bandwidth::AtLeast { radius_m, neighbours } => nearest(radius_m, neighbours),
            Bandwidth::Nearest(k) => nearest(0.0, k),
            Bandwidth::Automatic => {
                let chosen = bandwidth::choose(&footprints, map, choice.kernel, choice.replicates, 1.0);
                let bandwidth = chosen.bandwidth();
                return Self::new(footprints, map, photon_lm, Choice { bandwidth, ..choice });
            }
        };
        Self { footprints, map, photon_lm, kernel: choice.kernel, reach }
    }

    /// Adds the luminance at a point of a scattering surface, times `weight`. `value_of(direction of travel,
    /// arrived on the front)` is the surface's BSDF towards the eye, 1/sr; photons of both sides are offered,
    /// and those for which it is 0 tell nothing about an error. Where there are too few to tell one it is
    /// asked for light along the normal, too.
    pub fn gather(
        &self,
        at: &Hit,
        weight: [f64; C],
        value_of: impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) {
        self.gather_of(None, at, weight, value_of, into);
    }

    /// Adds the luminance at a point of a surface whose BSDF is 1 for all light that arrives on the side seen
    /// and 0 for other, times `weight`: photons of the other side do not count as neighbours. A pixel's
    /// samples lie close together against a wide radius: what was gathered for one, since `into` was last
    /// cleared, serves those within an eighth of the radius on the same side of the same surface.
    pub fn gather_evenly(&self, at: &Hit, weight: [f64; C], into: &mut Gathered<C>) {
        let evenly = |_, _| [1.0; C];
        let density = std::ptr::from_ref(self.map).addr();
        let mut places = std::mem::take(&mut into.places);
        if let Some(found) = places.near(density, at) {
            into.add_weighted(found, weight);
        } else if let Some(found) = places.remember(density, at, into.by_replicate.len()) {
            // One room for all places: what a search needs is many times what it finds.
            std::mem::swap(&mut into.room, &mut found.room);
            self.gather_of(Some(at.front), at, [1.0; C], evenly, found);
            std::mem::swap(&mut into.room, &mut found.room);
            into.add_weighted(found, weight);
        } else {
            self.gather_of(Some(at.front), at, weight, evenly, into);
        }
        into.places = places;
    }

    /// Photons of one side, or (`None`) of both.
    fn gather_of(
        &self,
        side: Option<bool>,
        at: &Hit,
        weight: [f64; C],
        value_of: impl FnMut(DVec3, bool) -> [f64; C],
        into: &mut Gathered<C>,
    ) {
        let mut point = Point {
            map: self.map,
            photon_lm: self.photon_lm,
            kernel: self.kernel,
            at,
            footprint: self.footprints.at(at),
            side,
            weight,
            value_of,
        };
        into.reach_m = self.narrowest_m();
        let area_m2 = || self.footprints.geometry().surfaces()[at.surface.0 as usize].shape.area();
        let found = match &self.reach {
            Reach::Radii(radii) => point.sum_within(radii, into),
            &Reach::Nearest(radius_m, least, _)
                if radius_m > 0.0 && point.holds_at_least(radius_m, least as usize) =>
            {
                point.sum_within(&[radius_m], into)
            }
            Reach::Nearest(radius_m, least, sorted) => {
                point.sum_nearest(sorted, (*least as usize, SECOND * radius_m), area_m2, into)
            }
        };
        point.owe(found, into);
    }

    /// The narrowest radius, m; 0 where that is a matter of the neighbours.
    fn narrowest_m(&self) -> f64 {
        match &self.reach {
            Reach::Radii(radii) => radii.iter().copied().fold(f64::INFINITY, f64::min),
            Reach::Nearest(radius_m, ..) => *radius_m,
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Geometry, Rectangle, Shape, Surface, Whereabouts};
    use crate::picture::photon_map::record::{FRONT, pack};
    use crate::picture::photon_map::{Frame, Photon};

    fn floor() -> Geometry {
        let shape = Shape::Rectangle(Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap());
        Geometry::build(vec![Surface { name: "floor".into(), shape }]).unwrap()
    }

    fn on_floor(geometry: &Geometry, x: f64) -> Hit {
        let from = DVec3::new(x, 0.5, 1.0);
        geometry.nearest(from, DVec3::NEG_Z, &Whereabouts::default(), &mut 0).unwrap()
    }

    /// A row of photons along x at y = 0.5, denser towards 1.
    fn row(geometry: &Geometry, n: u32) -> PhotonMap<1> {
        let (low, high) = geometry.bounds();
        let frame = Frame::new(low, high);
        let photon = |i: u32| {
            let x = ((f64::from(i) + 0.5) / f64::from(n)).sqrt();
            let cell = frame.cell(DVec3::new(x, 0.5, 0.0));
            Photon { cell, direction: pack(DVec3::NEG_Z), primitive: 0, tag: (i % 2) | FRONT, weight: [1.0] }
        };
        PhotonMap::build((0..n).map(photon).collect(), frame, 0.1)
    }

    fn evenly(density: &Density<'_, 1>, hits: &[Hit], weight: f64) -> Gathered<1> {
        let mut sums = Gathered::new(2);
        hits.iter().for_each(|hit| density.gather_evenly(hit, [weight], &mut sums));
        sums
    }

    #[test]
    fn samples_within_an_eighth_of_the_radius_share_a_place() {
        let geometry = floor();
        let map = row(&geometry, 1000);
        let choice = Choice { bandwidth: Bandwidth::Radius(0.08), kernel: Kernel::Flat, replicates: 2 };
        let density = Density::new(Arc::new(Footprints::new(&geometry)), &map, 1.0, choice);
        let [a, near, far] = [0.5, 0.509, 0.6].map(|x| on_floor(&geometry, x));
        let value = |hits: &[Hit]| evenly(&density, hits, 1.0).value[0];
        let [at_a, at_near, at_far] = [a, near, far].map(|hit| value(&[hit]));
        assert!(at_a != at_near && at_a != at_far);
        assert_eq!(value(&[a, near]), at_a + at_a);
        assert_eq!(value(&[near, a]), at_near + at_near);
        assert_eq!(value(&[a, far]), at_a + at_far);
        // By the general way, with the same BSDF, and by a weight.
        let mut sums = Gathered::new(2);
        density.gather(&a, [1.0], |_, front| [if front { 1.0 } else { 0.0 }], &mut sums);
        assert_eq!(sums.value[0], at_a);
        assert_eq!(evenly(&density, &[a, near], 0.25).value[0], 0.25 * at_a + 0.25 * at_a);
        // Beyond the 32 places that are remembered each is gathered for itself.
        let many: Vec<Hit> = (0..40).map(|i| on_floor(&geometry, 0.1 + 0.02 * f64::from(i))).collect();
        let alone: f64 = many.iter().map(|hit| value(&[*hit])).sum();
        assert!((value(&many) / alone - 1.0).abs() < 1e-12);
    }

    #[test]
    fn of_k_nearest_the_kth_is_the_rim_and_the_bias_a_part_of_the_light() {
        let geometry = floor();
        let map = row(&geometry, 1000);
        let kernel = Kernel::Epanechnikov;
        let choice = Choice { bandwidth: Bandwidth::Nearest(20), kernel, replicates: 2 };
        let density = Density::new(Arc::new(Footprints::new(&geometry)), &map, 3.0, choice);
        let at = on_floor(&geometry, 0.5);
        let sums = evenly(&density, &[at], 1.0);
        let mut distances: Vec<f64> =
            map.photons().iter().map(|p| map.position(p).distance(at.position)).collect();
        distances.sort_by(f64::total_cmp);
        // Photons of 3 lm under 2 / (pi r^2) (1 - d^2 / r^2), which is 0 for the kth.
        let exact = |k: usize| {
            let r2 = distances[k - 1].powi(2);
            let near = distances[..k].iter().map(|d| 1.0 - d * d / r2).sum::<f64>();
            3.0 * near * 2.0 / (std::f64::consts::PI * r2)
        };
        assert!((sums.value[0] / exact(20) - 1.0).abs() < 1e-9, "{} {}", sums.value[0], exact(20));
        assert!((sums.second[0] / exact(40) - 1.0).abs() < 1e-9, "{} {}", sums.second[0], exact(40));
        assert!((sums.nearest_bias / (sums.value[0] / 39.0) - 1.0).abs() < 1e-12);
        assert!((sums.by_replicate.iter().sum::<f64>() / sums.value[0] - 1.0).abs() < 1e-12);
        assert_eq!(sums.sparse, 0.0);
        let twice = evenly(&density, &[at, at], 0.5);
        assert!((twice.nearest_bias / sums.nearest_bias - 1.0).abs() < 1e-12);
    }

    /// Photons at these distances from (0.5, 0.5) on a floor of several, on its front or back.
    fn about_the_middle(geometry: &Geometry, floor: u32, front: bool, distances: &[f64]) -> Vec<Photon<1>> {
        let (low, high) = geometry.bounds();
        let frame = Frame::new(low, high);
        let place = |d: &f64| frame.cell(DVec3::new(0.5 + d, 0.5, f64::from(floor) * 1e-3));
        let tag = if front { FRONT } else { 0 };
        let photon = |d| Photon {
            cell: place(d),
            direction: pack(DVec3::NEG_Z),
            primitive: 2 * floor,
            tag,
            weight: [1.0],
        };
        distances.iter().map(photon).collect()
    }

    #[test]
    fn few_photons_owe_the_error_of_one_more() {
        let geometry = floor();
        let (low, high) = geometry.bounds();
        let choice = Choice { bandwidth: Bandwidth::Radius(0.1), kernel: Kernel::Flat, replicates: 1 };
        let owed = |near: usize, far: usize| {
            let distances = [vec![0.05; near], vec![0.12; far]].concat();
            let photons = about_the_middle(&geometry, 0, true, &distances);
            let map = PhotonMap::build(photons, Frame::new(low, high), 0.1);
            let density = Density::new(Arc::new(Footprints::new(&geometry)), &map, 3.0, choice);
            evenly(&density, &[on_floor(&geometry, 0.5)], 1.0).sparse
        };
        let one = 3.0 / (std::f64::consts::PI * 0.01);
        for (near, far, exact) in
            [(0, 0, one), (3, 20, 2.0 * one), (9, 0, 10f64.sqrt() * one), (10, 0, 0.0), (11, 5, 0.0)]
        {
            assert!((owed(near, far) - exact).abs() <= 1e-12 * one, "{near} {far}: {}", owed(near, far));
        }
    }

    #[test]
    fn photons_of_another_side_or_surface_are_no_neighbours() {
        let sheet = |i: u32| {
            let corner = DVec3::Z * (1e-3 * f64::from(i));
            let shape = Shape::Rectangle(Rectangle::new(corner, DVec3::X, DVec3::Y).unwrap());
            Surface { name: format!("s{i}"), shape }
        };
        let geometry = Geometry::build(vec![sheet(0), sheet(1), sheet(2)]).unwrap();
        let at = |far: f64| (1..=30).map(|i| far * f64::from(i)).collect::<Vec<_>>();
        // In the middle sheet's front 30 photons; nearer ones on its back and on the other two.
        let all = [
            about_the_middle(&geometry, 1, true, &at(0.01)),
            about_the_middle(&geometry, 1, false, &at(0.001)),
            about_the_middle(&geometry, 0, true, &at(0.001)),
            about_the_middle(&geometry, 2, true, &at(0.001)),
        ];
        let (low, high) = geometry.bounds();
        let alone = PhotonMap::build(all[0].clone(), Frame::new(low, high), 0.1);
        let among = PhotonMap::build(all.concat(), Frame::new(low, high), 0.1);
        let from = DVec3::new(0.5, 0.5, 1.5e-3);
        let at = geometry.nearest(from, DVec3::NEG_Z, &Whereabouts::default(), &mut 0).unwrap();
        assert_eq!((at.surface.0, at.front), (1, true));
        for bandwidth in [
            Bandwidth::Radius(0.05),
            Bandwidth::Nearest(10),
            Bandwidth::AtLeast { radius_m: 0.05, neighbours: 10 },
        ] {
            let choice = Choice { bandwidth, kernel: Kernel::Epanechnikov, replicates: 2 };
            let value = |map| {
                let density = Density::new(Arc::new(Footprints::new(&geometry)), map, 1.0, choice);
                evenly(&density, &[at], 1.0).value[0]
            };
            assert!(value(&alone) > 0.0);
            assert!((value(&among) / value(&alone) - 1.0).abs() < 1e-6, "{bandwidth:?}");
        }
    }

    #[test]
    fn progressive_radii_shrink_as_their_source_says() {
        let radii = progressive(0.1, 3);
        let second: f64 = 0.01 * (1.0 + PROGRESSIVE_ALPHA) / 2.0;
        let third: f64 = second * (2.0 + PROGRESSIVE_ALPHA) / 3.0;
        for (radius, exact) in radii.iter().zip([0.1, second.sqrt(), third.sqrt()]) {
            assert!((radius / exact - 1.0).abs() < 1e-15, "{radii:?}");
        }
        assert_eq!((progressive(0.1, 0).len(), radii.len()), (1, 3));
    }
}
