//! A stage of a run, cut into tasks.

use std::ops::Range;

use serde::{Deserialize, Serialize};

/// Photons of one replicate, for one rank.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Task {
    /// The replicate.
    pub replicate: u32,
    /// The indices.
    pub indices: Range<u64>,
}

/// Fewest photons of a task: some 20 ms of a core, a hundred times what a question and its answer take.
pub const FEWEST: u64 = 1 << 14;
/// A task is this part of a rank's share of what is left: a rank that is slow, or begins one late, keeps nobody waiting.
const PART: u64 = 4;

/// Tasks that are left of a stage. They become shorter, and end where nets do.
#[derive(Debug)]
pub struct Tasks {
    /// What is left, by replicate, and of all.
    open: Vec<Range<u64>>,
    left: u64,
    at: usize,
    ranks: u64,
}

impl Tasks {
    /// All tasks of these indices of each replicate, for so many ranks.
    pub fn new(open: Vec<Range<u64>>, ranks: u32) -> Self {
        let left = open.iter().map(|indices| indices.end.saturating_sub(indices.start)).sum();
        Self { open, left, at: 0, ranks: u64::from(ranks.max(1)) }
    }

    /// Photons that are left.
    pub fn photons(&self) -> u64 {
        self.left
    }

    /// Leaves what is left.
    pub fn clear(&mut self) {
        (self.left, self.at) = (0, self.open.len());
    }
}

impl Iterator for Tasks {
    type Item = Task;

    fn next(&mut self) -> Option<Task> {
        while self.open.get(self.at)?.is_empty() {
            self.at += 1;
        }
        let length = 1 << (self.left / (PART * self.ranks)).max(FEWEST).ilog2();
        let open = &mut self.open[self.at];
        let end = open.end.min((open.start / length + 1) * length);
        let indices = open.start..end;
        open.start = end;
        self.left -= end - indices.start;
        Some(Task { replicate: self.at as u32, indices })
    }
}

#[cfg(test)]
mod tests {
    use std::iter::once;

    use super::*;

    #[test]
    fn every_index_is_in_one_task_and_tasks_become_short() {
        for (open, ranks) in [
            (vec![0..1 << 20, 0..1 << 20], 2),
            (
                vec![
                    5..70_000,
                    1 << 18..1 << 19,
                    9..9,
                    Range { start: 12, end: 7 },
                    (1 << 40) + 3..(1 << 40) + 200_001,
                ],
                3,
            ),
            (once(0..1).collect(), 1024),
            (vec![], 2),
        ] {
            let photons: u64 = open.iter().map(|r: &Range<u64>| r.end.saturating_sub(r.start)).sum();
            let mut tasks = Tasks::new(open.clone(), ranks);
            assert_eq!(tasks.photons(), photons);
            let all: Vec<Task> = tasks.by_ref().collect();
            assert_eq!(tasks.photons(), 0);
            for (replicate, indices) in open.into_iter().enumerate() {
                let mut next = indices.start;
                for task in all.iter().filter(|task| task.replicate as usize == replicate) {
                    assert_eq!(task.indices.start, next);
                    assert!(!task.indices.is_empty());
                    next = task.indices.end;
                }
                assert_eq!(next, indices.end.max(indices.start));
            }
            let length = |task: &Task| task.indices.end - task.indices.start;
            if let [first, .., last] = &all[..] {
                assert!(length(first) <= photons / u64::from(ranks) / PART || length(first) <= FEWEST);
                assert!(length(last) <= FEWEST, "{last:?}");
                // Nets: all but the ends begin and end at multiples of their length.
                let whole = all.iter().filter(|task| length(task).is_power_of_two());
                assert!(whole.clone().count() > all.len() / 2);
            }
        }
        let mut left = Tasks::new(once(0..1 << 20).collect(), 2);
        left.clear();
        assert_eq!((left.next(), left.photons()), (None, 0));
    }
}
