//! How the output of a lamp depends on the tilt at which its luminaire is mounted.

use crate::error::invalid::Interval;

/// Mounting tilts.
pub(crate) const TILT_DEG: Interval =
    Interval { low: -180.0, high: 180.0, words: "a mounting tilt from -180 to 180 degrees" };

/// What a file says about it. The factors do not depend on the direction of emission: they are one factor of
/// all intensities, that of the tilt at which a luminaire is mounted ([`super::Photometry::factor_at_tilt`]).
#[derive(Debug, Clone, PartialEq)]
pub enum Tilt {
    /// `TILT=NONE`.
    None,
    /// `TILT=INCLUDE`: the table is in the file.
    Include(TiltTable),
    /// `TILT=name`: the table is in a file beside it; `None` when that file was not read.
    File {
        /// The name after `TILT=`.
        name: String,
        /// The table, if the file could be read.
        table: Option<TiltTable>,
    },
}

/// A tilt table: factors over the angle between the luminaire's axis and the vertical.
#[derive(Debug, Clone, PartialEq)]
pub struct TiltTable {
    /// Lamp-to-luminaire geometry: 1 vertical lamp, 2 horizontal and stays so, 3 horizontal and tilts.
    pub geometry: u32,
    /// Mounting angles, degrees.
    pub angles_deg: Vec<f64>,
    /// Factors at those angles.
    pub factors: Vec<f64>,
}

impl TiltTable {
    /// The factor at a mounting tilt, degrees: linear between the angles; `None` outside.
    pub fn factor_at(&self, tilt_deg: f64) -> Option<f64> {
        let high = self.angles_deg.iter().position(|&angle| angle >= tilt_deg)?;
        let node = |i: usize| Some((*self.angles_deg.get(i)?, *self.factors.get(i)?));
        let (angle, factor) = node(high)?;
        if angle == tilt_deg {
            return Some(factor);
        }
        let (before, factor_before) = node(high.checked_sub(1)?)?;
        let weight = (tilt_deg - before) / (angle - before);
        Some((1.0 - weight) * factor_before + weight * factor)
    }

    /// `0 to 90`: its angles.
    pub(crate) fn range(&self) -> String {
        let ends = (self.angles_deg.first(), self.angles_deg.last());
        format!("{} to {}", ends.0.copied().unwrap_or_default(), ends.1.copied().unwrap_or_default())
    }

    /// Least and greatest factor.
    pub(crate) fn factor_range(&self) -> (f64, f64) {
        self.factors.iter().fold((f64::MAX, f64::MIN), |(low, high), &f| (low.min(f), high.max(f)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn factors_are_linear_between_the_angles_and_none_outside() {
        let (angles_deg, factors) = (vec![0.0, 45.0, 90.0], vec![1.0, 0.9, 0.8]);
        let table = TiltTable { geometry: 1, angles_deg, factors };
        for (tilt_deg, factor) in [(0.0, 1.0), (45.0, 0.9), (90.0, 0.8)] {
            assert_eq!(table.factor_at(tilt_deg), Some(factor));
        }
        for (tilt_deg, factor) in [(22.5, 0.95), (9.0, 0.98), (60.0, 0.9 - 0.1 / 3.0)] {
            assert!((table.factor_at(tilt_deg).unwrap() - factor).abs() < 1e-15, "{tilt_deg}");
        }
        assert_eq!([-1.0, 90.5, f64::NAN].map(|tilt_deg| table.factor_at(tilt_deg)), [None; 3]);
        assert_eq!((table.range(), table.factor_range()), ("0 to 90".to_owned(), (0.8, 1.0)));
    }
}
