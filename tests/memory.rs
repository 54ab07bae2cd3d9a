//! Memory does not grow with the number of photons, and what a scene does not require is not there.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]
#![allow(unsafe_code)]

mod closed_support;

use std::alloc::{GlobalAlloc, Layout, System};
use std::sync::atomic::{AtomicUsize, Ordering};

use caustix::files::scene_toml::build::build;
use caustix::files::scene_toml::description::Description;
use caustix::scene::requires::requirements;
use caustix::sequence::Sequence;
use closed_support::run;

/// The system's allocator, counting live bytes and the most there ever were.
struct Counting;

static LIVE: AtomicUsize = AtomicUsize::new(0);
static PEAK: AtomicUsize = AtomicUsize::new(0);

// SAFETY: every call is handed on unchanged to the system's allocator; only counters are kept beside.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let live = LIVE.fetch_add(layout.size(), Ordering::SeqCst) + layout.size();
        PEAK.fetch_max(live, Ordering::SeqCst);
        // SAFETY: the caller keeps the contract of `alloc`.
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, pointer: *mut u8, layout: Layout) {
        LIVE.fetch_sub(layout.size(), Ordering::SeqCst);
        // SAFETY: the caller keeps the contract of `dealloc`, and `pointer` came from the system's allocator.
        unsafe { System.dealloc(pointer, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// Most bytes alive while `work` ran, beyond those alive before.
fn peak_of<T>(work: impl FnOnce() -> T) -> (usize, T) {
    let before = LIVE.load(Ordering::SeqCst);
    PEAK.store(before, Ordering::SeqCst);
    let result = work();
    (PEAK.load(Ordering::SeqCst) - before, result)
}

// One test: the counters are of the whole process.
#[test]
fn the_built_in_scene_needs_sums_and_nothing_that_grows_with_photons() {
    let scene = build(&Description::built_in().unwrap()).unwrap();
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
            let cells: usize = outcome.cells.iter().map(|c| c.sum.len()).sum();
            // Sum and sum of squares over replicates, and the counters of one replicate.
            let sums = outcome.memory_bytes() + cells * size_of::<u64>();
            println!("{} photons: peak {peak} bytes, of them sums {sums}", outcome.photons);
            assert!(peak >= sums, "the allocator counts");
            assert!(peak < sums + (1 << 16), "{peak} bytes for sums of {sums}");
            peak
        })
        .collect();
    // 64 times the photons: what changes is a few kilobytes of the batches' ledgers. One byte a photon would be 1 MB.
    assert!(peaks.iter().all(|p| p.abs_diff(peaks[0]) < 1 << 15), "{peaks:?}");
}
