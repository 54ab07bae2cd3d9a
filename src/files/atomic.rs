//! Files that are either the old ones or the new ones, never a half of something.

use std::ffi::{OsStr, OsString};
use std::fs::{self, File, OpenOptions};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process;
use std::sync::atomic::{AtomicU64, Ordering};

use crate::error::{Diagnostic, Kind, Result};

/// Tells the temporary files of one process apart; the process id tells those of several apart.
static NEXT: AtomicU64 = AtomicU64::new(0);

/// Writes `path` by way of a temporary file of the same directory that is renamed over it when it is complete and
/// on the disk. Whatever fails, what stood at `path` before still stands there and the temporary file is gone.
///
/// # Errors
/// [`Kind::Io`], with the path, when the directory cannot be written to, `write` fails, or the renaming does.
pub fn write_atomically(
    path: impl AsRef<Path>,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> Result<()> {
    let path = path.as_ref();
    write_and_rename(path, write).map_err(|error| {
        let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty() && !folder.is_dir());
        if let Some(folder) = folder {
            let found = format!("no folder `{}`", folder.display());
            return Diagnostic::new(Kind::Io, found, "a folder that is there, for what is written")
                .in_file(path);
        }
        Diagnostic::new(Kind::Io, format!("\"{error}\" while writing"), "a file that can be written")
            .in_file(path)
    })
}

/// The same for a file whose bytes are there.
///
/// # Errors
/// As [`write_atomically`].
pub fn write_bytes(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    write_atomically(path, |out| out.write_all(bytes))
}

/// Makes a directory, and those above it, where they are not there yet; `required` says what it is for.
///
/// # Errors
/// [`Kind::Io`], with the path.
pub fn make_directory(path: &Path, required: &str) -> Result<()> {
    fs::create_dir_all(path).map_err(|e| {
        // What stands in the way, where it is a file: the system's words for that are many.
        let file = path.ancestors().find(|part| part.is_file());
        let found = match file {
            Some(file) if file == path => "a file where a folder is to be made".to_string(),
            Some(file) => format!("a file `{}` where a folder is to be made", file.display()),
            None => format!("\"{e}\" while making the folder"),
        };
        Diagnostic::new(Kind::Io, found, required).in_file(path)
    })
}

/// Removes temporary files that dead processes left in a directory; their number. A living one has its file locked.
pub fn clear_temporaries(directory: &Path) -> usize {
    let entries = fs::read_dir(directory).into_iter().flatten().flatten();
    let temporary = entries
        .filter(|e| e.file_type().is_ok_and(|kind| kind.is_file()) && is_temporary(&e.file_name()))
        .map(|entry| entry.path());
    let is_left = |path: &PathBuf| File::open(path).is_ok_and(|file| file.try_lock().is_ok());
    temporary.filter(is_left).filter(|path| fs::remove_file(path).is_ok()).count()
}

fn write_and_rename(
    path: &Path,
    write: impl FnOnce(&mut BufWriter<File>) -> io::Result<()>,
) -> io::Result<()> {
    let (temporary, file) = create_beside(path)?;
    let mut writer = BufWriter::new(file);
    write(&mut writer)?;
    writer.flush()?;
    // Without it a crash soon after the renaming may leave the new name on an empty file.
    writer.get_ref().sync_all()?;
    drop(writer);
    fs::rename(&temporary.path, path)?;
    temporary.keep();
    Ok(())
}

/// A new file beside `path` under a name nobody has.
fn create_beside(path: &Path) -> io::Result<(Temporary, File)> {
    let Some(name) = path.file_name() else {
        return Err(io::Error::new(io::ErrorKind::InvalidInput, "the path names no file"));
    };
    loop {
        let mut hidden = OsString::from(".");
        hidden.push(name);
        hidden.push(format!(".{}-{}.tmp", process::id(), NEXT.fetch_add(1, Ordering::Relaxed)));
        let candidate = path.with_file_name(hidden);
        match OpenOptions::new().write(true).create_new(true).open(&candidate) {
            Ok(file) => {
                // For [`clear_temporaries`]; a file system without locks clears none.
                file.try_lock().ok();
                return Ok((Temporary { path: candidate, armed: true }, file));
            }
            // Left behind by a killed process that had our id.
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists => {}
            Err(error) => return Err(error),
        }
    }
}

/// Whether [`create_beside`] gives such names: `.NAME.PROCESS-NUMBER.tmp`.
fn is_temporary(name: &OsStr) -> bool {
    let is_number = |text: &str| !text.is_empty() && text.bytes().all(|b| b.is_ascii_digit());
    let stem = name.to_str().and_then(|name| name.strip_prefix('.')?.strip_suffix(".tmp"));
    let numbers = stem.and_then(|stem| stem.rsplit_once('.')?.1.split_once('-'));
    numbers.is_some_and(|(process, number)| is_number(process) && is_number(number))
}

/// Removes the file when dropped, unless it was renamed.
struct Temporary {
    path: PathBuf,
    armed: bool,
}

impl Temporary {
    fn keep(mut self) {
        self.armed = false;
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        if self.armed {
            // Nothing is left to do if this fails too: the first error is the one to tell.
            fs::remove_file(&self.path).ok();
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn names(directory: &Path) -> Vec<String> {
        let mut names: Vec<String> = fs::read_dir(directory)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        names
    }

    #[test]
    fn replaces_the_old_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("map.png");
        for text in ["first", "second, longer", "3"] {
            write_atomically(&path, |w| w.write_all(text.as_bytes())).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), text);
        }
        assert_eq!(names(directory.path()), ["map.png"]);
    }

    #[test]
    fn failure_leaves_the_old_file_and_no_other() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("map.png");
        fs::write(&path, "old").unwrap();
        let error = write_atomically(&path, |w| {
            w.write_all(&[7; 100_000])?;
            Err(io::Error::other("disk on fire"))
        })
        .unwrap_err();
        assert_eq!(error.kind(), Kind::Io);
        assert!(error.found().contains("disk on fire"), "{error}");
        assert_eq!(error.file(), path.to_str());
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(directory.path()), ["map.png"]);
    }

    #[test]
    fn a_panic_while_writing_leaves_no_temporary_file() {
        let directory = tempfile::tempdir().unwrap();
        let path = directory.path().join("map.png");
        let result = std::panic::catch_unwind(|| {
            write_atomically(&path, |_| {
                assert!(path.file_name().is_none(), "on purpose");
                Ok(())
            })
        });
        assert!(result.is_err());
        assert!(names(directory.path()).is_empty());
    }

    #[test]
    fn missing_directory_and_directory_in_the_way_are_diagnostics() {
        let directory = tempfile::tempdir().unwrap();
        let error = write_atomically(directory.path().join("no/such/a.exr"), |_| Ok(())).unwrap_err();
        assert_eq!(error.kind(), Kind::Io);
        let occupied = directory.path().join("dir");
        fs::create_dir(&occupied).unwrap();
        fs::write(occupied.join("x"), "x").unwrap();
        assert_eq!(write_atomically(&occupied, |_| Ok(())).unwrap_err().kind(), Kind::Io);
        assert_eq!(names(directory.path()), ["dir"]);
        assert_eq!(write_atomically("..", |_| Ok(())).unwrap_err().kind(), Kind::Io);
    }
}
