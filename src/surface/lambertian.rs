//! A perfectly diffuse surface: scattered with the cosine law about the facet's normal, on the side of arrival.
//!
//! Scene text: `type = "lambertian"`, `reflectance` 0 to 1, or `[r, g, b]`.

use std::f64::consts::PI;

use glam::DVec3;

use crate::math::frame::frame_about;
use crate::math::trig::sin_cos;
use crate::sample::coordinates::{Chooser, Purpose};
use crate::surface::{Event, Incidence, Reflectance, Throughput};

/// Scatters what the throughput lets go on; density cos(theta)/pi in solid angle.
#[inline]
pub fn scatter<C: Chooser, T: Throughput>(
    reflectance: &Reflectance,
    at: &Incidence,
    chooser: &mut C,
    carried: &mut T,
) -> Event {
    if !carried.reflect(reflectance, chooser) {
        return Event::Absorbed;
    }
    let u1 = chooser.uniform(Purpose::Scatter);
    let u2 = chooser.uniform(Purpose::Scatter);
    let direction = frame_about(at.facet) * cosine_direction(u1, u2);
    Event::Leaves { direction: direction.normalize(), through: false, corrected: false }
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
    use crate::surface::script::Script;
    use crate::surface::throughput::Grey;

    #[test]
    fn directions_stay_on_the_side_of_arrival_even_at_the_last_uniform() {
        let largest = 1.0 - f64::EPSILON / 2.0;
        for facet in [DVec3::Z, -DVec3::Z, DVec3::new(0.6, 0.0, -0.8)] {
            for u in [0.0, 0.5, largest] {
                let at = Incidence { direction: -facet, facet, smooth: facet, front: true };
                let mut script =
                    Script { events: vec![true], uniforms: vec![largest, u], ..Script::default() };
                match scatter(&Reflectance::grey(0.5), &at, &mut script, &mut Grey) {
                    Event::Leaves { direction, through: false, .. } => assert!(direction.dot(facet) > 0.0),
                    other => panic!("{other:?}"),
                }
            }
        }
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
