//! The state of a run: what it takes to go on, or to be added up with other parts of it.
//!
//! The magic `caustixS`, version (u32, little endian), length of the head (u32), the head (JSON: what the run is of), how far
//! each replicate is and what it counted (`run::together`, numbers of seven bits a byte), and the SHA-256 of all before it.
//!
//! A state is written whole beside the last one and renamed; the last one stays as `NAME.previous`. Whatever cuts that short,
//! one of the two is whole.

mod head;

use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;
use crate::math::digest::Hashing;
use crate::math::varint::damaged;
use crate::picture::part::AnyPhotons;
use crate::run::Plan;
use crate::run::replicates::Course;
use crate::run::together::Together;
use crate::scene::Scene;

pub use head::Head;

/// How a state begins.
pub const MAGIC: &[u8; 8] = b"caustixS";
/// The version that is written and read.
const VERSION: u32 = 1;
/// The name of a run's state in the folder of its results.
pub const STATE: &str = "run.state";
/// What the last one is called when there is a newer.
const PREVIOUS: &str = "previous";
/// Longest head, bytes.
const MOST_HEAD: u32 = 1 << 24;
const DIGEST: u64 = 32;

/// Writes a state; the last one of this name stays beside it.
///
/// # Errors
/// A file that cannot be written; then the last one stands where it was.
pub fn write(path: &Path, head: &Head, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    // Made whole under a name of its own first, so that a full disk costs neither of the two that are there.
    let newest = beside(path, "new");
    write_atomically(&newest, |file| {
        let mut out = Hashing::new(file);
        let json = serde_json::to_vec(head)?;
        out.write_all(MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(json.len() as u32).to_le_bytes())?;
        out.write_all(&json)?;
        body(&mut out)?;
        out.seal()
    })?;
    let renamed = |from: &Path, to: &Path| {
        fs::rename(from, to).map_err(|e| {
            let found = format!("\"{e}\" while renaming {}", from.display());
            Diagnostic::new(Kind::Io, found, "a folder that can be written to").in_file(to)
        })
    };
    if path.exists() {
        renamed(path, &beside(path, PREVIOUS))?;
    }
    renamed(&newest, path)
}

/// Removes a state and the one before it: of a run that has ended and cannot be added to, and of what it replaced.
pub fn remove(path: &Path) {
    // What cannot be removed is refused by whoever would go on from it.
    let all = [beside(path, "new"), path.to_path_buf(), beside(path, PREVIOUS)];
    all.iter().for_each(|path| _ = fs::remove_file(path));
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(".");
    name.push(ending);
    PathBuf::from(name)
}

/// A state that is there and whole.
#[derive(Debug)]
pub struct Saved {
    path: PathBuf,
    /// What it is of.
    pub head: Head,
    body: u64,
    end: u64,
}

/// The newest whole state of this name, and what is wrong with a newer one; `None` where there is none.
///
/// # Errors
/// States that are there, and all damaged.
pub fn newest(path: &Path) -> Result<Option<(Saved, Option<Diagnostic>)>> {
    let mut wrong = None;
    for candidate in [beside(path, "new"), path.to_path_buf(), beside(path, PREVIOUS)] {
        if !candidate.exists() {
            continue;
        }
        match Saved::open(&candidate) {
            Ok(saved) => return Ok(Some((saved, wrong))),
            Err(error) => wrong = wrong.or(Some(error)),
        }
    }
    wrong.map_or(Ok(None), Err)
}

impl Saved {
    /// Opens a state, and reads what it is of; its checksum is looked at first.
    ///
    /// # Errors
    /// What is no state, of another version, or damaged.
    pub fn open(path: &Path) -> Result<Self> {
        let io = |e: &io::Error| {
            Diagnostic::new(Kind::Io, format!("\"{e}\" while reading"), "a file that can be read")
                .in_file(path)
        };
        let wrong =
            |kind, found: String, required: String| Diagnostic::new(kind, found, required).in_file(path);
        let metadata = fs::metadata(path).map_err(|e| io(&e))?;
        if !metadata.is_file() {
            return Err(wrong(Kind::Io, "no regular file".into(), "the state of a run".into()));
        }
        let mut file = BufReader::new(File::open(path).map_err(|e| io(&e))?);
        let mut start = [0; 16];
        let is_state = file.read_exact(&mut start).is_ok() && start.starts_with(MAGIC);
        if !is_state {
            return Err(wrong(
                Kind::Syntax,
                "a file that is no state of a run".into(),
                "one that caustix wrote".into(),
            ));
        }
        let number = |at: usize| u32::from_le_bytes([start[at], start[at + 1], start[at + 2], start[at + 3]]);
        let (version, length) = (number(8), number(12));
        if version != VERSION {
            return Err(wrong(
                Kind::Unavailable,
                format!("a state of version {version}"),
                format!("version {VERSION}"),
            ));
        }
        let torn = || {
            wrong(
                Kind::Syntax,
                "a state that is cut short, or whose checksum does not fit".into(),
                "a whole one".into(),
            )
        };
        let end = metadata.len().checked_sub(DIGEST).ok_or_else(torn)?;
        let body = u64::from(length) + start.len() as u64;
        if length > MOST_HEAD || body > end {
            return Err(torn());
        }
        let mut json = vec![0; length as usize];
        file.read_exact(&mut json).map_err(|e| io(&e))?;
        let mut through = Hashing::new(io::sink());
        through.write_all(&[&start[..], &json].concat()).map_err(|e| io(&e))?;
        io::copy(&mut (&mut file).take(end - body), &mut through).map_err(|e| io(&e))?;
        let mut digest = [0; DIGEST as usize];
        file.read_exact(&mut digest).map_err(|e| io(&e))?;
        if through.digest() != digest {
            return Err(torn());
        }
        let head = serde_json::from_slice(&json).map_err(|e| {
            wrong(Kind::Syntax, format!("a head that says \"{e}\""), "one that caustix wrote".into())
        })?;
        Ok(Self { path: path.to_path_buf(), head, body, end })
    }

    /// The file.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// What stands after its head.
    ///
    /// # Errors
    /// A file that cannot be read any more.
    pub fn body(&self) -> io::Result<io::Take<BufReader<File>>> {
        let mut file = BufReader::new(File::open(&self.path)?);
        file.seek(io::SeekFrom::Start(self.body))?;
        Ok(file.take(self.end - self.body))
    }

    /// Adds what it holds to a run, which goes on from there; of a part of a picture its photons, too.
    ///
    /// # Errors
    /// A file that cannot be read any more; content of another run.
    pub fn add_to(&self, run: &mut Together<'_>, photons: Option<&mut AnyPhotons>) -> Result<()> {
        if !run.scene().far_fields.is_empty() && self.head.units_of_a_photon != run.units_of_a_photon() {
            let found = format!("far fields in units of 1 / {} of a photon", self.head.units_of_a_photon);
            let required =
                format!("1 / {}: a run of as many photons from its start", run.units_of_a_photon());
            return Err(Diagnostic::new(Kind::Range, found, required).in_file(&self.path));
        }
        let add = || -> io::Result<()> {
            let mut from = self.body()?;
            run.add_from(&mut from, self.head.replicates)?;
            if let Some(photons) = photons {
                photons.add_from(run.scene(), &mut from)?;
            }
            match from.limit() {
                0 => Ok(()),
                more => Err(damaged(&format!("{more} bytes too many"))),
            }
        };
        add().map_err(|e| {
            let found = format!("a state that holds {e}");
            Diagnostic::new(Kind::Syntax, found, "a state of this scene and these settings")
                .in_file(&self.path)
        })
    }

    /// A run that goes on from this state.
    ///
    /// # Errors
    /// Those of [`Head::check`], [`Together::of_part`] and [`Self::add_to`].
    pub fn resumed<'s>(
        &self,
        scene: &'s Scene,
        plan: &Plan,
        photons: Option<&mut AnyPhotons>,
    ) -> Result<Course<'s>> {
        self.head.check(scene, plan).map_err(|e| e.in_file(&self.path))?;
        let [start, end] = self.head.part;
        let part = if self.head.part_of.is_some() { start..end } else { 0..plan.photons_per_replicate() };
        let mut course = Course::new(Together::of_part(scene, plan, part)?);
        self.add_to(&mut course.run, photons)?;
        // Looks at fewer replicates say nothing of more.
        if self.head.replicates == plan.replicates() {
            course.looks = self.head.looks.clone();
        }
        course.trace_s = self.head.trace_s();
        Ok(course)
    }
}
