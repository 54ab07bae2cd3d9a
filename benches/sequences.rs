//! Nanoseconds per coordinate of every sequence, one thread: the first four coordinates, a late one, and far indices.
#![allow(clippy::unwrap_used, clippy::expect_used, missing_docs)]

use std::hint::black_box;
use std::time::Duration;

use caustix::sequence::other::OtherPoints;
use caustix::sequence::{Points, Sequence};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// Points of one iteration.
const BATCH: u64 = 1 << 10;
/// N of the sets that must know it.
const NUMBER: u64 = 4_456_448;

fn coordinates(criterion: &mut Criterion) {
    for (name, first, of) in [
        ("first", 1 << 20, [0, 1, 2, 3]),
        ("late", 1 << 20, [16, 17, 40, 63]),
        ("far", 1 << 40, [0, 1, 2, 3]),
    ] {
        let mut group = criterion.benchmark_group(format!("coordinate/{name}"));
        group.throughput(Throughput::Elements(BATCH * of.len() as u64)).sample_size(20);
        group.warm_up_time(Duration::from_millis(100)).measurement_time(Duration::from_millis(400));
        for sequence in Sequence::ALL {
            let points = OtherPoints::new(sequence, 1, 0, Some(NUMBER)).unwrap();
            group.bench_function(sequence.name(), |b| {
                b.iter(|| {
                    let points = black_box(&points);
                    let of_point = |i: u64| of.iter().fold(0, |sum, &c| sum ^ points.coordinate(i, c));
                    (first..first + BATCH).fold(0, |sum, i| sum ^ of_point(i))
                });
            });
        }
    }
}

criterion_group!(benches, coordinates);
criterion_main!(benches);
