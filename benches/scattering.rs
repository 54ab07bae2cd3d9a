//! Nanoseconds per scattering by a table, one thread, against an emission of a table of the same grid; the time to read a
//! table and build its samplers. The last lines are ratios of times taken in turns, which a busy machine disturbs least.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::print_stdout, missing_docs)]

#[path = "../tests/support/tables.rs"]
mod tables;

use std::hint::black_box;
use std::path::Path;
use std::time::{Duration, Instant};

use caustix::math::solve::Solver;
use caustix::sample::coordinates::{Coordinates, Purpose};
use caustix::sample::grid::Grid;
use caustix::scattering::{Frame, LobeData, Quantity, ScatterTable};
use caustix::sequence::owen::OwenPoints;
use caustix::surface::tabulated::{Energy, Options};
use caustix::surface::{
    Event, Grey, Incidence, Lambertian, Material, Reflectance, Rgb, Tabulated, Throughput as Carried,
};
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

fn built(data: LobeData) -> Material {
    let table = ScatterTable::new("bench", vec![data], vec![]).unwrap();
    let options = Options { energy: Energy::Scale, ..Options::default() };
    Material::Tabulated(Box::new(Tabulated::new(&table, &options).unwrap().0))
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
    Incidence { direction, facet: DVec3::Z, smooth: DVec3::Z, front: true, indices: [1.0; 2] }
}

/// One batch of scatterings from photon `first` on.
fn scatter<T: Carried>(bsdf: &Material, carried: T, first: u64) -> DVec3 {
    let points = OwenPoints::new(1, 0);
    let mut sum = DVec3::ZERO;
    for i in first..first + BATCH {
        let mut c = Coordinates::new(&points, i, true);
        if let Event::Leaves { direction, .. } = bsdf.scatter(&arriving(i), &mut c, &mut carried.clone()) {
            sum += direction;
        }
    }
    sum
}

/// One slice of the table as the grid of a luminaire.
fn luminaire(data: &LobeData) -> Grid {
    let radians = |angles: &[f64]| angles.iter().map(|a| a.to_radians()).collect::<Vec<f64>>();
    let nodes = data.polar_deg.len() * data.azimuth_deg.len();
    let values: Vec<f64> = data.values[..nodes].iter().map(|v| f64::from(*v)).collect();
    Grid::new(&radians(&data.polar_deg), &radians(&data.azimuth_deg), &values).unwrap()
}

/// One batch of emissions from photon `first` on.
fn emit(grid: &Grid, first: u64) -> DVec3 {
    let points = OwenPoints::new(1, 0);
    let mut sum = DVec3::ZERO;
    for i in first..first + BATCH {
        let mut c = Coordinates::new(&points, i, true);
        let u = c.draw_reusable(Purpose::Emission);
        sum += grid.draw_inverse(u, &mut c, Solver::DEFAULT).direction;
    }
    sum
}

/// Something that takes a batch of photons.
type Batch = (&'static str, Box<dyn Fn(u64) -> DVec3>);

/// The emission that is the measure, then everything that is measured by it.
fn batches() -> Vec<Batch> {
    fn of<T: Carried + 'static>(bsdf: Material, carried: T) -> Box<dyn Fn(u64) -> DVec3> {
        Box::new(move |first| scatter(&bsdf, carried, first))
    }
    let grey = table(1, Frame::Specular, vec![0.0]);
    let grid = luminaire(&grey);
    let lambertian = Material::Lambertian(Lambertian::new(Reflectance::new(1.0).unwrap()));
    let turn = steps(0.0, 360.0, 10.0);
    vec![
        ("emission of the same grid", Box::new(move |first| emit(&grid, first))),
        ("lambertian", of(lambertian, Grey)),
        ("table, specular frame", of(built(grey), Grey)),
        ("table, surface frame", of(built(table(1, Frame::Surface, vec![0.0])), Grey)),
        ("table, anisotropic", of(built(table(1, Frame::Specular, turn)), Grey)),
        ("table, rgb", of(built(table(3, Frame::Specular, vec![0.0])), Rgb::WHITE)),
    ]
}

fn scattering(criterion: &mut Criterion) {
    let mut group = short(criterion, "scattering");
    for (name, batch) in batches() {
        let mut first = 0;
        group.bench_function(name, |b| {
            b.iter(|| {
                first = (first + BATCH) % (1 << 24);
                black_box(batch(first))
            });
        });
    }
}

/// Rounds of the comparison in turns.
const ROUNDS: u64 = 400;

/// Times a round over the emission's in the same round: least and median.
fn ratios(_: &mut Criterion) {
    if std::env::args().any(|argument| argument == "--test") {
        return;
    }
    let batches = batches();
    let mut times = vec![Vec::new(); batches.len()];
    for round in 0..ROUNDS {
        for (times, (_, batch)) in times.iter_mut().zip(&batches) {
            let start = Instant::now();
            black_box(batch(round * BATCH));
            times.push(start.elapsed().as_secs_f64());
        }
    }
    let least = |times: &[f64]| times.iter().copied().fold(f64::INFINITY, f64::min);
    for (of, (name, _)) in times.iter().zip(&batches) {
        let mut by_round: Vec<f64> = of.iter().zip(&times[0]).map(|(t, emission)| t / emission).collect();
        by_round.sort_by(f64::total_cmp);
        let (median, minima) = (by_round[by_round.len() / 2], least(of) / least(&times[0]));
        let ns = least(of) / BATCH as f64 * 1e9;
        println!(
            "{name:26} {median:5.2} emissions (median of {ROUNDS}), {minima:5.2} of minima ({ns:.0} ns)"
        );
    }
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
    match std::env::var_os("CAUSTIX_TEST_DATA") {
        Some(data) => measured(&mut group, &Path::new(&data).join("brdf/zemax/IMX455.bsdf")),
        None => println!("skipped: CAUSTIX_TEST_DATA is not set"),
    }
}

/// The largest measured table at hand: read, and its samplers built.
fn measured(group: &mut BenchmarkGroup<'_, WallTime>, path: &Path) {
    let options = Options { energy: Energy::Scale, ..Options::default() };
    let both = || {
        let table = caustix::files::bsdf::read(path).unwrap();
        let values: usize = table.lobes.iter().map(|lobe| lobe.values.len()).sum();
        (Tabulated::new(&table, &options).unwrap().0, values)
    };
    let (tabulated, values) = both();
    let bytes = caustix::surface::memory_bytes(&[Material::Tabulated(Box::new(tabulated))]);
    println!(
        "{}: {values} values, {bytes} bytes, {:.2} a value",
        path.display(),
        bytes as f64 / values as f64
    );
    group.throughput(Throughput::Elements(values as u64));
    group.bench_function("IMX455.bsdf, read and built", |b| b.iter(|| black_box(both())));
}

criterion_group!(benches, scattering, building, ratios);
criterion_main!(benches);
