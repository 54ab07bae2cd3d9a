//! The same numbers as before, bit for bit: what the command writes is compared with hashes that were made
//! earlier.
//!
//! The scenes are those of `scenes/`, made small, and those of `scenes/` beside this file, which together
//! name every emitter, material, shape, receiver and camera that a scene file can; beside them stand runs of
//! the options. All is run with 1 and with 3 threads. Only the command line is used, nothing of the library:
//! the test outlives any change of the code's inside.
//!
//! What is hashed is content, not bytes: of an EXR every channel's values and every attribute, of a CSV every
//! column, of a PLY header and body, of JSON every key to the second level. Left out are times, the program's
//! version, hashes of scenes and files, paths, memory and threads. Each of these parts has its own hash, so
//! that a failure names it.
//!
//! A change that means to change numbers is marked **Value-breaking** and makes the hashes anew:
//!
//!     CAUSTIX_GOLDEN_WRITE=tests/golden/hashes.txt cargo test --locked --release --test golden
//!
//! `CAUSTIX_GOLDEN_BIN=path` runs another binary than the one just built: an older one, to make the hashes
//! from it. Pixels of PNGs and plots stand in a section of their own, `[drawings]`, since drawing may change
//! where numbers do not.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod book;
mod content;
mod openexr;
mod runs;
mod workplace;

use std::path::Path;

use book::Book;
use workplace::Workplace;

/// Differences that are told before the rest are only counted.
const MOST_TOLD: usize = 60;

#[test]
fn every_number_is_the_recorded_one_with_1_and_with_3_threads() {
    let workplace = Workplace::new();
    let runs = runs::all(&workplace);
    let book_of = |threads: u32| {
        let mut book = Book::default();
        for run in runs.iter().filter(|run| run.is_with(threads)) {
            for (file, parts) in workplace.files_of(run, threads) {
                book.add(&run.name, &file, parts);
            }
        }
        book
    };
    let (one, three) = (book_of(1), book_of(3));
    // Runs that are no longer there count as runs with either number of threads, so that they are missed.
    let with = |threads: u32| {
        let runs = &runs;
        move |name: &str| runs.iter().find(|run| run.name == name).is_none_or(|run| run.is_with(threads))
    };
    if let Some(path) = std::env::var_os("CAUSTIX_GOLDEN_WRITE") {
        fail_on("3 threads against 1 thread", &one.only(with(3)).differences(&three.only(with(1))));
        std::fs::write(path, one.with(three).to_text()).unwrap();
        return;
    }
    let recorded = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/hashes.txt");
    let recorded = Book::from_text(&std::fs::read_to_string(recorded).unwrap());
    fail_on("1 thread", &recorded.only(with(1)).differences(&one));
    fail_on("3 threads", &recorded.only(with(3)).differences(&three));
}

fn fail_on(what: &str, differences: &[String]) {
    let told = differences.len().min(MOST_TOLD);
    assert!(
        differences.is_empty(),
        "{what}: {} parts differ from what was recorded\n{}\n{}",
        differences.len(),
        differences[..told].join("\n"),
        if told < differences.len() { "and more" } else { "" }
    );
}
