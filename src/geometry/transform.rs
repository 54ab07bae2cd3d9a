//! Scale, rotation, translation, in this order.

use glam::{DMat3, DVec3};

use super::{ANGLE, COORDINATE};
use crate::error::Invalid;
use crate::error::invalid::Interval;

/// Scale factors.
pub const SCALE: Interval = Interval { low: 1e-9, high: 1e9, words: "a positive factor from 1e-9 to 1e9" };

/// An affine map: scale, then rotation about x, y and z (in this order, about the fixed axes), then translation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transform {
    scale: DVec3,
    rotation: DMat3,
    translation: DVec3,
}

impl Default for Transform {
    fn default() -> Self {
        Self::identity()
    }
}

impl Transform {
    /// The map that moves nothing.
    pub fn identity() -> Self {
        Self { scale: DVec3::ONE, rotation: DMat3::IDENTITY, translation: DVec3::ZERO }
    }

    /// Positive scale factors, right-handed rotations (degrees) and a translation (m).
    ///
    /// # Errors
    /// A scale, angle or translation out of range. (A negative scale is no movement: it would turn the surface inside out.)
    pub fn new(scale: DVec3, rotate_deg: DVec3, translate: DVec3) -> Result<Self, Invalid> {
        SCALE.vector("scale", scale)?;
        ANGLE.vector("rotate_deg", rotate_deg)?;
        COORDINATE.vector("translate", translate)?;
        let [(sx, cx), (sy, cy), (sz, cz)] = rotate_deg.to_array().map(sin_cos_deg);
        let about_x = DMat3::from_cols_array(&[1.0, 0.0, 0.0, 0.0, cx, sx, 0.0, -sx, cx]);
        let about_y = DMat3::from_cols_array(&[cy, 0.0, -sy, 0.0, 1.0, 0.0, sy, 0.0, cy]);
        let about_z = DMat3::from_cols_array(&[cz, sz, 0.0, -sz, cz, 0.0, 0.0, 0.0, 1.0]);
        Ok(Self { scale, rotation: about_z * about_y * about_x, translation: translate })
    }

    /// A point, moved (m).
    pub fn point(&self, p: DVec3) -> DVec3 {
        if *self == Self::identity() { p } else { self.vector(p) + self.translation }
    }

    /// A difference of points, moved.
    pub fn vector(&self, v: DVec3) -> DVec3 {
        self.rotation * (self.scale * v)
    }

    /// A normal, moved by the inverse transpose; not normalised.
    pub fn normal(&self, n: DVec3) -> DVec3 {
        self.rotation * (n / self.scale)
    }

    /// The rotation alone.
    pub fn rotate(&self, v: DVec3) -> DVec3 {
        self.rotation * v
    }

    /// The scale factor of an exact shape, which has no formula under several.
    ///
    /// # Errors
    /// Factors that differ.
    pub fn uniform_scale(&self) -> Result<f64, Invalid> {
        let s = self.scale;
        if s.x == s.y && s.y == s.z {
            return Ok(s.x);
        }
        Err(Invalid::Shape {
            what: "scale",
            found: format!("scale = {s}"),
            required: "one factor for all axes: a sphere or paraboloid keeps its shape",
        })
    }
}

/// Sine and cosine of degrees, exact at multiples of 90: a box turned by 90 degrees stays axis-parallel.
fn sin_cos_deg(angle_deg: f64) -> (f64, f64) {
    let reduced = angle_deg % 360.0;
    let quarter = reduced / 90.0;
    if quarter == quarter.trunc() {
        return match quarter as i32 {
            0 => (0.0, 1.0),
            1 | -3 => (1.0, 0.0),
            2 | -2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        };
    }
    let r = reduced.to_radians();
    (libm::sin(r), libm::cos(r))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotations_are_right_handed_and_in_order() {
        let turn = |x, y, z| Transform::new(DVec3::ONE, DVec3::new(x, y, z), DVec3::ZERO).unwrap();
        assert_eq!(turn(90.0, 0.0, 0.0).point(DVec3::Y), DVec3::Z);
        assert_eq!(turn(0.0, 90.0, 0.0).point(DVec3::Z), DVec3::X);
        assert_eq!(turn(0.0, 0.0, 90.0).point(DVec3::X), DVec3::Y);
        assert_eq!(turn(0.0, 0.0, -270.0).point(DVec3::X), DVec3::Y);
        assert_eq!(turn(90.0, 0.0, 90.0).point(DVec3::Y), DVec3::Z);
        let p = turn(0.0, 0.0, 30.0).point(DVec3::X);
        assert!((p - DVec3::new(0.75f64.sqrt(), 0.5, 0.0)).length() < 1e-15);
    }

    #[test]
    fn normals_stay_perpendicular_under_any_scale() {
        let t = Transform::new(DVec3::new(1.0, 2.0, 5.0), DVec3::new(10.0, 20.0, 30.0), DVec3::ONE).unwrap();
        let (a, b) = (DVec3::new(1.0, 0.3, -0.2), DVec3::new(0.1, 1.0, 0.7));
        let n = t.normal(a.cross(b));
        assert!(n.dot(t.vector(a)).abs() < 1e-14 && n.dot(t.vector(b)).abs() < 1e-14);
    }

    #[test]
    fn mirroring_and_nan_are_refused() {
        for scale in [DVec3::new(1.0, -1.0, 1.0), DVec3::ZERO, DVec3::new(f64::NAN, 1.0, 1.0)] {
            let refused = Transform::new(scale, DVec3::ZERO, DVec3::ZERO);
            assert!(matches!(refused, Err(Invalid::Vector { what: "scale", .. })), "{scale}");
        }
    }
}
