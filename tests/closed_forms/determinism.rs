//! The same seed gives the same bits: for any number of threads, any order of surfaces, any division of the photons.

use std::collections::HashMap;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::atomic::AtomicBool;

use caustix::files::scene_toml;
use caustix::files::scene_toml::read;
use caustix::sample::coordinates::Coordinates;
use caustix::sample::method::Sampling;
use caustix::scene::Scene;
use caustix::sequence::independent::IndependentPoints;
use caustix::sequence::owen::OwenPoints;
use caustix::sequence::{Points, Sequence};
use caustix::surface::Grey;
use caustix::tally::Receivers;
use caustix::transport::census::Exceptions;
use caustix::transport::parallel::{How, Traced, trace_range};
use caustix::transport::{Census, Ledger, walk};

use crate::support::data::project;
use crate::support::maps::{Maps, Samples, read_maps};
use crate::support::random::Generator;
use crate::support::scenes::{every_scene_file, run_with_killed};

/// Runs `caustix render` with these arguments into a new folder.
fn render(folder: &Path, arguments: &[&str]) -> PathBuf {
    let output = Command::new(env!("CARGO_BIN_EXE_caustix"))
        .arg("render")
        .args(arguments)
        .arg("-o")
        .arg(folder)
        .arg("--quiet")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    folder.to_path_buf()
}

/// The files of a folder with this extension, by name.
fn files(folder: &Path, extension: &str) -> Vec<(String, Vec<u8>)> {
    let mut all: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .map(|path| (path.file_name().unwrap().to_str().unwrap().to_string(), std::fs::read(&path).unwrap()))
        .collect();
    all.sort();
    assert!(!all.is_empty());
    all
}

#[test]
fn one_two_and_seven_threads_write_the_same_bytes_and_another_seed_others() {
    let folder = tempfile::tempdir().unwrap();
    let with = |name: &str, threads: &str, seed: &str| {
        let path = render(
            &folder.path().join(name),
            &["--photons", "2^16", "--replicates", "4", "--threads", threads, "--seed", seed],
        );
        (files(&path, "exr"), files(&path, "png"))
    };
    let one = with("one", "1", "5");
    assert!(one == with("two", "2", "5"));
    assert!(one == with("seven", "7", "5"));
    assert!(one == with("again", "7", "5"));
    let other = with("seed", "2", "6");
    assert!(one.0.iter().zip(&other.0).all(|(a, b)| a.0 == b.0 && a.1 != b.1));
    let hits = |name: &str| {
        let path = folder.path().join(name).join(&one.0[0].0);
        read_maps(path).unwrap().channels
    };
    assert!(hits("one") != hits("seed"), "the pixels differ, not only the attribute of the seed");
}

/// The text of a scene file with its `[[surface]]` parts in another order, and its paths made absolute.
fn reordered(text: &str, order: impl Fn(&mut Vec<String>)) -> String {
    let mut parts: Vec<String> = vec![String::new()];
    for line in text.lines() {
        if line.starts_with('[') {
            parts.push(String::new());
        }
        let part = parts.last_mut().unwrap();
        part.push_str(line);
        part.push('\n');
    }
    let (mut surfaces, others): (Vec<String>, Vec<String>) =
        parts.into_iter().partition(|part| part.starts_with("[[surface]]"));
    assert!(!surfaces.is_empty());
    order(&mut surfaces);
    let text = others.concat() + &surfaces.concat();
    text.replace("../ies/", &format!("{}/ies/", project().display()))
        .replace("../brdf_tables/", &format!("{}/brdf_tables/", project().display()))
        .replace("\"opal_cover.obj\"", &format!("\"{}/scenes/opal_cover.obj\"", project().display()))
        .replace("\"prism.obj\"", &format!("\"{}/scenes/prism.obj\"", project().display()))
        .replace("\"room/", &format!("\"{}/scenes/room/", project().display()))
        .replace("\"glassware/", &format!("\"{}/scenes/glassware/", project().display()))
}

/// A scene's text with small maps and a small picture, where it has one.
fn made_small(text: &str) -> String {
    let cells = |line: &str| line.starts_with("cells = [");
    let maps: Vec<&str> =
        text.lines().map(|line| if cells(line) { "cells = [48, 36]" } else { line }).collect();
    let text = maps.join("\n");
    let of_camera = text.find("\n[camera]").unwrap_or(text.len());
    let (scene, camera) = text.split_at(of_camera);
    let lines = camera.lines().map(|line| match line.split_once(" = ") {
        Some(("pixels", _)) => "pixels = [24, 18]\nsamples = 4",
        Some(("samples", _)) => "",
        _ => line,
    });
    scene.to_string() + &lines.collect::<Vec<_>>().join("\n")
}

/// Channels as bits: the pixels beyond the last face of a mesh are NaN, which is not equal to itself.
fn bits(maps: &Maps) -> Vec<(&str, Vec<u32>)> {
    let of = |data: &Samples| match data {
        Samples::F32(values) => values.iter().map(|v| v.to_bits()).collect(),
        Samples::U32(values) => values.clone(),
    };
    maps.channels.iter().map(|(name, data)| (name.as_str(), of(data))).collect()
}

#[test]
fn the_order_of_surfaces_changes_no_pixel() {
    let folder = tempfile::tempdir().unwrap();
    for file in every_scene_file() {
        let name = file.file_stem().unwrap().to_str().unwrap();
        let text = made_small(&std::fs::read_to_string(&file).unwrap());
        let maps = |label: &str, order: &dyn Fn(&mut Vec<String>)| -> Vec<Maps> {
            let scene = folder.path().join(format!("{name}-{label}.toml"));
            std::fs::write(&scene, reordered(&text, order)).unwrap();
            let out = folder.path().join(format!("{name}-{label}"));
            render(&out, &[scene.to_str().unwrap(), "--photons", "2^12", "--replicates", "4"]);
            files(&out, "exr").iter().map(|(exr, _)| read_maps(out.join(exr)).unwrap()).collect()
        };
        let original = maps("original", &|_| {});
        for (label, other) in [
            ("reversed", maps("reversed", &|s| s.reverse())),
            ("rotated", maps("rotated", &|s| s.rotate_left(1))),
        ] {
            for (a, b) in original.iter().zip(&other) {
                assert!(bits(a) == bits(b), "{name}, {label}");
                let differ: Vec<&String> =
                    a.attributes.keys().filter(|k| a.attributes.get(*k) != b.attributes.get(*k)).collect();
                assert!(
                    differ.iter().all(|k| k.starts_with("caustix.scene.")),
                    "{name}, {label}: {differ:?}"
                );
                assert_eq!(a.attributes.len(), b.attributes.len());
            }
        }
    }
}

#[test]
fn seeds_and_replicates_share_no_coordinate_stream() {
    // 64-bit values: among the 170,000 here a chance collision has a probability of 1e-9.
    let mut seen: HashMap<u64, (u64, u32, u32, u64)> = HashMap::new();
    let mut streams = 0;
    for seed in [1u64, 2, 3, u64::MAX] {
        for replicate in 0..4u32 {
            let owen = OwenPoints::new(seed, replicate);
            for coordinate in 0..66u32 {
                streams += 1;
                for index in 0..160u64 {
                    let value = owen.coordinate(index, coordinate);
                    let before = seen.insert(value, (seed, replicate, coordinate, index));
                    assert_eq!(before, None, "seed {seed}, replicate {replicate}, coordinate {coordinate}");
                }
            }
        }
    }
    assert_eq!(streams, 4 * 4 * 66);
}

/// Traces a range of indices into counters of its own.
fn part<'s, P: Points>(scene: &'s Scene, points: &P, range: Range<u64>) -> (Receivers<'s>, Traced) {
    let receivers = Receivers::new(&scene.geometry, &scene.receivers);
    let interrupt = AtomicBool::new(false);
    let how = How { sampling: Sampling::default(), reuse: true, interrupt: &interrupt, progress: &|_| {} };
    let traced = trace_range(scene, &scene.emitters, points, range, Grey, how, || receivers.sink());
    assert!(traced.complete);
    (receivers, traced)
}

fn counts(scene: &Scene, receivers: &Receivers<'_>) -> Vec<Vec<u64>> {
    (0..scene.receivers.len()).map(|r| receivers.counts(r).iter().collect()).collect()
}

/// The whole range at once against random divisions of it, merged in random order.
fn assert_additive<P: Points>(scene: &Scene, points: &P, n: u64, random: &mut impl FnMut() -> u64) {
    let (whole, traced) = part(scene, points, 0..n);
    for pieces in [2usize, 3, 17] {
        let mut cuts: Vec<u64> = (1..pieces).map(|_| random() % n).chain([0, n]).collect();
        cuts.sort_unstable();
        let mut ranges: Vec<Range<u64>> = cuts.windows(2).map(|w| w[0]..w[1]).collect();
        for i in (1..ranges.len()).rev() {
            ranges.swap(i, (random() % (i as u64 + 1)) as usize);
        }
        let mut sum: Vec<Vec<u64>> = scene.receivers.iter().map(|r| vec![0; r.cells.len()]).collect();
        let mut ledger = Ledger::new(scene.emitters.as_slice().len(), scene.geometry.surfaces().len());
        let mut census = Census::default();
        for range in ranges {
            let (receivers, traced) = part(scene, points, range);
            for (sum, part) in sum.iter_mut().flatten().zip(counts(scene, &receivers).iter().flatten()) {
                *sum += part;
            }
            ledger.merge(&traced.ledger);
            census.merge(&traced.census);
        }
        assert!(sum == counts(scene, &whole));
        assert_eq!(ledger, traced.ledger);
        assert_eq!(census, traced.census);
    }
}

#[test]
fn the_tally_of_two_sets_is_the_merge_of_their_tallies() {
    // SplitMix64: cuts and orders, the same every time.
    let mut generator = Generator(7);
    let mut random = || generator.next();
    let built_in = scene_toml::built_in().unwrap().build().unwrap();
    let pool = read(project().join("scenes/pool.toml")).unwrap().build().unwrap();
    for scene in [&built_in, &pool] {
        assert_additive(scene, &OwenPoints::new(1, 0), 40_000, &mut random);
        assert_additive(scene, &IndependentPoints::new(1, 3), 20_001, &mut random);
    }
}

#[test]
fn the_ledger_closes_in_every_scene() {
    for file in every_scene_file() {
        let scene = read(&file).unwrap().build().unwrap();
        for (sequence, seed) in [(Sequence::SobolOwen, 1), (Sequence::Independent, 2)] {
            let n = 3 * 5001;
            let outcome = run_with_killed(&scene, sequence, 5001, 3, seed);
            let ledger = &outcome.ledger;
            assert_eq!((ledger.total_emitted(), ledger.total_ended()), (n, n), "{}", file.display());
            assert_eq!(ledger.emitted.iter().sum::<u64>(), n);
            let others = [ledger.escaped, ledger.killed, ledger.total_trapped()];
            assert_eq!(ledger.absorbed.iter().chain(&others).sum::<u64>(), n);
            // What total reflection keeps in the wine glass is trapped, not killed.
            assert_eq!(ledger.killed, 0, "{}", file.display());
            assert_eq!(outcome.census.photons(), n);
            // The accounts that errors are computed from are the ledger's own numbers.
            let accounts: Vec<u64> = ledger.absorbed.iter().copied().chain(others).collect();
            assert_eq!(outcome.accounts().sum, accounts);
        }
    }
}

#[test]
fn a_photon_lost_on_purpose_is_seen() {
    struct Nothing;
    impl caustix::transport::Sink for Nothing {
        fn arrive(&mut self, _: &caustix::transport::Arrival<'_>) {}
    }
    let scene = scene_toml::built_in().unwrap().build().unwrap();
    let points = OwenPoints::new(1, 0);
    let n = 4096;
    for doctored in [None, Some(0), Some(1234), Some(n - 1)] {
        let mut ledger = Ledger::new(1, scene.geometry.surfaces().len());
        for index in 0..n {
            let mut coordinates = Coordinates::new(&points, index, true);
            let (emitter, emission) = scene.emitters.emit(Sampling::default(), &mut coordinates).unwrap();
            ledger.begin(emitter);
            let mut exceptions = Exceptions::default();
            let start = scene.start(emitter);
            let end = walk(&scene, emission, start, Grey, &mut coordinates, &mut Nothing, &mut exceptions);
            if doctored != Some(index) {
                ledger.end(end);
            }
        }
        let lost = u64::from(doctored.is_some());
        assert_eq!(ledger.is_balanced(), lost == 0);
        assert_eq!(ledger.total_emitted() - ledger.total_ended(), lost);
        // Another loss does not make up for it when ledgers are merged, and one ended twice is seen as well.
        let mut twice = ledger.clone();
        twice.merge(&ledger);
        assert_eq!(twice.is_balanced(), lost == 0);
        let mut double = ledger.clone();
        double.escaped += 2;
        assert!(!double.is_balanced());
    }
}
