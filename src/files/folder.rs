//! A folder of results that one run has for itself: a lock keeps a second one out, and what a dead one left is removed.
//!
//! The lock is the operating system's, on an open file: it ends with its process, however that ends, so none is ever left to
//! be removed by hand. While a run lasts, its files lie in a hidden folder within ([`super::set`]).

use std::collections::BTreeSet;
use std::ffi::OsStr;
use std::fs::{self, File, OpenOptions, TryLockError};
use std::io;
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::{clear_temporaries, make_directory};
use crate::files::bytes::read_capped;

/// The file that is locked.
pub const LOCK: &str = ".caustix.lock";
/// Folders of files that are not yet in their places.
const STAGING: (&str, &str) = (".caustix-", ".new");
/// Largest list of files that is read.
const MOST_MANIFEST_BYTES: u64 = 1 << 30;
/// Files that list others and vouch for them, each for a set of its own.
pub const MANIFESTS: [&str; 3] = ["report.json", "compare.json", "sweep.json"];
/// Endings of files that are results.
const ENDINGS: [&str; 8] = ["exr", "png", "csv", "ply", "vtp", "svg", "md", "json"];

/// Tells several hidden folders of one process apart.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// A folder that is locked until this is dropped.
#[derive(Debug)]
pub struct Folder {
    path: PathBuf,
    /// `None` where the file system knows no locks.
    lock: Option<File>,
    /// The name of the file that is locked.
    locked: String,
    is_new: bool,
    cleared: usize,
    /// The list that a run which was ended had ready, and did not come to write.
    torn: Option<&'static str>,
}

impl Folder {
    /// Makes the folder where it is not there, locks it, and removes what dead runs left.
    ///
    /// # Errors
    /// A folder that cannot be made or written to, or that another run has.
    pub fn take(path: &Path, required: &str) -> Result<Self> {
        let mut folder = Self::take_part(path, LOCK, required)?;
        // Without locks, what looks left may be another's.
        if folder.lock.is_some() {
            folder.clear();
        }
        Ok(folder)
    }

    /// Makes the folder where it is not there, for a run that writes one file into it, beside others that do so: the lock of
    /// this name keeps out a second one of the same file.
    ///
    /// # Errors
    /// As [`Self::take`].
    pub fn take_part(path: &Path, locked: &str, required: &str) -> Result<Self> {
        let is_new = !path.exists();
        make_directory(path, required)?;
        let lock = lock(path, locked).map_err(|e| match e.kind() {
            Kind::Unavailable if locked != LOCK => {
                let found = "this part of the run is being traced already";
                Diagnostic::new(Kind::Unavailable, found, "each part once").in_file(path)
            }
            _ => e,
        })?;
        Ok(Self { path: path.to_path_buf(), lock, locked: locked.to_owned(), is_new, cleared: 0, torn: None })
    }

    fn clear(&mut self) {
        let is_left =
            |name: &OsStr| name.to_str().is_some_and(|n| n.starts_with(STAGING.0) && n.ends_with(STAGING.1));
        for entry in fs::read_dir(&self.path).into_iter().flatten().flatten() {
            if is_left(&entry.file_name()) && entry.file_type().is_ok_and(|kind| kind.is_dir()) {
                let is_without =
                    |name: &str| entry.path().join(name).exists() && !self.path.join(name).exists();
                self.torn = MANIFESTS.into_iter().find(|name| is_without(name)).or(self.torn);
                self.cleared += usize::from(fs::remove_dir_all(entry.path()).is_ok());
            }
        }
        self.cleared += clear_temporaries(&self.path);
    }

    /// Where it is.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What is to be said of what was found in it, a line each.
    pub fn remarks(&self) -> Vec<String> {
        let shown = self.path.display();
        let mut remarks = Vec::new();
        if self.lock.is_none() {
            remarks.push(format!("{shown} cannot be locked: see that no other run writes into it"));
        }
        if let Some(list) = self.torn {
            let why = format!("without {list} they were no whole set");
            remarks.push(format!("an earlier run was ended while it wrote its results into {shown}: {why}"));
        }
        if self.cleared > 0 {
            let files = if self.cleared == 1 { "leftover" } else { "leftovers" };
            remarks.push(format!("removed {} {files} of runs that were ended from {shown}", self.cleared));
        }
        remarks
    }

    /// A new hidden folder within, for files that are not yet in their places.
    pub(super) fn staging(&self) -> Result<PathBuf> {
        let number = NEXT.fetch_add(1, Ordering::Relaxed);
        let path = self.path.join(format!("{}{}-{number}{}", STAGING.0, process::id(), STAGING.1));
        // Left where there are no locks, by a process that had our id.
        fs::remove_dir_all(&path).ok();
        make_directory(&path, "a folder that can be written to")?;
        Ok(path)
    }

    /// Names of results in the folder that are neither `ours` nor in the list of another set; inputs of the run are no results.
    pub fn others(&self, ours: &BTreeSet<String>, inputs: &[PathBuf]) -> Vec<String> {
        let mut known = ours.clone();
        for manifest in MANIFESTS {
            known.insert(manifest.to_string());
            known.extend(listed(&self.path.join(manifest)));
        }
        let inputs: BTreeSet<PathBuf> = inputs.iter().filter_map(|path| path.canonicalize().ok()).collect();
        let is_result = |name: &str| {
            let ending = Path::new(name).extension().and_then(OsStr::to_str);
            ending.is_some_and(|e| ENDINGS.contains(&e)) && !name.starts_with('.')
        };
        let mut others: Vec<String> = fs::read_dir(&self.path)
            .into_iter()
            .flatten()
            .flatten()
            .filter(|entry| entry.path().is_file())
            .filter(|entry| entry.path().canonicalize().is_ok_and(|path| !inputs.contains(&path)))
            .filter_map(|entry| entry.file_name().into_string().ok())
            .filter(|name| is_result(name) && !known.contains(name))
            .collect();
        others.sort();
        others
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        // On Unix a file may be unlinked while it is locked; whoever waits for the lock looks whether it is still the one of
        // that name. Elsewhere it stays.
        if cfg!(unix) && self.lock.is_some() {
            fs::remove_file(self.path.join(&self.locked)).ok();
        }
        if self.is_new {
            // Fails where results are in it.
            fs::remove_dir(&self.path).ok();
        }
    }
}

/// Names that a manifest lists; none where it is not there or no manifest.
pub(super) fn listed(manifest: &Path) -> Vec<String> {
    let text = || read_capped(manifest, MOST_MANIFEST_BYTES).ok();
    let read = || serde_json::from_slice::<serde_json::Value>(&text()?).ok();
    let Some(json) = read() else { return Vec::new() };
    json["files"].as_object().map(|files| files.keys().cloned().collect()).unwrap_or_default()
}

/// Locks the folder; `None` where its file system has no locks.
fn lock(folder: &Path, name: &str) -> Result<Option<File>> {
    let path = folder.join(name);
    let io = |e: io::Error| {
        let found = format!("\"{e}\" while locking the folder");
        Diagnostic::new(Kind::Io, found, "a folder that can be written to").in_file(folder)
    };
    loop {
        let file = OpenOptions::new().create(true).truncate(false).write(true).open(&path).map_err(io)?;
        match file.try_lock() {
            Ok(()) if is_still(&file, &path) => return Ok(Some(file)),
            // The run that had it is done and took its name away: the next of that name.
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                let found = "another run of caustix is writing its results into this folder";
                return Err(Diagnostic::new(Kind::Unavailable, found, "a folder of its own for each run")
                    .hint("wait until the other run has ended, or give another folder with -o")
                    .in_file(folder));
            }
            Err(TryLockError::Error(_)) => return Ok(None),
        }
    }
}

/// Whether an open file is the one of this name.
#[cfg(unix)]
fn is_still(file: &File, path: &Path) -> bool {
    use std::os::unix::fs::MetadataExt;
    let identity = |m: fs::Metadata| (m.dev(), m.ino());
    match (file.metadata(), fs::metadata(path)) {
        (Ok(open), Ok(named)) => identity(open) == identity(named),
        _ => false,
    }
}

/// Elsewhere the file stays, so it is.
#[cfg(not(unix))]
fn is_still(_file: &File, _path: &Path) -> bool {
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let mut names: Vec<String> =
            fs::read_dir(directory).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
        names.sort();
        names
    }

    #[test]
    fn a_second_run_is_kept_out_and_nothing_is_left() {
        let around = tempfile::tempdir().unwrap();
        let path = around.path().join("out");
        let first = Folder::take(&path, "a folder").unwrap();
        let error = Folder::take(&path, "a folder").unwrap_err();
        assert_eq!((error.kind(), error.file()), (Kind::Unavailable, path.to_str()));
        assert!(error.advice().unwrap().contains("-o"), "{error}");
        drop(first);
        // An empty folder that the run had made goes with it.
        assert_eq!(names(around.path()), [""; 0]);
        drop(Folder::take(&path, "a folder").unwrap());
        fs::create_dir(&path).unwrap();
        fs::write(path.join(LOCK), "").unwrap();
        drop(Folder::take(&path, "a folder").unwrap());
        assert_eq!(names(&path), [""; 0]);
    }

    #[test]
    fn leftovers_of_the_dead_are_removed_and_told_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        fs::create_dir(path.join(".caustix-77-0.new")).unwrap();
        fs::write(path.join(".caustix-77-0.new/report.json"), "{}").unwrap();
        fs::write(path.join(".floor.exr.77-3.tmp"), "half").unwrap();
        for kept in [".floor.tmp", "floor.exr", ".caustix-7.new", ".hidden.1-2.tmpx"] {
            fs::write(path.join(kept), "").unwrap();
        }
        let held = File::create(path.join(".map.78-1.tmp")).unwrap();
        held.try_lock().unwrap();
        let taken = Folder::take(path, "a folder").unwrap();
        let remarks = taken.remarks();
        assert_eq!(remarks.len(), 2, "{remarks:?}");
        assert!(
            remarks[0].contains("no whole set") && remarks[1].contains("removed 2 leftovers"),
            "{remarks:?}"
        );
        drop(taken);
        let kept = [".caustix-7.new", ".floor.tmp", ".hidden.1-2.tmpx", ".map.78-1.tmp", "floor.exr"];
        assert_eq!(names(path), kept);
        assert_eq!(Folder::take(path, "a folder").unwrap().remarks(), [""; 0]);
    }

    #[test]
    fn others_are_results_that_no_list_and_no_input_names() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path();
        for name in
            ["a.exr", "b.exr", "c.csv", "in.png", "scene.toml", "compare.csv", ".h.exr", "photons.map"]
        {
            fs::write(path.join(name), "").unwrap();
        }
        fs::create_dir(path.join("d.exr")).unwrap();
        fs::write(path.join("compare.json"), r#"{"files": {"compare.csv": "00"}}"#).unwrap();
        let taken = Folder::take(path, "a folder").unwrap();
        let ours = BTreeSet::from(["a.exr".to_string()]);
        assert_eq!(taken.others(&ours, &[path.join("in.png")]), ["b.exr", "c.csv"]);
    }
}
