//! How often what there is of a run is kept.

use std::time::{Duration, Instant};

/// What there is is kept after a second, and then when a hundred times as long as it takes has gone by: that costs a percent.
const FIRST: Duration = Duration::from_secs(1);
const PART: u32 = 100;

/// When to keep what there is.
#[derive(Debug)]
pub struct Pace {
    last: Instant,
    cost: Duration,
}

impl Pace {
    /// From now on.
    pub fn new() -> Self {
        Self { last: Instant::now(), cost: Duration::ZERO }
    }

    /// Whether it is time.
    pub fn is_due(&self) -> bool {
        self.last.elapsed() >= FIRST.max(self.cost * PART)
    }

    /// Keeps what there is by this, and remembers what it took.
    pub fn keep(&mut self, keep: impl FnOnce()) {
        let begun = Instant::now();
        keep();
        (self.last, self.cost) = (Instant::now(), begun.elapsed());
    }
}

impl Default for Pace {
    fn default() -> Self {
        Self::new()
    }
}
