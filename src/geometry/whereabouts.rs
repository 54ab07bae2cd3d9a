//! On which side of which surface a photon is: state that is carried, never recomputed.
//!
//! A photon that has just crossed a surface stands on it, give or take rounding, and no geometric test can say on
//! which side. So the photon remembers: the primitives it met at this place, the side it left them on, and the closed
//! surfaces it is behind. A candidate hit that contradicts this is the same crossing seen again, and is skipped.

use super::{Hit, SurfaceId};

/// A side of a surface: front is where the outward normal points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Where the outward normal points to.
    Front,
    /// The other one.
    Back,
}

/// Primitives remembered at one place, and closed surfaces nested in one another.
const CAPACITY: usize = 8;

#[derive(Debug, Clone, Copy)]
struct Met {
    primitive: u32,
    surface: SurfaceId,
    side: Side,
    /// Came out of a closed surface here.
    emerged: bool,
}

const NOBODY: Met =
    Met { primitive: u32::MAX, surface: SurfaceId(u32::MAX), side: Side::Front, emerged: false };

/// The side state of one photon.
#[derive(Debug, Clone, Copy)]
pub struct Whereabouts {
    met: [Met; CAPACITY],
    met_len: u8,
    behind_len: u8,
    /// Closed surfaces entered beyond the list's capacity; while there are any, a closed surface that is not listed
    /// is treated as open.
    untracked: u32,
    behind: [SurfaceId; CAPACITY],
}

/// What the state says about a candidate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Verdict {
    Take,
    /// The same crossing again, or a silhouette's rounding: skipped and counted.
    Contradicts,
}

impl Default for Whereabouts {
    fn default() -> Self {
        Self::start([])
    }
}

impl Whereabouts {
    /// A photon in free space, behind these closed surfaces and in front of all others.
    pub fn start(behind: impl IntoIterator<Item = SurfaceId>) -> Self {
        let mut at = Self {
            met: [NOBODY; CAPACITY],
            met_len: 0,
            behind_len: 0,
            untracked: 0,
            behind: [SurfaceId(u32::MAX); CAPACITY],
        };
        for surface in behind {
            at.enter(surface);
        }
        at
    }

    /// Records that the photon goes on from `hit` on this side of its surface.
    pub fn leave(&mut self, hit: &Hit, side: Side) {
        // A step that is not surely longer than its error may have stayed at the same place.
        if hit.t > 4.0 * hit.t_bound {
            self.met_len = 0;
        }
        let mut n = usize::from(self.met_len);
        if n == CAPACITY {
            self.met.copy_within(1.., 0);
            n -= 1;
        }
        let emerged = hit.closed && !hit.front && side == Side::Front;
        self.met[n] = Met { primitive: hit.primitive, surface: hit.surface, side, emerged };
        self.met_len = n as u8 + 1;
        if hit.closed {
            match side {
                Side::Back => self.enter(hit.surface),
                Side::Front => self.exit(hit.surface),
            }
        }
    }

    /// Whether the photon is behind this closed surface.
    #[inline(always)]
    pub fn is_behind(&self, surface: SurfaceId) -> bool {
        self.behind().contains(&surface)
    }

    /// The closed surfaces the photon is behind, outermost first.
    #[inline(always)]
    pub fn behind(&self) -> &[SurfaceId] {
        &self.behind[..usize::from(self.behind_len)]
    }

    /// The surface just left.
    pub fn surface_left(&self) -> Option<SurfaceId> {
        self.met[..usize::from(self.met_len)].last().map(|m| m.surface)
    }

    fn enter(&mut self, surface: SurfaceId) {
        if self.is_behind(surface) {
            return;
        }
        match self.behind.get_mut(usize::from(self.behind_len)) {
            Some(place) => {
                *place = surface;
                self.behind_len += 1;
            }
            None => self.untracked += 1,
        }
    }

    fn exit(&mut self, surface: SurfaceId) {
        match self.behind().iter().position(|&s| s == surface) {
            Some(i) => {
                self.behind.copy_within(i + 1.., i);
                self.behind_len -= 1;
            }
            None => self.untracked = self.untracked.saturating_sub(1),
        }
    }

    /// Whether the photon met this primitive at the place where it is.
    #[inline(always)]
    pub(crate) fn has_met(&self, primitive: u32) -> bool {
        self.met[..usize::from(self.met_len)].iter().any(|m| m.primitive == primitive)
    }

    /// The side the state prescribes for a surface, if it does.
    #[inline(always)]
    fn side_of_closed(&self, surface: SurfaceId, closed: bool) -> Option<Side> {
        if !closed {
            return None;
        }
        if self.is_behind(surface) {
            return Some(Side::Back);
        }
        (self.untracked == 0).then_some(Side::Front)
    }

    /// A candidate; `here` says that its distance is within its own rounding bound.
    #[inline(always)]
    pub(crate) fn judge(&self, surface: SurfaceId, closed: bool, front: bool, here: bool) -> Verdict {
        let mut side = self.side_of_closed(surface, closed);
        if here && self.met_len > 0 {
            let met = &self.met[..usize::from(self.met_len)];
            if side.is_none() {
                side = met.iter().rev().find(|m| m.surface == surface).map(|m| m.side);
            }
            // At a silhouette's vertex rounding can show front, back and front again. In and out at one place is
            // all a line can do there.
            if front && met.iter().any(|m| m.emerged && m.surface == surface) {
                return Verdict::Contradicts;
            }
        }
        match side {
            Some(side) if (side == Side::Front) != front => Verdict::Contradicts,
            _ => Verdict::Take,
        }
    }
}
