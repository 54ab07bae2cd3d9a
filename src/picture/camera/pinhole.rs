//! From pixels to rays and back: a pinhole, or a thin lens.
//!
//! Pixel (column i, row j) covers [i, i + 1) x [j, j + 1) of the picture, row 0 at the top. The picture lies
//! at a distance of `focal_px` pixels behind the pinhole.

use std::f64::consts::PI;

use glam::{DVec2, DVec3};

use crate::math::trig::sin_cos;
use crate::scene::camera::Camera;

/// The projection of a camera.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pinhole {
    position: DVec3,
    forward: DVec3,
    right: DVec3,
    up: DVec3,
    /// Half the columns and rows.
    middle: DVec2,
    focal_px: f64,
    lens_radius_m: f64,
    focus_m: f64,
}

/// A ray into the scene.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EyeRay {
    /// Where it starts, m.
    pub origin: DVec3,
    /// Unit.
    pub direction: DVec3,
}

/// Where a point is seen.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Seen {
    /// Place in the picture, pixels from its top left.
    pub place_px: DVec2,
    /// Unit vector from the pinhole to the point.
    pub direction: DVec3,
    /// Distance from the pinhole, m.
    pub distance_m: f64,
    /// Pixels^2 per steradian there: focal length^2 / cos^3 of the angle to the axis.
    pub pixels_per_sr: f64,
}

impl Pinhole {
    /// The projection of a camera.
    pub fn new(spec: &Camera) -> Self {
        let half = 0.5 * spec.fov_deg.to_radians();
        let middle = 0.5 * DVec2::new(f64::from(spec.pixels[0]), f64::from(spec.pixels[1]));
        let (sin, cos) = libm::sincos(half);
        Self {
            position: spec.position,
            forward: spec.forward,
            right: spec.forward.cross(spec.up),
            up: spec.up,
            middle,
            focal_px: middle.x * cos / sin,
            lens_radius_m: spec.lens_radius_m,
            focus_m: spec.focus_m,
        }
    }

    /// Whether rays start on a lens.
    pub fn has_lens(&self) -> bool {
        self.lens_radius_m > 0.0
    }

    /// Distance of the picture behind the pinhole, pixels.
    pub fn focal_px(&self) -> f64 {
        self.focal_px
    }

    /// The ray through the pinhole of a place in the picture, pixels from the top left.
    #[inline]
    pub fn ray(&self, place_px: DVec2) -> EyeRay {
        let d = place_px - self.middle;
        let along = self.forward * self.focal_px + self.right * d.x - self.up * d.y;
        EyeRay { origin: self.position, direction: along.normalize() }
    }

    /// The ray through the point of the lens that `u` stands for: all of one place in the picture meet in the
    /// plane in focus.
    #[inline]
    pub fn ray_by_lens(&self, place_px: DVec2, u: [f64; 2]) -> EyeRay {
        let through_middle = self.ray(place_px);
        let origin = self.position + self.lens_point(u);
        let to_focus = self.focus_m / through_middle.direction.dot(self.forward);
        let focus = self.position + through_middle.direction * to_focus;
        EyeRay { origin, direction: (focus - origin).normalize() }
    }

    /// A point of the lens from its middle, uniform over its area.
    #[inline]
    pub fn lens_point(&self, u: [f64; 2]) -> DVec3 {
        let radius = self.lens_radius_m * u[0].sqrt();
        let (sin, cos) = sin_cos(2.0 * PI * u[1]);
        self.right * (radius * cos) + self.up * (radius * sin)
    }

    /// Where a point (m) is seen through the pinhole; `None` for one that is not before it. The place may lie
    /// outside the picture.
    #[inline]
    pub fn project(&self, point: DVec3) -> Option<Seen> {
        let to = point - self.position;
        let depth = to.dot(self.forward);
        if depth <= 0.0 {
            return None;
        }
        let distance_m = to.length();
        let scale = self.focal_px / depth;
        let place_px = self.middle + DVec2::new(to.dot(self.right) * scale, -to.dot(self.up) * scale);
        let cosine = depth / distance_m;
        let pixels_per_sr = self.focal_px * self.focal_px / (cosine * cosine * cosine);
        Some(Seen { place_px, direction: to / distance_m, distance_m, pixels_per_sr })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::camera::CameraSpec;

    fn pinhole(spec: CameraSpec) -> Pinhole {
        Pinhole::new(&Camera::new(spec).unwrap())
    }

    fn spec() -> CameraSpec {
        CameraSpec::pinhole(DVec3::new(1.0, -2.0, 3.0), DVec3::new(0.0, 0.5, 0.2), DVec3::Z, 50.0, [8, 6])
    }

    #[test]
    fn the_angle_is_that_across_the_width_and_up_is_up() {
        let camera = pinhole(spec());
        let left = camera.ray(DVec2::new(0.0, 3.0)).direction;
        let right = camera.ray(DVec2::new(8.0, 3.0)).direction;
        assert!((left.dot(right).acos().to_degrees() - 50.0).abs() < 1e-12);
        assert!(camera.ray(DVec2::new(4.0, 0.0)).direction.z > camera.ray(DVec2::new(4.0, 6.0)).direction.z);
        // Seen from -y towards +y with z up, x points right.
        let along_y = CameraSpec::pinhole(DVec3::NEG_Y, DVec3::ZERO, DVec3::Z, 50.0, [8, 6]);
        assert!(pinhole(along_y).ray(DVec2::new(8.0, 3.0)).direction.x > 0.4);
    }

    #[test]
    fn projection_inverts_the_ray_and_its_scale_is_the_jacobian() {
        let camera = pinhole(spec());
        for place in [DVec2::new(0.1, 0.2), DVec2::new(4.0, 3.0), DVec2::new(9.0, -1.0)] {
            let ray = camera.ray(place);
            let seen = camera.project(ray.origin + ray.direction * 2.5).unwrap();
            assert!((seen.place_px - place).length() < 1e-12 && (seen.distance_m - 2.5).abs() < 1e-14);
            // Solid angle of a small square of the picture.
            let h = 1e-4;
            let d = |x: f64, y: f64| camera.ray(place + h * DVec2::new(x, y)).direction;
            let omega = (d(0.5, 0.0) - d(-0.5, 0.0)).cross(d(0.0, 0.5) - d(0.0, -0.5)).length();
            assert!((h * h / omega / seen.pixels_per_sr - 1.0).abs() < 1e-6);
        }
        assert!(camera.project(spec().position - spec().forward).is_none());
        assert!(camera.project(spec().position).is_none());
    }

    #[test]
    fn rays_of_a_lens_meet_in_the_plane_in_focus() {
        let camera = pinhole(CameraSpec { lens_radius_m: 0.2, focus_m: 3.0, ..spec() });
        let place = DVec2::new(6.5, 1.0);
        let middle = camera.ray(place);
        let expected = middle.origin + middle.direction * (3.0 / middle.direction.dot(spec().forward));
        for u in [[0.0, 0.0], [0.3, 0.9], [0.99, 0.4]] {
            let ray = camera.ray_by_lens(place, u);
            let at = ray.origin + ray.direction * (expected - ray.origin).dot(ray.direction);
            assert!((at - expected).length() < 1e-14);
            assert!((ray.origin - spec().position).length() <= 0.2);
        }
    }
}
