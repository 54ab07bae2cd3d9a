//! Memory does not grow with the number of photons, and what a scene does not require is not there.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

// A binary of its own: the allocator counts the whole process, so no other test may run beside this one.
#[path = "support/allocator.rs"]
mod allocator;
#[path = "support/mod.rs"]
mod support;

use caustix::files::scene_toml;
use caustix::scene::requires::requirements;
use caustix::sequence::Sequence;

use crate::allocator::peak_of;
use crate::support::scenes::run;

#[test]
fn the_built_in_scene_needs_sums_and_nothing_that_grows_with_photons() {
    let scene = scene_toml::built_in().unwrap().build().unwrap();
    assert_eq!(
        requirements(&scene),
        ["photometric table", "triangles", "smooth normals", "refraction", "receiver cells"],
        "and so no photon map, no camera, no wavelengths, no weights"
    );
    // Threads and their stacks are made once.
    run(&scene, Sequence::SobolOwen, 1 << 11, 2, 1);
    let peaks: Vec<usize> = [11u32, 15, 17]
        .into_iter()
        .map(|m| {
            let (peak, outcome) = peak_of(|| run(&scene, Sequence::SobolOwen, 1 << m, 8, 1));
            let cells: usize = outcome.cells().iter().map(|c| c.sum.len()).sum();
            // Sum, that of every other replicate and sum of squares, and the counters of all 8, which advance together.
            let (sums, counters) = (2 * size_of::<u64>() + size_of::<u128>(), size_of::<[u64; 8]>());
            let sums = cells * (sums + counters);
            println!("{} photons: peak {peak} bytes, of them sums {sums}", outcome.photons);
            assert!(peak >= sums, "the allocator counts");
            assert!(peak < sums + (1 << 16), "{peak} bytes for sums of {sums}");
            peak
        })
        .collect();
    // 64 times the photons: what changes is a few kilobytes of the batches' ledgers. One byte a photon would be 1 MB.
    assert!(peaks.iter().all(|p| p.abs_diff(peaks[0]) < 1 << 15), "{peaks:?}");
}
