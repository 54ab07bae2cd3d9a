//! The ledger: every photon emitted is in exactly one account.
//!
//! All in integers. Photons are counted in when an emitter starts them and out where they end, so a photon lost in between
//! shows as an imbalance; nothing is computed as the rest.

use std::collections::BTreeMap;

use crate::geometry::SurfaceId;

use super::walk::End;

/// Photons begun and ended.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Ledger {
    /// Begun, by emitter.
    pub emitted: Vec<u64>,
    /// Absorbed, by surface.
    pub absorbed: Vec<u64>,
    /// Left the scene.
    pub escaped: u64,
    /// Ended by the guard.
    pub killed: u64,
    /// Kept for ever by total reflection, by body.
    pub trapped: BTreeMap<SurfaceId, u64>,
}

impl Ledger {
    /// An empty ledger for this many emitters and surfaces.
    pub fn new(emitters: usize, surfaces: usize) -> Self {
        Self { emitted: vec![0; emitters], absorbed: vec![0; surfaces], ..Self::default() }
    }

    /// Counts a photon in.
    #[inline]
    pub fn begin(&mut self, emitter: usize) {
        self.emitted[emitter] += 1;
    }

    /// Counts a photon out.
    #[inline]
    pub fn end(&mut self, end: End) {
        match end {
            End::Absorbed(surface) => self.absorbed[surface.0 as usize] += 1,
            End::Escaped | End::Missed => self.escaped += 1,
            End::Killed => self.killed += 1,
            End::Trapped(body) => *self.trapped.entry(body).or_default() += 1,
        }
    }

    /// Photons begun.
    pub fn total_emitted(&self) -> u64 {
        self.emitted.iter().sum()
    }

    /// Photons ended.
    pub fn total_ended(&self) -> u64 {
        self.absorbed.iter().sum::<u64>() + self.escaped + self.killed + self.total_trapped()
    }

    /// Photons kept by total reflection.
    pub fn total_trapped(&self) -> u64 {
        self.trapped.values().sum()
    }

    /// Whether every photon begun has ended.
    pub fn is_balanced(&self) -> bool {
        self.total_emitted() == self.total_ended()
    }

    /// Adds the photons of another ledger of the same scene.
    pub fn merge(&mut self, other: &Self) {
        for (a, b) in self.emitted.iter_mut().zip(&other.emitted) {
            *a += b;
        }
        for (a, b) in self.absorbed.iter_mut().zip(&other.absorbed) {
            *a += b;
        }
        self.escaped += other.escaped;
        self.killed += other.killed;
        for (body, count) in &other.trapped {
            *self.trapped.entry(*body).or_default() += count;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_lost_photon_shows() {
        let mut ledger = Ledger::new(1, 2);
        for end in [End::Absorbed(SurfaceId(1)), End::Escaped, End::Killed, End::Trapped(SurfaceId(1))] {
            ledger.begin(0);
            assert!(!ledger.is_balanced());
            ledger.end(end);
            assert!(ledger.is_balanced());
        }
        let mut twice = ledger.clone();
        twice.merge(&ledger);
        assert_eq!((twice.total_emitted(), twice.total_ended(), twice.absorbed[1]), (8, 8, 2));
    }
}
