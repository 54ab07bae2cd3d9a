//! Emitters as a point of a surface, or an eye, sees them: direct light without photons.

use std::f64::consts::PI;

use glam::DVec3;

use super::collimated::CrossSection;
use super::spherical_rectangle::SphericalRectangle;
use super::{Collimated, Emitter, Isotropic, Panel, Photometric};

/// Solid angle, sr, from which on a panel is sampled by it: four angles that sum to it are each right to some 1e-15.
const LEAST_SOLID_ANGLE: f64 = 1e-3;

/// Light that reaches a point from an emitter, if nothing stands between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct DirectLight {
    /// Unit vector from the point to where the light comes from.
    pub towards: DVec3,
    /// How far away that is, m.
    pub distance_m: f64,
    /// Illuminance of a surface facing it, lx. From a panel it is an estimate, whose mean over the coordinates is the
    /// illuminance of a surface times the cosine there.
    pub illuminance_lx: f64,
}

impl Emitter {
    /// Continuous coordinates of [`Self::direct_light`].
    pub const fn direct_coordinates(&self) -> u32 {
        match self {
            Self::Photometric(_) | Self::Isotropic(_) | Self::Collimated(_) => 0,
            Self::Panel(_) => 2,
        }
    }

    /// Light at a point (m); `None` where this emitter, or the point of it that `u` stands for, sends none. `u` in [0, 1)
    /// places a point on a panel.
    pub fn direct_light(&self, point: DVec3, u: [f64; 2]) -> Option<DirectLight> {
        match self {
            Self::Photometric(e) => e.direct_light(point),
            Self::Isotropic(e) => e.direct_light(point),
            Self::Collimated(e) => e.direct_light(point),
            Self::Panel(e) => e.direct_light(point, u),
        }
    }

    /// The luminance (cd/m2) of this emitter to an eye at `origin` (m) that looks along the unit vector `direction`, and how far
    /// away it is (m). Points and beams have no luminance: they are not seen.
    pub fn seen(&self, origin: DVec3, direction: DVec3) -> Option<(f64, f64)> {
        match self {
            Self::Photometric(_) | Self::Isotropic(_) | Self::Collimated(_) => None,
            Self::Panel(panel) => {
                panel.crossing(origin, direction).map(|distance_m| (panel.luminance_cd_m2(), distance_m))
            }
        }
    }
}

/// Of a point emitter: E = I / d^2.
fn from_point(emitter: DVec3, point: DVec3, intensity_cd: impl FnOnce(DVec3) -> f64) -> Option<DirectLight> {
    let to = emitter - point;
    let distance_m = to.length();
    if !(distance_m > 0.0 && distance_m.is_finite()) {
        return None;
    }
    let towards = to / distance_m;
    let illuminance_lx = intensity_cd(-towards) / (distance_m * distance_m);
    (illuminance_lx > 0.0).then_some(DirectLight { towards, distance_m, illuminance_lx })
}

impl Photometric {
    /// Light at a point: the tabulated intensity itself over the square of the distance.
    pub fn direct_light(&self, point: DVec3) -> Option<DirectLight> {
        from_point(self.position(), point, |direction| self.intensity_cd(direction))
    }
}

impl Isotropic {
    /// Light at a point.
    pub fn direct_light(&self, point: DVec3) -> Option<DirectLight> {
        from_point(self.position, point, |_| self.flux_lm / (4.0 * PI))
    }
}

impl Collimated {
    /// Area of the cross-section, m2.
    pub fn area_m2(&self) -> f64 {
        match self.section {
            CrossSection::Rectangle(x, y) => 4.0 * x.length() * y.length(),
            CrossSection::Disc(x, y) => PI * x.length() * y.length(),
        }
    }

    /// Light at a point: inside the beam the flux over its cross-section, else none.
    pub fn direct_light(&self, point: DVec3) -> Option<DirectLight> {
        let from_centre = point - self.centre;
        let distance_m = from_centre.dot(self.direction);
        // In halves of the width, or radii; what is along the beam is across neither.
        let across = |axis: DVec3| from_centre.dot(axis) / axis.length_squared();
        let inside = match self.section {
            CrossSection::Rectangle(x, y) => across(x).abs() <= 1.0 && across(y).abs() <= 1.0,
            CrossSection::Disc(x, y) => {
                let (a, b) = (across(x), across(y));
                a * a + b * b <= 1.0
            }
        };
        (inside && distance_m > 0.0).then(|| DirectLight {
            towards: -self.direction,
            distance_m,
            illuminance_lx: self.flux_lm / self.area_m2(),
        })
    }
}

impl Panel {
    /// Luminance of the lit side, cd/m2: flux / (pi area).
    #[inline]
    pub fn luminance_cd_m2(&self) -> f64 {
        let [width, height] = self.size_m();
        self.flux_lm() / (PI * width * height)
    }

    /// Light from the point of the panel that `u` stands for. Near the panel the point is uniform in solid angle, L omega; far away,
    /// where the solid angle is a difference of large numbers, over the area, L A cos / d^2, cos at the panel.
    pub fn direct_light(&self, point: DVec3, u: [f64; 2]) -> Option<DirectLight> {
        let height = (point - self.centre()).dot(self.aim());
        if !(height > 0.0 && height.is_finite()) {
            return None;
        }
        let near = self.near(point, height);
        let place = match &near {
            Some(rectangle) => self.halves(point, rectangle.sample(u)),
            None => u.map(|u| 2.0 * u - 1.0),
        };
        let to = self.point(place[0], place[1]) - point;
        let distance_m = to.length();
        if !(distance_m > 0.0 && distance_m.is_finite()) {
            return None;
        }
        let illuminance_lx = match near {
            Some(rectangle) => self.luminance_cd_m2() * rectangle.solid_angle_sr(),
            None => self.flux_lm() * (height / distance_m) / (PI * distance_m * distance_m),
        };
        Some(DirectLight { towards: to / distance_m, distance_m, illuminance_lx })
    }

    /// The panel as it is seen from a point, if that is near.
    fn near(&self, point: DVec3, height: f64) -> Option<SphericalRectangle> {
        let [width, breadth] = self.size_m();
        let far = (self.centre() - point).length_squared() > 16.0 * width.max(breadth).powi(2);
        if far {
            return None;
        }
        let [x, y] = self.coordinates(point);
        let edges = |at: f64, size: f64| [(-1.0 - at) * 0.5 * size, (1.0 - at) * 0.5 * size];
        let rectangle = SphericalRectangle::new(edges(x, width), edges(y, breadth), height);
        (rectangle.solid_angle_sr() > LEAST_SOLID_ANGLE).then_some(rectangle)
    }

    /// Offsets from a point, m, as [`Self::point`] counts places.
    fn halves(&self, point: DVec3, offset: [f64; 2]) -> [f64; 2] {
        let [x, y] = self.coordinates(point);
        let [width, breadth] = self.size_m();
        [x + 2.0 * offset[0] / width, y + 2.0 * offset[1] / breadth]
    }

    /// Where a ray from `origin` (m) along the unit vector `direction` crosses the panel from its lit side: the distance, m.
    pub fn crossing(&self, origin: DVec3, direction: DVec3) -> Option<f64> {
        let cosine = -direction.dot(self.aim());
        if cosine <= 0.0 {
            return None;
        }
        let t = (origin - self.centre()).dot(self.aim()) / cosine;
        if !(t > 0.0 && t.is_finite()) {
            return None;
        }
        let [x, y] = self.coordinates(origin + direction * t);
        (x.abs() <= 1.0 && y.abs() <= 1.0).then_some(t)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Mean of illuminance times cosine on a surface of this normal, over a grid of the unit square, and its largest term.
    fn illuminance(panel: &Panel, point: DVec3, normal: DVec3) -> (f64, f64) {
        let n = 400;
        let (mut sum, mut most) = (0.0, 0.0f64);
        for i in 0..n {
            for j in 0..n {
                let u = [(f64::from(i) + 0.5) / f64::from(n), (f64::from(j) + 0.5) / f64::from(n)];
                let light = panel.direct_light(point, u).unwrap();
                let term = light.illuminance_lx * light.towards.dot(normal).max(0.0);
                sum += term;
                most = most.max(term);
            }
        }
        (sum / f64::from(n * n), most)
    }

    #[test]
    fn over_the_corner_of_a_unit_square_the_form_factor_is_0_138532() {
        // Luminance 1: flux pi. E = pi F.
        let panel = Panel::new(DVec3::new(0.5, 0.5, 1.0), DVec3::NEG_Z, DVec3::Y, [1.0; 2], PI);
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
        let panel = Panel::new(DVec3::Z, DVec3::NEG_Z, DVec3::Y, [2.0; 2], 4.0 * PI);
        for height in [1e-9, 1e-3, 0.1] {
            let (e, most) = illuminance(&panel, DVec3::new(0.3, 0.2, 1.0 - height), DVec3::Z);
            assert!(e < PI * (1.0 + 1e-4) && most <= 2.0 * PI * (1.0 + 1e-12), "{height}: {e} {most}");
            if height < 1e-3 {
                assert!((e / PI - 1.0).abs() < 1e-4, "{e}");
            }
        }
    }

    #[test]
    fn a_beam_lights_what_is_in_it_and_ahead() {
        let beam = Collimated {
            centre: DVec3::Z,
            direction: -DVec3::Z,
            section: CrossSection::Disc(DVec3::X * 2.0, DVec3::Y * 2.0),
            flux_lm: 4.0 * PI,
        };
        let light = beam.direct_light(DVec3::new(1.0, 1.0, -1.0)).unwrap();
        assert_eq!((light.towards, light.distance_m), (DVec3::Z, 2.0));
        assert!((light.illuminance_lx - 1.0).abs() < 1e-15);
        assert!(beam.direct_light(DVec3::new(1.5, 1.5, -1.0)).is_none());
        assert!(beam.direct_light(DVec3::new(0.0, 0.0, 1.5)).is_none());
    }

    #[test]
    fn a_panel_is_seen_from_its_lit_side_only() {
        let panel = Panel::new(DVec3::Z, DVec3::NEG_Z, DVec3::Y, [2.0, 1.0], PI);
        assert_eq!(panel.crossing(DVec3::ZERO, DVec3::Z), Some(1.0));
        assert_eq!(panel.crossing(DVec3::Z * 2.0, -DVec3::Z), None);
        assert_eq!(panel.crossing(DVec3::Z * 2.0, DVec3::Z), None);
        assert_eq!(panel.crossing(DVec3::new(0.9, 0.0, 0.0), DVec3::Z), Some(1.0));
        assert_eq!(panel.crossing(DVec3::new(0.0, 0.9, 0.0), DVec3::Z), None);
        assert!((panel.luminance_cd_m2() - 0.5).abs() < 1e-15);
    }
}
