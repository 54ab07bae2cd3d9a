//! Every rank but 0: traces the tasks that it gets, and gives what it counted.

use std::sync::atomic::{AtomicBool, Ordering};

use rayon::ThreadPool;

use crate::error::Result;
use crate::run::together::{Together, Watched};
use crate::transport::parallel::Traced;

use super::desk::Desk;
use super::message::Message;
use super::serve::{add, not_of_this_run};
use super::{Pause, Post, children, parent};

/// A rank at work.
struct Worker<'a> {
    post: &'a dyn Post,
    pool: &'a ThreadPool,
    interrupt: &'a AtomicBool,
    /// Whether a task is asked for that has not come.
    has_asked: bool,
    /// Whether rank 0 knows that this one was interrupted.
    is_told: bool,
    /// Sums that have come from other ranks.
    sums: Vec<(u32, Vec<Vec<u8>>)>,
}

/// Works for rank 0 until there is nothing more to do. Not for a thread of the pool.
///
/// # Errors
/// Sums of another run; messages of another version. What goes wrong with photons is told to rank 0.
pub fn work(
    post: &dyn Post,
    pool: &ThreadPool,
    run: &mut Together<'_>,
    interrupt: &AtomicBool,
) -> Result<()> {
    let mut worker = Worker { post, pool, interrupt, has_asked: false, is_told: false, sums: Vec::new() };
    while let Some(traced) = worker.stage(run)? {
        if !worker.add_up(run, &traced)? {
            break;
        }
    }
    Ok(())
}

impl Worker<'_> {
    /// Traces tasks until a stage is over: what they left beside the sums; `None` at the end of all.
    fn stage(&mut self, run: &Together<'_>) -> Result<Option<Vec<(u32, Traced)>>> {
        let Self { post, pool, interrupt, .. } = *self;
        let watched = Watched { interrupt, progress: &|_| {} };
        let mut all = Vec::new();
        pool.in_place_scope(|scope| {
            let mut desk = Desk::new(pool.current_num_threads());
            let mut pause = Pause::default();
            loop {
                if !self.is_told && interrupt.load(Ordering::Relaxed) {
                    self.is_told = true;
                    Message::Stop.send(post, 0);
                }
                if !self.has_asked && desk.wants_more() {
                    self.has_asked = true;
                    Message::Ask.send(post, 0);
                }
                if let Some((task, traced)) = desk.finished(pause.longer()) {
                    pause.end();
                    let complete = traced.as_ref().is_ok_and(|traced| traced.complete);
                    match traced {
                        Ok(traced) => all.push((task.replicate, traced)),
                        Err(error) => Message::failed(&error).send(post, 0),
                    }
                    let photons = task.indices.end - task.indices.start;
                    Message::Done { photons, complete }.send(post, 0);
                }
                while let Some((from, message)) = Message::poll(post)? {
                    pause.end();
                    match message {
                        Message::Task(task) => {
                            self.has_asked = false;
                            desk.begin(scope, run, task, watched);
                        }
                        Message::Sums(sums) => self.sums.push((from, sums)),
                        Message::Stop => interrupt.store(true, Ordering::Relaxed),
                        Message::AddUp => return Ok(Some(all)),
                        Message::End => return Ok(None),
                        _ => {}
                    }
                }
            }
        })
    }

    /// Gives what this rank and those below it in the tree counted to the one above; false at the end of all.
    fn add_up(&mut self, run: &mut Together<'_>, traced: &[(u32, Traced)]) -> Result<bool> {
        let post = self.post;
        traced.iter().for_each(|(replicate, traced)| run.took(*replicate, traced));
        let mut is_empty = traced.is_empty();
        let mut missing = children(post.rank(), post.size()).count();
        let mut pause = Pause::default();
        loop {
            for (from, sums) in std::mem::take(&mut self.sums) {
                self.pool.install(|| add(run, &sums)).map_err(|e| not_of_this_run(from, &e))?;
                is_empty &= sums.is_empty();
                missing -= 1;
                pause.end();
            }
            if missing == 0 {
                break;
            }
            match Message::poll(post)? {
                Some((from, Message::Sums(sums))) => self.sums.push((from, sums)),
                Some((_, Message::End)) => return Ok(false),
                Some(_) => {}
                None => std::thread::sleep(pause.longer()),
            }
        }
        let sums = if is_empty { Ok(Vec::new()) } else { self.pool.install(|| run.counted()) };
        let sums = sums.map_err(|e| not_of_this_run(post.rank(), &e))?;
        Message::Sums(sums).send(post, parent(post.rank()));
        if !is_empty {
            self.pool.install(|| run.clear());
        }
        Ok(true)
    }
}
