//! The rectangle of a panel.
//!
//! Scene text: `type = "panel"`, `position` (the centre), `aim` (the normal of the lit side), `up`, `size = [w, h]`, w along
//! aim x up and h along up, `flux_lm`.

use std::f64::consts::PI;

use super::area::LitShape;
use super::spherical_rectangle::SphericalRectangle;
use crate::error::Invalid;
use crate::geometry::LENGTH;

/// Solid angle, sr, from which on a panel is sampled by it: four angles that sum to it are each right to some 1e-15.
const LEAST_SOLID_ANGLE: f64 = 1e-3;

/// Corners and middles of the edges of the square from -1 to 1, around.
pub(super) const SQUARE: [[f64; 2]; 8] =
    [[1.0, 0.0], [1.0, 1.0], [0.0, 1.0], [-1.0, 1.0], [-1.0, 0.0], [-1.0, -1.0], [0.0, -1.0], [1.0, -1.0]];

/// A rectangle about the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Panel {
    size_m: [f64; 2],
}

impl Panel {
    /// A rectangle of this width along aim x up and height along up, m.
    ///
    /// # Errors
    /// A size out of range or not a number.
    pub fn new([width, height]: [f64; 2]) -> Result<Self, Invalid> {
        Ok(Self { size_m: [LENGTH.check("size", width)?, LENGTH.check("size", height)?] })
    }

    /// The place at x and y in halves of the size: -1 to 1.
    #[inline]
    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [0.5 * self.size_m[0] * x, 0.5 * self.size_m[1] * y]
    }

    /// A place in halves of the size.
    #[inline]
    fn halves(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x / (0.5 * self.size_m[0]), y / (0.5 * self.size_m[1])]
    }
}

impl LitShape for Panel {
    const NOUN: &'static str = "panel";
    const REQUIRES: (u8, &'static str) = (3, "panel emission");

    #[inline]
    fn etendue_m2_sr(&self) -> f64 {
        PI * self.size_m[0] * self.size_m[1]
    }

    fn extent_m(&self) -> f64 {
        self.size_m[0].max(self.size_m[1])
    }

    #[inline]
    fn sample_point(&self, u: [f64; 2]) -> [f64; 2] {
        self.at(u.map(|u| 2.0 * u - 1.0))
    }

    #[inline]
    fn contains(&self, place: [f64; 2]) -> bool {
        let [x, y] = self.halves(place);
        x.abs() <= 1.0 && y.abs() <= 1.0
    }

    fn outline(&self) -> Vec<[f64; 2]> {
        SQUARE.map(|corner| self.at(corner)).to_vec()
    }

    /// Uniform in solid angle.
    fn sample_direction(&self, foot: [f64; 2], height_m: f64, u: [f64; 2]) -> Option<([f64; 2], f64)> {
        let ([x, y], [width, height]) = (self.halves(foot), self.size_m);
        let edges = |at: f64, size: f64| [(-1.0 - at) * 0.5 * size, (1.0 - at) * 0.5 * size];
        let rectangle = SphericalRectangle::new(edges(x, width), edges(y, height), height_m);
        (rectangle.solid_angle_sr() > LEAST_SOLID_ANGLE).then(|| {
            let offset = rectangle.sample(u);
            let place = self.at([x + 2.0 * offset[0] / width, y + 2.0 * offset[1] / height]);
            (place, rectangle.solid_angle_sr())
        })
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::area::AreaLight;
    use super::super::{AimFrame, Emits};
    use super::*;
    use crate::emitter::tests::{illuminance, starts};

    fn panel(centre: DVec3, up: DVec3, size_m: [f64; 2], flux_lm: f64) -> AreaLight<Panel> {
        let frame = AimFrame::new(DVec3::NEG_Z, Some(up)).unwrap();
        AreaLight::new(centre, frame, Panel::new(size_m).unwrap(), flux_lm).unwrap()
    }

    #[test]
    fn moments_are_those_of_a_lambertian_rectangle() {
        let (aim, n) = (DVec3::NEG_Z, 1 << 14);
        let panel = panel(DVec3::new(1.0, 2.0, 3.0), DVec3::X, [0.4, 3.0], 10.0);
        let (mut across2, mut up2, mut cos, mut cos2, mut cross) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for e in starts(&panel, n, 4) {
            let d = e.origin - panel.position();
            assert!(d.z == 0.0 && d.x.abs() <= 1.5 && d.y.abs() <= 0.2 + 1e-15);
            assert!(e.direction.z < 0.0);
            across2 += d.y * d.y;
            up2 += d.x * d.x;
            cos += e.direction.dot(aim);
            cos2 += e.direction.dot(aim).powi(2);
            cross += d.x * e.direction.x;
        }
        let mean = |sum: f64| sum / n as f64;
        assert!((mean(across2) - 0.04 / 3.0).abs() < 1e-5);
        assert!((mean(up2) - 0.75).abs() < 1e-3);
        assert!((mean(cos) - 2.0 / 3.0).abs() < 1e-4 && (mean(cos2) - 0.5).abs() < 1e-4);
        assert!(mean(cross).abs() < 3e-3, "place and direction are independent");
    }

    #[test]
    fn over_the_corner_of_a_unit_square_the_form_factor_is_0_138532() {
        // Luminance 1: flux pi. E = pi F.
        let panel = panel(DVec3::new(0.5, 0.5, 1.0), DVec3::Y, [1.0; 2], PI);
        let (e, _) = illuminance(&panel, DVec3::ZERO, DVec3::Z);
        let exact = (0.5f64.sqrt()).atan() / (PI * 2f64.sqrt());
        assert!((exact - 0.138532).abs() < 1e-6);
        assert!((e / (PI * exact) - 1.0).abs() < 1e-5, "{e}");
        // From far away it is a point: I / d^2, I = L A.
        let (far, _) = illuminance(&panel, DVec3::new(0.5, 0.5, -99.0), DVec3::Z);
        assert!((far * 1e4 - 1.0).abs() < 1e-4, "{far}");
        assert!(panel.direct_light(DVec3::new(0.5, 0.5, 2.0), [0.5; 2]).is_none(), "the other side is dark");
    }

    #[test]
    fn close_to_a_panel_the_estimate_has_a_bound() {
        let panel = panel(DVec3::Z, DVec3::Y, [2.0; 2], 4.0 * PI);
        for height in [1e-9, 1e-3, 0.1] {
            let (e, most) = illuminance(&panel, DVec3::new(0.3, 0.2, 1.0 - height), DVec3::Z);
            assert!(e < PI * (1.0 + 1e-4) && most <= 2.0 * PI * (1.0 + 1e-12), "{height}: {e} {most}");
            if height < 1e-3 {
                assert!((e / PI - 1.0).abs() < 1e-4, "{e}");
            }
        }
    }

    #[test]
    fn a_panel_is_seen_from_its_lit_side_only() {
        let panel = panel(DVec3::Z, DVec3::Y, [2.0, 1.0], PI);
        assert_eq!(panel.seen(DVec3::ZERO, DVec3::Z), Some((panel.luminance_cd_m2(), 1.0)));
        assert_eq!(panel.seen(DVec3::Z * 2.0, -DVec3::Z), None);
        assert_eq!(panel.seen(DVec3::Z * 2.0, DVec3::Z), None);
        assert!(panel.seen(DVec3::new(0.9, 0.0, 0.0), DVec3::Z).is_some_and(|(_, t)| t == 1.0));
        assert_eq!(panel.seen(DVec3::new(0.0, 0.9, 0.0), DVec3::Z), None);
        assert!((panel.luminance_cd_m2() - 0.5).abs() < 1e-15);
    }
}
