//! Where an emitter points: the directions `aim` and `up` of the scene file.

use glam::{DMat3, DVec3};

use crate::error::Invalid;
use crate::error::invalid::Interval;
use crate::math::frame::{orthogonal_part, unit};

/// Fluxes of emitters, lm.
pub const FLUX: Interval = Interval { low: 1e-9, high: 1e12, words: "a flux from 1e-9 to 1e12 lm" };

/// Orthogonal unit vectors `aim` and `up`.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AimFrame {
    aim: DVec3,
    up: DVec3,
}

impl AimFrame {
    /// A frame whose `aim` is along the one given and whose `up` is the part of the one given across it; without one it is
    /// +y, or +x where `aim` is along y.
    ///
    /// # Errors
    /// A vector without a direction, and `up` parallel to `aim` (an angle below 1e-9).
    pub fn new(aim: DVec3, up: Option<DVec3>) -> Result<Self, Invalid> {
        let direction = |what, value| unit(value).ok_or(Invalid::NoDirection { what, value });
        let aim = direction("aim", aim)?;
        let across = match up {
            Some(up) => orthogonal_part(direction("up", up)?, aim),
            None => orthogonal_part(DVec3::Y, aim).or_else(|| orthogonal_part(DVec3::X, aim)),
        };
        Ok(Self { aim, up: across.ok_or(Invalid::Parallel { what: "up", to: "aim" })? })
    }

    /// The direction (V, H) = (0, 0) of a luminaire, of a beam's light, or that a lit side faces.
    #[inline]
    pub fn aim(&self) -> DVec3 {
        self.aim
    }

    /// Orthogonal to `aim`.
    #[inline]
    pub fn up(&self) -> DVec3 {
        self.up
    }

    /// Columns: aim x up, up, aim.
    pub(super) fn axes(&self) -> DMat3 {
        DMat3::from_cols(self.aim.cross(self.up), self.up, self.aim)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_length_and_any_lean_give_orthogonal_unit_vectors() {
        for scale in [2f64.powi(-700), 1.0, 2f64.powi(700)] {
            let frame =
                AimFrame::new(DVec3::new(0.0, 3.0, -4.0) * scale, Some(DVec3::new(1.0, 5.0, 0.0))).unwrap();
            assert_eq!(frame.aim(), DVec3::new(0.0, 0.6, -0.8));
            assert!((frame.up().length() - 1.0).abs() < 1e-15 && frame.up().dot(frame.aim()).abs() < 1e-16);
            assert!(frame.up().x > 0.0 && frame.axes().x_axis.dot(frame.aim().cross(frame.up())) > 0.999);
        }
        assert_eq!(AimFrame::new(DVec3::NEG_Z, None).unwrap().up(), DVec3::Y);
        assert_eq!(AimFrame::new(DVec3::Y * 2.0, None).unwrap().up(), DVec3::X);
    }
}
