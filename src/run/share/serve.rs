//! Rank 0: hands out the tasks of a stage, traces its own, and adds up what was counted.

use std::sync::atomic::Ordering;

use rayon::ThreadPool;

use crate::error::{Diagnostic, Kind, Result};
use crate::run::together::{Together, Watched};
use crate::transport::parallel::Traced;

use super::desk::Desk;
use super::message::{Message, of_rank};
use super::tasks::{FEWEST, Tasks};
use super::{Pause, Post, children};

/// All ranks of a run, as rank 0 has them. Not for a thread of the pool.
pub struct Shared<'a> {
    post: &'a dyn Post,
    pool: &'a ThreadPool,
    /// Ranks that wait for a task.
    asking: Vec<u32>,
}

/// What rank 0 traced of a stage.
#[derive(Default)]
struct Stage {
    traced: Vec<(u32, Traced)>,
    /// False where a task was left.
    complete: bool,
}

impl<'a> Shared<'a> {
    /// All ranks, of which this one traces on these threads.
    pub fn new(post: &'a dyn Post, pool: &'a ThreadPool) -> Self {
        Self { post, pool, asking: Vec::new() }
    }

    /// Traces all replicates up to an index; false where an interrupt came before, as [`Together::trace`].
    ///
    /// # Errors
    /// Those of [`Together::trace`], and what went wrong on another rank.
    pub fn trace(&mut self, run: &mut Together<'_>, end: u64, watched: Watched<'_>) -> Result<bool> {
        while run.done() < end {
            let stage = run.stage(end);
            let tasks = Tasks::new(run.open(stage), self.post.size());
            // So few are traced here in less time than it takes to add them up.
            let is_done = if tasks.photons() < FEWEST * u64::from(self.post.size()) {
                self.pool.install(|| run.trace(stage, watched))?
            } else {
                self.stage(run, tasks, stage, watched)?
            };
            if !is_done {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Does a sum on the threads of this rank.
    pub fn install<R: Send>(&self, sum: impl FnOnce() -> R + Send) -> R {
        self.pool.install(sum)
    }

    /// Traces a stage with all ranks; false where it was stopped.
    fn stage(
        &mut self,
        run: &mut Together<'_>,
        tasks: Tasks,
        end: u64,
        watched: Watched<'_>,
    ) -> Result<bool> {
        let stage = self.hand_out(run, tasks, watched)?;
        for (replicate, traced) in &stage.traced {
            run.took(*replicate, traced);
        }
        if !stage.complete {
            return Ok(false);
        }
        Message::AddUp.send_to_all(self.post);
        let mut missing = children(0, self.post.size()).count();
        let mut pause = Pause::default();
        while missing > 0 {
            match Message::poll(self.post)? {
                None => std::thread::sleep(pause.longer()),
                Some((from, Message::Sums(sums))) => {
                    let add = || add(run, &sums);
                    self.pool.install(add).map_err(|e| not_of_this_run(from, &e))?;
                    missing -= 1;
                    pause.end();
                }
                Some((from, Message::Ask)) => self.asking.push(from),
                Some((_, Message::Stop)) => watched.interrupt.store(true, Ordering::Relaxed),
                Some((from, Message::Failed { found, required })) => {
                    return Err(of_rank(from, &found, required));
                }
                Some(_) => {}
            }
        }
        self.pool.install(|| run.close(end));
        Ok(true)
    }

    /// Until all tasks are done, or somebody stops them.
    fn hand_out(&mut self, run: &Together<'_>, mut tasks: Tasks, watched: Watched<'_>) -> Result<Stage> {
        let Self { post, pool, asking } = self;
        let mut stage = Stage { traced: Vec::new(), complete: true };
        let mut failed: Option<Diagnostic> = None;
        // Tasks that other ranks have.
        let mut elsewhere = 0_u64;
        let mut is_stopped = false;
        pool.in_place_scope(|scope| {
            let mut desk = Desk::new(pool.current_num_threads());
            let mut pause = Pause::default();
            loop {
                if !is_stopped && (failed.is_some() || watched.interrupt.load(Ordering::Relaxed)) {
                    is_stopped = true;
                    stage.complete = stage.complete && tasks.photons() == 0;
                    tasks.clear();
                    watched.interrupt.store(true, Ordering::Relaxed);
                    Message::Stop.send_to_all(*post);
                }
                while !asking.is_empty() || desk.wants_more() {
                    let Some(task) = tasks.next() else { break };
                    match asking.pop() {
                        None => desk.begin(scope, run, task, watched),
                        Some(rank) => {
                            elsewhere += 1;
                            Message::Task(task).send(*post, rank);
                        }
                    }
                }
                // A rank that failed may never tell of its tasks.
                if desk.is_empty() && tasks.photons() == 0 && (elsewhere == 0 || failed.is_some()) {
                    break;
                }
                if let Some((task, traced)) = desk.finished(pause.longer()) {
                    pause.end();
                    match traced {
                        Ok(traced) => {
                            stage.complete &= traced.complete;
                            stage.traced.push((task.replicate, traced));
                        }
                        Err(error) => failed = failed.take().or(Some(error)),
                    }
                }
                while let Some((from, message)) = Message::poll(*post).unwrap_or_else(|error| {
                    failed = failed.take().or(Some(error));
                    None
                }) {
                    pause.end();
                    match message {
                        Message::Ask => asking.push(from),
                        Message::Done { photons, complete } => {
                            elsewhere -= 1;
                            stage.complete &= complete;
                            (watched.progress)(photons);
                        }
                        Message::Stop => watched.interrupt.store(true, Ordering::Relaxed),
                        Message::Failed { found, required } => {
                            failed = failed.take().or_else(|| Some(of_rank(from, &found, required)));
                        }
                        _ => {}
                    }
                }
            }
        });
        failed.map_or(Ok(stage), Err)
    }
}

/// Adds the sums of another rank, where it had a task.
pub(super) fn add(run: &mut Together<'_>, sums: &[Vec<u8>]) -> std::io::Result<()> {
    if sums.is_empty() { Ok(()) } else { run.add_counted(sums) }
}

/// That sums cannot be added.
pub(super) fn not_of_this_run(from: u32, error: &std::io::Error) -> Diagnostic {
    let found = format!("sums of rank {from} that hold {error}");
    Diagnostic::new(Kind::Syntax, found, "sums of the same run, by the same version of caustix")
}
