//! Orthonormal frames.

use glam::{DMat3, DVec3};

/// Unit vector along `v`, or `None` where `v` has no direction (zero, infinite or NaN). Scaled by the largest component
/// first, so that neither tiny nor huge vectors lose their direction to under- or overflow.
pub fn unit(v: DVec3) -> Option<DVec3> {
    let largest = v.abs().max_element();
    if !(largest > 0.0 && largest.is_finite() && v.is_finite()) {
        return None;
    }
    let scaled = v / largest;
    Some(scaled / scaled.length())
}

/// The unit vector along the part of the unit vector `v` that is orthogonal to the unit vector `axis`; `None` if the angle
/// between their lines is below 1e-9, where rounding would choose the direction.
pub fn orthogonal_part(v: DVec3, axis: DVec3) -> Option<DVec3> {
    let sine = v.cross(axis).length();
    // Subtracted twice: the first remainder is orthogonal to rounding of v, the second to rounding of itself.
    let once = unit(v - axis * v.dot(axis))?;
    let part = unit(once - axis * once.dot(axis))?;
    (sine >= 1e-9).then_some(part)
}

/// Right-handed frame (columns x, y, z) with z along `axis` and x the part of `towards` across it, or `None` where
/// one of them has no direction or they are parallel.
pub fn frame_from_axis(axis: DVec3, towards: DVec3) -> Option<DMat3> {
    let z = unit(axis)?;
    let towards = unit(towards)?;
    let y = z.cross(towards);
    // Two unit vectors are parallel as far as f64 can tell when their cross product is rounding only.
    if y.length_squared() <= (4.0 * f64::EPSILON) * (4.0 * f64::EPSILON) {
        return None;
    }
    let y = unit(y)?;
    Some(DMat3::from_cols(y.cross(z), y, z))
}

/// Right-handed frame (columns x, y, z) about the unit vector `z`, continuous but for z = -Z. (Duff et al., "Building
/// an orthonormal basis, revisited", JCGT 6, 2017.)
#[inline]
pub fn frame_about(z: DVec3) -> DMat3 {
    let sign = 1.0f64.copysign(z.z);
    let a = -1.0 / (sign + z.z);
    let b = z.x * z.y * a;
    let x = DVec3::new(1.0 + sign * z.x * z.x * a, sign * b, -sign * z.x);
    let y = DVec3::new(b, sign + z.y * z.y * a, -z.y);
    DMat3::from_cols(x, y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn is_right_handed_orthonormal(m: DMat3) -> bool {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-14;
        let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
        close(x.length(), 1.0)
            && close(y.length(), 1.0)
            && close(z.length(), 1.0)
            && close(x.dot(y), 0.0)
            && close(y.dot(z), 0.0)
            && close(z.dot(x), 0.0)
            && close(m.determinant(), 1.0)
    }

    #[test]
    fn frames_are_right_handed_for_any_size_of_input() {
        for scale in [1e-200, 1.0, 1e200] {
            let axis = DVec3::new(0.3, -0.5, 0.8) * scale;
            let m = frame_from_axis(axis, DVec3::new(0.0, 1.0, 0.0) / scale).unwrap();
            assert!(is_right_handed_orthonormal(m));
            assert!(m.x_axis.y > 0.0);
        }
        for z in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(0.6, 0.0, -0.8)] {
            assert!(is_right_handed_orthonormal(frame_about(z)), "{z}");
        }
    }

    #[test]
    fn directionless_or_parallel_input_has_no_frame() {
        assert!(unit(DVec3::ZERO).is_none());
        assert!(unit(DVec3::new(f64::NAN, 0.0, 1.0)).is_none());
        assert!(unit(DVec3::new(f64::INFINITY, 0.0, 1.0)).is_none());
        assert!(frame_from_axis(DVec3::Z, DVec3::Z * -3.0).is_none());
    }
}
