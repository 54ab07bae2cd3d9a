//! Draws of a table by any variant on any sequence, as photons get them.

use std::time::{Duration, Instant};

use glam::DVec3;

use crate::error::Result;
use crate::lab::certificate::{Draw, PointKind};
use crate::run::Algorithm;
use crate::run::tracer::{PointSet, UsePoints};
use crate::sample::cell::GridPoint;
use crate::sample::coordinates::{Coordinates, Purpose};
use crate::sample::grid::Grid;
use crate::sample::method::Sampling;
use crate::sequence::{Points, Sequence};

/// Draws that are timed together and then handed over.
const BLOCK: usize = 1 << 12;

/// A draw with its direction.
#[derive(Debug, Clone, Copy)]
pub struct Sampled {
    /// The angles, and the coordinates it took.
    pub draw: Draw,
    /// Unit vector: polar axis of the grid z, azimuth from x towards y.
    pub direction: DVec3,
}

/// What sampling took.
#[derive(Debug, Clone, Copy, Default)]
pub struct Effort {
    /// Time of sampling alone.
    pub time: Duration,
    /// Draws.
    pub draws: u64,
    /// Points of the sequence; more than draws where a rejected point gives none.
    pub points: u64,
}

impl Effort {
    /// Nanoseconds a draw.
    pub fn ns_per_draw(&self) -> f64 {
        1e9 * self.time.as_secs_f64() / self.draws.max(1) as f64
    }

    /// The sum with another one.
    #[must_use]
    pub fn with(self, other: Self) -> Self {
        let (draws, points) = (self.draws + other.draws, self.points + other.points);
        Self { time: self.time + other.time, draws, points }
    }
}

/// What draws of this sequence are to be compared with.
pub fn made_from(sequence: Sequence) -> PointKind {
    if sequence == Sequence::Independent { PointKind::Random } else { PointKind::LowDiscrepancy }
}

/// Samples `number` directions of a table with one randomisation of an algorithm, and hands them over block
/// by block; `sink` says whether to go on.
///
/// # Errors
/// A sequence that cannot have this many points or, where rejection skips points, more.
pub fn sample(
    grid: &Grid,
    algorithm: &Algorithm,
    seed: u64,
    replicate: u32,
    number: u64,
    sink: impl FnMut(&[Sampled]) -> bool,
) -> Result<Effort> {
    let points = PointSet { sequence: algorithm.sequence, seed, replicate, number };
    let sampling = algorithm.sampling();
    algorithm.check_skipping(true)?;
    points.provide(Run { grid, sampling, reuse: algorithm.variant.reuses(), number, sink })
}

struct Run<'g, S> {
    grid: &'g Grid,
    sampling: Sampling,
    reuse: bool,
    number: u64,
    sink: S,
}

impl<S: FnMut(&[Sampled]) -> bool> UsePoints for Run<'_, S> {
    type Output = Effort;

    fn with<P: Points>(mut self, points: &P) -> Effort {
        let mut effort = Effort::default();
        let mut block = Vec::with_capacity(BLOCK);
        while effort.draws < self.number {
            block.clear();
            let wanted = (self.number - effort.draws).min(BLOCK as u64) as usize;
            let started = Instant::now();
            while block.len() < wanted {
                let mut coordinates = Coordinates::new(points, effort.points, self.reuse);
                effort.points += 1;
                let u = coordinates.draw_reusable(Purpose::Emission);
                if let Some(point) = self.grid.draw(self.sampling, u, &mut coordinates) {
                    let GridPoint { theta: theta_rad, phi: phi_rad, direction, .. } = point;
                    let coordinates = coordinates.drawn();
                    block.push(Sampled { draw: Draw { theta_rad, phi_rad, coordinates }, direction });
                }
            }
            effort.time += started.elapsed();
            effort.draws += block.len() as u64;
            if !(self.sink)(&block) {
                break;
            }
        }
        effort
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::emitter::photometric::grid_axes;
    use crate::emitter::{AimFrame, Emits, Emitter, Emitters, Photometric};
    use crate::files::photometric;
    use crate::sequence::owen::OwenPoints;

    #[test]
    fn draws_are_the_directions_of_photons() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/ies/wavy_glass.ies");
        let photometry = photometric::read(file).unwrap();
        let up = DVec3::new(0.2, 0.1, 1.0);
        let frame = AimFrame::new(DVec3::new(0.3, -0.7, -0.5), Some(up)).unwrap();
        let axes = grid_axes(photometry.web.photometric_type, frame).unwrap();
        let lamp = Photometric::new(&photometry, DVec3::ZERO, frame, None).unwrap();
        let grid = lamp.table().unwrap().clone();
        let emitters = Emitters::new(vec![Emitter::Photometric(lamp)]).unwrap();
        for name in ["qmc", "qmc:table", "qmc:next-point", "qmc-inverse", "qmc-inverse-reuse"] {
            let algorithm = Algorithm::parse(name).unwrap();
            let points = OwenPoints::new(7, 3);
            let mut photons = (0..).filter_map(|index| {
                let mut c = Coordinates::new(&points, index, algorithm.variant.reuses());
                let (_, emission) = emitters.emit(algorithm.sampling(), &mut c)?;
                Some((emission.direction, c.drawn()))
            });
            let mut compared = 0;
            let effort = sample(&grid, &algorithm, 7, 3, 5000, |block| {
                for sampled in block {
                    let (direction, drawn) = photons.next().unwrap();
                    assert_eq!(direction, axes * sampled.direction, "{name}");
                    assert_eq!(sampled.draw.coordinates, drawn);
                    let Draw { theta_rad, phi_rad, .. } = sampled.draw;
                    let (sin, cos) = theta_rad.sin_cos();
                    let by_angles = DVec3::new(sin * phi_rad.cos(), sin * phi_rad.sin(), cos);
                    assert!((by_angles - sampled.direction).length() < 1e-14, "{name}");
                    compared += 1;
                }
                true
            })
            .unwrap();
            assert_eq!((compared, effort.draws), (5000, 5000));
            assert_eq!(effort.points > 5000, name == "qmc:next-point", "{name}");
        }
    }
}
