//! What the closed-form tests share: scenes from text, quadrature, and the judgement of a map in its own standard errors.
#![allow(dead_code)]

pub mod judge;
pub mod quadrature;

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use caustix::run::{Algorithm, Outcome, Plan, Settings, trace};
use caustix::scene::Scene;
use caustix::scene::build::build;
use caustix::scene::description::Description;
use caustix::scene::file::parse;
use caustix::scene::source::Base;
use caustix::sequence::Sequence;

/// The project's folder.
pub fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// A scene's text as a description; paths are relative to `scenes/`.
pub fn describe(text: &str) -> Description {
    parse(text, "test.toml", Base::Directory(project().join("scenes")))
        .unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// A scene from its text; paths are relative to `scenes/`.
pub fn scene(text: &str) -> Scene {
    build(&describe(text)).unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// Every scene file of the project, by name.
///
/// Without those that have a camera: they are made to be looked at, of balls, rings and wine glasses in which light goes round, and
/// every turn magnifies the rounding that is bounded here.
pub fn scene_files() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(project().join("scenes"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .filter(|path| !std::fs::read_to_string(path).unwrap().contains("\n[camera]"))
        .collect();
    files.sort();
    assert!(files.len() >= 6, "the project has six scenes");
    files
}

/// Traces `replicates` sets of `per_replicate` photons.
pub fn run(scene: &Scene, sequence: Sequence, per_replicate: u64, replicates: u32, seed: u64) -> Outcome {
    let settings = Settings {
        photons: Some(per_replicate * u64::from(replicates)),
        replicates: Some(replicates),
        seed,
        algorithm: Algorithm { sequence, ..Algorithm::default() },
    };
    let plan = Plan::new(&settings).unwrap();
    let outcome = trace(scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap();
    assert_eq!(outcome.killed_lm().value, 0.0);
    outcome
}
