//! What fills the space: bodies and the medium around them.
//!
//! A closed transparent surface bounds a body. Where bodies are in one another the medium is that of the highest priority,
//! and among equals that of the smallest; in no body it is the ambient medium, which an open transparent surface changes.
//! (C. M. Schmidt and B. Budge, "Simple nested dielectrics in ray traced images", Journal of Graphics Tools 7 (2), 2002.)

use crate::geometry::{Body, Geometry, Hit, Met, Side, SurfaceId, Whereabouts};
use crate::surface::Material;

use super::options::SurfaceOptions;

/// Number of a medium in its scene; 0 is the one that the scene lies in.
pub type MediumId = u16;

/// A transparent medium.
#[derive(Debug, Clone, PartialEq)]
pub struct Medium {
    /// What it is called.
    pub name: String,
    /// Its refractive index.
    pub ior: f64,
}

/// What a surface is to the media beside it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Role {
    /// No light passes from one medium to another.
    Solid,
    /// It is closed and bounds a body.
    Body {
        /// What is inside.
        medium: MediumId,
        /// Of bodies that contain a point, the one of the highest rank fills it.
        rank: u32,
        /// The index that the scene says is outside, where it says so.
        outside: Option<f64>,
    },
    /// It is open, and passing it changes the ambient medium.
    Open {
        /// Before and behind the outward normal.
        media: [MediumId; 2],
    },
}

/// The media of a scene.
#[derive(Debug, Clone)]
pub struct Media {
    media: Vec<Medium>,
    roles: Vec<Role>,
}

/// A face, for what arrives there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reached {
    /// What it is between.
    pub interface: Interface,
    /// Whether the medium on the side of arrival is another than the scene says there is at an open surface, or the index
    /// outside a body another than the scene says.
    pub is_contradicted: bool,
}

/// What a face is between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Interface {
    /// The medium is the same on both sides: nothing happens.
    Nothing,
    /// The refractive indices on the side of arrival and on the other.
    Between([f64; 2]),
}

impl Medium {
    /// Air, against which refractive indices are given.
    pub fn air() -> Self {
        Self { name: "air".into(), ior: 1.0 }
    }
}

impl Media {
    /// The media of these surfaces, in an ambient medium; materials and options are those of the surfaces.
    pub fn new(
        ambient: Medium,
        geometry: &Geometry,
        materials: &[Material],
        options: &[SurfaceOptions],
    ) -> Self {
        let mut all = Self { media: vec![ambient], roles: Vec::new() };
        let mut ranks: Vec<usize> = (0..materials.len()).collect();
        let surfaces = geometry.surfaces();
        let volume = |i: usize| surfaces[i].shape.volume_m3();
        ranks.sort_by(|&i, &j| {
            let by_size = options[i].priority.cmp(&options[j].priority).then(volume(j).total_cmp(&volume(i)));
            by_size.then_with(|| surfaces[i].name.cmp(&surfaces[j].name))
        });
        let mut rank_of = vec![0; ranks.len()];
        for (rank, i) in ranks.into_iter().enumerate() {
            rank_of[i] = rank as u32;
        }
        let roles = materials.iter().enumerate().map(|(i, material)| {
            let Some((ior, outside)) = material.indices() else { return Role::Solid };
            let name = &surfaces[i].name;
            let medium = all.number(Medium { name: name.clone(), ior });
            if geometry.is_closed(SurfaceId(i as u32)) {
                return Role::Body { medium, rank: rank_of[i], outside };
            }
            let before =
                outside.map_or(0, |ior| all.number(Medium { name: format!("what is before {name}"), ior }));
            Role::Open { media: [before, medium] }
        });
        all.roles = roles.collect();
        all
    }

    /// The number of a medium; of equal refractive indices it is the same medium.
    pub fn number(&mut self, medium: Medium) -> MediumId {
        let known = self.media.iter().position(|m| m.ior == medium.ior);
        let number = known.unwrap_or_else(|| {
            self.media.push(medium);
            self.media.len() - 1
        });
        number as MediumId
    }

    /// The refractive index of a medium.
    pub fn ior(&self, medium: MediumId) -> f64 {
        self.media[usize::from(medium)].ior
    }

    /// Whether there is any open surface that changes the medium.
    pub fn has_sheets(&self) -> bool {
        self.roles
            .iter()
            .any(|role| matches!(role, Role::Open { media: [before, behind] } if before != behind))
    }

    /// What a surface is.
    #[inline]
    pub fn role(&self, surface: SurfaceId) -> Role {
        self.roles[surface.0 as usize]
    }

    /// The bodies that contain what is in this state.
    #[inline]
    pub fn bodies_of<'a>(&'a self, at: &'a Whereabouts) -> impl Iterator<Item = SurfaceId> + 'a {
        at.behind().filter(|surface| matches!(self.role(*surface), Role::Body { .. }))
    }

    /// Whether there is any body.
    pub fn has_bodies(&self) -> bool {
        self.roles.iter().any(|role| matches!(role, Role::Body { .. }))
    }

    /// Whether some face may have the same medium on both sides.
    pub fn may_vanish(&self) -> bool {
        self.roles.iter().filter(|role| **role != Role::Solid).count() > 1
    }

    /// A hit face for a photon in this state.
    #[inline]
    pub fn reached(&self, hit: &Hit, at: &Whereabouts) -> Reached {
        let role = &self.roles[hit.surface.0 as usize];
        match role {
            Role::Solid => Reached { interface: Interface::Between([1.0; 2]), is_contradicted: false },
            // The usual cases: an open surface alone, and a body alone.
            Role::Open { media } if hit.touch.is_none() && !at.is_behind_any() => Reached {
                interface: self.between(at.ambient(), media[usize::from(hit.front)]),
                is_contradicted: at.ambient() != media[usize::from(!hit.front)],
            },
            Role::Body { medium, outside, .. }
                if hit.touch.is_none() && hit.body == Body::Simple && at.is_alone(hit.surface, hit.front) =>
            {
                let (before, behind) =
                    if hit.front { (at.ambient(), *medium) } else { (*medium, at.ambient()) };
                Reached {
                    interface: self.between(before, behind),
                    is_contradicted: outside.is_some_and(|ior| self.ior(at.ambient()) != ior),
                }
            }
            Role::Open { .. } | Role::Body { .. } => self.reached_by_rank(role, hit, at),
        }
    }

    #[inline]
    fn between(&self, before: MediumId, after: MediumId) -> Interface {
        if before == after {
            return Interface::Nothing;
        }
        Interface::Between([self.media[usize::from(before)].ior, self.media[usize::from(after)].ior])
    }

    /// Where bodies are in one another or in contact.
    #[inline(never)]
    fn reached_by_rank(&self, role: &Role, hit: &Hit, at: &Whereabouts) -> Reached {
        let joint = hit.touch.map_or([None; 2], |touch| touch.joint);
        let crossed = [Some(hit.face_met()), joint[0], joint[1]];
        let is_contradicted = match role {
            Role::Solid => false,
            Role::Open { media } => at.ambient() != media[usize::from(!hit.front)],
            Role::Body { outside, .. } => outside.is_some_and(|ior| {
                let left = if hit.front { None } else { Some(hit.face_met()) };
                self.ior(self.with(at, &[left])) != ior
            }),
        };
        Reached { interface: self.between(self.with(at, &[]), self.with(at, &crossed)), is_contradicted }
    }

    /// The medium of a state that has crossed these faces as well.
    #[inline]
    fn with(&self, at: &Whereabouts, crossed: &[Option<Met>]) -> MediumId {
        let mut highest: Option<(u32, MediumId)> = None;
        let mut contains = |surface: SurfaceId| {
            if let Role::Body { medium, rank, .. } = self.role(surface)
                && highest.is_none_or(|(r, _)| rank > r)
            {
                highest = Some((rank, medium));
            }
        };
        let mut left: [Option<SurfaceId>; 3] = [None; 3];
        for (left, face) in left.iter_mut().zip(crossed) {
            *left = face.and_then(|face| (!face.front).then_some(face.surface));
        }
        for surface in at.behind() {
            // One of several layers is left once for each that was entered.
            match left.iter_mut().find(|s| **s == Some(surface)) {
                Some(place) => *place = None,
                None => contains(surface),
            }
        }
        let mut ambient = at.ambient();
        for face in crossed.iter().flatten() {
            match self.role(face.surface) {
                Role::Body { .. } if face.front => contains(face.surface),
                Role::Open { media } => ambient = media[usize::from(face.front)],
                Role::Body { .. } | Role::Solid => {}
            }
        }
        highest.map_or(ambient, |(_, medium)| medium)
    }

    /// Goes on from a hit on this side of its surface: the state and, through an open surface, the ambient medium.
    #[inline(always)]
    pub fn leave(&self, at: &mut Whereabouts, hit: &Hit, side: Side) {
        at.leave(hit, side);
        let through = hit.front == (side == Side::Back);
        if through {
            self.change_ambient(at, hit.surface, hit.front);
            for face in hit.touch.iter().flat_map(|touch| touch.joint.iter().flatten()) {
                self.change_ambient(at, face.surface, face.front);
            }
        }
    }

    #[inline]
    fn change_ambient(&self, at: &mut Whereabouts, surface: SurfaceId, front: bool) {
        if let Role::Open { media } = &self.roles[surface.0 as usize] {
            at.set_ambient(media[usize::from(front)]);
        }
    }
}
