//! Nanoseconds per scattering by a table, one thread, against an emission of a table of the same grid; and the time to build
//! the samplers of a table.
#![allow(clippy::unwrap_used, clippy::expect_used, missing_docs)]

#[path = "../tests/tabulated_support/mod.rs"]
mod tables;

use std::hint::black_box;
use std::time::Duration;

use caustix::bsdf::tabulated::{Energy, Options};
use caustix::bsdf::{Bsdf, Grey, Incidence, Outcome, Reflectance, Rgb, Tabulated, Throughput as Carried};
use caustix::math::solve::Solver;
use caustix::sample::coordinates::{Coordinates, Purpose};
use caustix::sample::grid::Grid;
use caustix::scattering::{Frame, LobeData, Quantity, ScatterTable};
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::{Points, to_unit_f64};
use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use glam::DVec3;
use tables::{lobe, steps};

/// Scatterings of one iteration.
const BATCH: u64 = 1 << 12;

/// A lobe on 46 x 73 nodes for eight incidences, of an albedo above 1: scaled to 1, so that every photon is scattered.
fn table(channels: usize, frame: Frame, phi_i: Vec<f64>) -> LobeData {
    let angles = [steps(0.0, 84.0, 12.0), phi_i, steps(0.0, 90.0, 2.0), steps(0.0, 360.0, 5.0)];
    lobe((Quantity::Reflection, frame), angles, channels, |c, phi, theta, polar, azimuth| {
        let swing = 1.0 + 0.3 * (azimuth + phi).to_radians().cos();
        3.0 * swing * (1.0 + theta / 90.0) * (-polar / (20.0 + 10.0 * c as f64)).exp()
    })
}

fn built(data: LobeData) -> Bsdf {
    let table = ScatterTable::new("bench", vec![data], vec![]).unwrap();
    let options = Options { energy: Energy::Scale, ..Options::default() };
    Bsdf::Tabulated(Box::new(Tabulated::new(&table, &options).unwrap().0))
}

fn short<'c>(criterion: &'c mut Criterion, name: &str) -> BenchmarkGroup<'c, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(BATCH)).sample_size(20);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    group
}

/// Photons from changing directions about 40 degrees off the normal.
fn arriving(i: u64) -> Incidence {
    let shift = (i % 64) as f64 / 640.0;
    let direction = DVec3::new(0.6 + shift, 0.2 - shift, -0.75).normalize();
    Incidence { direction, facet: DVec3::Z, smooth: DVec3::Z, front: true }
}

fn scatterings<T: Carried>(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, bsdf: &Bsdf, carried: T) {
    let points = OwenPoints::new(1, 0);
    let mut first = 0;
    group.bench_function(name, |b| {
        b.iter(|| {
            let mut sum = DVec3::ZERO;
            for i in first..first + BATCH {
                let mut c = Coordinates::new(&points, i, true);
                if let Outcome::Leaves { direction, .. } =
                    bsdf.interact(&arriving(i), &mut c, &mut carried.clone())
                {
                    sum += direction;
                }
            }
            first = (first + BATCH) % (1 << 24);
            black_box(sum)
        });
    });
}

/// An emission from one slice of the table: its grid as that of a luminaire.
fn emissions<P: Points>(group: &mut BenchmarkGroup<'_, WallTime>, data: &LobeData, points: &P) {
    let radians = |angles: &[f64]| angles.iter().map(|a| a.to_radians()).collect::<Vec<f64>>();
    let nodes = data.polar_deg.len() * data.azimuth_deg.len();
    let values: Vec<f64> = data.values[..nodes].iter().map(|v| f64::from(*v)).collect();
    let grid = Grid::new(&radians(&data.polar_deg), &radians(&data.azimuth_deg), &values).unwrap();
    let mut first = 0;
    group.bench_function("emission of the same grid", |b| {
        b.iter(|| {
            let mut sum = DVec3::ZERO;
            for i in first..first + BATCH {
                let mut c = Coordinates::new(points, i, true);
                let mut u = c.draw_reusable(Purpose::Emission);
                let cell = c.choose(grid.choice(), &mut u, Purpose::Emission);
                let u_theta = c.remainder(u, Purpose::EmissionTheta);
                let u_phi = to_unit_f64(c.draw(Purpose::EmissionPhi));
                sum += grid.place(cell, u_theta, u_phi, Solver::DEFAULT).direction;
            }
            first = (first + BATCH) % (1 << 24);
            black_box(sum)
        });
    });
}

fn scattering(criterion: &mut Criterion) {
    let grey = table(1, Frame::Specular, vec![0.0]);
    let mut group = short(criterion, "scattering");
    emissions(&mut group, &grey, &OwenPoints::new(1, 0));
    let lambertian = Bsdf::Lambertian { reflectance: Reflectance::grey(1.0) };
    scatterings(&mut group, "lambertian", &lambertian, Grey);
    scatterings(&mut group, "table, specular frame", &built(grey), Grey);
    scatterings(&mut group, "table, surface frame", &built(table(1, Frame::Surface, vec![0.0])), Grey);
    let turn = steps(0.0, 360.0, 10.0);
    scatterings(&mut group, "table, anisotropic", &built(table(1, Frame::Specular, turn)), Grey);
    let rgb = built(table(3, Frame::Specular, vec![0.0]));
    scatterings(&mut group, "table, rgb", &rgb, Rgb::WHITE);
}

fn building(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("building");
    group.sample_size(10).measurement_time(Duration::from_secs(2));
    // 37 x 8 incidences of 46 x 73 nodes: a million values.
    let data = table(1, Frame::Specular, steps(0.0, 360.0, 10.0));
    let table = ScatterTable::new("bench", vec![data], vec![]).unwrap();
    let options = Options { energy: Energy::Scale, ..Options::default() };
    group.throughput(Throughput::Elements(table.lobes[0].values.len() as u64));
    group.bench_function("samplers of a million values", |b| {
        b.iter(|| Tabulated::new(black_box(&table), &options).unwrap());
    });
}

criterion_group!(benches, scattering, building);
criterion_main!(benches);
