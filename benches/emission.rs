//! Nanoseconds per emission, one thread: tables of three sizes under three sequences; and the cell equation alone, by
//! each solver (benches/solvers.rs compares them with others).
#![allow(clippy::unwrap_used, clippy::expect_used, missing_docs)]

use std::hint::black_box;
use std::path::Path;
use std::time::Duration;

use caustix::emitter::{AimFrame, Emitter, Emitters, Photometric};
use caustix::files::photometric;
use caustix::math::solve::Solver;
use caustix::photometry::{PhotometricType, Photometry, Web};
use caustix::sample::angles::Row;
use caustix::sample::cell::Cell;
use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::Sampling;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::sobol::SobolPoints;
use caustix::sequence::{Points, to_unit_f64};
use criterion::{
    BenchmarkGroup, Criterion, Throughput, criterion_group, criterion_main, measurement::WallTime,
};
use glam::DVec3;

/// Emissions, or solutions, of one iteration.
const BATCH: u64 = 1 << 12;

fn own(name: &str) -> Photometry {
    photometric::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("ies").join(name)).unwrap()
}

/// The largest table of the wild: V by a quarter of a degree, H by one degree, every value another.
fn largest() -> Photometry {
    let vertical: Vec<f64> = (0..721).map(|i| f64::from(i) * 0.25).collect();
    let horizontal: Vec<f64> = (0..361).map(f64::from).collect();
    let candela = (0..361u32)
        .flat_map(|h| (0..721u32).map(move |v| f64::from((v * 31 + (h % 360) * 17) % 997) + 1.0))
        .collect();
    let web = Web::new(PhotometricType::C, vertical, horizontal, candela).unwrap();
    Photometry { web, ..own("wavy_glass.ies") }
}

fn lamp(photometry: &Photometry) -> Emitters {
    let aim = DVec3::new(0.1, -0.2, -1.0);
    let frame = AimFrame::new(aim, None).unwrap();
    let e = Photometric::new(photometry, DVec3::Z, frame, None).unwrap();
    Emitters::new(vec![Emitter::Photometric(e)]).unwrap()
}

fn emissions<P: Points>(group: &mut BenchmarkGroup<'_, WallTime>, name: &str, lamp: &Emitters, points: &P) {
    let mut first = 0;
    group.bench_function(name, |b| {
        b.iter(|| {
            let mut sum = DVec3::ZERO;
            for i in first..first + BATCH {
                sum += lamp
                    .emit(Sampling::default(), &mut Coordinates::new(points, i, true))
                    .unwrap()
                    .1
                    .direction;
            }
            first = (first + BATCH) % (1 << 24);
            black_box(sum)
        });
    });
}

fn short<'c>(criterion: &'c mut Criterion, name: &str) -> BenchmarkGroup<'c, WallTime> {
    let mut group = criterion.benchmark_group(name);
    group.throughput(Throughput::Elements(BATCH)).sample_size(20);
    group.warm_up_time(Duration::from_millis(300)).measurement_time(Duration::from_secs(1));
    group
}

fn emission(criterion: &mut Criterion) {
    let tables = [("wavy_glass", own("wavy_glass.ies")), ("spot", own("spot.ies")), ("721x361", largest())];
    for (name, photometry) in &tables {
        let lamp = lamp(photometry);
        let mut group = short(criterion, &format!("emission/{name}"));
        emissions(&mut group, "independent", &lamp, &IndependentPoints::new(1, 0));
        emissions(&mut group, "sobol", &lamp, &SobolPoints);
        emissions(&mut group, "sobol-owen", &lamp, &OwenPoints::new(1, 0));
    }
}

/// Cells as they come in tables: inner, at the pole, with zero corners, over six decades, wide.
fn cells() -> Vec<(Row, Cell)> {
    let corners = [
        [1.0, 1.2, 0.9, 1.1],
        [1.0, 1.0, 0.2, 0.3],
        [0.0, 0.0, 1.0, 1.0],
        [1.0, 0.0, 0.0, 0.0],
        [1e-6, 1e-6, 1.0, 0.5],
    ];
    let rows = [(0.0, 2.5), (2.5, 5.0), (42.5, 45.0), (87.5, 90.0), (60.0, 90.0), (175.0, 180.0)];
    let rows = rows.map(|(from, to): (f64, f64)| Row::new(from.to_radians(), to.to_radians()));
    rows.into_iter().flat_map(|row| corners.map(|c| (row, Cell::new(&row, c).unwrap()))).collect()
}

fn cell_equation(criterion: &mut Criterion) {
    let cells = cells();
    let points = IndependentPoints::new(2, 0);
    let work: Vec<(usize, f64)> =
        (0..BATCH).map(|i| (i as usize % cells.len(), to_unit_f64(points.coordinate(i, 0)))).collect();
    let mut group = short(criterion, "cell");
    let mut solver = |name: &str, solve: &dyn Fn(&Row, &Cell, f64) -> f64| {
        group.bench_function(name, |b| {
            b.iter(|| work.iter().map(|(k, u)| solve(&cells[*k].0, &cells[*k].1, *u)).sum::<f64>());
        });
    };
    for method in Solver::ALL {
        solver(method.name(), &|row, cell, u| cell.sample_theta(row, u, method).s);
    }
}

criterion_group!(benches, emission, cell_equation);
criterion_main!(benches);
