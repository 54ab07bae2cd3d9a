//! The direction along a surface from which a scattering table counts azimuths of incidence.

use glam::DVec3;

use crate::error::{Diagnostic, Kind, Result};
use crate::math::frame::{frame_about, unit};

/// Where azimuth 0 is at every place of a surface, told from the outward normal there alone.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Reference {
    /// The part of this direction that lies along the surface: brushed straight.
    Along(DVec3),
    /// Around this axis, as brushed on a lathe: counter-clockwise seen from its tip where the outward normal
    /// points away from the axis, the other way where it points to the axis.
    Around(DVec3),
}

impl Default for Reference {
    fn default() -> Self {
        Self::Along(DVec3::X)
    }
}

impl Reference {
    /// The same with a unit vector, which [`Self::tangent`] relies on.
    ///
    /// # Errors
    /// A vector without direction.
    pub fn normalised(self) -> Result<Self> {
        let unit = |v: DVec3| {
            unit(v).ok_or_else(|| {
                Diagnostic::new(Kind::Range, format!("the reference direction {v}"), "a direction")
            })
        };
        Ok(match self {
            Self::Along(direction) => Self::Along(unit(direction)?),
            Self::Around(axis) => Self::Around(unit(axis)?),
        })
    }

    /// The unit reference direction across the unit normal `outward`. Where the normal is the direction or
    /// axis itself, some fixed one stands in.
    #[inline]
    pub fn tangent(&self, outward: DVec3) -> DVec3 {
        self.along(outward).normalize()
    }

    /// The same of any length: angles need no more.
    #[inline]
    pub fn along(&self, outward: DVec3) -> DVec3 {
        let along = match *self {
            Self::Along(direction) => direction - direction.dot(outward) * outward,
            Self::Around(axis) => axis.cross(outward),
        };
        // Parallel as far as f64 can tell: rounding is all that is left.
        let parallel = along.length_squared() <= (8.0 * f64::EPSILON) * (8.0 * f64::EPSILON);
        if parallel { frame_about(outward).x_axis } else { along }
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
        let reference = Reference::Along(DVec3::new(3.0, 0.0, 4.0)).normalised().unwrap();
        assert!(close(reference.tangent(DVec3::Z), DVec3::X));
        assert!(close(reference.tangent(-DVec3::Z), DVec3::X), "the same on both sides");
        assert!(close(reference.tangent(DVec3::X), DVec3::Z));
        assert!(close(reference.tangent(DVec3::Y), DVec3::new(0.6, 0.0, 0.8)));
    }

    #[test]
    fn turned_brushing_goes_around_the_axis() {
        let reference = Reference::Around(DVec3::Z * 2.0).normalised().unwrap();
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
        assert!(Reference::Along(DVec3::ZERO).normalised().is_err());
    }
}
