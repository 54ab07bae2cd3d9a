//! One run by several processes, its ranks: blocks of photons are handed out by rank 0, and what was counted is added up.
//!
//! Points are functions of (seed, replicate, index), every index is in one task, all that is counted is added as whole numbers,
//! and only rank 0 looks and decides: nobody can tell from the results how many ranks there were (METHOD 7).
//!
//! Rank 0 cuts a stage of a run into tasks. A rank asks for a task while it has another, so that its threads do not wait. When
//! all are done the sums go up a binomial tree to rank 0, which then is where a single process would be. Nobody waits in a call
//! of the message library: such calls take a whole core in many of them.

mod desk;
mod message;
mod serve;
mod tasks;
mod work;

use std::time::Duration;

pub use message::Message;
pub use serve::Shared;
pub use work::work;

/// The messages between the ranks of a run, in order between any two.
pub trait Post {
    /// This process among the others.
    fn rank(&self) -> u32;
    /// Number of ranks.
    fn size(&self) -> u32;
    /// Number of ranks on this machine.
    fn neighbours(&self) -> u32;
    /// Sends a message.
    fn send(&self, to: u32, message: &[u8]);
    /// A message that has come, and from whom, without waiting for one.
    fn poll(&self) -> Option<(u32, Vec<u8>)>;
}

/// How long to wait for news: longer while there are none.
#[derive(Debug)]
pub struct Pause(Duration);

const SHORTEST: Duration = Duration::from_micros(100);
const LONGEST: Duration = Duration::from_millis(2);

impl Default for Pause {
    fn default() -> Self {
        Self(SHORTEST)
    }
}

impl Pause {
    /// Something has come.
    pub fn end(&mut self) {
        self.0 = SHORTEST;
    }

    /// The next one.
    pub fn longer(&mut self) -> Duration {
        let now = self.0;
        self.0 = LONGEST.min(now * 2);
        now
    }
}

/// Ranks whose sums a rank adds to its own.
fn children(rank: u32, size: u32) -> impl Iterator<Item = u32> {
    let bits = if rank == 0 { u32::BITS } else { rank.trailing_zeros() };
    (0..bits).map_while(move |bit| rank.checked_add(1_u32.checked_shl(bit)?)).take_while(move |r| *r < size)
}

/// The rank that adds the sums of this one.
fn parent(rank: u32) -> u32 {
    rank & rank.wrapping_sub(1)
}

#[cfg(test)]
mod tests;
