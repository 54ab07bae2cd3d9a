//! The walk of one photon.
//!
//! Its Russian roulette is part of what it carries: `surface/throughput`.

use glam::DVec3;

use crate::emitter::Emission;
use crate::geometry::{Body, Hit, Side, SurfaceId, Whereabouts};
use crate::sample::coordinates::Chooser;
use crate::scene::Scene;
use crate::scene::media::Interface;
use crate::surface::{Event, Grey, Incidence, Throughput};

use super::census::Exceptions;

/// Events after which a photon is taken to be caught for ever and is killed, and counted as such. It is a
/// guard against scenes that absorb nothing, not a bounce cap: with an albedo of 0.999 one photon in 10^43
/// gets this far.
pub const MAX_EVENTS: u32 = 100_000;

/// A photon reaching a surface, before anything happens to it.
#[derive(Debug, Clone, Copy)]
pub struct Arrival<'a, T = Grey> {
    /// Where.
    pub hit: &'a Hit,
    /// The way it travels; unit.
    pub direction: DVec3,
    /// Events it has been through: 0 is direct light.
    pub events: u32,
    /// What it carries.
    pub carried: &'a T,
    /// On which side of what it was on its way here.
    pub whereabouts: &'a Whereabouts,
}

/// What takes the arrivals of photons that carry `T`.
pub trait Sink<T = Grey> {
    /// A photon arrives.
    fn arrive(&mut self, arrival: &Arrival<'_, T>);

    /// A photon goes on from the back of a surface through it, out of its front.
    fn emerge(&mut self, _surface: SurfaceId, _direction: DVec3) {}

    /// A photon leaves the scene.
    fn escape(&mut self, _direction: DVec3) {}

    /// A photon starts; its arrivals follow. `weight` is [`Emission::weight`].
    fn start(&mut self, _weight: f64) {}
}

/// How a photon ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum End {
    /// By absorption on this surface.
    Absorbed(SurfaceId),
    /// It met no further surface.
    Escaped,
    /// It met none at all.
    Missed,
    /// Total reflection keeps it in this body for ever ([`super::trap`]).
    Trapped(SurfaceId),
    /// The guard ended it ([`MAX_EVENTS`]).
    Killed,
}

/// Follows one photon from its emission to its end, or to `trapped_after` total reflections in a row; the chooser decides,
/// the sink sees every arrival.
#[inline]
#[allow(clippy::too_many_arguments)]
pub fn walk_until<C: Chooser, S: Sink<T>, T: Throughput>(
    trapped_after: u32,
    scene: &Scene,
    emission: Emission,
    mut whereabouts: Whereabouts,
    mut carried: T,
    chooser: &mut C,
    sink: &mut S,
    exceptions: &mut Exceptions,
) -> End {
    let Emission { mut origin, mut direction, .. } = emission;
    // Total reflections in a row are counted by themselves: the guard is not for them. Crossings at which nothing happens
    // are no events, but guarded: no rounding at an edge may keep a photon.
    let (mut events, mut guarded, mut reflections) = (0, 0, 0);
    while guarded < MAX_EVENTS {
        let found =
            scene.geometry.nearest(origin, direction, &whereabouts, &mut exceptions.skipped_crossings);
        let Some(hit) = &found else {
            for body in scene.media.bodies_of(&whereabouts) {
                *exceptions.lost.entry(body).or_default() += 1;
            }
            sink.escape(direction);
            return if events == 0 { End::Missed } else { End::Escaped };
        };
        let arrival = Arrival { hit, direction, events, carried: &carried, whereabouts: &whereabouts };
        sink.arrive(&arrival);
        exceptions.meets(hit.surface);
        if hit.touch.is_some() {
            arrive_jointly(scene, &arrival, sink, exceptions);
        }
        let reached = scene.media.reached(hit, &whereabouts);
        if reached.is_contradicted {
            *exceptions.contradicted.entry(hit.surface).or_default() += 1;
        }
        let Interface::Between(indices) = reached.interface else {
            // The same medium on both sides.
            emerge(scene, hit, direction, sink);
            scene.media.leave(&mut whereabouts, hit, hit.other_side());
            origin = hit.position;
            guarded += 1;
            continue;
        };
        let at = Incidence::of(hit, direction, indices);
        // Inside a body, where the medium beyond its face is the thinner one.
        let is_inside = indices[0] > indices[1] && hit.body != Body::Open;
        let went_through;
        match scene.material(hit.surface).scatter(&at, chooser, &mut carried) {
            Event::Absorbed => return End::Absorbed(hit.surface),
            Event::BelowHorizon => {
                exceptions.below_horizon += 1;
                return End::Absorbed(hit.surface);
            }
            Event::Leaves { direction: onward, through, corrected } => {
                if corrected {
                    *exceptions.corrected_directions.entry(hit.surface).or_default() += 1;
                }
                went_through = through;
                if through {
                    emerge(scene, hit, onward, sink);
                }
                let side = if hit.front == through { Side::Back } else { Side::Front };
                scene.media.leave(&mut whereabouts, hit, side);
                (origin, direction) = (hit.position, onward);
            }
        }
        events += 1;
        if is_inside && !went_through {
            reflections += 1;
            if reflections >= trapped_after {
                return End::Trapped(hit.surface);
            }
        } else {
            reflections = 0;
            guarded += 1;
            exceptions.events += 1;
        }
    }
    End::Killed
}

/// Goes on through the faces that are crossed here, out of the front of those whose back it came to.
#[inline]
fn emerge<S: Sink<T>, T>(scene: &Scene, hit: &Hit, direction: DVec3, sink: &mut S) {
    if !hit.front {
        sink.emerge(hit.surface, direction);
    }
    if hit.touch.is_some() {
        for joint in scene.geometry.joint_hits(hit).filter(|joint| !joint.front) {
            sink.emerge(joint.surface, direction);
        }
    }
}

/// The arrivals at the faces that are crossed at once with the one of this arrival.
#[cold]
fn arrive_jointly<S: Sink<T>, T>(
    scene: &Scene,
    arrival: &Arrival<'_, T>,
    sink: &mut S,
    exceptions: &mut Exceptions,
) {
    for joint in scene.geometry.joint_hits(arrival.hit) {
        exceptions.meets(joint.surface);
        sink.arrive(&Arrival { hit: &joint, ..*arrival });
    }
}

#[cfg(test)]
mod tests;
