//! A smooth interface between two transparent media: exact Fresnel reflection, refraction, total reflection.
//!
//! Scene text: `type = "dielectric"`, `ior` behind the outward normal, `ior_outside` before it. What is on the two sides of a
//! face, the state of the photon says ([`crate::scene::media`]).
//! Unpolarised at every face: a slab then passes T = (1 - R)/(1 + R) with R the mean of s and p (METHOD 1).

use glam::DVec3;

use crate::error::Invalid;
use crate::error::invalid::Interval;
use crate::sample::coordinates::Chooser;
use crate::surface::incidence::keep_side;
use crate::surface::{Event, Incidence, Kind, Model, Throughput, Way, Ways};

/// The two refractive indices of an interface.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Dielectric {
    ior: f64,
    ior_outside: Option<f64>,
}

/// Refractive indices.
pub const IOR: Interval = Interval { low: 1e-3, high: 1e3, words: "a refractive index from 0.001 to 1000" };

impl Dielectric {
    /// An interface: the index `ior` behind the outward normal. `ior_outside` before it can be left out (`None`): then the
    /// medium is the one that is there.
    ///
    /// # Errors
    /// Indices outside `IOR`.
    pub fn new(ior: f64, ior_outside: impl Into<Option<f64>>) -> Result<Self, Invalid> {
        let ior_outside = ior_outside.into().map(|n| IOR.check("ior_outside", n)).transpose()?;
        Ok(Self { ior: IOR.check("ior", ior)?, ior_outside })
    }

    /// Refractive index behind the outward normal.
    pub fn ior(&self) -> f64 {
        self.ior
    }

    /// Refractive index before the outward normal, where it is stated.
    pub fn ior_outside(&self) -> Option<f64> {
        self.ior_outside
    }
}

/// Unpolarised Fresnel reflectance and the cosine of the refracted ray, for relative index `eta` =
/// transmitted over incident and the cosine of incidence; total reflection is (1, 0).
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

impl Dielectric {
    /// The part of the flux that is mirrored (1 in total reflection), and both ways on by whether they go
    /// through: the direction, unit, and whether a smooth normal made an exception necessary
    /// ([`Event::Leaves`]).
    #[inline]
    fn split(at: &Incidence) -> (f64, impl Fn(bool) -> (DVec3, bool)) {
        let Incidence { direction, facet, .. } = *at;
        let [before, behind_face] = at.indices;
        let eta = behind_face / before;
        let (normal, behind) = at.working_normal();
        // Edge-on, rounding may put the direction on the other side of the facet it arrived at.
        let cos_i = (-direction.dot(normal)).clamp(0.0, 1.0);
        let (reflectance, cos_t) = fresnel(eta, cos_i);
        let way = move |through| {
            let (onward, towards) = if through {
                (direction / eta + (cos_i / eta - cos_t) * normal, -facet)
            } else {
                (direction + 2.0 * cos_i * normal, facet)
            };
            let (onward, turned) = keep_side(onward, towards);
            (onward.normalize(), behind || turned)
        };
        (reflectance, way)
    }

    /// (n_i / n_t)^2: luminance over the square of the index is what refraction leaves unchanged, so an eye
    /// path that goes on through the interface from the medium of index n_i sees that
    /// part of the luminance in n_t. (E. Veach, "Robust Monte Carlo Methods for Light Transport Simulation",
    /// 1997, section 5.2.)
    #[inline]
    fn luminance_factor(at: &Incidence) -> f64 {
        let [n_i, n_t] = at.indices;
        // The same bits as for the ratio of outside to inside, whichever way the path goes.
        if at.front { (n_i / n_t) * (n_i / n_t) } else { 1.0 / ((n_t / n_i) * (n_t / n_i)) }
    }
}

impl Model for Dielectric {
    const REQUIRES: &[(u8, &'static str)] = &[(0, "refraction")];

    fn kind(&self) -> Kind {
        Kind::Specular
    }

    fn keeps_all(&self) -> bool {
        true
    }

    fn is_opaque(&self) -> bool {
        false
    }

    fn is_coloured(&self) -> bool {
        false
    }

    fn indices(&self) -> Option<(f64, Option<f64>)> {
        Some((self.ior, self.ior_outside))
    }

    /// Reflects with the Fresnel reflectance, else refracts.
    #[inline]
    fn scatter<C: Chooser, T: Throughput>(&self, at: &Incidence, chooser: &mut C, _: &mut T) -> Event {
        let (reflectance, way) = Self::split(at);
        let through = !chooser.happens(reflectance);
        let (direction, corrected) = way(through);
        Event::Leaves { direction, through, corrected }
    }

    fn specular(&self, at: &Incidence) -> Ways {
        let (r, way) = Self::split(at);
        let way = |through, part, luminance_factor| {
            let direction = way(through).0;
            Way { direction, part: [part; 3], luminance_factor }
        };
        Ways {
            mirrored: (r > 0.0).then(|| way(false, r, 1.0)),
            through: (r < 1.0).then(|| way(true, 1.0 - r, Self::luminance_factor(at))),
            lossless: true,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::Grey;
    use crate::surface::tests::Script;

    /// Out of a medium of the first index into one of the second, or back.
    fn at(angle: f64, front: bool, indices: [f64; 2]) -> Incidence {
        let direction = DVec3::new(angle.sin(), 0.0, -angle.cos());
        let indices = if front { indices } else { [indices[1], indices[0]] };
        Incidence { direction, facet: DVec3::Z, smooth: DVec3::Z, front, indices }
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
        let glass = Dielectric::new(1.5, 1.0).unwrap();
        for (angle, total) in [(critical - 1e-9, false), (critical + 1e-9, true)] {
            let mut script = Script::new([false], []);
            match glass.scatter(&at(angle, false, [1.0, 1.5]), &mut script, &mut Grey) {
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
        let glass = Dielectric::new(1.5, 1.2).unwrap();
        for (front, ratio) in [(true, 1.2 / 1.5), (false, 1.5 / 1.2)] {
            let mut script = Script::new([false], []);
            match glass.scatter(&at(0.5, front, [1.2, 1.5]), &mut script, &mut Grey) {
                Event::Leaves { direction, through: true, corrected: false } => {
                    assert!((direction.x - ratio * 0.5f64.sin()).abs() < 1e-15 && direction.z < 0.0);
                }
                other => panic!("{other:?}"),
            }
        }
    }

    #[test]
    fn a_tilted_smooth_normal_never_sends_a_photon_to_the_wrong_side() {
        let glass = Dielectric::new(1.5, 1.0).unwrap();
        let mut corrected = 0;
        for i in 0..1000 {
            let tilt = 0.4 * f64::from(i % 7 - 3) / 3.0;
            let mut incidence = at(1.57 * f64::from(i) / 1000.0, i % 2 == 0, [1.0, 1.5]);
            incidence.smooth = DVec3::new(tilt.sin(), 0.0, tilt.cos());
            for reflect in [true, false] {
                let mut script = Script::new([reflect], []);
                match glass.scatter(&incidence, &mut script, &mut Grey) {
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

    #[test]
    fn an_eye_path_goes_the_ways_of_photons_with_the_parts_that_they_go() {
        let glass = Dielectric::new(1.5, 1.2).unwrap();
        for (front, factor) in [(true, 0.64), (false, 1.0 / 0.64)] {
            let mut incidence = at(0.5, front, [1.2, 1.5]);
            incidence.smooth = DVec3::new(0.1, 0.0, 1.0).normalize();
            let ways = glass.specular(&incidence);
            assert!(ways.lossless);
            for (reflect, way) in [(true, ways.mirrored.unwrap()), (false, ways.through.unwrap())] {
                let mut script = Script::new([reflect], []);
                match glass.scatter(&incidence, &mut script, &mut Grey) {
                    Event::Leaves { direction, .. } => assert_eq!(direction, way.direction),
                    other => panic!("{other:?}"),
                }
                let chance = if reflect { script.asked[0] } else { 1.0 - script.asked[0] };
                assert_eq!(way.part, [chance; 3]);
                let factor = if reflect { 1.0 } else { factor };
                assert!((way.luminance_factor / factor - 1.0).abs() < 1e-15);
            }
        }
        let total = glass.specular(&at(1.2, false, [1.2, 1.5]));
        assert!(total.through.is_none() && total.mirrored.unwrap().part == [1.0; 3]);
        let matched = Dielectric::new(1.5, 1.5).unwrap().specular(&at(1.2, false, [1.5, 1.5]));
        assert!(matched.mirrored.is_none() && matched.through.unwrap().part == [1.0; 3]);
    }

    #[test]
    fn what_is_no_index_is_refused() {
        for ior in [f64::NAN, f64::INFINITY, 0.0, -1.5, 1e-4, 1e4, 1e300] {
            assert_eq!(Dielectric::new(ior, 1.0).unwrap_err().what(), "ior");
            assert_eq!(Dielectric::new(1.5, ior).unwrap_err().what(), "ior_outside");
        }
    }
}
