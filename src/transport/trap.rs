//! Light that total reflection keeps in a clear body for ever.
//!
//! It is real: of an isotropic lamp in a clear box all light whose direction cosines are all below sqrt(1 - 1/n^2) stays.
//! A photon that has been totally reflected so many times in a row ends there. A light guide keeps its light for many
//! reflections and gives it back, so the number is lowered only where a probe finds that none comes back.

use rayon::prelude::*;

use crate::sample::coordinates::Coordinates;
use crate::sample::method::Sampling;
use crate::scene::Scene;
use crate::sequence::independent::IndependentPoints;
use crate::surface::Grey;

use super::census::Exceptions;
use super::walk::{Arrival, End, Sink, walk_until};

/// Reflections in a row after which a photon is trapped, whatever the scene.
const FAR: u32 = 1 << 17;
/// The same where no photon of the probe that got so far left again.
const NEAR: u32 = 1 << 12;
/// Photons of the probe, of fixed points: the same for every run of a scene.
const PROBE: u64 = 4096;
const PROBE_SEED: u64 = 0x7472_6170;

/// Total reflections in a row.
#[derive(Debug, Clone, Copy)]
pub struct Streak {
    /// A photon of so many is trapped.
    pub limit: u32,
    /// The most after which one went on otherwise.
    pub longest_left: u32,
}

impl Streak {
    /// Nothing yet.
    pub fn new(limit: u32) -> Self {
        Self { limit, longest_left: 0 }
    }
}

struct Nowhere;

impl Sink for Nowhere {
    fn arrive(&mut self, _: &Arrival<'_>) {}
}

/// After how many total reflections in a row a photon of this scene is trapped.
#[inline]
pub fn limit(scene: &Scene) -> u32 {
    *scene.trap_limit.get_or_init(|| if scene.media.has_bodies() { probed(scene) } else { FAR })
}

fn probed(scene: &Scene) -> u32 {
    let points = IndependentPoints::new(PROBE_SEED, 0);
    let follow = |index: u64| {
        let mut coordinates = Coordinates::new(&points, index, true);
        let (emitter, emission) = scene.emitters.emit(Sampling::default(), &mut coordinates)?;
        let mut streak = Streak::new(FAR);
        let start = scene.start(emitter);
        let (sink, exceptions) = (&mut Nowhere, &mut Exceptions::default());
        let end = walk_until(&mut streak, scene, emission, start, Grey, &mut coordinates, sink, exceptions);
        Some((matches!(end, End::Trapped(_)), streak.longest_left))
    };
    let found: Vec<(bool, u32)> = (0..PROBE).into_par_iter().filter_map(follow).collect();
    let is_trap = found.iter().any(|(is_trapped, _)| *is_trapped);
    let none_left = found.iter().all(|(_, longest_left)| *longest_left < NEAR);
    if is_trap && none_left { NEAR } else { FAR }
}
