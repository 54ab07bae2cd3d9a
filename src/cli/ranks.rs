//! `caustix render` as one of several processes, the ranks of a run: what they read must be the same, rank 0 alone speaks and
//! writes, the others work for it.

use std::process::ExitCode;
use std::sync::atomic::Ordering;

use serde::{Deserialize, Serialize};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::run_state::Head;
use crate::run::kept::is_together;
use crate::run::replicates::Course;
use crate::run::share::{Message, Pause, Post, work};
use crate::run::together::Together;
use crate::run::{ErrorGoal, Plan};
use crate::scene::Scene;

use super::progress::{INTERRUPTED, catch_interrupts};
use super::start::{load, thread_pool};
use super::{MUTE, RenderArgs};

/// What a rank has read: the same on every one, or they would trace different scenes.
#[derive(Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Read {
    caustix: String,
    /// SHA-256 of the scene file, and of what its results depend on.
    scene: String,
    results: String,
    /// Files that it names, and their SHA-256.
    files: Vec<(String, String)>,
    /// Why it could not be read.
    wrong: Option<String>,
}

impl Read {
    fn new(scene: std::result::Result<&Scene, &[Diagnostic]>) -> Self {
        let identity = scene.map(|scene| scene.identity.clone()).unwrap_or_default();
        Self {
            caustix: env!("CARGO_PKG_VERSION").to_owned(),
            scene: identity.sha256,
            results: identity.results,
            files: identity.files,
            wrong: scene.err().and_then(|errors| Some(errors.first()?.to_string())),
        }
    }

    /// That another rank has read the same as this one.
    fn check(&self, rank: u32, other: &Self) -> Result<()> {
        let fail = |found: String, required: String| Err(Diagnostic::new(Kind::Range, found, required));
        let same = "under the same path on every machine: in a folder that they share, or copied to each";
        if other.caustix != self.caustix {
            return fail(
                format!("caustix {} on rank {rank}", other.caustix),
                format!("caustix {}, as on rank 0: another version may trace other photons", self.caustix),
            );
        }
        if let Some(wrong) = &other.wrong {
            return fail(
                format!("rank {rank} without the scene (\"{wrong}\")"),
                format!("the same files {same}"),
            );
        }
        if let Some(((name, _), _)) =
            self.files.iter().zip(&other.files).find(|(ours, theirs)| ours != theirs)
        {
            return fail(
                format!("another {name} on rank {rank} than on rank 0"),
                format!("the same file {same}"),
            );
        }
        if self != other {
            return fail(
                format!("another scene file on rank {rank} than on rank 0"),
                format!("the same file {same}"),
            );
        }
        Ok(())
    }
}

/// Ends all other ranks when it goes, whatever came of the run.
pub struct Leader<'a>(pub &'a dyn Post);

impl Drop for Leader<'_> {
    fn drop(&mut self) {
        // After a panic all are ended in another way, that does not need them to listen.
        if !std::thread::panicking() {
            Message::End.send_to_all(self.0);
        }
    }
}

/// That several processes can share what is asked for.
///
/// # Errors
/// Pictures, replicates that are traced one after another, points that are rejected; parts and saved photons.
pub fn check(args: &RenderArgs, scene: &Scene, plan: &Plan, post: &dyn Post) -> Result<()> {
    let size = post.size();
    let fail = |found: String, required: &str| {
        let hint =
            "without `mpirun`, or with `mpirun -n 1`, one process does it with all threads of its machine";
        Err(Diagnostic::new(Kind::Unavailable, format!("{found} by {size} processes"), required).hint(hint))
    };
    if args.part.is_some() {
        let required =
            "one of both: `mpirun` shares a whole run, and a part is traced by a process of its own";
        return fail("--part".into(), required);
    }
    if scene.camera.is_some() {
        return fail(
            "a scene with [camera]".into(),
            "one process: a picture's photons are kept in its memory",
        );
    }
    if plan.algorithm().sampling().skips_points() {
        let found = format!("a run by {}", plan.algorithm().name());
        return fail(found, "a variant whose photons are numbered as its points are");
    }
    if !is_together(scene, plan) {
        let required = "one process, or a sequence that is not made for its number of points, and maps of all replicates \
                        that fit into a gibibyte";
        return fail("replicates that are traced one after another".into(), required);
    }
    Ok(())
}

/// That a subcommand is not shared.
pub fn for_one() -> Diagnostic {
    let required = "`caustix render`, which is shared; other commands in one process, without `mpirun`";
    Diagnostic::new(Kind::Unavailable, "several processes for one command", required)
}

/// That all ranks have read what rank 0 has.
///
/// # Errors
/// What differs, and on which rank.
pub fn check_all_read(scene: &Scene, post: &dyn Post) -> Result<()> {
    let ours = Read::new(Ok(scene));
    let mut pause = Pause::default();
    let mut missing = post.size() - 1;
    while missing > 0 {
        match Message::poll(post)? {
            Some((rank, Message::Hello(read))) => {
                let read: Read = serde_json::from_str(&read).map_err(|e| damaged(&e))?;
                ours.check(rank, &read)?;
                missing -= 1;
                pause.end();
            }
            _ if INTERRUPTED.load(Ordering::Relaxed) => {
                let found = format!("an interrupt before all {} ranks had read the scene", post.size());
                return Err(Diagnostic::new(Kind::Interrupted, found, "time for that"));
            }
            _ => std::thread::sleep(pause.longer()),
        }
    }
    Ok(())
}

/// That this process is no rank of a run, which only the feature `mpi` can share: each would do the whole, into one folder.
///
/// # Errors
/// A process that a launcher started as one of several.
#[cfg(not(feature = "mpi"))]
pub fn check_launched(args: &RenderArgs) -> std::result::Result<(), Vec<Diagnostic>> {
    let number = |name| std::env::var(name).ok()?.parse::<u32>().ok();
    let launched = [["OMPI_COMM_WORLD_SIZE", "OMPI_COMM_WORLD_RANK"], ["PMI_SIZE", "PMI_RANK"]];
    let one_of = launched.iter().find_map(|[size, rank]| Some((number(size)?, number(rank)?)));
    match one_of.filter(|(size, _)| *size > 1 && args.part.is_none()) {
        None => Ok(()),
        Some((_, rank)) if rank > 0 => {
            MUTE.store(true, Ordering::Relaxed);
            Err(Vec::new())
        }
        Some((size, _)) => {
            let found = format!("{size} processes that are to trace one run together");
            let required = "a caustix that was built with `--features mpi` (docs/MPI.md), or one process";
            Err(Diagnostic::new(Kind::Unavailable, found, required).into())
        }
    }
}

/// Tells all other ranks what the run is of.
pub fn start(course: &Course<'_>, goal: Option<ErrorGoal>, post: &dyn Post) -> Result<()> {
    let head = serde_json::to_string(&Head::of(course, goal, None)).map_err(|e| damaged(&e))?;
    Message::Start(head).send_to_all(post);
    Ok(())
}

/// Any rank but 0: works for it, and says nothing. Its own end is no error; what went wrong rank 0 says.
pub fn follow(args: &RenderArgs, post: &dyn Post) -> ExitCode {
    MUTE.store(true, Ordering::Relaxed);
    catch_interrupts();
    if let Err(error) = followed(args, post) {
        Message::failed(&error).send(post, 0);
        let mut pause = Pause::default();
        while !matches!(Message::poll(post), Ok(Some((_, Message::End)))) {
            std::thread::sleep(pause.longer());
        }
    }
    ExitCode::SUCCESS
}

fn followed(args: &RenderArgs, post: &dyn Post) -> Result<()> {
    let loaded = load(args.scene.as_deref(), args.confine, true);
    let read = Read::new(loaded.as_ref().map(|(scene, _)| scene).map_err(|errors| &errors[..]));
    Message::Hello(serde_json::to_string(&read).map_err(|e| damaged(&e))?).send(post, 0);
    let mut pause = Pause::default();
    let start = loop {
        match Message::poll(post)? {
            Some((_, Message::Start(head))) => break head,
            Some((_, Message::End)) => return Ok(()),
            _ => std::thread::sleep(pause.longer()),
        }
    };
    let Ok((mut scene, _)) = loaded else { return Ok(()) };
    let head: Head = serde_json::from_str(&start).map_err(|e| damaged(&e))?;
    head.divide(&mut scene);
    let plan = Plan::new(&head.settings()?)?;
    let pool = thread_pool(threads(args, post))?;
    work(post, &pool, &mut Together::new(&scene, &plan)?, &INTERRUPTED)
}

/// Threads of a rank: those asked for, else its share of the cores of its machine.
pub fn threads(args: &RenderArgs, post: &dyn Post) -> Option<u32> {
    let cores = std::thread::available_parallelism().map_or(1, |cores| cores.get() as u32);
    args.threads.or(Some((cores / post.neighbours().max(1)).max(1)))
}

fn damaged(error: &serde_json::Error) -> Diagnostic {
    let found = format!("a message between ranks that holds \"{error}\"");
    Diagnostic::new(Kind::Syntax, found, "one that this version of caustix sent, on every rank")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_between_ranks_is_named() {
        let read = |change: fn(&mut Read)| {
            let mut read = Read {
                caustix: "1".into(),
                scene: "a".into(),
                results: "b".into(),
                files: vec![("lamp.ies".into(), "c".into()), ("glass.obj".into(), "d".into())],
                wrong: None,
            };
            change(&mut read);
            read
        };
        let ours = read(|_| {});
        assert_eq!(ours.check(3, &read(|_| {})), Ok(()));
        type Change = fn(&mut Read);
        let changes: [(Change, &str); 4] = [
            (|read| read.caustix = "2".into(), "caustix 2 on rank 3"),
            (|read| read.scene = "z".into(), "another scene file on rank 3"),
            (|read| read.files[1].1 = "z".into(), "another glass.obj on rank 3"),
            (|read| read.wrong = Some("no such file".into()), "rank 3 without the scene (\"no such file\")"),
        ];
        for (change, told) in changes {
            let error = ours.check(3, &read(change)).unwrap_err().to_string();
            assert!(error.contains(told) && error.contains("required"), "{error}");
        }
    }
}
