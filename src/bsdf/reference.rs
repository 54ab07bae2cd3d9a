//! The direction along a surface from which a scattering table counts azimuths of incidence.

use glam::DVec3;

use crate::math::frame::{frame_about, frame_from_axis};

/// Where azimuth 0 is at every place of a surface, told from the normal there alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference {
    /// The part of this direction that lies along the surface: brushed straight.
    Along(DVec3),
    /// Around this axis, as brushed on a lathe: counter-clockwise seen from its tip where the normal points away from the
    /// axis, the other way on the side that looks to the axis.
    Around(DVec3),
}

impl Reference {
    /// The unit reference direction across the unit normal `normal`.
    ///
    /// A surface that looks along the direction or axis has no such part. There the part of the y axis stands in, and if
    /// the normal is that one, any direction across it.
    #[inline]
    pub fn tangent(&self, normal: DVec3) -> DVec3 {
        let frame = match *self {
            Self::Along(direction) => frame_from_axis(normal, direction).map(|frame| frame.x_axis),
            // y is normal x axis.
            Self::Around(axis) => frame_from_axis(normal, axis).map(|frame| -frame.y_axis),
        };
        frame
            .or_else(|| frame_from_axis(normal, DVec3::Y).map(|frame| frame.x_axis))
            .unwrap_or_else(|| frame_about(normal).x_axis)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(a: DVec3, b: DVec3) -> bool {
        (a - b).length() < 1e-14
    }

    #[test]
    fn straight_brushing_is_projected() {
        let reference = Reference::Along(DVec3::new(3.0, 0.0, 4.0));
        assert!(close(reference.tangent(DVec3::Z), DVec3::X));
        assert!(close(reference.tangent(-DVec3::Z), DVec3::X), "the same on both sides");
        assert!(close(reference.tangent(DVec3::X), DVec3::Z));
        assert!(close(reference.tangent(DVec3::Y), DVec3::new(0.6, 0.0, 0.8)));
    }

    #[test]
    fn turned_brushing_goes_around_the_axis() {
        let reference = Reference::Around(DVec3::Z * 2.0);
        // Seen from the tip of z, counter-clockwise: at x it goes towards y, at y towards -x.
        for side in [1.0, -1.0] {
            let slanted = |x: f64, y: f64| DVec3::new(0.6 * x, 0.6 * y, 0.8) * side;
            assert!(close(reference.tangent(slanted(1.0, 0.0)), DVec3::Y * side));
            assert!(close(reference.tangent(slanted(0.0, 1.0)), -DVec3::X * side));
        }
    }

    #[test]
    fn there_is_always_a_direction_across_the_normal() {
        let references = [DVec3::X, DVec3::Y, DVec3::Z].map(|d| [Reference::Along(d), Reference::Around(d)]);
        for reference in references.into_iter().flatten() {
            for normal in [DVec3::X, -DVec3::Y, DVec3::Z, DVec3::new(0.0, 1e-300, 1.0)] {
                let tangent = reference.tangent(normal);
                assert!((tangent.length() - 1.0).abs() < 1e-15 && tangent.dot(normal).abs() < 1e-15);
            }
        }
        assert!(close(Reference::Along(DVec3::X).tangent(DVec3::X), DVec3::Y));
    }
}
