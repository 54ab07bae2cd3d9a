//! Results as one set: all of its files, and last a list that vouches for them by SHA-256.
//!
//! Files are made in a hidden folder within their own, each complete and on the disk. Only when all are there does the set take
//! its place: the old list goes first, then file by file is renamed over the old one, and the new list comes last. Whenever that
//! is cut short, there is the whole old set, no list, or the whole new set.
//!
//! A file that cannot be made costs no other. But where the disk takes no more, an older set stays as it is, and what could be
//! made goes into a folder `incomplete` beside it.

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_bytes;
use crate::files::folder::{Folder, MANIFESTS, listed};
use crate::math::digest::sha256_of;

/// Where files go that would replace a whole set by a part of one.
const INCOMPLETE: &str = "incomplete";

/// What a list says of its files, by name.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Listed {
    /// SHA-256 in hexadecimal digits.
    pub sha256: BTreeMap<String, String>,
    /// Lengths.
    pub bytes: BTreeMap<String, u64>,
}

/// Files on their way into a folder.
#[derive(Debug)]
pub struct Set<'f> {
    folder: &'f Folder,
    staging: PathBuf,
    manifest: &'static str,
    files: Listed,
    errors: Vec<Diagnostic>,
    /// Whether the disk did not take a file.
    is_cut: bool,
}

/// A set that has taken its place.
#[derive(Debug)]
pub struct Written {
    /// The folder that it is in.
    pub directory: PathBuf,
    /// Whether older results were left where they are; then the folder is another, or nothing was written.
    pub keeps_older: bool,
    /// Its files, without the list.
    pub files: Listed,
    /// What could not be written.
    pub errors: Vec<Diagnostic>,
}

impl<'f> Set<'f> {
    /// An empty set; `manifest` is the name of its list.
    ///
    /// # Errors
    /// A folder that cannot be written to.
    pub fn new(folder: &'f Folder, manifest: &'static str) -> Result<Self> {
        let (files, errors) = (Listed::default(), Vec::new());
        Ok(Self { folder, staging: folder.staging()?, manifest, files, errors, is_cut: false })
    }

    /// Makes a file of this name by `write`, which is given a path; false where it made none or could not. What went wrong is kept.
    pub fn add(&mut self, name: &str, write: impl FnOnce(&Path) -> Result<bool>) -> bool {
        let path = self.staging.join(name);
        let target = self.folder.path().join(name);
        let made = self.free(&target).and_then(|()| write(&path)).and_then(|is_made| {
            if is_made {
                let (bytes, sha256) = sha256_of_file(&path)?;
                self.files.bytes.insert(name.to_string(), bytes);
                self.files.sha256.insert(name.to_string(), sha256);
            }
            Ok(is_made)
        });
        made.unwrap_or_else(|error| self.fails(error, &target))
    }

    /// Makes a file of these bytes; whether it could.
    pub fn add_bytes(&mut self, name: &str, bytes: &[u8]) -> bool {
        self.add(name, |path| write_bytes(path, bytes).map(|()| true))
    }

    /// That no folder is in the way of a file.
    fn free(&self, target: &Path) -> Result<()> {
        if fs::symlink_metadata(target).is_ok_and(|there| there.is_dir()) {
            let found = "a folder of this name";
            return Err(
                Diagnostic::new(Kind::Range, found, "a file that can be replaced").hint("move it away")
            );
        }
        Ok(())
    }

    fn fails(&mut self, error: Diagnostic, target: &Path) -> bool {
        // Our own folder took other files: what is wrong with this one is the disk.
        self.is_cut |= error.kind() == Kind::Io;
        // The reader knows the file by the name that it was to have.
        self.errors.push(error.moved_to(target));
        false
    }

    /// Puts the set into its place. `list` makes the list's text of the files that are in the set.
    pub fn finish(mut self, list: impl Fn(&Listed) -> Result<String>) -> Written {
        let is_listed = self.write_list(&list);
        let mut directory = self.folder.path().to_path_buf();
        let is_cut = self.is_cut && directory.join(self.manifest).is_file();
        let keeps_older = is_cut || !self.take_place(&directory, is_listed, &list, &mut || true);
        if keeps_older && (is_listed || !self.files.sha256.is_empty()) {
            // With a lock of its own until the files are there.
            match Folder::take(&directory.join(INCOMPLETE), "room for what could be written") {
                Ok(beside) => {
                    directory = beside.path().to_path_buf();
                    self.take_place(&directory, is_listed, &list, &mut || true);
                }
                Err(error) => self.errors.push(error),
            }
        }
        let (files, errors) = (std::mem::take(&mut self.files), std::mem::take(&mut self.errors));
        Written { directory, keeps_older, files, errors }
    }

    fn write_list(&mut self, list: &impl Fn(&Listed) -> Result<String>) -> bool {
        let target = self.folder.path().join(self.manifest);
        let write = || write_bytes(self.staging.join(self.manifest), list(&self.files)?.as_bytes());
        match self.free(&target).and_then(|()| write()) {
            Ok(()) => true,
            Err(error) => self.fails(error, &target),
        }
    }

    /// Renames all, the list last; false, and nothing is replaced, where an older list cannot go. `goes_on` is asked before each
    /// step: a test ends it there, as a kill would.
    fn take_place(
        &mut self,
        directory: &Path,
        mut is_listed: bool,
        list: &impl Fn(&Listed) -> Result<String>,
        goes_on: &mut impl FnMut() -> bool,
    ) -> bool {
        for old in self.outdated(directory) {
            if !goes_on() {
                return true;
            }
            if let Err(error) = fs::remove_file(&old) {
                let found = format!("\"{error}\" while removing the list of older results");
                let error = Diagnostic::new(Kind::Io, found, "a file that can be replaced").in_file(&old);
                self.errors.push(error);
                return false;
            }
        }
        // On the disk before any file is replaced: a list must not come back after a power cut.
        synced(directory);
        let names: Vec<String> = self.files.sha256.keys().cloned().collect();
        for name in names {
            if !goes_on() {
                return true;
            }
            let target = directory.join(&name);
            if let Err(error) = fs::rename(self.staging.join(&name), &target) {
                let found = format!("\"{error}\" while renaming");
                self.errors
                    .push(Diagnostic::new(Kind::Io, found, "a file that can be replaced").in_file(target));
                self.files.sha256.remove(&name);
                self.files.bytes.remove(&name);
                is_listed = is_listed && self.write_list(list);
            }
        }
        synced(directory);
        if !is_listed || !goes_on() {
            return true;
        }
        let target = directory.join(self.manifest);
        if let Err(error) = fs::rename(self.staging.join(self.manifest), &target) {
            let found = format!("\"{error}\" while renaming");
            self.errors.push(Diagnostic::new(Kind::Io, found, "a file that can be replaced").in_file(target));
        }
        synced(directory);
        true
    }

    /// Lists that would no longer be true: that of the set before, and of another that has a file of ours in it.
    fn outdated(&self, directory: &Path) -> Vec<PathBuf> {
        let is_ours = |name: &String| self.files.sha256.contains_key(name);
        let lists = MANIFESTS.map(|name| (name, directory.join(name)));
        lists
            .into_iter()
            .filter(|(name, path)| {
                path.is_file() && (*name == self.manifest || listed(path).iter().any(is_ours))
            })
            .map(|(_, path)| path)
            .collect()
    }
}

impl Drop for Set<'_> {
    fn drop(&mut self) {
        fs::remove_dir_all(&self.staging).ok();
    }
}

fn sha256_of_file(path: &Path) -> Result<(u64, String)> {
    let read = || sha256_of(&mut File::open(path)?);
    read().map_err(|e: io::Error| {
        Diagnostic::new(Kind::Io, format!("\"{e}\" while reading back"), "a file that can be read")
    })
}

/// Names of a folder onto the disk. Where a system cannot (a folder cannot be opened as a file), it does so by itself.
fn synced(directory: &Path) {
    if let Ok(folder) = File::open(directory) {
        folder.sync_all().ok();
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::math::digest::sha256_hex;
    use std::io::Write as _;

    const REPORT: &str = "report.json";

    fn list(files: &Listed) -> Result<String> {
        Ok(serde_json::json!({ "files": files.sha256, "bytes": files.bytes }).to_string())
    }

    fn set<'f>(folder: &'f Folder, files: &[(&str, &str)]) -> Set<'f> {
        let mut set = Set::new(folder, REPORT).unwrap();
        for (name, text) in files {
            assert!(set.add_bytes(name, text.as_bytes()));
        }
        set
    }

    /// What the list in a folder vouches for, each file as it is there; `None` without a list.
    fn vouched(folder: &Path) -> Option<Vec<(String, String)>> {
        let text = fs::read_to_string(folder.join(REPORT)).ok()?;
        let json: serde_json::Value = serde_json::from_str(&text).unwrap();
        let of = |(name, hash): (&String, &serde_json::Value)| {
            let bytes = fs::read(folder.join(name)).unwrap();
            assert_eq!(hash, &sha256_hex(&bytes), "{name}");
            assert_eq!(json["bytes"][name], bytes.len());
            (name.clone(), String::from_utf8(bytes).unwrap())
        };
        Some(json["files"].as_object().unwrap().iter().map(of).collect())
    }

    fn texts(files: &[(&str, &str)]) -> Option<Vec<(String, String)>> {
        Some(files.iter().map(|(name, text)| (name.to_string(), text.to_string())).collect())
    }

    const OLD: [(&str, &str); 3] = [("a.exr", "old a"), ("b.exr", "old b"), ("c.exr", "old c")];
    const NEW: [(&str, &str); 3] = [("a.exr", "new a"), ("b.exr", "new b"), ("d.exr", "new d")];

    #[test]
    fn ended_before_any_step_there_is_the_old_set_none_or_the_new_one() {
        let mut seen = Vec::new();
        for steps in 0..8 {
            let directory = tempfile::tempdir().unwrap();
            let folder = Folder::take(directory.path(), "a folder").unwrap();
            assert!(set(&folder, &OLD).finish(list).errors.is_empty());
            let mut new = set(&folder, &NEW);
            assert!(new.write_list(&list));
            let mut left = steps;
            new.take_place(directory.path(), true, &list, &mut || (left > 0, left -= 1).0);
            let now = vouched(directory.path());
            assert!(now.is_none() || now == texts(&OLD) || now == texts(&NEW), "{steps}: {now:?}");
            seen.push(now);
        }
        // Before the first step; after the last of five, which are the list's end, three names and the new list.
        assert_eq!((&seen[0], &seen[4], &seen[5]), (&texts(&OLD), &None, &texts(&NEW)));
    }

    #[test]
    fn a_folder_in_the_way_costs_its_file_alone() {
        let directory = tempfile::tempdir().unwrap();
        let folder = Folder::take(directory.path(), "a folder").unwrap();
        set(&folder, &OLD).finish(list);
        fs::remove_file(directory.path().join("b.exr")).unwrap();
        fs::create_dir(directory.path().join("b.exr")).unwrap();
        let mut new = Set::new(&folder, REPORT).unwrap();
        let made = NEW.map(|(name, text)| new.add_bytes(name, text.as_bytes()));
        assert_eq!(made, [true, false, true]);
        let written = new.finish(list);
        assert_eq!(written.errors.len(), 1);
        assert_eq!(written.errors[0].file(), directory.path().join("b.exr").to_str());
        assert_eq!(vouched(directory.path()), texts(&[NEW[0], NEW[2]]));
    }

    #[test]
    fn a_disk_that_takes_no_more_leaves_an_older_set_and_the_rest_stands_beside_it() {
        let directory = tempfile::tempdir().unwrap();
        let folder = Folder::take(directory.path(), "a folder").unwrap();
        set(&folder, &OLD).finish(list);
        let cut = |set: &mut Set<'_>| {
            let made = set.add("b.exr", |path| {
                let full = io::Error::from(io::ErrorKind::StorageFull);
                crate::files::atomic::write_atomically(path, |out| out.write_all(b"half").and(Err(full)))?;
                Ok(true)
            });
            assert!(!made);
        };
        let mut new = set(&folder, &[NEW[0]]);
        cut(&mut new);
        assert!(new.add_bytes("d.exr", b"new d"));
        let written = new.finish(list);
        let beside = directory.path().join("incomplete");
        assert_eq!((written.directory.as_path(), written.errors.len()), (beside.as_path(), 1));
        assert_eq!(written.errors[0].file(), directory.path().join("b.exr").to_str());
        assert_eq!(vouched(directory.path()), texts(&OLD));
        assert_eq!(vouched(&beside), texts(&[NEW[0], NEW[2]]));
        // Where nothing stood before, the rest stands in the place.
        fs::remove_file(directory.path().join(REPORT)).unwrap();
        let mut new = set(&folder, &[NEW[0]]);
        cut(&mut new);
        assert_eq!(new.finish(list).directory, directory.path());
        assert_eq!(vouched(directory.path()), texts(&[NEW[0]]));
        // Where not even the list can be made, nothing is.
        let mut new = Set::new(&folder, REPORT).unwrap();
        cut(&mut new);
        let nothing = |_: &Listed| Err(Diagnostic::new(Kind::Io, "a full disk", "room"));
        let written = new.finish(nothing);
        assert!(written.keeps_older && written.errors.len() == 2);
        assert_eq!(vouched(directory.path()), texts(&[NEW[0]]));
    }

    #[test]
    fn the_list_of_another_set_goes_when_a_file_of_it_is_replaced() {
        let directory = tempfile::tempdir().unwrap();
        let folder = Folder::take(directory.path(), "a folder").unwrap();
        let study = |text: &str, name: &str| {
            let mut set = Set::new(&folder, "compare.json").unwrap();
            assert!(set.add_bytes(name, text.as_bytes()));
            set.finish(list);
        };
        set(&folder, &OLD).finish(list);
        study("a table", "compare.csv");
        assert_eq!(vouched(directory.path()), texts(&OLD));
        study("a table", "a.exr");
        assert_eq!(vouched(directory.path()), None);
    }

    #[test]
    fn a_set_that_is_given_up_leaves_nothing() {
        let directory = tempfile::tempdir().unwrap();
        let folder = Folder::take(directory.path(), "a folder").unwrap();
        drop(set(&folder, &NEW));
        drop(folder);
        assert!(fs::read_dir(directory.path()).unwrap().next().is_none());
    }
}
