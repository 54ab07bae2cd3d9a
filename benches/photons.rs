//! Whole photons: the built-in scene from emission to the receiver, photons/s on all threads and on one.
#![allow(clippy::unwrap_used, clippy::expect_used, missing_docs)]

use std::hint::black_box;
use std::sync::atomic::AtomicBool;

use caustix::files::scene_toml;
use caustix::run::{Algorithm, Plan, Settings, trace};
use caustix::scene::Scene;
use caustix::sequence::Sequence;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const PHOTONS: u64 = 1 << 19;

fn scene() -> Scene {
    scene_toml::built_in().unwrap().build().unwrap()
}

fn photons(c: &mut Criterion) {
    let scene = scene();
    let mut group = c.benchmark_group("photons of the built-in scene");
    group.throughput(Throughput::Elements(PHOTONS)).sample_size(10);
    for (threads, label) in [(0, "all threads"), (1, "one thread")] {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        for sequence in [Sequence::Independent, Sequence::Sobol, Sequence::SobolOwen] {
            let algorithm = Algorithm { sequence, ..Algorithm::default() };
            let settings =
                Settings { photons: Some(PHOTONS), replicates: Some(1), algorithm, ..Settings::default() };
            let plan = Plan::new(&settings).unwrap();
            group.bench_function(format!("{label}, {}", sequence.name()), |b| {
                b.iter(|| {
                    pool.install(|| trace(black_box(&scene), &plan, &AtomicBool::new(false), &|_| {}))
                        .unwrap()
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, photons);
criterion_main!(benches);
