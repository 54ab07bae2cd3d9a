//! On which side of which surface a photon is: state that is carried, never recomputed.
//!
//! A photon that has just crossed a surface stands on it, give or take rounding, and no geometric test can say on
//! which side. So the photon remembers: the primitives it met at this place, the side it left them on, the closed
//! surfaces it is behind, and, between two faces in contact, which of them comes next. A candidate hit that contradicts
//! this is the same crossing seen again, and is skipped.

use super::{Hit, SurfaceId};

/// A side of a surface: front is where the outward normal points to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Where the outward normal points to.
    Front,
    /// The other one.
    Back,
}

/// Primitives remembered at one place, and closed surfaces that are kept without an allocation.
const CAPACITY: usize = 8;

/// No primitive.
const NO_FACE: u32 = u32::MAX;

/// A face that a photon meets, from which side, and what kind of surface it belongs to.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Met {
    /// Primitive number, counted through all surfaces.
    pub primitive: u32,
    /// The surface.
    pub surface: SurfaceId,
    /// The side of arrival is the one the outward normal points to.
    pub front: bool,
    /// Whether the surface has an inside.
    pub body: Body,
}

/// Faces in contact with one that is met, where it is met.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Beyond a film: the face that comes next for what stands in the film.
    pub film: Option<Met>,
    /// Crossed at once with it.
    pub joint: [Option<Met>; 2],
}

/// Whether a surface has an inside.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Body {
    /// It has none.
    Open,
    /// A ray that goes in must come out before it can go in again.
    Simple,
    /// It has parts that may lie in one another, or cuts itself: a ray can go in several times before it comes out. Its
    /// inside is where it winds around a point at least once.
    Layered,
}

#[derive(Debug, Clone, Copy)]
struct Left {
    primitive: u32,
    surface: SurfaceId,
    side: Side,
    /// Came out of a closed surface here.
    emerged: bool,
}

const NOBODY: Left =
    Left { primitive: NO_FACE, surface: SurfaceId(u32::MAX), side: Side::Front, emerged: false };

/// The side state of one photon.
#[derive(Debug, Clone)]
pub struct Whereabouts {
    met: [Left; CAPACITY],
    met_len: u8,
    behind_len: u8,
    /// The medium outside all bodies, by its number in the scene.
    ambient: u16,
    /// The face that comes next, at this very place: the other one of two in contact.
    next: u32,
    /// Closed surfaces that it is behind; one of several layers as often as it was entered.
    behind: [SurfaceId; CAPACITY],
    /// Those that `behind` has no room for.
    more: Vec<SurfaceId>,
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
    /// A photon in free space, behind these closed surfaces (as often as they are named) and in front of all others.
    pub fn start(behind: impl IntoIterator<Item = SurfaceId>) -> Self {
        let mut at = Self {
            met: [NOBODY; CAPACITY],
            met_len: 0,
            behind_len: 0,
            ambient: 0,
            next: NO_FACE,
            behind: [SurfaceId(u32::MAX); CAPACITY],
            more: Vec::new(),
        };
        for surface in behind {
            at.push(surface);
        }
        at
    }

    /// The same in another medium outside all bodies.
    #[must_use]
    pub fn in_ambient(self, ambient: u16) -> Self {
        Self { ambient, ..self }
    }

    /// The medium outside all bodies, by its number in the scene.
    #[inline]
    pub fn ambient(&self) -> u16 {
        self.ambient
    }

    /// Enters another medium outside all bodies.
    #[inline]
    pub fn set_ambient(&mut self, ambient: u16) {
        self.ambient = ambient;
    }

    /// Records that the photon goes on from `hit` on this side of its surface. What it meets jointly with that is crossed
    /// with it, or not.
    #[inline]
    pub fn leave(&mut self, hit: &Hit, side: Side) {
        // A step that is not surely longer than its error may have stayed at the same place.
        if hit.t > 4.0 * hit.t_bound {
            self.met_len = 0;
        }
        let through = hit.front == (side == Side::Back);
        self.next = NO_FACE;
        match &hit.touch {
            None => self.leave_face(hit.face_met(), through, false),
            Some(touch) => self.leave_touch(hit.face_met(), touch, through, side),
        }
    }

    #[cold]
    fn leave_touch(&mut self, face: Met, touch: &Touch, through: bool, side: Side) {
        for other in touch.joint.iter().flatten() {
            self.leave_face(*other, through, true);
        }
        if let Some(next) = touch.film {
            // It stays before that face, whether it goes there now or not.
            self.leave_face(Met { front: true, ..next }, false, true);
            if side == Side::Front {
                self.next = next.primitive;
            }
        }
        self.leave_face(face, through, true);
    }

    #[inline(always)]
    fn leave_face(&mut self, face: Met, through: bool, between: bool) {
        let Met { primitive, surface, front, body } = face;
        let side = if front == through { Side::Back } else { Side::Front };
        let mut n = usize::from(self.met_len);
        // Between two faces in contact each may be met again and again.
        let known = if between { self.met[..n].iter().position(|m| m.primitive == primitive) } else { None };
        let mut had_emerged = false;
        if let Some(known) = known {
            had_emerged = self.met[known].emerged;
            self.met.copy_within(known + 1..n, known);
            n -= 1;
        }
        if n == CAPACITY {
            self.met.copy_within(1.., 0);
            n -= 1;
        }
        let closed = body != Body::Open;
        let emerged = closed && side == Side::Front && (!front || had_emerged);
        self.met[n] = Left { primitive, surface, side, emerged };
        self.met_len = n as u8 + 1;
        match (body, side) {
            (Body::Open, _) => {}
            (Body::Layered, _) if !through => {}
            (Body::Simple, Side::Back) if self.is_behind(surface) => {}
            (_, Side::Back) => self.push(surface),
            (_, Side::Front) => self.remove(surface),
        }
    }

    /// Whether the photon is behind this closed surface.
    #[inline(always)]
    pub fn is_behind(&self, surface: SurfaceId) -> bool {
        let few = &self.behind[..usize::from(self.behind_len)];
        few.contains(&surface) || (few.len() == CAPACITY && self.more.contains(&surface))
    }

    /// Whether, of all closed surfaces, it is behind none, or behind this one alone where it meets that from behind.
    #[inline(always)]
    pub fn is_alone(&self, surface: SurfaceId, front: bool) -> bool {
        if front { self.behind_len == 0 } else { self.behind_len == 1 && self.behind[0] == surface }
    }

    /// Whether it is behind any.
    #[inline(always)]
    pub fn is_behind_any(&self) -> bool {
        self.behind_len > 0
    }

    /// The closed surfaces the photon is behind, one of several layers as often as it was entered.
    #[inline]
    pub fn behind(&self) -> impl Iterator<Item = SurfaceId> + '_ {
        self.behind[..usize::from(self.behind_len)].iter().chain(&self.more).copied()
    }

    /// The surface just left.
    pub fn surface_left(&self) -> Option<SurfaceId> {
        self.met[..usize::from(self.met_len)].last().map(|m| m.surface)
    }

    /// The closed surfaces among those met at this place that the photon is behind, the last one first.
    #[inline]
    pub(crate) fn entered_here(&self) -> impl Iterator<Item = SurfaceId> + '_ {
        let met = &self.met[..usize::from(self.met_len)];
        let behind = |(i, m): (usize, &Left)| {
            let again = met[i + 1..].iter().any(|later| later.surface == m.surface);
            (!again && self.is_behind(m.surface)).then_some(m.surface)
        };
        met.iter().enumerate().rev().filter_map(behind)
    }

    /// The face just left, and the one in contact with it that comes next.
    #[inline(always)]
    pub(crate) fn in_film(&self) -> Option<(u32, u32)> {
        let left = self.met[..usize::from(self.met_len)].last();
        (self.next != NO_FACE).then(|| (left.map_or(NO_FACE, |m| m.primitive), self.next))
    }

    fn push(&mut self, surface: SurfaceId) {
        match self.behind.get_mut(usize::from(self.behind_len)) {
            Some(place) => {
                *place = surface;
                self.behind_len += 1;
            }
            None => self.more.push(surface),
        }
    }

    fn remove(&mut self, surface: SurfaceId) {
        let n = usize::from(self.behind_len);
        if let Some(i) = self.behind[..n].iter().position(|&s| s == surface) {
            self.behind.copy_within(i + 1..n, i);
            match self.more.pop() {
                Some(last) => self.behind[n - 1] = last,
                None => self.behind_len -= 1,
            }
        } else if let Some(i) = self.more.iter().position(|&s| s == surface) {
            self.more.swap_remove(i);
        }
    }

    /// Whether the photon met this primitive at the place where it is.
    #[inline(always)]
    pub(crate) fn has_met(&self, primitive: u32) -> bool {
        self.met[..usize::from(self.met_len)].iter().any(|m| m.primitive == primitive)
    }

    /// The side the state prescribes for a surface, if it does.
    #[inline(always)]
    fn side_of(&self, surface: SurfaceId, body: Body) -> Option<Side> {
        match (body, body != Body::Open && self.is_behind(surface)) {
            (Body::Open, _) | (Body::Layered, true) => None,
            (Body::Simple, true) => Some(Side::Back),
            (_, false) => Some(Side::Front),
        }
    }

    /// A candidate; `here` says that its distance is within its own rounding bound.
    #[inline(always)]
    pub(crate) fn judge(&self, surface: SurfaceId, body: Body, front: bool, here: bool) -> Verdict {
        let mut side = self.side_of(surface, body);
        if here && self.met_len > 0 {
            let met = &self.met[..usize::from(self.met_len)];
            if side.is_none() {
                side = met.iter().rev().find(|m| m.surface == surface).map(|m| m.side);
            }
            // At a silhouette's vertex rounding can show front, back and front again. In and out at one place is
            // all a line can do there.
            if front && body != Body::Layered && met.iter().any(|m| m.emerged && m.surface == surface) {
                return Verdict::Contradicts;
            }
        }
        match side {
            Some(side) if (side == Side::Front) != front => Verdict::Contradicts,
            _ => Verdict::Take,
        }
    }
}
