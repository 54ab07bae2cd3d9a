//! Where a scene comes from: its text, its hash, and the files it names.

use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

use sha2::{Digest, Sha256};

use crate::error::{Diagnostic, Kind, Result};

/// Largest scene file that is read: 16 MiB.
pub const SCENE_LIMIT_BYTES: u64 = 16 << 20;

/// Largest file that a scene may name (mesh, photometric file, image): 1 GiB.
pub const FILE_LIMIT_BYTES: u64 = 1 << 30;

/// Name under which messages and reports show the built-in scene.
pub const BUILT_IN_NAME: &str = "wavy_glass.toml (built in)";

pub(crate) const BUILT_IN_TEXT: &str = include_str!("../../../scenes/wavy_glass.toml");

/// The files the built-in scene names, under the names it uses.
const BUILT_IN_FILES: [(&str, &[u8]); 1] =
    [("../ies/wavy_glass.ies", include_bytes!("../../../ies/wavy_glass.ies"))];

/// What relative paths of a scene are relative to.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Base {
    /// A directory: normally that of the scene file.
    Directory(PathBuf),
    /// The files inside the program; there are no others.
    BuiltIn,
}

/// The text of a scene and where it comes from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Source {
    /// The scene file's path as the user gave it.
    pub name: String,
    /// The whole text.
    pub text: String,
    /// SHA-256 of the text's bytes, 64 lower-case hexadecimal digits: what `sha256sum` prints for the file.
    pub sha256: String,
    /// What relative paths are relative to.
    pub base: Base,
}

impl Source {
    /// A source of this text. `name` is for messages only.
    pub fn new(text: &str, name: &str, base: Base) -> Self {
        Self { name: name.to_string(), text: text.to_string(), sha256: sha256_hex(text.as_bytes()), base }
    }

    /// Where this path, as written in the scene, leads to; `None` for files inside the program.
    pub fn path(&self, path: &str) -> Option<PathBuf> {
        match &self.base {
            Base::Directory(directory) => Some(directory.join(path)),
            Base::BuiltIn => None,
        }
    }

    /// The bytes of a file that the scene names by this path, at most [`FILE_LIMIT_BYTES`].
    ///
    /// # Errors
    /// [`Kind::Io`] for a file that is missing, not a regular file or not readable, [`Kind::Limit`] for one
    /// that is too large. The diagnostic has no place: see [`crate::files::scene_toml::description::Description::load`].
    pub fn load(&self, path: &str) -> Result<Vec<u8>> {
        match self.path(path) {
            Some(full) => read_capped(&full, FILE_LIMIT_BYTES),
            None => built_in_file(path).map(<[u8]>::to_vec),
        }
    }

    /// Whether [`Source::load`] would find a file of acceptable size, without reading it.
    ///
    /// # Errors
    /// As those of [`Source::load`].
    pub fn probe(&self, path: &str) -> Result<()> {
        match self.path(path) {
            Some(full) => open(&full, FILE_LIMIT_BYTES).map(|_| ()),
            None => built_in_file(path).map(|_| ()),
        }
    }
}

/// SHA-256 in lower-case hexadecimal digits.
pub fn sha256_hex(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

fn built_in_file(path: &str) -> Result<&'static [u8]> {
    BUILT_IN_FILES.iter().find(|(name, _)| *name == path).map(|(_, bytes)| *bytes).ok_or_else(|| {
        Diagnostic::new(Kind::Io, format!("the file `{path}`"), "a file that is inside the program")
    })
}

/// Open a regular file of at most `limit_bytes`. A pipe or a device is refused: it could block or never end.
fn open(path: &Path, limit_bytes: u64) -> Result<File> {
    let shown = path.display();
    let io = |why: String| Diagnostic::new(Kind::Io, why, "a file that can be read");
    // The kind is asked before opening: opening a pipe waits for its other end.
    let metadata = std::fs::metadata(path)
        .map_err(|e| io(format!("the file `{shown}`, which cannot be opened: {e}")))?;
    if !metadata.is_file() {
        return Err(io(format!("`{shown}`, which is not a file")));
    }
    if metadata.len() > limit_bytes {
        return Err(too_large(path, limit_bytes));
    }
    File::open(path).map_err(|e| io(format!("the file `{shown}`, which cannot be opened: {e}")))
}

fn too_large(path: &Path, limit_bytes: u64) -> Diagnostic {
    Diagnostic::new(
        Kind::Limit,
        format!("the file `{}`, which is larger than {} MiB", path.display(), limit_bytes >> 20),
        format!("a file of at most {} MiB", limit_bytes >> 20),
    )
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
    fn hash_is_that_of_fips_180() {
        // FIPS 180-2, appendix B.1.
        assert_eq!(sha256_hex(b"abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
    }

    #[test]
    fn files_above_the_cap_and_non_files_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("a.bin");
        std::fs::write(&path, [7u8; 100]).unwrap();
        assert_eq!(read_capped(&path, 100).unwrap(), [7u8; 100]);
        assert_eq!(read_capped(&path, 99).unwrap_err().kind(), Kind::Limit);
        let source = Source::new("", "s.toml", Base::Directory(folder.path().to_path_buf()));
        assert_eq!(source.load("a.bin").unwrap().len(), 100);
        assert_eq!(source.load("b.bin").unwrap_err().kind(), Kind::Io);
        assert_eq!(source.load(".").unwrap_err().kind(), Kind::Io);
        assert!(source.probe("a.bin").is_ok());
        assert_eq!(source.probe("b.bin").unwrap_err().kind(), Kind::Io);
    }
}
