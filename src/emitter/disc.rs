//! The disc of a round light.
//!
//! Scene text: `type = "disc"`, `position` (the centre), `aim` (the normal of the lit side), `up` (optional: turns the map of
//! coordinates), `radius`, `flux_lm`.

use std::f64::consts::PI;

use super::area::LitShape;
use crate::error::Invalid;
use crate::geometry::LENGTH;
use crate::math::trig::sin_cos;

/// Corners of the polygon that stands for a circle: 0.12 % of the radius within it.
const CORNERS: u32 = 64;

/// The point of the unit disc for a point of the unit square: r^2 = u1, phi = 2 pi u2.
///
/// Equal areas, and axis-parallel in (r^2, phi): a net of the square is a net of rings and sectors, and what depends on r alone,
/// as on the axis of a round lamp, costs one coordinate. (The concentric map of Shirley and Chiu keeps cells rounder, but its
/// folds along the diagonals tie r to both coordinates.)
#[inline]
pub(super) fn unit_disc([u1, u2]: [f64; 2]) -> [f64; 2] {
    let radius = u1.sqrt();
    let (sin, cos) = sin_cos(2.0 * PI * u2);
    [radius * cos, radius * sin]
}

/// Corners on the unit circle, around.
pub(super) fn circle() -> Vec<[f64; 2]> {
    (0..CORNERS).map(|k| sin_cos(2.0 * PI * f64::from(k) / f64::from(CORNERS))).map(|(s, c)| [c, s]).collect()
}

/// A disc about the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Disc {
    radius_m: f64,
}

impl Disc {
    /// A disc of this radius, m.
    ///
    /// # Errors
    /// A radius out of range or not a number.
    pub fn new(radius_m: f64) -> Result<Self, Invalid> {
        Ok(Self { radius_m: LENGTH.check("radius", radius_m)? })
    }
}

impl LitShape for Disc {
    const NOUN: &'static str = "disc";
    const REQUIRES: (u8, &'static str) = (4, "disc emission");

    fn etendue_m2_sr(&self) -> f64 {
        PI * PI * self.radius_m * self.radius_m
    }

    fn extent_m(&self) -> f64 {
        2.0 * self.radius_m
    }

    #[inline]
    fn sample_point(&self, u: [f64; 2]) -> [f64; 2] {
        unit_disc(u).map(|x| self.radius_m * x)
    }

    fn contains(&self, [x, y]: [f64; 2]) -> bool {
        x * x + y * y <= self.radius_m * self.radius_m
    }

    fn outline(&self) -> Vec<[f64; 2]> {
        circle().into_iter().map(|place| place.map(|x| self.radius_m * x)).collect()
    }

    /// A line of the plane through the foot by its azimuth, uniform in the range in which lines meet the disc; then a place of
    /// that line's chord, uniform in solid angle. The estimate has a bound (the reciprocal density is at most 2 pi) and no
    /// spread on the axis. Where no part of the disc is twice as far away as another, its area serves better.
    fn sample_direction(&self, foot: [f64; 2], height_m: f64, u: [f64; 2]) -> Option<([f64; 2], f64)> {
        let (radius, h2) = (self.radius_m, height_m * height_m);
        let off_axis = libm::hypot(foot[0], foot[1]);
        let (least, most) = ((off_axis - radius).max(0.0), off_axis + radius);
        if h2 + most * most < 4.0 * (h2 + least * least) {
            return None;
        }
        let widest = if off_axis > radius { libm::asin(radius / off_axis) } else { 0.5 * PI };
        let (sin, cos) = libm::sincos(widest * (2.0 * u[0] - 1.0));
        // Along the line from the foot, towards the side of the centre: the chord is from a - b to a + b.
        let (a, b) = (off_axis * cos, (radius * radius - (off_axis * sin).powi(2)).max(0.0).sqrt());
        // Solid angle per azimuth between the foot and a place of the line, with the sign of the place: 1 - h / distance.
        let up_to = |t: f64| {
            let distance = (t * t + h2).sqrt();
            t * t.abs() / (distance * (distance + height_m))
        };
        let (from, to) = (up_to(a - b), up_to(a + b));
        let reached = from + u[1] * (to - from);
        let cos_theta = 1.0 - reached.abs();
        let t = (height_m * ((1.0 - cos_theta) * (1.0 + cos_theta)).sqrt() / cos_theta).copysign(reached);
        let t = t.clamp(a - b, a + b);
        // Towards the centre; any direction on the axis.
        let [x, y] = if off_axis > 0.0 { foot.map(|f| -f / off_axis) } else { [1.0, 0.0] };
        let place = [foot[0] + t * (cos * x - sin * y), foot[1] + t * (cos * y + sin * x)];
        Some((place, 2.0 * widest * (to - from)))
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::super::area::AreaLight;
    use super::super::{AimFrame, Emits};
    use super::*;
    use crate::emitter::tests::{illuminance, starts};

    const RADIUS: f64 = 0.7;

    /// Luminance 1, at z = 1, shining down.
    fn disc() -> AreaLight<Disc> {
        let frame = AimFrame::new(DVec3::NEG_Z, None).unwrap();
        let flux_lm = PI * PI * RADIUS * RADIUS;
        AreaLight::new(DVec3::new(1.0, 2.0, 1.0), frame, Disc::new(RADIUS).unwrap(), flux_lm).unwrap()
    }

    /// Illuminance of a facing plane below a disc of luminance 1: pi / 2 (1 - (1 + h^2 - r^2) / sqrt(...)), lengths in radii.
    /// (Howell, Menguc, Daun, Siegel, "Thermal Radiation Heat Transfer": plane element to parallel disc.)
    fn below(off_axis: f64, height: f64) -> f64 {
        let (h, r) = (height / RADIUS, off_axis / RADIUS);
        let z = 1.0 + h * h + r * r;
        0.5 * PI * (1.0 - (z - 2.0) / (z * z - 4.0 * r * r).sqrt())
    }

    #[test]
    fn moments_are_those_of_a_lambertian_disc() {
        let (disc, n) = (disc(), 1 << 14);
        let mut sums = [0.0; 6];
        let mut rings = [0u32; 4];
        for e in starts(&disc, n, 4) {
            let d = e.origin - disc.position();
            let (r, cos) = (d.truncate().length(), -e.direction.z);
            assert!(d.z == 0.0 && r <= RADIUS * (1.0 + 1e-15) && cos > 0.0);
            // Place and direction, and the two directions of the place, go their own ways.
            let terms = [r, cos, cos * cos, d.x * e.direction.x, d.x * d.y, r * cos];
            (0..6).for_each(|k| sums[k] += terms[k] / n as f64);
            rings[((r / RADIUS).powi(2) * 4.0).min(3.0) as usize] += 1;
        }
        let [r, cos, cos2, across, xy, r_cos] = sums;
        assert!((r - 2.0 / 3.0 * RADIUS).abs() < 1e-4, "{r}");
        assert!((cos - 2.0 / 3.0).abs() < 1e-4 && (cos2 - 0.5).abs() < 1e-4, "{cos} {cos2}");
        assert!(across.abs() < 1e-3 && xy.abs() < 1e-3 && (r_cos - r * cos).abs() < 1e-3);
        assert!(rings.iter().all(|count| u64::from(*count) == n / 4), "equal areas: {rings:?}");
    }

    #[test]
    fn direct_light_is_the_form_factor_s_near_and_far_and_has_a_bound() {
        let disc = disc();
        let axis = disc.position().truncate();
        for height in [1e-6, 1e-3, 0.1, 0.5, 1.0, 3.0, 40.0] {
            for off_axis in [0.0, 0.3, 0.69, 0.7, 0.71, 1.5, 4.0] {
                let point = axis.extend(1.0 - height) + DVec3::new(0.6, -0.8, 0.0) * off_axis;
                let (e, most) = illuminance(&disc, point, DVec3::Z);
                let exact = below(off_axis, height);
                let tolerance = 2e-3 * exact + 1e-5;
                assert!((e - exact).abs() < tolerance, "{height} {off_axis}: {e} for {exact}");
                assert!(most <= 3.0 * PI, "{height} {off_axis}: {most}");
            }
        }
        // On the axis E = pi L sin^2 of the half angle, at which the rim is seen; and the estimate of the solid angle is exact.
        assert!((below(0.0, 0.5) - PI * 0.49 / (0.49 + 0.25)).abs() < 1e-14);
        let exact = 2.0 * PI * (1.0 - 0.3 / (0.49f64 + 0.09).sqrt());
        for u in [[0.0, 0.0], [0.3, 0.9], [0.999, 0.5]] {
            let light = disc.direct_light(axis.extend(0.7), u).unwrap();
            assert!((light.illuminance_lx / exact - 1.0).abs() < 1e-14, "{u:?}");
        }
        assert!(disc.direct_light(axis.extend(1.5), [0.5; 2]).is_none(), "the other side is dark");
    }

    #[test]
    fn places_of_directions_are_on_the_disc_whatever_the_coordinates() {
        let (shape, last) = (Disc::new(RADIUS).unwrap(), 1.0 - f64::EPSILON / 2.0);
        let grown = Disc::new(RADIUS * (1.0 + 1e-9)).unwrap();
        let mut near = 0;
        for height in [1e-12, 1e-6, 1e-3, 0.5, 1.0] {
            for off_axis in [0.0, 1e-300, 0.3, RADIUS, RADIUS * (1.0 + 1e-15), 0.9, 2.0] {
                for u in [[0.0, 0.0], [last, 0.0], [0.0, last], [last, last], [0.5, 0.5], [0.25, 0.75]] {
                    let Some((place, solid_angle)) = shape.sample_direction([0.0, off_axis], height, u)
                    else {
                        continue;
                    };
                    near += 1;
                    assert!(grown.contains(place), "{height} {off_axis} {u:?}: {place:?}");
                    assert!((0.0..=2.0 * PI * (1.0 + 1e-15)).contains(&solid_angle), "{solid_angle}");
                }
            }
        }
        assert!(near > 100, "{near}");
    }

    #[test]
    fn a_disc_is_seen_from_its_lit_side_only_and_where_it_is() {
        let disc = disc();
        let below = |x: f64, y: f64| disc.seen(DVec3::new(1.0 + x, 2.0 + y, 0.0), DVec3::Z);
        assert_eq!(below(0.0, 0.0), Some((disc.luminance_cd_m2(), 1.0)));
        assert!(below(0.49, 0.49).is_some() && below(0.5, 0.5).is_none() && below(0.0, -0.69).is_some());
        assert_eq!(disc.seen(DVec3::new(1.0, 2.0, 2.0), DVec3::NEG_Z), None);
        assert!((disc.luminance_cd_m2() - 1.0).abs() < 1e-15);
    }
}
