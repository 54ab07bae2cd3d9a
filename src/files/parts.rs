//! Finished parts of a study, one file each, so that a study that was stopped goes on where it was.
//!
//! A part is named by the hash of its key; the key says all that the part depends on (scene, files, settings, the program's
//! version) and stands in the file again, with a checksum of the content. A file that is damaged, cut short or of another key is
//! not used: its part is made again.

use std::io::Write;
use std::path::{Path, PathBuf};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::{make_directory, write_atomically};
use crate::files::bytes::read_capped;
use crate::math::digest::sha256_hex;

/// First line of every part.
const FORMAT: &str = "caustix part 1";
/// Largest part that is read: four times the largest that is written (64 grids of 4096 x 4096 cells are not a study).
const MOST_BYTES: u64 = 1 << 30;

/// The folder of a study's parts.
#[derive(Debug, Clone)]
pub struct Parts {
    directory: PathBuf,
}

/// A part that is there.
#[derive(Debug)]
pub enum Found {
    /// Whole and of this key.
    Whole(Vec<u8>),
    /// Not there.
    Missing,
    /// There, but not usable: what is wrong with it.
    Damaged(Diagnostic),
}

impl Parts {
    /// The parts in this folder; it need not be there yet.
    pub fn new(directory: PathBuf) -> Self {
        Self { directory }
    }

    /// The folder.
    pub fn directory(&self) -> &Path {
        &self.directory
    }

    fn path(&self, kind: &str, key: &str) -> PathBuf {
        self.directory.join(format!("{kind}-{}.part", &sha256_hex(key.as_bytes())[..24]))
    }

    /// Looks for the part of this key.
    pub fn load(&self, kind: &str, key: &str) -> Found {
        let path = self.path(kind, key);
        if std::fs::metadata(&path).is_err() {
            return Found::Missing;
        }
        let damaged = |found: String| {
            let required = "a whole part of this study: it is made again";
            Found::Damaged(Diagnostic::new(Kind::Syntax, found, required).in_file(&path))
        };
        let bytes = match read_capped(&path, MOST_BYTES) {
            Ok(bytes) => bytes,
            Err(e) => return damaged(e.found().to_owned()),
        };
        let content = &bytes[bytes.iter().position(|b| *b == b'\0').map_or(bytes.len(), |at| at + 1)..];
        if bytes.starts_with(header(key, content).as_bytes()) {
            Found::Whole(content.to_vec())
        } else {
            damaged("a part whose key or checksum does not fit".into())
        }
    }

    /// Keeps a part, whole or not at all.
    ///
    /// # Errors
    /// A folder or file that cannot be written.
    pub fn store(&self, kind: &str, key: &str, content: &[u8]) -> Result<()> {
        make_directory(&self.directory, "a directory for parts")?;
        write_atomically(self.path(kind, key), |file| {
            file.write_all(header(key, content).as_bytes())?;
            file.write_all(content)
        })
    }
}

/// Everything before the content: format, checksum, key, and a zero byte that none of them holds.
fn header(key: &str, content: &[u8]) -> String {
    format!("{FORMAT}\nsha256 {}\n{}\n\0", sha256_hex(content), key.replace('\0', " "))
}

/// Numbers as bytes, little-endian.
pub fn to_bytes(numbers: &[u64]) -> Vec<u8> {
    numbers.iter().flat_map(|n| n.to_le_bytes()).collect()
}

/// The inverse of [`to_bytes`]; `None` where the length is not that of `expected` numbers.
pub fn from_bytes(bytes: &[u8], expected: usize) -> Option<Vec<u64>> {
    let (chunks, rest) = bytes.as_chunks::<8>();
    (rest.is_empty() && chunks.len() == expected)
        .then(|| chunks.iter().map(|chunk| u64::from_le_bytes(*chunk)).collect())
}
