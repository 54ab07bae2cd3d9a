//! Scenes from text and from the project's files, and runs of them.

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;

use caustix::error::Diagnostic;
use caustix::files::bytes::Base;
use caustix::files::scene_toml::parse;
use caustix::run::{Algorithm, Outcome, Plan, Settings, trace};
use caustix::scene::Scene;
use caustix::sequence::Sequence;

use super::data::project;

/// A scene from its text; paths are relative to `scenes/`.
pub fn scene(text: &str) -> Scene {
    try_scene(text).unwrap_or_else(|e| panic!("{e:?}\n{text}"))
}

/// The same for a text that may be refused.
pub fn try_scene(text: &str) -> Result<Scene, Vec<Diagnostic>> {
    parse(text, "test.toml", Base::Directory(project().join("scenes")))?.build()
}

/// Every scene file of the project, by name.
pub fn every_scene_file() -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> = std::fs::read_dir(project().join("scenes"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    files.sort();
    files
}

/// Those with a camera, or those without.
///
/// Tests that bound rounding run over those without: a scene with a camera is made to be looked at, of balls, rings and wine
/// glasses in which light goes round, and every turn magnifies rounding. What changes no bit is tested on both.
fn scene_files_by(with_camera: bool, fewest: usize) -> Vec<PathBuf> {
    let mut files = every_scene_file();
    files.retain(|path| std::fs::read_to_string(path).unwrap().contains("\n[camera]") == with_camera);
    assert!(files.len() >= fewest, "the project has {fewest} such scenes");
    files
}

/// The scene files without a camera.
pub fn scene_files() -> Vec<PathBuf> {
    scene_files_by(false, 6)
}

/// The scene files with a camera.
pub fn camera_scene_files() -> Vec<PathBuf> {
    scene_files_by(true, 5)
}

/// Traces `replicates` sets of `per_replicate` photons, none of which may go on for ever.
pub fn run(scene: &Scene, sequence: Sequence, per_replicate: u64, replicates: u32, seed: u64) -> Outcome {
    let outcome = run_with_killed(scene, sequence, per_replicate, replicates, seed);
    assert_eq!(outcome.killed_lm().value, 0.0);
    outcome
}

/// The same where some may.
pub fn run_with_killed(
    scene: &Scene,
    sequence: Sequence,
    per_replicate: u64,
    replicates: u32,
    seed: u64,
) -> Outcome {
    let settings = Settings {
        photons: Some(per_replicate * u64::from(replicates)),
        replicates: Some(replicates),
        seed,
        algorithm: Algorithm { sequence, ..Algorithm::default() },
    };
    let plan = Plan::new(&settings).unwrap();
    trace(scene, &plan, &AtomicBool::new(false), &|_| {}).unwrap()
}
