//! Emitters as a point of a surface, or an eye, sees them: direct light without photons.

use std::f64::consts::PI;

use glam::DVec3;

use super::collimated::CrossSection;
use super::{Collimated, Emitter, Isotropic, Panel, Photometric};

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

    /// Light from the point of the panel that `u` stands for: L A cos / d^2, cos at the panel.
    pub fn direct_light(&self, point: DVec3, u: [f64; 2]) -> Option<DirectLight> {
        let to = self.point(2.0 * u[0] - 1.0, 2.0 * u[1] - 1.0) - point;
        let distance_m = to.length();
        if !(distance_m > 0.0 && distance_m.is_finite()) {
            return None;
        }
        let towards = to / distance_m;
        let cosine = -towards.dot(self.aim());
        (cosine > 0.0).then(|| DirectLight {
            towards,
            distance_m,
            illuminance_lx: self.flux_lm() * cosine / (PI * distance_m * distance_m),
        })
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
