//! Files as bytes: capped, regular files only, and those of a scene each once.

use std::collections::HashMap;
use std::fs::{File, Metadata, OpenOptions};
use std::io::{ErrorKind, Read};
use std::path::{Path, PathBuf};
use std::rc::Rc;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::confine::Confinement;
use crate::files::excerpt::visible;
use crate::files::suggest;
use crate::math::digest::sha256_hex;

/// Largest file that a scene may name (mesh, photometric file, image): 1 GiB.
pub const FILE_LIMIT_BYTES: u64 = 1 << 30;
/// Most bytes of all files of a scene: 2 GiB. They stay in memory until the scene is built.
pub const FILES_LIMIT_BYTES: u64 = 2 << 30;

/// The files the built-in scene names, under the names it uses.
const BUILT_IN_FILES: [(&str, &[u8]); 1] =
    [("../ies/wavy_glass.ies", include_bytes!("../../ies/wavy_glass.ies"))];

/// What relative paths of a scene are relative to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Base {
    /// A directory: normally that of the scene file.
    Directory(PathBuf),
    /// A directory that no file may lie outside of.
    Confined(PathBuf, Confinement),
    /// The files inside the program; there are no others.
    BuiltIn,
}

/// The files of a scene. Each is read once, however often and by whatever names it is named, and its hash is that of the bytes
/// that were used.
#[derive(Debug)]
pub(crate) struct Files {
    base: Base,
    read: Vec<Rc<[u8]>>,
    /// Index into `read`, by the names in the scene and by where they lead to.
    by_name: HashMap<String, usize>,
    by_place: HashMap<PathBuf, usize>,
    /// The name of each use.
    uses: Vec<String>,
    bytes: u64,
    limit_bytes: u64,
    is_over: bool,
}

impl Files {
    pub(crate) fn new(base: Base) -> Self {
        let (by_name, by_place) = (HashMap::new(), HashMap::new());
        Self {
            base,
            read: Vec::new(),
            by_name,
            by_place,
            uses: Vec::new(),
            bytes: 0,
            limit_bytes: FILES_LIMIT_BYTES,
            is_over: false,
        }
    }

    /// Where this path, as written in the scene, leads to; the path itself for a file inside the program.
    pub(crate) fn path(&self, name: &str) -> PathBuf {
        match &self.base {
            Base::Directory(directory) | Base::Confined(directory, _) => directory.join(name),
            Base::BuiltIn => name.into(),
        }
    }

    /// The bytes of the file of this name, at most [`FILE_LIMIT_BYTES`], and at most [`FILES_LIMIT_BYTES`] with those before.
    pub(crate) fn load(&mut self, name: &str) -> Result<Rc<[u8]>> {
        let (_, bytes) = self.look(name)?;
        self.uses.push(name.to_owned());
        Ok(bytes)
    }

    /// The same without a use of the file that [`Files::hashes`] would tell, and its number.
    pub(crate) fn look(&mut self, name: &str) -> Result<(usize, Rc<[u8]>)> {
        let number = self.number(name)?;
        Ok((number, Rc::clone(&self.read[number])))
    }

    /// The number of the file of this name, which is read; the same for all its names.
    fn number(&mut self, name: &str) -> Result<usize> {
        if let Some(number) = self.by_name.get(name) {
            return Ok(*number);
        }
        let place = self.place(name)?;
        let number = match self.by_place.get(&place) {
            Some(number) => *number,
            None => {
                let bytes: Rc<[u8]> = match self.base {
                    Base::BuiltIn => built_in_file(name)?.into(),
                    _ => self.read_next(&place)?.into(),
                };
                self.bytes += bytes.len() as u64;
                self.read.push(bytes);
                self.by_place.insert(place, self.read.len() - 1);
                self.read.len() - 1
            }
        };
        self.by_name.insert(name.to_owned(), number);
        Ok(number)
    }

    /// What is read where a file is named; links are followed, so that one file has one place.
    fn place(&self, name: &str) -> Result<PathBuf> {
        match &self.base {
            Base::Directory(directory) => {
                let path = directory.join(name);
                Ok(path.canonicalize().unwrap_or(path))
            }
            Base::Confined(_, confinement) => confinement.admit(name),
            Base::BuiltIn => Ok(name.into()),
        }
    }

    /// Whether a file was refused because of those before it.
    pub(crate) fn is_over(&self) -> bool {
        self.is_over
    }

    fn read_next(&mut self, path: &Path) -> Result<Vec<u8>> {
        let room = self.limit_bytes - self.bytes;
        let size = regular(path, FILE_LIMIT_BYTES)?.len();
        if size > room {
            self.is_over = true;
            let shown = visible(&path.display().to_string());
            let found =
                format!("the file `{shown}`, with which there are {} bytes", self.bytes.saturating_add(size));
            let required = format!("at most {} bytes in all files of a scene", self.limit_bytes);
            return Err(Diagnostic::new(Kind::Limit, found, required));
        }
        read_capped(path, room.min(FILE_LIMIT_BYTES))
    }

    /// Whether [`Files::load`] would find a file of acceptable size, without reading it.
    pub(crate) fn probe(&self, name: &str) -> Result<()> {
        match self.base {
            Base::Directory(_) => regular(&self.path(name), FILE_LIMIT_BYTES).map(drop),
            Base::Confined(..) => regular(&self.place(name)?, FILE_LIMIT_BYTES).map(drop),
            Base::BuiltIn => built_in_file(name).map(drop),
        }
    }

    /// (name, SHA-256) of what was read, once for each part of the scene that names it, in their order.
    pub(crate) fn hashes(&self) -> Vec<(String, String)> {
        let hashes: Vec<String> = self.read.iter().map(|bytes| sha256_hex(bytes)).collect();
        self.uses.iter().map(|name| (name.clone(), hashes[self.by_name[name]].clone())).collect()
    }
}

fn built_in_file(path: &str) -> Result<&'static [u8]> {
    BUILT_IN_FILES.iter().find(|(name, _)| *name == path).map(|(_, bytes)| *bytes).ok_or_else(|| {
        Diagnostic::new(Kind::Io, format!("the file `{path}`"), "a file that is inside the program")
    })
}

/// What is known of a regular file of at most `limit_bytes`, by its path. A pipe or a device is refused: it could block or never
/// end, and only to open it may do something.
fn regular(path: &Path, limit_bytes: u64) -> Result<Metadata> {
    let shown = visible(&path.display().to_string());
    let io = |why: String| Diagnostic::new(Kind::Io, why, READABLE);
    let metadata = std::fs::metadata(path).map_err(|e| match e.kind() {
        ErrorKind::NotFound | ErrorKind::NotADirectory => like_it(io(format!("no file `{shown}`")), path),
        _ => io(format!("the file `{shown}`, which cannot be opened: {e}")),
    })?;
    check_regular(path, metadata, limit_bytes)
}

fn check_regular(path: &Path, metadata: Metadata, limit_bytes: u64) -> Result<Metadata> {
    if !metadata.is_file() {
        let what =
            if metadata.is_dir() { "a folder" } else { "not a regular file (a pipe, a device or a socket)" };
        let found = format!("`{}`, which is {what}", visible(&path.display().to_string()));
        return Err(Diagnostic::new(Kind::Io, found, "a regular file"));
    }
    if metadata.len() > limit_bytes { Err(too_large(path, limit_bytes)) } else { Ok(metadata) }
}

const READABLE: &str = "a file that can be read";

/// Open a regular file of at most `limit_bytes`. It is looked at again once it is open: in between, another may have been put in
/// its place, so opening must not wait for a pipe's other end.
fn open(path: &Path, limit_bytes: u64) -> Result<File> {
    regular(path, limit_bytes)?;
    let mut options = OpenOptions::new();
    options.read(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::custom_flags(&mut options, libc::O_NONBLOCK);
    let opened = options.open(path).and_then(|file| Ok((file.metadata()?, file)));
    let (metadata, file) = opened.map_err(|e| {
        let shown = visible(&path.display().to_string());
        Diagnostic::new(Kind::Io, format!("the file `{shown}`, which cannot be opened: {e}"), READABLE)
    })?;
    check_regular(path, metadata, limit_bytes).map(|_| file)
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
        let shown = visible(&path.display().to_string());
        Diagnostic::new(Kind::Io, format!("the file `{shown}`, which cannot be read: {e}"), READABLE)
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
    fn all_files_together_have_a_cap_and_each_counts_once() {
        let folder = tempfile::tempdir().unwrap();
        for name in ["a", "b"] {
            std::fs::write(folder.path().join(name), [7u8; 100]).unwrap();
        }
        let mut files = Files::new(Base::Directory(folder.path().to_path_buf()));
        files.limit_bytes = 199;
        for name in ["a", "./a", "a"] {
            assert_eq!(files.load(name).unwrap().len(), 100);
        }
        assert_eq!(files.bytes, 100);
        let error = files.load("b").unwrap_err();
        assert_eq!(error.kind(), Kind::Limit);
        assert!(error.found().ends_with("b`, with which there are 200 bytes"), "{error}");
        assert_eq!(error.required(), "at most 199 bytes in all files of a scene");
        files.limit_bytes = 200;
        assert_eq!(files.load("b").unwrap().len(), 100);
        assert_eq!(files.hashes().len(), 4);
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
