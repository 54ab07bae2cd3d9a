//! A folder with copies of the scenes and of what they name, in which the command runs: paths are the same
//! everywhere.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

use tempfile::TempDir;

use crate::book::Parts;
use crate::content;
use crate::runs::{Run, Threads};

/// Folders that scenes name files of, as they lie to each other in the repository.
const FOLDERS: [&str; 4] = ["ies", "brdf_tables", "scenes", "tests/golden/scenes"];

/// Where a run writes.
pub const OUT: &str = "out";

/// The folder.
pub struct Workplace {
    folder: TempDir,
    binary: PathBuf,
}

impl Workplace {
    /// A new one. Scenes lose their comments, so that another wording leaves `caustix.scene.text` as it is;
    /// those of `scenes/` become small.
    pub fn new() -> Self {
        let folder = tempfile::tempdir().unwrap();
        for name in FOLDERS {
            let source = Path::new(env!("CARGO_MANIFEST_DIR")).join(name);
            copy(&source, &folder.path().join(name), name == "scenes");
        }
        fs::write(folder.path().join("tests/golden/scenes/measured.binary"), merl()).unwrap();
        let binary = std::env::var_os("CAUSTIX_GOLDEN_BIN").unwrap_or(env!("CARGO_BIN_EXE_caustix").into());
        Self { folder, binary: fs::canonicalize(binary).unwrap() }
    }

    /// Files of a folder with this ending, by name.
    pub fn list(&self, folder: &str, ending: &str) -> Vec<String> {
        let entries = fs::read_dir(self.folder.path().join(folder)).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.filter(|name| name.ends_with(ending)).collect();
        names.sort();
        assert!(!names.is_empty(), "no file {ending} in {folder}");
        names
    }

    /// Does the run and hashes every file that it leaves.
    pub fn files_of(&self, run: &Run, threads: u32) -> Vec<(String, Parts)> {
        let out = self.folder.path().join(OUT);
        if out.exists() {
            fs::remove_dir_all(&out).unwrap();
        }
        fs::create_dir(&out).unwrap();
        for line in &run.lines {
            let mut command = Command::new(&self.binary);
            command.args(line.split_whitespace()).current_dir(self.folder.path());
            if run.threads != Threads::NotAsked {
                command.args(["--quiet", "--threads", &threads.to_string()]);
            }
            let output = command.output().unwrap();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(output.status.success(), "{}: caustix {line}: {}\n{said}", run.name, output.status);
            if line.contains("--json") {
                fs::write(out.join("stdout.json"), &output.stdout).unwrap();
            }
        }
        let mut files = Vec::new();
        for entry in fs::read_dir(&out).unwrap().map(Result::unwrap).filter(|e| e.path().is_file()) {
            let parts = content::parts(&entry.path());
            files.extend(parts.map(|parts| (entry.file_name().into_string().unwrap(), parts)));
        }
        assert!(!files.is_empty(), "{} left nothing", run.name);
        files
    }
}

/// A MERL file: too long for the repository, and easily told.
fn merl() -> Vec<u8> {
    const COUNTS: [u32; 3] = [90, 90, 180];
    let values =
        (0..3 * COUNTS.iter().product::<u32>()).map(|i| 150.0 + 0.125 * f64::from(i % 997 * 7 % 800));
    COUNTS.into_iter().flat_map(u32::to_le_bytes).chain(values.flat_map(f64::to_le_bytes)).collect()
}

fn copy(source: &Path, target: &Path, small: bool) {
    fs::create_dir_all(target).unwrap();
    for entry in fs::read_dir(source).unwrap().map(Result::unwrap) {
        let (from, to) = (entry.path(), target.join(entry.file_name()));
        if from.is_dir() {
            copy(&from, &to, small);
        } else if from.extension().is_some_and(|e| e == "toml") {
            let text = without_comments(&fs::read_to_string(&from).unwrap());
            fs::write(&to, if small { made_small(&text) } else { text }).unwrap();
        } else {
            fs::copy(&from, &to).unwrap();
        }
    }
}

/// The lines without comments, blank ones left out. No scene has a `#` in a text.
fn without_comments(text: &str) -> String {
    let lines = text.lines().map(|line| line.split('#').next().unwrap_or_default().trim_end());
    lines.filter(|line| !line.is_empty()).map(|line| format!("{line}\n")).collect()
}

/// The scene with few pixels, few eye paths and few cells of its receivers; heightfields keep their cells.
fn made_small(text: &str) -> String {
    let mut small = String::new();
    let mut section = "";
    for line in text.lines() {
        let key = line.split('=').next().unwrap_or_default().trim();
        match (section, key) {
            ("[camera]", "pixels") => small += "pixels = [40, 24]\nsamples = 4\n",
            ("[camera]", "samples") => {}
            ("[[receiver]]", "cells") => small += "cells = [24, 16]\n",
            _ => small += &format!("{line}\n"),
        }
        if line.starts_with('[') {
            section = line;
        }
    }
    small
}
