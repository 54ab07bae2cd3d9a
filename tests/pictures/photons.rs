//! Photons on shapes, and densities of them at a hit.

use std::f64::consts::{FRAC_1_PI, PI};
use std::sync::Arc;

use caustix::geometry::{Geometry, Hit, Rectangle, Shape, Surface, Whereabouts};
use caustix::picture::gather::footprint::Footprints;
use caustix::picture::gather::{Choice, Density, ErrorSums, Gathered};
use caustix::picture::photon_map::record::{FRONT, pack};
use caustix::picture::photon_map::{Frame, Photon, PhotonMap};
use caustix::scene::camera::{Bandwidth, Kernel};
use caustix::sequence::hash::mix64;
use glam::DVec3;

pub const KERNELS: [Kernel; 2] = [Kernel::Flat, Kernel::Epanechnikov];

/// Numbers in [0, 1) without pattern.
pub fn u(i: u64, salt: u64) -> f64 {
    (mix64(mix64(i.wrapping_add(1)) ^ mix64(salt.wrapping_mul(0x9e37_79b9).wrapping_add(7))) >> 11) as f64
        / (1u64 << 53) as f64
}

pub fn geometry(shapes: Vec<Shape>) -> Geometry {
    let named = shapes.into_iter().enumerate().map(|(i, shape)| Surface { name: format!("s{i}"), shape });
    Geometry::build(named.collect()).unwrap()
}

pub fn floor() -> Shape {
    Shape::Rectangle(Rectangle::new(DVec3::ZERO, DVec3::X, DVec3::Y).unwrap())
}

/// What a ray from `from` towards `to` meets.
pub fn hit(geometry: &Geometry, from: DVec3, to: DVec3) -> Hit {
    geometry.nearest(from, (to - from).normalize(), &Whereabouts::default(), &mut 0).unwrap()
}

/// A hit on the floor z = 0, from above.
pub fn on_floor(geometry: &Geometry, x: f64, y: f64) -> Hit {
    hit(geometry, DVec3::new(x, y, 0.5), DVec3::new(x, y, 0.0))
}

pub fn frame_of(geometry: &Geometry) -> Frame {
    let (low, high) = geometry.bounds();
    Frame::new(low, high)
}

/// A photon coming straight down on the front.
pub fn photon(frame: &Frame, at: DVec3, primitive: u32, replicate: u32) -> Photon<1> {
    let tag = replicate | FRONT;
    Photon { cell: frame.cell(at), direction: pack(-DVec3::Z), primitive, tag, weight: [1.0] }
}

/// BSDF 1 / pi on the side looked at: luminance is illuminance / pi.
pub fn lambertian(front: bool) -> impl FnMut(DVec3, bool) -> [f64; 1] {
    move |_, arrived| [if arrived == front { FRAC_1_PI } else { 0.0 }]
}

/// Photons per m2 at a hit, of photons of 1 lm, with the gathered sums.
pub fn density_at(density: &Density<'_, 1>, at: &Hit, replicates: usize) -> (f64, Gathered<1>) {
    let mut sums = Gathered::new(replicates);
    density.gather(at, [PI], lambertian(at.front), &mut sums);
    (sums.value[0], sums)
}

/// Standard error and bias as a pixel of one sample has them.
pub fn error_and_bias(sums: &Gathered<1>) -> (f64, f64) {
    let replicates = sums.by_replicate.len() as u32;
    let mut error = ErrorSums::NOTHING;
    error.add(sums, 1.0, 0..replicates, true);
    (error.variance(replicates).sqrt(), error.bias())
}

/// A density on these surfaces.
pub fn density_of<'m>(
    geometry: &'m Geometry,
    map: &'m PhotonMap<1>,
    photon_lm: f64,
    choice: Choice,
) -> Density<'m, 1> {
    Density::new(Arc::new(Footprints::new(geometry)), map, photon_lm, choice)
}

pub fn choice(bandwidth: Bandwidth, kernel: Kernel, replicates: u32) -> Choice {
    Choice { bandwidth, kernel, replicates }
}

pub fn mean_and_error(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (variance / n).sqrt())
}

/// Independent photons spread evenly over the unit floor.
pub fn on_the_floor(frame: &Frame, n: u64, seed: u64, replicates: u64) -> Vec<Photon<1>> {
    let at = |i: u64| DVec3::new(u(i, 2 * seed), u(i, 2 * seed + 1), 0.0);
    (0..n).map(|i| photon(frame, at(i), u32::from(at(i).y > at(i).x), (i % replicates) as u32)).collect()
}
