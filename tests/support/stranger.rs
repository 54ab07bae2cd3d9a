//! The command as a stranger types it, in a folder of its own.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// A new folder with files of a test's own.
pub struct Stranger(TempDir);

impl Stranger {
    pub fn new() -> Self {
        Self(tempfile::tempdir().unwrap())
    }

    pub fn with(files: &[(&str, &str)]) -> Self {
        let new = Self::new();
        for (name, text) in files {
            new.write(name, text);
        }
        new
    }

    pub fn folder(&self) -> &Path {
        self.0.path()
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    /// `caustix LINE` in the folder.
    pub fn command(&self, line: &str) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_caustix"));
        command.args(line.split_whitespace()).current_dir(self.0.path());
        command
    }

    /// Types the line; the exit code and what it says on stdout and stderr.
    pub fn types(&self, line: &str) -> (i32, String, String) {
        let Output { status, stdout, stderr } = self.command(line).output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        (status.code().unwrap(), text(stdout), text(stderr))
    }

    /// The same for a line that must fail with this code and say all of these.
    pub fn is_told(&self, line: &str, code: i32, all: &[&str]) {
        let (exit, out, err) = self.types(line);
        assert_eq!(exit, code, "caustix {line}\n{out}{err}");
        for part in all {
            assert!(err.contains(part), "caustix {line}: no \"{part}\" in\n{err}");
        }
    }

    pub fn report(&self, folder: &str) -> Value {
        serde_json::from_str(&fs::read_to_string(self.path(folder).join("report.json")).unwrap()).unwrap()
    }
}
