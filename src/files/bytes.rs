//! Files as bytes: capped, regular files only, and those of a scene each once.

use std::fs::File;
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::visible;
use crate::files::suggest;
use crate::math::digest::sha256_hex;

/// Largest file that a scene may name (mesh, photometric file, image): 1 GiB.
const FILE_LIMIT_BYTES: u64 = 1 << 30;

/// The files the built-in scene names, under the names it uses.
const BUILT_IN_FILES: [(&str, &[u8]); 1] =
    [("../ies/wavy_glass.ies", include_bytes!("../../ies/wavy_glass.ies"))];

/// What relative paths of a scene are relative to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Base {
    /// A directory: normally that of the scene file.
    Directory(PathBuf),
    /// The files inside the program; there are no others.
    BuiltIn,
}

/// The files of a scene. Each is read once, however often it is named, and its hash is that of the bytes that were used.
#[derive(Debug)]
pub(crate) struct Files {
    base: Base,
    read: Vec<(String, Rc<[u8]>)>,
    /// Index into `read` of each use.
    uses: Vec<usize>,
}

impl Files {
    pub(crate) fn new(base: Base) -> Self {
        Self { base, read: Vec::new(), uses: Vec::new() }
    }

    /// Where this path, as written in the scene, leads to; the path itself for a file inside the program.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        match &self.base {
            Base::Directory(directory) => directory.join(name),
            Base::BuiltIn => name.into(),
        }
    }

    /// The bytes of the file of this name, at most [`FILE_LIMIT_BYTES`].
    pub(crate) fn load(&mut self, name: &str) -> Result<Rc<[u8]>> {
        if let Some(known) = self.read.iter().position(|(known, _)| known == name) {
            self.uses.push(known);
            return Ok(Rc::clone(&self.read[known].1));
        }
        let bytes: Rc<[u8]> = match self.base {
            Base::Directory(_) => read_capped(&self.path(name), FILE_LIMIT_BYTES)?.into(),
            Base::BuiltIn => built_in_file(name)?.into(),
        };
        self.uses.push(self.read.len());
        self.read.push((name.to_owned(), Rc::clone(&bytes)));
        Ok(bytes)
    }

    /// Whether [`Files::load`] would find a file of acceptable size, without reading it.
    pub(crate) fn probe(&self, name: &str) -> Result<()> {
        match self.base {
            Base::Directory(_) => open(&self.path(name), FILE_LIMIT_BYTES).map(drop),
            Base::BuiltIn => built_in_file(name).map(drop),
        }
    }

    /// (name, SHA-256) of what was read, once for each part of the scene that names it, in their order.
    pub(crate) fn hashes(&self) -> Vec<(String, String)> {
        let read: Vec<_> = self.read.iter().map(|(name, bytes)| (name.clone(), sha256_hex(bytes))).collect();
        self.uses.iter().map(|k| read[*k].clone()).collect()
    }
}

fn built_in_file(path: &str) -> Result<&'static [u8]> {
    BUILT_IN_FILES.iter().find(|(name, _)| *name == path).map(|(_, bytes)| *bytes).ok_or_else(|| {
        Diagnostic::new(Kind::Io, format!("the file `{path}`"), "a file that is inside the program")
    })
}

/// Open a regular file of at most `limit_bytes`. A pipe or a device is refused: it could block or never end.
fn open(path: &Path, limit_bytes: u64) -> Result<File> {
    let shown = visible(&path.display().to_string());
    let io = |why: String| Diagnostic::new(Kind::Io, why, "a file that can be read");
    // The kind is asked before opening: opening a pipe waits for its other end.
    let metadata = std::fs::metadata(path).map_err(|e| match e.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => like_it(io(format!("no file `{shown}`")), path),
        _ => io(format!("the file `{shown}`, which cannot be opened: {e}")),
    })?;
    if metadata.is_dir() {
        return Err(io(format!("`{shown}`, which is a folder")));
    }
    if !metadata.is_file() {
        return Err(io(format!("`{shown}`, which is not a file")));
    }
    if metadata.len() > limit_bytes {
        return Err(too_large(path, limit_bytes));
    }
    File::open(path).map_err(|e| io(format!("the file `{shown}`, which cannot be opened: {e}")))
}

/// The error that a file is not there, with the one of its folder that was probably meant: it has the same ending and
/// a name near its own.
fn like_it(error: Diagnostic, path: &Path) -> Diagnostic {
    const MOST_LOOKED_AT: usize = 1000;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let Ok(entries) = std::fs::read_dir(folder) else {
        return error.hint(format!("there is no folder `{}`", visible(&folder.display().to_string())));
    };
    let ending = |path: &Path| path.extension().map(|ending| ending.to_ascii_lowercase());
    let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned());
    let near = |found: &PathBuf| found.is_file() && ending(found) == ending(path);
    let mut near: Vec<PathBuf> =
        entries.take(MOST_LOOKED_AT).flatten().map(|entry| entry.path()).filter(near).collect();
    near.sort();
    let stems: Vec<String> = near.iter().filter_map(|path| stem(path)).collect();
    let stems: Vec<&str> = stems.iter().map(String::as_str).collect();
    let meant = suggest::nearest(&stem(path).unwrap_or_default(), &stems);
    let meant = near.iter().find(|path| stem(path).as_deref() == meant && meant.is_some());
    match meant.and_then(|path| path.file_name()) {
        Some(name) => error.hint(format!("did you mean `{}`?", visible(&name.to_string_lossy()))),
        None => error,
    }
}

fn too_large(path: &Path, limit_bytes: u64) -> Diagnostic {
    let (shown, limit) = (visible(&path.display().to_string()), limit_bytes >> 20);
    let found = format!("the file `{shown}`, which is larger than {limit} MiB");
    Diagnostic::new(Kind::Limit, found, format!("a file of at most {limit} MiB"))
}

/// That bytes which are there already are no more than `limit_bytes`.
pub(crate) fn check_length(bytes: &[u8], limit_bytes: u64) -> Result<()> {
    if bytes.len() as u64 <= limit_bytes {
        return Ok(());
    }
    let limit = format!("{} MiB", limit_bytes >> 20);
    let found = format!("more than {limit}");
    Err(Diagnostic::new(Kind::Limit, found, format!("at most {limit}")))
}

/// The bytes of a regular file of at most `limit_bytes`, even if it grows while it is read.
pub(crate) fn read_capped(path: &Path, limit_bytes: u64) -> Result<Vec<u8>> {
    let mut bytes = Vec::new();
    let file = open(path, limit_bytes)?;
    file.take(limit_bytes + 1).read_to_end(&mut bytes).map_err(|e| {
        let found = format!("the file `{}`, which cannot be read: {e}", path.display());
        Diagnostic::new(Kind::Io, found, "a file that can be read")
    })?;
    if bytes.len() as u64 > limit_bytes {
        return Err(too_large(path, limit_bytes));
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn files_above_the_cap_and_non_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        std::fs::write(&path, [7u8; 100]).unwrap();
        assert_eq!(read_capped(&path, 100).unwrap(), [7u8; 100]);
        assert_eq!(read_capped(&path, 99).unwrap_err().kind(), Kind::Limit);
        let mut files = Files::new(Base::Directory(folder.path().to_path_buf()));
        assert_eq!(files.load("a.bin").unwrap().len(), 100);
        for bad in ["b.bin", "."] {
            assert_eq!(files.load(bad).unwrap_err().kind(), Kind::Io);
            assert_eq!(files.probe(bad).unwrap_err().kind(), Kind::Io);
        }
        assert!(files.probe("a.bin").is_ok());
    }

    #[test]
    fn a_file_is_read_once_and_its_hash_is_that_of_what_was_read() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        std::fs::write(&path, "first").unwrap();
        let mut files = Files::new(Base::Directory(folder.path().to_path_buf()));
        assert_eq!(&*files.load("a.bin").unwrap(), b"first");
        std::fs::write(&path, "second").unwrap();
        assert_eq!(&*files.load("a.bin").unwrap(), b"first");
        let both = ("a.bin".to_owned(), sha256_hex(b"first"));
        assert_eq!(files.hashes(), [both.clone(), both]);
    }
}
