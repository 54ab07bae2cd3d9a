//! What ranks tell each other.

use serde::{Deserialize, Serialize};

use crate::error::{Diagnostic, Kind, Result};
use crate::math::varint::{damaged, put, take};

use super::Post;
use super::tasks::Task;

/// A message. All are JSON but the sums, which begin with a zero.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub enum Message {
    /// To 0: what a rank has read.
    Hello(String),
    /// From 0: the run begins.
    Start(String),
    /// To 0: a task is wanted.
    Ask,
    /// From 0: photons to be traced.
    Task(Task),
    /// To 0: a task is done, or was left when somebody stopped it.
    Done {
        /// Its photons.
        photons: u64,
        /// False where it was left.
        complete: bool,
    },
    /// To 0: this rank was interrupted. From 0: leave all tasks.
    Stop,
    /// From 0: a stage is over, its sums are wanted.
    AddUp,
    /// To the parent in the tree: what each replicate counted; empty where there was no task.
    #[serde(skip)]
    Sums(Vec<Vec<u8>>),
    /// To 0: this rank cannot go on.
    Failed {
        /// What it found.
        found: String,
        /// What is required.
        required: String,
    },
    /// From 0: there is nothing more to do.
    End,
}

impl Message {
    /// That a rank cannot go on.
    pub fn failed(error: &Diagnostic) -> Self {
        let place = error.file().map_or(String::new(), |file| format!("{file}: "));
        Self::Failed { found: place + error.found(), required: error.required().to_owned() }
    }

    /// Sends it.
    pub fn send(&self, post: &dyn Post, to: u32) {
        post.send(to, &self.to_bytes());
    }

    /// Sends it to all other ranks.
    pub fn send_to_all(&self, post: &dyn Post) {
        let bytes = self.to_bytes();
        (0..post.size()).filter(|rank| *rank != post.rank()).for_each(|rank| post.send(rank, &bytes));
    }

    /// One that has come, and from whom.
    ///
    /// # Errors
    /// What is no message.
    pub fn poll(post: &dyn Post) -> Result<Option<(u32, Self)>> {
        let Some((from, bytes)) = post.poll() else { return Ok(None) };
        let message = match bytes.split_first() {
            Some((0, sums)) => sums_of(sums).map_err(|e| e.to_string()),
            _ => serde_json::from_slice(&bytes).map_err(|e| e.to_string()),
        };
        message.map(|message| Some((from, message))).map_err(|error| {
            let found = format!("a message from rank {from} that holds {error}");
            Diagnostic::new(Kind::Syntax, found, "one that this version of caustix sent, on every rank")
        })
    }

    fn to_bytes(&self) -> Vec<u8> {
        let Self::Sums(sums) = self else { return serde_json::to_vec(self).unwrap_or_default() };
        let mut bytes = vec![0];
        let lengths = [sums.len()].into_iter().chain(sums.iter().map(Vec::len));
        // Into memory, where nothing can fail.
        let _written = put(&mut bytes, lengths.map(|length| length as u64));
        bytes.reserve_exact(sums.iter().map(Vec::len).sum());
        sums.iter().for_each(|sum| bytes.extend_from_slice(sum));
        bytes
    }
}

fn sums_of(mut bytes: &[u8]) -> std::io::Result<Message> {
    let count = take(&mut bytes)?;
    let lengths = (0..count).map(|_| take(&mut bytes)).collect::<std::io::Result<Vec<_>>>()?;
    let of = |length: u64| {
        let (sum, rest) =
            bytes.split_at_checked(length as usize).ok_or_else(|| damaged("sums that are cut short"))?;
        bytes = rest;
        Ok(sum.to_vec())
    };
    Ok(Message::Sums(lengths.into_iter().map(of).collect::<std::io::Result<_>>()?))
}

/// What went wrong on another rank, as this one says it.
pub fn of_rank(rank: u32, found: &str, required: String) -> Diagnostic {
    Diagnostic::new(Kind::Unavailable, format!("{found} (rank {rank})"), required)
}
