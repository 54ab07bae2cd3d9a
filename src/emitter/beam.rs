//! A beam of parallel light of uniform illuminance over its cross-section.
//!
//! Scene text: `type = "collimated"`, `position` (centre of the cross-section), `aim`, `flux_lm`, and either `radius` or
//! `size = [w, h]`, w along aim x up and h along up.

use std::f64::consts::PI;

use glam::DVec3;

use super::disc::{circle, unit_disc};
use super::panel::SQUARE;
use super::{AimFrame, DirectLight, Emission, Emits, EmitterKind, FLUX};
use crate::error::Invalid;
use crate::geometry::{COORDINATE, LENGTH};
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sample::method::Sampling;
use crate::sequence::{Points, to_unit_f64};

/// The cross-section of a beam, about the emitter's position and orthogonal to its aim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum BeamSection {
    /// A disc.
    Disc {
        /// m.
        radius: f64,
    },
    /// A rectangle.
    Rectangle {
        /// Along aim x up, m.
        width: f64,
        /// Along up, m.
        height: f64,
    },
}

/// A collimated beam.
#[derive(Debug, Clone, Copy)]
pub struct Beam {
    centre: DVec3,
    direction: DVec3,
    /// From the centre to the edge, m: half the sides of a rectangle, two radii of a disc.
    half_axes: [DVec3; 2],
    is_round: bool,
    flux_lm: f64,
}

impl Beam {
    /// A beam about `centre` (m) along the aim of a frame.
    ///
    /// # Errors
    /// A position, size or flux out of range or not a number.
    pub fn new(centre: DVec3, frame: AimFrame, section: BeamSection, flux_lm: f64) -> Result<Self, Invalid> {
        let ([x, y], is_round) = match section {
            BeamSection::Disc { radius } => ([LENGTH.check("radius", radius)?; 2], true),
            BeamSection::Rectangle { width, height } => {
                ([0.5 * LENGTH.check("size", width)?, 0.5 * LENGTH.check("size", height)?], false)
            }
        };
        let axes = frame.axes();
        Ok(Self {
            centre: COORDINATE.vector("position", centre)?,
            direction: frame.aim(),
            half_axes: [axes.x_axis * x, axes.y_axis * y],
            is_round,
            flux_lm: FLUX.check("flux_lm", flux_lm)?,
        })
    }

    /// Area of the cross-section, m2.
    pub fn area_m2(&self) -> f64 {
        let [x, y] = self.half_axes;
        if self.is_round { PI * x.length() * y.length() } else { 4.0 * x.length() * y.length() }
    }
}

impl Emits for Beam {
    fn flux_lm(&self) -> f64 {
        self.flux_lm
    }

    fn position(&self) -> DVec3 {
        self.centre
    }

    /// Uniform over the cross-section.
    #[inline]
    fn emit<P: Points>(
        &self,
        _: Sampling,
        u: Reusable,
        coordinates: &mut Coordinates<'_, P>,
    ) -> Option<Emission> {
        let u1 = coordinates.rest(u, Purpose::BeamPosition);
        let u2 = to_unit_f64(coordinates.draw(Purpose::BeamPosition));
        let [a, b] = if self.is_round { unit_disc([u1, u2]) } else { [2.0 * u1 - 1.0, 2.0 * u2 - 1.0] };
        let [x, y] = self.half_axes;
        Some(Emission::new(self.centre + (x * a + y * b), self.direction))
    }

    /// Inside the beam the flux over its cross-section, else none.
    fn direct_light(&self, point: DVec3, _: [f64; 2]) -> Option<DirectLight> {
        let from_centre = point - self.centre;
        let distance_m = from_centre.dot(self.direction);
        // In halves of the width, or radii; what is along the beam is across neither.
        let [a, b] = self.half_axes.map(|axis| from_centre.dot(axis) / axis.length_squared());
        let inside = if self.is_round { a * a + b * b <= 1.0 } else { a.abs() <= 1.0 && b.abs() <= 1.0 };
        (inside && distance_m > 0.0).then(|| DirectLight {
            towards: -self.direction,
            distance_m,
            illuminance_lx: self.flux_lm / self.area_m2(),
        })
    }

    fn outline(&self) -> Vec<DVec3> {
        let [x, y] = self.half_axes;
        let ring = if self.is_round { circle() } else { SQUARE.to_vec() };
        ring.into_iter().map(|[a, b]| self.centre + x * a + y * b).collect()
    }

    #[inline]
    fn kind(&self) -> EmitterKind {
        EmitterKind { may_touch: true, ..EmitterKind::new("beam", (2, "collimated emission")) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::owen::OwenPoints;

    fn beam(section: BeamSection, flux_lm: f64) -> Beam {
        Beam::new(DVec3::Z, AimFrame::new(DVec3::NEG_Z, None).unwrap(), section, flux_lm).unwrap()
    }

    #[test]
    fn cross_sections_are_filled_uniformly() {
        let points = OwenPoints::new(1, 0);
        let n = 1 << 14;
        for (section, second_moment, inside) in [
            (BeamSection::Rectangle { width: 4.0, height: 2.0 }, 4.0 / 3.0, 1.0),
            // A disc of radius 2: mean of x^2 is R^2 / 4, a quarter of the points within R / 2.
            (BeamSection::Disc { radius: 2.0 }, 1.0, 0.25),
        ] {
            let beam = beam(section, 1.0);
            let (mut x2, mut close) = (0.0, 0.0);
            for i in 0..n {
                let mut c = Coordinates::new(&points, i, true);
                let u = c.draw_reusable(Purpose::Emission);
                let e = beam.emit(Sampling::default(), u, &mut c).unwrap();
                assert_eq!(c.drawn(), 2);
                x2 += e.origin.x * e.origin.x;
                close += f64::from(u8::from(e.origin.truncate().length() < 1.0));
            }
            assert!((x2 / n as f64 - second_moment).abs() < 2e-3);
            if inside < 1.0 {
                assert!((close / n as f64 - inside).abs() < 2e-3);
            }
        }
    }

    #[test]
    fn a_beam_lights_what_is_in_it_and_ahead() {
        let beam = beam(BeamSection::Disc { radius: 2.0 }, 4.0 * PI);
        let light = beam.direct_light(DVec3::new(1.0, 1.0, -1.0), [0.5; 2]).unwrap();
        assert_eq!((light.towards, light.distance_m), (DVec3::Z, 2.0));
        assert!((light.illuminance_lx - 1.0).abs() < 1e-15);
        assert!(beam.direct_light(DVec3::new(1.5, 1.5, -1.0), [0.5; 2]).is_none());
        assert!(beam.direct_light(DVec3::new(0.0, 0.0, 1.5), [0.5; 2]).is_none());
    }

    #[test]
    fn a_rectangular_beam_lights_its_corners() {
        let beam = beam(BeamSection::Rectangle { width: 4.0, height: 2.0 }, 16.0);
        assert_eq!(beam.area_m2(), 8.0);
        // Outside the inscribed ellipse, inside the rectangle.
        for (x, y, lx) in [(1.9, 0.9, Some(2.0)), (-1.9, 0.9, Some(2.0)), (2.1, 0.0, None), (0.0, 1.1, None)]
        {
            let light = beam.direct_light(DVec3::new(x, y, -1.0), [0.5; 2]);
            assert_eq!(light.map(|light| light.illuminance_lx), lx, "{x}, {y}");
        }
    }
}
