//! A beam of parallel light of uniform illuminance over its cross-section.
//!
//! Scene text: `type = "collimated"`, `position` (centre of the cross-section), `aim`, `flux_lm`, and either `radius` or
//! `size = [w, h]`, w along aim x up and h along up.

use std::f64::consts::PI;

use glam::DVec3;

use super::Emission;
use crate::math::trig::sin_cos;
use crate::sample::choose::Reusable;
use crate::sample::coordinates::{Chooser, Coordinates, Purpose};
use crate::sequence::{Points, to_unit_f64};

/// The shape of a beam's cross-section; half-axes in metres.
#[derive(Debug, Clone, Copy)]
pub enum CrossSection {
    /// Centre plus or minus the two vectors.
    Rectangle(DVec3, DVec3),
    /// Disc with these two perpendicular radii.
    Disc(DVec3, DVec3),
}

/// A collimated beam.
#[derive(Debug, Clone, Copy)]
pub struct Collimated {
    /// Centre of the cross-section.
    pub centre: DVec3,
    /// Direction; unit.
    pub direction: DVec3,
    /// Cross-section, perpendicular to the direction.
    pub section: CrossSection,
    /// Luminous flux, lm.
    pub flux_lm: f64,
}

impl Collimated {
    /// A photon's start: uniform over the cross-section.
    #[inline]
    pub fn emit<P: Points>(&self, u: Reusable, coordinates: &mut Coordinates<'_, P>) -> Emission {
        let u1 = coordinates.rest(u, Purpose::BeamPosition);
        let u2 = to_unit_f64(coordinates.draw(Purpose::BeamPosition));
        let offset = match self.section {
            CrossSection::Rectangle(x, y) => x * (2.0 * u1 - 1.0) + y * (2.0 * u2 - 1.0),
            CrossSection::Disc(x, y) => {
                // r^2 uniform: equal areas; axis-parallel in (r^2, phi), so a net stays a net.
                let radius = u1.sqrt();
                let (sin, cos) = sin_cos(2.0 * PI * u2);
                x * (radius * cos) + y * (radius * sin)
            }
        };
        Emission { origin: self.centre + offset, direction: self.direction }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::owen::OwenPoints;

    #[test]
    fn cross_sections_are_filled_uniformly() {
        let points = OwenPoints::new(1, 0);
        let n = 1 << 14;
        for (section, second_moment, inside) in [
            (CrossSection::Rectangle(DVec3::X * 2.0, DVec3::Y), 4.0 / 3.0, 1.0),
            // A disc of radius 2: mean of x^2 is R^2 / 4, a quarter of the points within R / 2.
            (CrossSection::Disc(DVec3::X * 2.0, DVec3::Y * 2.0), 1.0, 0.25),
        ] {
            let beam = Collimated { centre: DVec3::Z, direction: -DVec3::Z, section, flux_lm: 1.0 };
            let (mut x2, mut close) = (0.0, 0.0);
            for i in 0..n {
                let mut c = Coordinates::new(&points, i, true);
                let u = c.draw_reusable(Purpose::Emission);
                let e = beam.emit(u, &mut c);
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
}
