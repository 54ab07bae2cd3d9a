//! Faces of two surfaces that all but lie in one another, found beside those that do.
//!
//! A file of six digits puts a block 3e-7 m above the table it is meant to stand on, or as far into it: then nothing is in
//! contact, and what was said of the contact is not heard. Only faces of closed surfaces are looked at, with those of any
//! other surface.

use std::collections::BTreeMap;

use super::coplanar::{extent, normal, overlap, rounding};
use super::{Body, DVec3, Info, Surface, SurfaceId};

/// A pair of surfaces of which faces are parallel, overlap, and are next to each other, but not in contact.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Near {
    /// Both, the lower number first.
    pub surfaces: [SurfaceId; 2],
    /// The most that such faces are apart, m; negative where one is inside the other's body.
    pub distance_m: f64,
}

/// Nearer than this share of the smaller closed surface's size is meant to touch.
const NEAR: f64 = 1e-5;
/// And parallel to this share of it.
const PARALLEL: f64 = 1e-6;
/// Of the smaller closed surface's area, this much has to be near: less is where something curved of fine facets touches.
const LEAST_AREA: f64 = 0.01;

/// How far from a shape what all but touches it may be, m: nothing is near to an open one by itself.
pub(super) fn reach(surface: &Surface) -> f64 {
    if surface.shape.body() == Body::Open { 0.0 } else { NEAR * size(surface) }
}

fn size(surface: &Surface) -> f64 {
    let (low, high) = surface.shape.bounds();
    (high - low).max_element()
}

/// What was found of a pair.
#[derive(Debug, Clone, Copy, Default)]
struct Found {
    distance_m: f64,
    area_m2: f64,
}

/// Collects faces that are near.
pub(super) struct Nearly {
    /// Sizes of closed surfaces, m, and their areas, m2; infinite for others.
    sizes: Vec<[f64; 2]>,
    found: BTreeMap<[u32; 2], Found>,
}

impl Nearly {
    pub fn new(surfaces: &[Surface], info: &[Info]) -> Self {
        let of = |(surface, info): (&Surface, &Info)| match info.body {
            Body::Open => [f64::INFINITY; 2],
            Body::Simple | Body::Layered => [size(surface), surface.shape.area()],
        };
        Self { sizes: surfaces.iter().zip(info).map(of).collect(), found: BTreeMap::new() }
    }

    fn smaller(&self, [s, t]: [u32; 2]) -> [f64; 2] {
        let [a, b] = [s, t].map(|s| self.sizes[s as usize]);
        if a[0] <= b[0] { a } else { b }
    }

    /// Looks at triangles of two surfaces that are not in contact.
    pub fn consider(&mut self, surfaces: [u32; 2], [a, b]: [&[DVec3; 3]; 2]) {
        let [size, _] = self.smaller(surfaces);
        if !size.is_finite() {
            return;
        }
        let (na, nb) = (normal(a), normal(b));
        let first_is_larger = na.length_squared() >= nb.length_squared();
        let (plane, other, across) = if first_is_larger { (a, b, na) } else { (b, a, nb) };
        let Some(n) = across.try_normalize() else { return };
        let [least, greatest] = extent(other.iter().map(|v| (*v - plane[0]).dot(n)));
        let is_parallel = greatest - least <= PARALLEL * size;
        if least < -NEAR * size || greatest > NEAR * size || !is_parallel {
            return;
        }
        if !overlap(a, b, n, rounding(a, b)) {
            return;
        }
        let facing = na.dot(nb) < 0.0;
        let height = if -least > greatest { least } else { greatest };
        // Along the outward normal of a closed one, from it to the other.
        let from_first = if first_is_larger || facing { height } else { -height };
        let [first_is_closed, second_is_closed] = surfaces.map(|s| self.sizes[s as usize][0].is_finite());
        let distance_m = match (first_is_closed, second_is_closed) {
            // One within the other: which of the two is the outer one, does not matter.
            (true, true) if !facing => height.abs(),
            (true, _) => from_first,
            (false, _) if facing => from_first,
            (false, _) => -from_first,
        };
        let [s, t] = surfaces;
        let found = self.found.entry([s.min(t), s.max(t)]).or_default();
        found.area_m2 += 0.5 * na.length().min(nb.length());
        if distance_m.abs() > found.distance_m.abs() {
            found.distance_m = distance_m;
        }
    }

    /// The pairs of which enough is near.
    pub fn finish(self) -> Vec<Near> {
        let is_enough = |pair: [u32; 2], found: &Found| found.area_m2 >= LEAST_AREA * self.smaller(pair)[1];
        let of = |(pair, found): (&[u32; 2], &Found)| Near {
            surfaces: pair.map(SurfaceId),
            distance_m: found.distance_m,
        };
        self.found.iter().filter(|(pair, found)| is_enough(**pair, found)).map(of).collect()
    }
}
