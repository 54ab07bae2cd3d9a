//! The state of a run: what it takes to go on, or to be added up with other parts of it.
//!
//! The magic `caustixS`, version (u32, little endian), length of the head (u32), the head (JSON: what the run is of), how far
//! each replicate is and what it counted (`run::together`, numbers of seven bits a byte), and the SHA-256 of all before it.
//!
//! A state is written whole beside the last one and renamed; the last one stays as `NAME.previous`. Whatever cuts that short,
//! one of the two is whole.

use std::fs::{self, File};
use std::io::{self, BufReader, Read, Seek, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_atomically;
use crate::files::excerpt::cut;
use crate::math::varint::damaged;
use crate::run::goal::Looks;
use crate::run::replicates::Course;
use crate::run::together::Together;
use crate::run::{Algorithm, ErrorGoal, ErrorOf, Plan, Settings};
use crate::scene::Scene;
use crate::scene::receiver::{Cells, DividedBy};

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

/// What a run is of: what must be the same for a state to be gone on from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the program: another one may trace other photons.
    caustix: String,
    /// The scene as it was named.
    pub scene: String,
    /// SHA-256 of what its results depend on.
    scene_sha256: String,
    /// The algorithm, by name.
    algorithm: String,
    seed: u64,
    photons_per_replicate: u64,
    /// Replicates.
    pub replicates: u32,
    /// The indices of every replicate that this is of.
    part: [u64; 2],
    /// Which part of how many, counted from 1, where it is one.
    pub part_of: Option<[u32; 2]>,
    /// The index up to which all replicates are traced.
    done: u64,
    /// Cells along u and v of the receivers that a pilot divided.
    cells: Vec<Option<[u32; 2]>>,
    /// Units of a photon in far fields.
    units_of_a_photon: u64,
    /// The error to be reached, as a fraction, and what it is of.
    goal: Option<(f64, String)>,
    looks: Looks,
    trace_s: f64,
}

impl Head {
    /// Of a run where it is.
    pub fn of(course: &Course<'_>, goal: Option<ErrorGoal>, part_of: Option<[u32; 2]>) -> Self {
        let (run, plan) = (&course.run, course.run.plan());
        let chosen =
            run.scene().receivers.iter().map(|receiver| match (receiver.divided_by, receiver.cells) {
                (DividedBy::Pilot, Cells::Grid { nu, nv }) => Some([nu, nv]),
                _ => None,
            });
        let part = run.part();
        Self {
            caustix: env!("CARGO_PKG_VERSION").to_owned(),
            scene: run.scene().identity.name.clone(),
            scene_sha256: run.scene().identity.results.clone(),
            algorithm: plan.algorithm().name(),
            seed: plan.seed(),
            photons_per_replicate: plan.photons_per_replicate(),
            replicates: plan.replicates(),
            part: [part.start, part.end],
            part_of,
            done: run.done(),
            cells: chosen.collect(),
            units_of_a_photon: run.units_of_a_photon(),
            goal: goal.map(|goal| (goal.relative(), goal.of().name().to_owned())),
            looks: course.looks.clone(),
            trace_s: course.trace_s,
        }
    }

    /// The settings of its run.
    ///
    /// # Errors
    /// An algorithm that this version does not have.
    pub fn settings(&self) -> Result<Settings> {
        let photons = self.photons_per_replicate.checked_mul(self.replicates.into());
        Ok(Settings {
            photons: Some(photons.unwrap_or(u64::MAX)),
            replicates: Some(self.replicates),
            seed: self.seed,
            algorithm: Algorithm::parse(&self.algorithm)?,
        })
    }

    /// The error that its run was to reach.
    pub fn goal(&self) -> Option<ErrorGoal> {
        let (relative, of) = self.goal.as_ref()?;
        ErrorGoal::new(*relative, ErrorOf::from_name(of)?).ok()
    }

    /// Photons of each replicate, and how many of this part are traced.
    pub fn photons(&self) -> (u64, u64) {
        (self.photons_per_replicate, self.done.saturating_sub(self.part[0]))
    }

    /// Whether all of its photons are traced.
    pub fn is_done(&self) -> bool {
        self.done == self.part[1]
    }

    /// Time of tracing, s.
    pub fn trace_s(&self) -> f64 {
        self.trace_s
    }

    /// That another state is of a part of the same run.
    ///
    /// # Errors
    /// What differs, by name.
    pub fn check_same_run(&self, other: &Self) -> Result<()> {
        let of = |head: &Self| head.part_of.map_or(1, |[_, of]| of);
        let differs = |what: &str, [found, required]: [&dyn std::fmt::Display; 2]| {
            let of_other = format!("a state of another run: {what} {found}");
            Err(Diagnostic::new(Kind::Range, of_other, format!("{what} {required}, as of the first")))
        };
        if other.caustix != self.caustix {
            return differs("by caustix", [&cut(&other.caustix), &cut(&self.caustix)]);
        }
        if other.scene_sha256 != self.scene_sha256 || other.cells != self.cells {
            return differs(
                "of the scene",
                [&cut(&other.scene), &format!("{} as it was there", cut(&self.scene))],
            );
        }
        if other.algorithm != self.algorithm {
            return differs("by", [&cut(&other.algorithm), &cut(&self.algorithm)]);
        }
        for (what, found, required) in [
            ("with seed", other.seed, self.seed),
            ("of replicates of photons", other.photons_per_replicate, self.photons_per_replicate),
            ("of replicates", other.replicates.into(), self.replicates.into()),
            ("of parts", of(other).into(), of(self).into()),
        ] {
            if found != required {
                return differs(what, [&found, &required]);
            }
        }
        Ok(())
    }

    /// Divides the receivers of a scene as the run's pilot did.
    pub fn divide(&self, scene: &mut Scene) {
        for (receiver, cells) in scene.receivers.iter_mut().zip(&self.cells) {
            if let (DividedBy::Default, Some(cells)) = (receiver.divided_by, cells) {
                *receiver = receiver.divided(*cells, DividedBy::Pilot);
            }
        }
    }

    /// That it is of a scene and a plan: of the same photons, of which there may be more now, in more replicates.
    ///
    /// # Errors
    /// What differs, by name.
    pub fn check(&self, scene: &Scene, plan: &Plan) -> Result<()> {
        let version = env!("CARGO_PKG_VERSION");
        let is_scene = self.scene_sha256 == scene.identity.results;
        let is_divided = self.cells.len() == scene.receivers.len();
        let differs = |found: String, required: String| Err(Diagnostic::new(Kind::Range, found, required));
        if self.caustix != version {
            let found = format!("the state of a run by caustix {}", cut(&self.caustix));
            return differs(
                found,
                format!("one by caustix {version}: another version may trace other photons"),
            );
        }
        if !(is_scene && is_divided) {
            let found =
                format!("the state of a run of another scene, or of {} as it was before", cut(&self.scene));
            return differs(found, format!("one of {} as it is now, files included", scene.identity.name));
        }
        let name = plan.algorithm().name();
        if (&self.algorithm, self.seed) != (&name, plan.seed()) {
            let found = format!("the state of a run by {}, seed {}", cut(&self.algorithm), self.seed);
            return differs(found, format!("one by {name}, seed {}", plan.seed()));
        }
        let [asked, there] = [plan.photons_per_replicate(), self.done];
        if there > asked || self.replicates > plan.replicates() {
            let found = format!("the state of {} replicates of {there} photons", self.replicates);
            let required = format!(
                "at most the {} of {asked} that are asked for: more can be added, none taken away",
                plan.replicates()
            );
            return differs(found, required);
        }
        Ok(())
    }
}

/// Writes a state; the last one of this name stays beside it.
///
/// # Errors
/// A file that cannot be written; then the last one stands where it was.
pub fn write(path: &Path, head: &Head, run: &Together<'_>) -> Result<()> {
    // Made whole under a name of its own first, so that a full disk costs neither of the two that are there.
    let newest = beside(path, "new");
    write_atomically(&newest, |file| {
        let mut out = Hashing { inner: file, hash: Sha256::new() };
        let json = serde_json::to_vec(head)?;
        out.write_all(MAGIC)?;
        out.write_all(&VERSION.to_le_bytes())?;
        out.write_all(&(json.len() as u32).to_le_bytes())?;
        out.write_all(&json)?;
        run.write(&mut out)?;
        let Hashing { inner, hash } = out;
        inner.write_all(hash.finalize().as_slice())
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
        let mut through = Hashing { inner: io::sink(), hash: Sha256::new() };
        through.hash.update(start);
        through.hash.update(&json);
        io::copy(&mut (&mut file).take(end - body), &mut through).map_err(|e| io(&e))?;
        let mut digest = [0; DIGEST as usize];
        file.read_exact(&mut digest).map_err(|e| io(&e))?;
        if through.hash.finalize().as_slice() != digest {
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

    /// Adds what it holds to a run, which goes on from there.
    ///
    /// # Errors
    /// A file that cannot be read any more; content of another run.
    pub fn add_to(&self, run: &mut Together<'_>) -> Result<()> {
        if !run.scene().far_fields.is_empty() && self.head.units_of_a_photon != run.units_of_a_photon() {
            let found = format!("far fields in units of 1 / {} of a photon", self.head.units_of_a_photon);
            let required =
                format!("1 / {}: a run of as many photons from its start", run.units_of_a_photon());
            return Err(Diagnostic::new(Kind::Range, found, required).in_file(&self.path));
        }
        let mut add = || -> io::Result<()> {
            let mut file = BufReader::new(File::open(&self.path)?);
            file.seek(io::SeekFrom::Start(self.body))?;
            let mut from = file.take(self.end - self.body);
            run.add_from(&mut from, self.head.replicates)?;
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
    pub fn resumed<'s>(&self, scene: &'s Scene, plan: &Plan) -> Result<Course<'s>> {
        self.head.check(scene, plan).map_err(|e| e.in_file(&self.path))?;
        let [start, end] = self.head.part;
        let part = if self.head.part_of.is_some() { start..end } else { 0..plan.photons_per_replicate() };
        let mut course = Course::new(Together::of_part(scene, plan, part)?);
        self.add_to(&mut course.run)?;
        // Looks at fewer replicates say nothing of more.
        if self.head.replicates == plan.replicates() {
            course.looks = self.head.looks.clone();
        }
        course.trace_s = self.head.trace_s;
        Ok(course)
    }
}

/// Hashes what goes through.
struct Hashing<W> {
    inner: W,
    hash: Sha256,
}

impl<W: Write> Write for Hashing<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.inner.write(bytes)?;
        self.hash.update(&bytes[..written]);
        Ok(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.inner.flush()
    }
}
