//! Light that total reflection keeps in a clear body for ever.
//!
//! It is real: of an isotropic lamp in a clear box all light whose direction cosines are all below sqrt(1 - 1/n^2) stays.
//! A photon that has been totally reflected so many times in a row ends there. A light guide keeps its light for many
//! reflections and gives it back, so the number is lowered only where a probe finds that none comes back.

use crate::emitter::Emission;
use crate::geometry::Whereabouts;
use crate::sample::coordinates::{Chooser, Coordinates};
use crate::sample::method::Sampling;
use crate::scene::Scene;
use crate::sequence::independent::IndependentPoints;
use crate::surface::{Grey, Throughput};

use super::census::Exceptions;
use super::walk::{Arrival, End, Sink, walk_until};

/// Reflections in a row after which a photon is trapped, whatever the scene.
const FAR: u32 = 1 << 17;
/// The same where no photon of the probe that got so far left again.
const NEAR: u32 = 1 << 12;
/// Photons of the probe at most, of fixed points: the same for every run of a scene; and how many at a time.
const PROBE: u64 = 4096;
const PART: u64 = 256;
/// Of those that get so far, the ones that are followed on: where one in ten leaves again, 64 miss that once in 850.
const FOLLOWED: usize = 64;
const PROBE_SEED: u64 = 0x7472_6170;

/// Follows one photon from its emission to its end; the chooser decides, the sink sees every arrival.
#[inline]
pub fn walk<C: Chooser, S: Sink<T>, T: Throughput>(
    scene: &Scene,
    emission: Emission,
    whereabouts: Whereabouts,
    carried: T,
    chooser: &mut C,
    sink: &mut S,
    exceptions: &mut Exceptions,
) -> End {
    walk_until(limit(scene), scene, emission, whereabouts, carried, chooser, sink, exceptions)
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

/// By one thread: a task that waited here for others of its pool could be handed one of these that waits for the same answer.
fn probed(scene: &Scene) -> u32 {
    let points = IndependentPoints::new(PROBE_SEED, 0);
    let is_kept = |index: u64, limit: u32| {
        let mut coordinates = Coordinates::new(&points, index, true);
        let Some((emitter, emission)) = scene.emitters.emit(Sampling::default(), &mut coordinates) else {
            return false;
        };
        let start = scene.start(emitter);
        let (sink, exceptions) = (&mut Nowhere, &mut Exceptions::default());
        let end = walk_until(limit, scene, emission, start, Grey, &mut coordinates, sink, exceptions);
        matches!(end, End::Trapped(_))
    };
    let mut kept = Vec::new();
    for first in (0..PROBE).step_by(PART as usize) {
        kept.extend((first..first + PART).filter(|index| is_kept(*index, NEAR)));
        if kept.len() >= FOLLOWED {
            break;
        }
    }
    kept.truncate(FOLLOWED);
    let is_trap = !kept.is_empty() && kept.into_iter().all(|index| is_kept(index, FAR));
    if is_trap { NEAR } else { FAR }
}
