//! Nearest hits per second, one thread: a glass pane of two 128 x 128 x 2 heightfields over a plate.
#![allow(clippy::unwrap_used, clippy::expect_used, missing_docs)]

use std::hint::black_box;

use caustix::geometry::{
    Facing, Formula, Geometry, Heightfield, Noise, Octave, Rectangle, Shape, Sphere, Surface, Whereabouts,
};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use glam::{DVec2, DVec3};

const RAYS: usize = 1 << 16;

fn pane(z_m: f64, seed: u64, stretch: f64, facing: Facing) -> Shape {
    let octaves = [(1.0, 0.30), (0.45, 0.148), (0.12, 0.073)];
    let octaves = octaves.map(|(amplitude, l)| Octave { amplitude, wavelength_m: l * stretch });
    let formula = Formula::Noise(Noise::new(seed, octaves.to_vec(), 0.01).unwrap());
    let origin = DVec3::new(-1.4, -1.4, z_m);
    let field = Heightfield::new(origin, DVec2::splat(2.8), [128, 128], formula).unwrap().facing(facing);
    Shape::Mesh(field.mesh().unwrap())
}

fn scene(ball: bool) -> Geometry {
    let plate = Rectangle::new(DVec3::new(-1.0, -1.0, 0.0), DVec3::X * 2.0, DVec3::Y * 2.0).unwrap();
    let mut surfaces = vec![
        ("upper", pane(1.1, 1, 1.0, Facing::Up)),
        ("lower", pane(0.8, 2, 1.1, Facing::Down)),
        ("plate", Shape::Rectangle(plate)),
    ];
    if ball {
        surfaces.push(("ball", Shape::Sphere(Sphere::new(DVec3::new(0.2, 0.1, 1.5), 0.2).unwrap())));
    }
    let named = surfaces.into_iter().map(|(name, shape)| Surface { name: name.into(), shape });
    Geometry::build(named.collect()).unwrap()
}

/// Weyl sequence in [0, 1).
fn u(i: usize, step: f64) -> f64 {
    (i as f64 * step).fract()
}

fn direction(i: usize) -> DVec3 {
    let (z, phi) = (2.0 * u(i, 0.754_877_666_2) - 1.0, std::f64::consts::TAU * u(i, 0.569_840_290_9));
    let r = (1.0 - z * z).sqrt();
    DVec3::new(r * phi.cos(), r * phi.sin(), z)
}

/// From the lamp to a grid on the plate, row by row.
fn coherent() -> Vec<(DVec3, DVec3)> {
    let lamp = DVec3::new(0.03, -0.02, 2.0);
    let aim = |i: usize| DVec3::new((i % 256) as f64 / 128.0 - 1.0, (i / 256) as f64 / 128.0 - 1.0, 0.0);
    (0..RAYS).map(|i| (lamp, (aim(i) - lamp).normalize())).collect()
}

/// The same rays in no order.
fn shuffled() -> Vec<(DVec3, DVec3)> {
    let rays = coherent();
    (0..RAYS).map(|i| rays[i * 40_503 % RAYS]).collect()
}

/// Origins and directions anywhere in the scene.
fn incoherent() -> Vec<(DVec3, DVec3)> {
    let origin =
        |i: usize| DVec3::new(2.4 * u(i, 0.618_034) - 1.2, 2.4 * u(i, 0.414_214) - 1.2, 1.8 * u(i, 0.732_05));
    (0..RAYS).map(|i| (origin(i), direction(i))).collect()
}

fn traversal(c: &mut Criterion) {
    let mut group = c.benchmark_group("nearest");
    group.throughput(Throughput::Elements(RAYS as u64));
    group.sample_size(20);
    let at = Whereabouts::default();
    for (name, ball, rays, avx2) in [
        ("coherent", false, coherent(), true),
        ("shuffled", false, shuffled(), true),
        ("incoherent", false, incoherent(), true),
        ("incoherent, closed ball", true, incoherent(), true),
        ("incoherent, no avx2", false, incoherent(), false),
    ] {
        let mut geometry = scene(ball);
        geometry.use_avx2(avx2);
        group.bench_function(name, |b| {
            b.iter(|| {
                let mut skipped = 0;
                for &(o, d) in &rays {
                    black_box(geometry.nearest(o, d, &at, &mut skipped));
                }
                skipped
            });
        });
    }
    group.finish();
}

criterion_group!(benches, traversal);
criterion_main!(benches);
