//! Runs that take long: what is kept of them, and how they go on.

use std::fs::File;
use std::io::{self, BufReader, Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};

use rayon::ThreadPool;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::run_state::{self, Head, Saved};
use crate::picture::part::AnyPhotons;
use crate::picture::{AnyPicture, Watch, not_of_this, trace_picture_from};
use crate::report::numbers::{duration, grouped, percent};
use crate::run::pace::Pace;
use crate::run::replicates::{Course, Keep};
use crate::run::share::{Post, Shared};
use crate::run::together::{Together, Watched};
use crate::run::turns::{KeepTurns, ToReceivers, Turns};
use crate::run::{Goal, Outcome, Plan};
use crate::scene::Scene;

use super::progress::{INTERRUPTED, Progress};
use super::{ranks, say};

/// The newest state of this name, as far as there is a whole one; what is wrong with a newer is said.
///
/// # Errors
/// States that are there and all damaged.
pub fn found(path: &Path, quiet: bool) -> Result<Option<Saved>> {
    let damaged =
        |e: Diagnostic| e.hint("remove it, or leave out --resume: the run starts with its first photon then");
    let Some((saved, wrong)) = run_state::newest(path).map_err(damaged)? else {
        if quiet {
            return Ok(None);
        }
        say(&format!("caustix: no {} to go on from: this run starts with its first photon", path.display()));
        return Ok(None);
    };
    if let Some(wrong) = wrong {
        say(&format!("warning: {wrong}; the state before it, {}, is gone on from", saved.path().display()));
    }
    Ok(Some(saved))
}

/// A run whose state is kept.
pub struct Job<'a> {
    pub scene: &'a Scene,
    pub plan: Plan,
    pub goal: Goal,
    /// The file of its state.
    pub state: &'a Path,
    pub part_of: Option<[u32; 2]>,
    pub quiet: bool,
}

impl Job<'_> {
    /// Traces it, from a state if there is one.
    ///
    /// # Errors
    /// Those of tracing; a state of another run.
    pub fn traced(&self, saved: Option<&Saved>) -> Result<Outcome> {
        self.traced_by(saved, None)
    }

    /// The same by all ranks, of which this one traces on the threads of a pool.
    ///
    /// # Errors
    /// Those of [`Self::traced`], and of the other ranks.
    pub fn traced_by_all(
        &self,
        saved: Option<&Saved>,
        post: &dyn Post,
        pool: &ThreadPool,
    ) -> Result<Outcome> {
        self.traced_by(saved, Some((post, pool)))
    }

    fn traced_by(&self, saved: Option<&Saved>, all: Option<(&dyn Post, &ThreadPool)>) -> Result<Outcome> {
        // A part of a picture keeps its photons: the camera sees those of all parts.
        let is_seen = self.part_of.is_some() && self.scene.camera.is_some();
        let mut kept = is_seen.then(|| AnyPhotons::new(self.scene)).transpose()?;
        let course = match saved {
            Some(saved) => saved.resumed(self.scene, &self.plan, kept.as_mut())?,
            None => Course::new(Together::of_part(self.scene, &self.plan, self.indices())?),
        };
        let shared = match all {
            None => None,
            Some((post, pool)) => {
                ranks::start(&course, self.goal.error, post)?;
                Some(Shared::new(post, pool))
            }
        };
        let all = if self.goal.error.is_some() || self.goal.until.is_some() { 0 } else { self.photons() };
        let progress = self.progress(saved, all);
        let state = State::new(self, saved);
        let mut keeper = Keeper { job: self, state, progress: &progress, kept, shared };
        let photons = |photons| progress.inc(photons);
        let watched = Watched { interrupt: &INTERRUPTED, progress: &photons };
        let outcome = course.run(self.goal, watched, &mut keeper);
        progress.clear();
        outcome
    }

    /// The indices of each replicate that it is of.
    pub fn indices(&self) -> std::ops::Range<u64> {
        self.plan.part(self.part_of.unwrap_or([1, 1]))
    }

    fn photons(&self) -> u64 {
        let indices = self.indices();
        (indices.end - indices.start) * u64::from(self.plan.replicates())
    }

    /// Traces it with its picture, from a state if there is one; what there is of it is kept until it has ended.
    ///
    /// # Errors
    /// Those of tracing and of the picture; a state of another run.
    pub fn in_turn(&self, saved: Option<&Saved>, save_map: bool) -> Result<(Outcome, Option<AnyPicture>)> {
        let mut turns = Turns::new(self.scene, &self.plan)?;
        let mut body = saved.map(|saved| self.opened(saved, &mut turns)).transpose()?;
        let progress = self.progress(saved, self.photons());
        let keeper =
            TurnsKeeper { state: State::new(self, saved), progress: &progress, pace: Mutex::default() };
        let photons = |photons| progress.inc(photons);
        let traced = if self.scene.camera.is_none() {
            let watched = Watched { interrupt: &INTERRUPTED, progress: &photons };
            let read = body.as_mut().map_or(Ok(()), |from| turns.read(from)).map_err(|e| not_of_this(&e));
            read.and_then(|()| turns.run(watched, &mut ToReceivers { watched, keep: &keeper }))
                .and_then(|()| Ok((turns.finish()?, None)))
        } else {
            let camera = |share| progress.picture(share);
            let watch = Watch { interrupt: &INTERRUPTED, photons: &photons, camera: &camera };
            let from = body.as_mut().map(|from| from as &mut dyn Read);
            trace_picture_from(turns, from, save_map, watch, &keeper)
                .map(|(outcome, picture)| (outcome, Some(picture)))
        };
        progress.clear();
        traced.map_err(|e| match saved {
            Some(saved) if e.file().is_none() && e.kind() == Kind::Syntax => e.in_file(saved.path()),
            _ => e,
        })
    }

    /// What a state of replicates in turn holds, for a run that is to go on from it.
    fn opened(&self, saved: &Saved, turns: &mut Turns<'_>) -> Result<io::Take<BufReader<File>>> {
        saved.head.check(self.scene, &self.plan).map_err(|e| e.in_file(saved.path()))?;
        turns.after(saved.head.trace_s());
        saved.body().map_err(|e| {
            let found = format!("\"{e}\" while reading");
            Diagnostic::new(Kind::Io, found, "a file that can be read").in_file(saved.path())
        })
    }

    /// The line of progress over so many photons; from where a run goes on is said.
    fn progress(&self, saved: Option<&Saved>, all: u64) -> Progress {
        let progress = Progress::new(self.quiet, "tracing", all);
        if let Some(saved) = saved {
            let (there, path) = (grouped(saved.head.traced()), saved.path().display());
            progress.suspend(|| say(&format!("caustix: goes on after {there} photons from {path}")));
            progress.after(saved.head.traced());
        }
        progress
    }
}

/// The file of a state that is written again and again.
struct State<'a> {
    path: &'a Path,
    /// Whether it was told that it cannot be written.
    is_told: AtomicBool,
    /// A state of so many photons is there, and is not replaced by one of fewer that is not finished.
    more: AtomicU64,
}

impl<'a> State<'a> {
    /// Of a run that goes on from a state, or starts anew beside one.
    fn new(job: &Job<'a>, saved: Option<&Saved>) -> Self {
        let path = job.state;
        let earlier = if saved.is_none() { run_state::newest(path).ok().flatten() } else { None };
        let same = earlier.filter(|(saved, _)| saved.head.check_photons(job.scene, &job.plan).is_ok());
        let more = same.map_or(0, |(saved, _)| saved.head.traced());
        Self { path, is_told: AtomicBool::new(false), more: more.into() }
    }

    fn write(&self, head: &Head, progress: &Progress, body: impl FnOnce(&mut dyn Write) -> io::Result<()>) {
        if !head.is_done() && head.traced() < self.more.load(Ordering::Relaxed) {
            return;
        }
        match run_state::write(self.path, head, body) {
            Ok(()) => self.more.store(0, Ordering::Relaxed),
            Err(error) => {
                let rest =
                    "the run goes on, but if it were ended now it could go on from an older state at best";
                if !self.is_told.swap(true, Ordering::Relaxed) {
                    progress.suspend(|| say(&format!("warning: {error}; {rest}")));
                }
            }
        }
    }
}

/// Keeps the state of replicates together.
struct Keeper<'a> {
    job: &'a Job<'a>,
    state: State<'a>,
    progress: &'a Progress,
    /// Photons for a camera.
    kept: Option<AnyPhotons>,
    /// All ranks, where there are several.
    shared: Option<Shared<'a>>,
}

impl Keep for Keeper<'_> {
    fn trace(&mut self, run: &mut Together<'_>, end: u64, watched: Watched<'_>) -> Result<bool> {
        match (&mut self.shared, &mut self.kept) {
            (Some(shared), _) => shared.trace(run, end, watched),
            (None, Some(kept)) => kept.trace(run, end, watched),
            (None, None) => run.trace(end, watched),
        }
    }

    fn install<R: Send>(&self, sum: impl FnOnce() -> R + Send) -> R {
        match &self.shared {
            Some(shared) => shared.install(sum),
            None => sum(),
        }
    }

    fn keep(&mut self, course: &Course<'_>) {
        let head = Head::of(course, self.job.goal.error, self.job.part_of);
        self.state.write(&head, self.progress, |out| {
            course.run.write(out)?;
            self.kept.as_ref().map_or(Ok(()), |kept| kept.write(out))
        });
    }

    fn look(&mut self, error: f64, asked: f64, left_s: Option<f64>) {
        let left = left_s.filter(|_| error > asked);
        let left = left.map_or(String::new(), |s| format!(" in about {}", duration(s)));
        let now =
            if error.is_finite() { format!("{} % now", percent(error)) } else { "nothing arrived".into() };
        self.progress.phase(format!("tracing: {now}, {} %{left}", percent(asked)));
    }
}

/// Keeps the state of replicates in turn.
struct TurnsKeeper<'a> {
    state: State<'a>,
    progress: &'a Progress,
    pace: Mutex<Pace>,
}

impl KeepTurns for TurnsKeeper<'_> {
    fn is_due(&self) -> bool {
        self.pace.lock().unwrap_or_else(PoisonError::into_inner).is_due()
    }

    fn keep(&self, turns: &Turns<'_>, more: &mut dyn FnMut(&mut dyn Write) -> io::Result<()>) {
        let head = Head::of_turns(turns);
        let write = |out: &mut dyn Write| turns.write(out).and_then(|()| more(out));
        let mut pace = self.pace.lock().unwrap_or_else(PoisonError::into_inner);
        pace.keep(|| self.state.write(&head, self.progress, write));
    }
}
