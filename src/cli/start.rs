//! What commands with a scene begin with: the scene, the threads, the files that there will be.

use std::path::{Path, PathBuf};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::folder::LOCK;
use crate::files::run_state::STATE;
use crate::files::scene_toml::{self, RunDefaults};
use crate::scene::Scene;
use crate::scene::receiver::Receiver;

use super::args::MAX_THREADS;
use super::misuse::a_folder;
use super::progress::Progress;
use super::written::{REPORT, endings};
use super::{far_field, picture};

/// Reads and builds a scene, from its own folder alone if it is confined to that; without a path the built-in one.
pub(super) fn load(
    path: Option<&Path>,
    confine: bool,
    quiet: bool,
) -> std::result::Result<(Scene, RunDefaults), Vec<Diagnostic>> {
    let name = path.map_or("the built-in scene".into(), |path| path.display().to_string());
    let progress = Progress::new(quiet, &format!("reading {name}"), 0);
    let loaded = load_in_phases(path, confine, || progress.phase(format!("building {name}")));
    progress.clear();
    loaded
}

fn load_in_phases(
    path: Option<&Path>,
    confine: bool,
    building: impl FnOnce(),
) -> std::result::Result<(Scene, RunDefaults), Vec<Diagnostic>> {
    let file = match path {
        Some(path) if path.is_dir() => return Err(a_folder(path, "a scene file (TOML)").into()),
        Some(path) if confine => scene_toml::read_confined(path)?,
        Some(path) => scene_toml::read(path)?,
        None => scene_toml::built_in()?,
    };
    let run = file.run;
    building();
    Ok((file.build()?, run))
}

/// Every file that the results of a scene are; `traced`: with those of its receivers and far fields.
pub(super) fn files_of<'a>(
    scene: &'a Scene,
    output: &'a Path,
    traced: bool,
) -> impl Iterator<Item = PathBuf> + 'a {
    let of_receiver = |receiver: &'a Receiver| {
        let endings = endings(receiver).into_iter();
        endings.map(|ending| format!("{}.{ending}", receiver.name))
    };
    let of_receivers = scene.receivers.iter().filter(move |_| traced).flat_map(of_receiver);
    let of_fields = scene.far_fields.iter().filter(move |_| traced).flat_map(far_field::files);
    let of_camera = scene.camera.iter().flat_map(|spec| picture::files(spec));
    let names =
        of_receivers.chain(of_fields).chain(of_camera).chain([REPORT, LOCK, STATE].map(str::to_string));
    names.map(|name| output.join(name))
}

/// The threads that are asked for, all cores where none are.
pub(super) fn thread_pool(threads: Option<u32>) -> Result<rayon::ThreadPool> {
    if let Some(threads) = threads.filter(|t| !(1..=MAX_THREADS).contains(t)) {
        let found = format!("--threads {threads}");
        return Err(Diagnostic::new(Kind::Range, found, format!("1 to {MAX_THREADS} threads")));
    }
    let threads = threads.unwrap_or(0);
    rayon::ThreadPoolBuilder::new().num_threads(threads as usize).build().map_err(|e| {
        Diagnostic::new(Kind::Limit, format!("{threads} threads: {e}"), "threads that can be started")
    })
}
