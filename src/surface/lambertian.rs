//! A perfectly diffuse surface: scattered with the cosine law about the facet's normal, on the side of
//! arrival.
//!
//! Scene text: `type = "lambertian"`, `reflectance` 0 to 1, or `[r, g, b]`. With a `transmittance` it is
//! [`crate::surface::DiffuseTransmission`].

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use crate::math::frame::frame_about;
use crate::math::trig::sin_cos;
use crate::sample::coordinates::{Chooser, Purpose};
use crate::surface::{Event, Incidence, Kind, Leg, Model, Reflectance, Throughput};

/// A perfectly diffuse surface: f = reflectance / pi between directions of one side.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lambertian {
    reflectance: Reflectance,
}

impl Lambertian {
    /// A surface that reflects these parts of the flux, on either side.
    pub fn new(reflectance: Reflectance) -> Self {
        Self { reflectance }
    }

    /// Reflected parts of the flux.
    pub fn reflectance(&self) -> &Reflectance {
        &self.reflectance
    }
}

impl Model for Lambertian {
    const REQUIRES: &[(u8, &'static str)] = &[(2, "diffuse scattering")];

    fn kind(&self) -> Kind {
        if self.reflectance.luminous() > 0.0 { Kind::Scattering } else { Kind::Absorbing }
    }

    fn keeps_all(&self) -> bool {
        self.reflectance.by_channel() == [1.0; 3]
    }

    fn is_opaque(&self) -> bool {
        true
    }

    fn is_coloured(&self) -> bool {
        self.reflectance.is_coloured()
    }

    /// Scatters what the throughput lets go on.
    #[inline]
    fn scatter<C: Chooser, T: Throughput>(&self, at: &Incidence, chooser: &mut C, carried: &mut T) -> Event {
        if !carried.reflect(&self.reflectance, chooser) {
            return Event::Absorbed;
        }
        Event::Leaves { direction: sample_cosine(at.facet, chooser), through: false, corrected: false }
    }

    #[inline]
    fn eval(&self, _outward: DVec3, wi: Leg, wo: Leg) -> [f64; 3] {
        if wi.front == wo.front { value(&self.reflectance) } else { [0.0; 3] }
    }

    fn even_value(&self) -> Option<[f64; 3]> {
        Some(value(&self.reflectance))
    }
}

/// f of a diffuse surface that scatters these parts into one side, 1/sr.
#[inline]
pub(super) fn value(parts: &Reflectance) -> [f64; 3] {
    parts.by_channel().map(|part| part * FRAC_1_PI)
}

/// Direction of density cos(theta) / pi about a unit normal; unit.
#[inline]
pub(super) fn sample_cosine<C: Chooser>(normal: DVec3, chooser: &mut C) -> DVec3 {
    let u1 = chooser.uniform(Purpose::Scatter);
    let u2 = chooser.uniform(Purpose::Scatter);
    (frame_about(normal) * cosine_direction(u1, u2)).normalize()
}

/// Cosine-distributed direction about +Z: sin^2(theta) = u1, phi = 2 pi u2.
#[inline]
pub fn cosine_direction(u1: f64, u2: f64) -> DVec3 {
    let sin_theta = u1.sqrt();
    let (sin_phi, cos_phi) = sin_cos(2.0 * PI * u2);
    DVec3::new(sin_theta * cos_phi, sin_theta * sin_phi, (1.0 - u1).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::surface::tests::Script;
    use crate::surface::throughput::Grey;

    #[test]
    fn directions_stay_on_the_side_of_arrival_even_at_the_last_uniform() {
        let largest = 1.0 - f64::EPSILON / 2.0;
        let wall = Lambertian::new(Reflectance::new(0.5).unwrap());
        for facet in [DVec3::Z, -DVec3::Z, DVec3::new(0.6, 0.0, -0.8)] {
            for u in [0.0, 0.5, largest] {
                let at =
                    Incidence { direction: -facet, facet, smooth: facet, front: true, indices: [1.0; 2] };
                match wall.scatter(&at, &mut Script::new([true], [largest, u]), &mut Grey) {
                    Event::Leaves { direction, through: false, .. } => assert!(direction.dot(facet) > 0.0),
                    other => panic!("{other:?}"),
                }
            }
        }
    }

    #[test]
    fn it_is_equally_bright_from_its_lit_side() {
        let wall = Lambertian::new(Reflectance::rgb([0.5, 0.25, 1.0]).unwrap());
        let bright = [0.5 * FRAC_1_PI, 0.25 * FRAC_1_PI, FRAC_1_PI];
        let (a, b) = (DVec3::new(0.6, 0.0, 0.8), DVec3::new(0.0, 0.8, 0.6));
        for outward in [DVec3::Z, -DVec3::Z] {
            let eval = |wi, wo| wall.eval(outward, Leg::new(wi, outward), Leg::new(wo, outward));
            assert_eq!((eval(a, b), eval(-a, -b)), (bright, bright));
            assert_eq!((eval(a, -b), eval(-a, b)), ([0.0; 3], [0.0; 3]));
        }
        assert_eq!(wall.even_value(), Some(bright));
        assert_eq!(wall.kind(), Kind::Scattering);
        assert_eq!(Lambertian::new(Reflectance::new(0.0).unwrap()).kind(), Kind::Absorbing);
    }

    #[test]
    fn moments_are_those_of_the_cosine_law() {
        // Mean of cos is 2/3, of cos^2 is 1/2, of x and y 0: midpoint rule over the unit square.
        let n = 400;
        let (mut c1, mut c2, mut x, mut y) = (0.0, 0.0, 0.0, 0.0);
        for i in 0..n {
            for j in 0..n {
                let d = cosine_direction(
                    (f64::from(i) + 0.5) / f64::from(n),
                    (f64::from(j) + 0.5) / f64::from(n),
                );
                c1 += d.z;
                c2 += d.z * d.z;
                x += d.x;
                y += d.y;
            }
        }
        let n2 = f64::from(n * n);
        assert!((c1 / n2 - 2.0 / 3.0).abs() < 1e-5 && (c2 / n2 - 0.5).abs() < 1e-12);
        assert!(x.abs() / n2 < 1e-12 && y.abs() / n2 < 1e-12);
    }
}
