//! The photon map: building it, and gathering about 100 neighbours with the queries in order, one thread each.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, missing_docs)]

use std::f64::consts::{FRAC_1_PI, PI};
use std::hint::black_box;
use std::sync::Arc;

use caustix::geometry::{Geometry, Hit, Rectangle, Shape, Surface, Whereabouts};
use caustix::picture::gather::footprint::Footprints;
use caustix::picture::gather::{Choice, Density, Gathered};
use caustix::picture::photon_map::record::{FRONT, pack};
use caustix::picture::photon_map::{Frame, Photon, PhotonMap};
use caustix::scene::camera::{Bandwidth, Kernel};
use caustix::sequence::hash::mix64;
use criterion::{BatchSize, Criterion, Throughput, criterion_group, criterion_main};
use glam::DVec3;

const PHOTONS: u64 = 4_500_000;
const QUERIES: u32 = 64;

fn u(i: u64, salt: u64) -> f64 {
    (mix64(mix64(i) ^ mix64(salt)) >> 11) as f64 / (1u64 << 53) as f64
}

/// The floor and two walls of a room, 4 m long.
fn scene() -> Geometry {
    let (x, y, z) = (DVec3::X * 4.0, DVec3::Y * 4.0, DVec3::Z * 4.0);
    let rectangles = [("floor", x, y), ("left", y, z), ("back", z, x)];
    let shape = |u, v| Shape::Rectangle(Rectangle::new(DVec3::ZERO, u, v).unwrap());
    let surfaces = rectangles.map(|(name, u, v)| Surface { name: name.into(), shape: shape(u, v) });
    Geometry::build(surfaces.into()).unwrap()
}

fn photons<const C: usize>(frame: &Frame) -> Vec<Photon<C>> {
    let photon = |i: u64| {
        let (a, b) = (4.0 * u(i, 1), 4.0 * u(i, 2));
        let wall = (i % 3) as u32;
        let at = [DVec3::new(a, b, 0.0), DVec3::new(0.0, a, b), DVec3::new(b, 0.0, a)][wall as usize];
        Photon {
            cell: frame.cell(at),
            direction: pack(DVec3::new(-u(i, 3), -u(i, 4), -u(i, 5)).normalize()),
            primitive: 2 * wall + u32::from(b > a),
            tag: (i % 8) as u32 | FRONT,
            weight: [1.0; C],
        }
    };
    (0..PHOTONS).map(photon).collect()
}

/// The radius that holds this many.
fn radius(neighbours: f64) -> f64 {
    (neighbours * 48.0 / (PI * PHOTONS as f64)).sqrt()
}

fn build(c: &mut Criterion) {
    let mut group = c.benchmark_group("build");
    group.throughput(Throughput::Elements(PHOTONS)).sample_size(10);
    let geometry = scene();
    let (low, high) = geometry.bounds();
    let frame = Frame::new(low, high);
    let (grey, rgb) = (photons::<1>(&frame), photons::<3>(&frame));
    group.bench_function("4.5 M photons, one channel", |b| {
        b.iter_batched(
            || grey.clone(),
            |p| PhotonMap::build(p, frame, radius(100.0)),
            BatchSize::PerIteration,
        );
    });
    group.bench_function("4.5 M photons, three channels", |b| {
        b.iter_batched(
            || rgb.clone(),
            |p| PhotonMap::build(p, frame, radius(100.0)),
            BatchSize::PerIteration,
        );
    });
    group.finish();
}

fn gather(c: &mut Criterion) {
    let geometry = scene();
    let (low, high) = geometry.bounds();
    let frame = Frame::new(low, high);
    let map = PhotonMap::build(photons::<1>(&frame), frame, radius(100.0));
    // A patch of the floor, row by row, as pixels see it.
    let hits: Vec<Hit> = (0..QUERIES * QUERIES)
        .map(|i| {
            let step = |k: u32| 1.0 + 0.01 * f64::from(k);
            let to = DVec3::new(step(i % QUERIES), step(i / QUERIES), 0.0);
            let (from, down) = (to + DVec3::Z, -DVec3::Z);
            geometry.nearest(from, down, &Whereabouts::default(), &mut 0).unwrap()
        })
        .collect();
    let mut group = c.benchmark_group("gather 100 neighbours");
    group.throughput(Throughput::Elements(hits.len() as u64)).sample_size(20);
    for (name, bandwidth, kernel) in [
        ("fixed radius, flat", Bandwidth::Radius(radius(100.0)), Kernel::Flat),
        ("fixed radius, Epanechnikov", Bandwidth::Radius(radius(100.0)), Kernel::Epanechnikov),
        ("k nearest, Epanechnikov", Bandwidth::Nearest(100), Kernel::Epanechnikov),
    ] {
        let density = Density::new(
            Arc::new(Footprints::new(&geometry)),
            &map,
            1e-6,
            Choice { bandwidth, kernel, replicates: 8 },
        );
        let mut sums = Gathered::new(8);
        group.bench_function(name, |b| {
            b.iter(|| {
                sums.clear();
                for hit in &hits {
                    density.gather(hit, [1.0], |_, front| [if front { FRAC_1_PI } else { 0.0 }], &mut sums);
                }
                black_box(sums.second)
            });
        });
    }
    group.finish();
}

criterion_group!(benches, build, gather);
criterion_main!(benches);
