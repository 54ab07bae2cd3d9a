//! A smooth interface between two transparent media: exact Fresnel reflection, refraction, total reflection.
//!
//! Scene text: `type = "dielectric"`, `ior` behind the outward normal, `ior_outside` (default 1) before it. Unpolarised at
//! every face: a slab then passes T = (1 - R)/(1 + R) with R the mean of s and p (METHOD 1).

use glam::DVec3;

use crate::sample::coordinates::Chooser;
use crate::surface::{Event, Incidence, keep_side, working_normal};

/// The two refractive indices of an interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    /// Index on the side the outward normal points to.
    pub ior_outside: f64,
    /// Index behind the outward normal.
    pub ior: f64,
}

/// Unpolarised Fresnel reflectance and the cosine of the refracted ray, for relative index `eta` = transmitted over
/// incident and the cosine of incidence; total reflection is (1, 0).
#[inline]
pub fn fresnel(eta: f64, cos_i: f64) -> (f64, f64) {
    if eta == 1.0 {
        return (0.0, cos_i); // An index-matched face is not there: exactly nothing is reflected, nothing is drawn.
    }
    let sin2_t = (1.0 - cos_i) * (1.0 + cos_i) / (eta * eta);
    if sin2_t >= 1.0 {
        return (1.0, 0.0);
    }
    let cos_t = (1.0 - sin2_t).sqrt();
    let s = (cos_i - eta * cos_t) / (cos_i + eta * cos_t);
    let p = (eta * cos_i - cos_t) / (eta * cos_i + cos_t);
    (0.5 * (s * s + p * p), cos_t)
}

/// The two ways on from an interface, and how much goes which.
#[derive(Debug, Clone, Copy)]
pub struct Ways {
    /// Part of the flux that is mirrored; the rest is refracted. 1 in total reflection, where there is no refracted way.
    pub reflectance: f64,
    direction: DVec3,
    facet: DVec3,
    normal: DVec3,
    eta: f64,
    cos_i: f64,
    cos_t: f64,
    behind: bool,
}

impl Ways {
    /// The mirrored direction, unit, and whether a smooth normal made an exception necessary ([`Event::Leaves`]).
    #[inline]
    pub fn mirrored(&self) -> (DVec3, bool) {
        self.kept(self.direction + 2.0 * self.cos_i * self.normal, self.facet)
    }

    /// The same of the refracted direction; without meaning in total reflection.
    #[inline]
    pub fn refracted(&self) -> (DVec3, bool) {
        self.kept(refract(self.direction, self.normal, self.eta, self.cos_i, self.cos_t), -self.facet)
    }

    #[inline]
    fn kept(&self, direction: DVec3, towards: DVec3) -> (DVec3, bool) {
        let (direction, turned) = keep_side(direction, towards);
        (direction.normalize(), self.behind || turned)
    }
}

impl Dielectric {
    /// Both ways of what arrives.
    #[inline]
    pub fn ways(&self, at: &Incidence) -> Ways {
        let eta = if at.front { self.ior / self.ior_outside } else { self.ior_outside / self.ior };
        let (normal, behind) = working_normal(at);
        // Edge-on, rounding may put the direction on the other side of the facet it arrived at.
        let cos_i = (-at.direction.dot(normal)).clamp(0.0, 1.0);
        let (reflectance, cos_t) = fresnel(eta, cos_i);
        Ways { reflectance, direction: at.direction, facet: at.facet, normal, eta, cos_i, cos_t, behind }
    }

    /// Reflects with the Fresnel reflectance, else refracts.
    #[inline]
    pub fn scatter<C: Chooser>(&self, at: &Incidence, chooser: &mut C) -> Event {
        let ways = self.ways(at);
        let through = !chooser.happens(ways.reflectance);
        let (direction, corrected) = if through { ways.refracted() } else { ways.mirrored() };
        Event::Leaves { direction, through, corrected }
    }
}

#[inline]
fn refract(direction: DVec3, normal: DVec3, eta: f64, cos_i: f64, cos_t: f64) -> DVec3 {
    direction / eta + (cos_i / eta - cos_t) * normal
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::script::Script;

    fn at(angle: f64, front: bool) -> Incidence {
        let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
        Incidence { direction, facet: DVec3::Z, smooth: DVec3::Z, front }
    }

    #[test]
    fn fresnel_at_known_angles() {
        // Normal incidence ((n - 1)/(n + 1))^2; Brewster: R_p = 0, so R = R_s / 2 = ((n^2-1)/(n^2+1))^2 / 2.
        assert!((fresnel(1.5, 1.0).0 - 0.04).abs() < 1e-16);
        let brewster = 1.5f64.atan();
        assert!((fresnel(1.5, brewster.cos()).0 - 0.5 * (1.25f64 / 3.25).powi(2)).abs() < 1e-15);
        assert_eq!(fresnel(1.0, 0.3).0, 0.0);
        // Grazing incidence reflects all; the approach is linear in the cosine.
        assert!((1.0 - fresnel(1.5, 1e-9).0) / 1e-9 < 10.0);
        // Stokes reversibility: the same reflectance from either side along the same path.
        let (r, cos_t) = fresnel(1.5, 0.4);
        assert!((fresnel(1.0 / 1.5, cos_t).0 - r).abs() < 1e-14);
    }

    #[test]
    fn total_reflection_begins_at_the_critical_angle() {
        let critical = (1.0f64 / 1.5).asin();
        let glass = Dielectric { ior: 1.5, ior_outside: 1.0 };
        for (angle, total) in [(critical - 1e-9, false), (critical + 1e-9, true)] {
            let mut script = Script { events: vec![false], ..Script::default() };
            match glass.scatter(&at(angle, false), &mut script) {
                Event::Leaves { direction, through, .. } => {
                    assert_eq!(through, !total);
                    assert_eq!(script.asked.is_empty(), total, "total reflection draws nothing");
                    if !total {
                        // Snell: the refracted ray is within sqrt(2 * 1e-9 / tan) of grazing.
                        assert!((direction.x - 1.5 * angle.sin()).abs() < 1e-12);
                    }
                }
                Event::Absorbed | Event::BelowHorizon => panic!("glass does not absorb"),
            }
        }
    }

    #[test]
    fn snell_holds_on_both_sides() {
        let glass = Dielectric { ior: 1.5, ior_outside: 1.2 };
        for (front, ratio) in [(true, 1.2 / 1.5), (false, 1.5 / 1.2)] {
            let mut script = Script { events: vec![false], ..Script::default() };
            match glass.scatter(&at(0.5, front), &mut script) {
                Event::Leaves { direction, through: true, corrected: false } => {
                    assert!((direction.x - ratio * 0.5f64.sin()).abs() < 1e-15 && direction.z < 0.0);
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn a_tilted_smooth_normal_never_sends_a_photon_to_the_wrong_side() {
        let glass = Dielectric { ior: 1.5, ior_outside: 1.0 };
        let mut corrected = 0;
        for i in 0..1000 {
            let tilt = 0.4 * f64::from(i % 7 - 3) / 3.0;
            let mut incidence = at(1.57 * f64::from(i) / 1000.0, i % 2 == 0);
            incidence.smooth = DVec3::new(tilt.sin(), 0.0, tilt.cos());
            for reflect in [true, false] {
                let mut script = Script { events: vec![reflect], ..Script::default() };
                match glass.scatter(&incidence, &mut script) {
                    Event::Leaves { direction, through, corrected: c } => {
                        assert!(direction.z * if through { -1.0 } else { 1.0 } >= 0.0);
                        assert!((direction.length() - 1.0).abs() < 1e-14);
                        corrected += u32::from(c);
                    }
                    Event::Absorbed | Event::BelowHorizon => panic!("glass does not absorb"),
                }
            }
        }
        assert!(corrected > 10, "the family must contain exceptions");
    }
}
