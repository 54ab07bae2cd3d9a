//! Parts that a study has finished, and what names them.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::progress::{Progress, catch_interrupts};
use super::{exit, print, results, say};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::clear_temporaries;
use crate::files::folder::Folder;
use crate::files::outputs::check_outputs;
use crate::files::parts::{Found, Parts};
use crate::files::set::Set;
use crate::lab::study::REVISION;
use crate::report::json::SceneReport;
use crate::report::vouched::vouching;
use crate::scene::Scene;

/// All that a scene's photons depend on.
pub fn scene_key(scene: &Scene) -> String {
    let identity = &scene.identity;
    let version = env!("CARGO_PKG_VERSION");
    let mut key = format!("caustix {version} revision {REVISION}\nscene {}", identity.sha256);
    for (file, sha256) in &identity.files {
        key.push_str(&format!("\nfile {sha256} {file}"));
    }
    key
}

/// What a study is given and writes.
pub struct Order<'a> {
    /// Its folder.
    pub output: &'a Path,
    /// No bar and no table.
    pub quiet: bool,
    /// Files that are read.
    pub inputs: Vec<PathBuf>,
    /// The list of the files that are written.
    pub list: &'static str,
    /// The names of these.
    pub files: &'a [&'a str],
}

/// The parts that a study keeps, and the bar over its photons.
pub struct Kept {
    folder: Folder,
    inputs: Vec<PathBuf>,
    list: &'static str,
    quiet: bool,
    pub parts: Parts,
    pub progress: Progress,
}

impl Kept {
    /// Takes the folder of a study of so many photons, and catches Ctrl-C.
    ///
    /// # Errors
    /// A folder that cannot be made or that another run has; files that would replace those of the scene.
    pub fn start(order: Order<'_>, photons: u64) -> Result<Self> {
        let Order { output, quiet, inputs, list, files } = order;
        let folder = results::take(output)?;
        let outputs: Vec<PathBuf> = files.iter().chain(&[list]).map(|name| output.join(name)).collect();
        check_outputs(&outputs, &inputs)?;
        catch_interrupts();
        let parts = Parts::new(output.join("parts"));
        clear_temporaries(parts.directory());
        Ok(Self { folder, inputs, list, quiet, parts, progress: Progress::new(quiet, "starting", photons) })
    }

    /// A part that is there and whole; one that is damaged is told, and made again.
    pub fn found(&self, kind: &str, key: &str) -> Option<Vec<u8>> {
        match self.parts.load(kind, key) {
            Found::Whole(content) => Some(content),
            Found::Missing => None,
            Found::Damaged(diagnostic) => {
                self.progress.suspend(|| say(&format!("warning: {diagnostic}")));
                None
            }
        }
    }

    /// A part in JSON, of so many photons: the one that is there, else one that is made, and kept; `None` where it was not finished.
    ///
    /// # Errors
    /// Those of making it; a file that cannot be written.
    pub fn part<T: Serialize + DeserializeOwned>(
        &self,
        kind: &str,
        key: &str,
        photons: u64,
        make: impl FnOnce(&(dyn Fn(u64) + Sync)) -> Result<Option<T>>,
    ) -> Result<Option<T>> {
        let found = self.found(kind, key).and_then(|bytes| serde_json::from_slice(&bytes).ok());
        if found.is_some() {
            self.progress.inc(photons);
            return Ok(found);
        }
        let made = make(&|n| self.progress.inc(n))?;
        if let Some(part) = &made {
            let bytes = serde_json::to_vec_pretty(part).map_err(|e| {
                Diagnostic::new(Kind::Io, format!("\"{e}\" while writing a {kind}"), "a part as text")
            })?;
            self.parts.store(kind, key, &bytes)?;
        }
        Ok(made)
    }

    /// Says how to go on after an interrupt, and what there is by then; the exit code.
    pub fn interrupted(&self, what: &str) -> u8 {
        let folder = self.parts.directory().display();
        say(&format!("caustix: interrupted; {what}. The same command goes on from the parts in {folder}"));
        exit::INTERRUPTED
    }

    /// Writes the files of a study, and prints what it found; whether all could be written.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn write(&self, scene: &Scene, files: &[(&str, String)], text: &str) -> Result<bool> {
        let mut set = Set::new(&self.folder, self.list)?;
        for (name, content) in files {
            set.add_bytes(name, content.as_bytes());
        }
        let report = StudyReport { caustix: env!("CARGO_PKG_VERSION"), scene: SceneReport::new(scene) };
        let written = set.finish(|files| vouching(&report, files));
        results::tell(&self.folder, &written, &self.inputs);
        if !self.quiet {
            print(text);
            print(&results::written_to(&self.folder, &written));
        }
        Ok(written.errors.is_empty())
    }
}

/// What the list says besides.
#[derive(Serialize)]
struct StudyReport {
    /// Version of the program.
    caustix: &'static str,
    /// The scene.
    scene: SceneReport,
}

/// The command as it was typed, without the folder that the program lies in.
pub fn command_line() -> String {
    let quoted = |word: String| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:^=+".contains(c);
        if !word.is_empty() && word.chars().all(plain) { word } else { format!("'{word}'") }
    };
    let words = std::env::args_os().skip(1).map(|word| quoted(word.to_string_lossy().into_owned()));
    std::iter::once("caustix".to_string()).chain(words).collect::<Vec<_>>().join(" ")
}
