//! The tasks that a rank has begun.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::Duration;

use rayon::Scope;

use crate::error::Result;
use crate::run::together::{Together, Watched};
use crate::transport::parallel::Traced;

use super::tasks::{FEWEST, Task};

/// Tasks on the threads of a rank.
pub struct Desk {
    begun: usize,
    /// Photons of the tasks begun, and how many keep all threads busy.
    photons: u64,
    enough: u64,
    sender: Sender<(Task, std::thread::Result<Result<Traced>>)>,
    finished: Receiver<(Task, std::thread::Result<Result<Traced>>)>,
}

/// Tasks that a rank has at least: threads that one leaves idle go on with the next.
const TASKS: usize = 2;

impl Desk {
    /// Nothing begun, for so many threads.
    pub fn new(threads: usize) -> Self {
        let (sender, finished) = channel();
        Self { begun: 0, photons: 0, enough: 2 * FEWEST * threads as u64, sender, finished }
    }

    /// Whether another task should be begun.
    pub fn wants_more(&self) -> bool {
        self.begun < TASKS || self.photons < self.enough
    }

    /// Whether nothing is begun.
    pub fn is_empty(&self) -> bool {
        self.begun == 0
    }

    /// Begins a task.
    pub fn begin<'scope>(
        &mut self,
        scope: &Scope<'scope>,
        run: &'scope Together<'_>,
        task: Task,
        watched: Watched<'scope>,
    ) {
        self.begun += 1;
        self.photons += task.indices.end - task.indices.start;
        let sender = self.sender.clone();
        scope.spawn(move |_| {
            let trace = || run.task(task.replicate, task.indices.clone(), watched);
            // A panic is told, too: it must not leave this rank waiting, and all others for it.
            let traced = catch_unwind(AssertUnwindSafe(trace));
            let _told = sender.send((task, traced));
        });
    }

    /// A task that is finished, or `None` where none is within this time.
    pub fn finished(&mut self, patience: Duration) -> Option<(Task, Result<Traced>)> {
        if self.is_empty() {
            std::thread::sleep(patience);
            return None;
        }
        let (task, traced) = self.finished.recv_timeout(patience).ok()?;
        self.begun -= 1;
        self.photons -= task.indices.end - task.indices.start;
        Some((task, traced.unwrap_or_else(|panic| resume_unwind(panic))))
    }
}
