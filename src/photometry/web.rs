//! The photometric web: intensities over the angles of a file, its symmetry, and the intensity in any direction.
//!
//! The frame, in words (aim is the direction (V, H) = (0, 0), up what the scene says): type C tilts from the aim
//! by V, towards H counted counter-clockwise seen from above when the lamp aims down; types A and B have the aim at
//! their equator, V grows towards up, H towards aim x up; A turns by H about the V axis, B by V about the H axis.

pub use super::axes::PhotometricType;
use super::axes::{Fold, check_axes, circle_fold, flat_fold};
use crate::error::{Diagnostic, Kind, Result};

/// How the stored planes stand for the sphere.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Symmetry {
    /// One plane for all H (type C).
    Rotational,
    /// H = 0..90, mirrored into four quadrants (type C).
    Quadrants,
    /// H = 0..180, mirrored in the 0-180 plane (type C).
    Bilateral0To180,
    /// H = 90..270, mirrored in the 90-270 plane (type C).
    Bilateral90To270,
    /// H from 0, mirrored left to right (types A and B).
    LeftRight,
    /// V from 0, mirrored up to down (types A and B).
    UpDown,
    /// Both of the last two.
    LeftRightUpDown,
    /// Stored as it is.
    None,
}

impl Symmetry {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Rotational => "rotational",
            Self::Quadrants => "quadrants",
            Self::Bilateral0To180 => "bilateral 0-180",
            Self::Bilateral90To270 => "bilateral 90-270",
            Self::LeftRight => "left-right",
            Self::UpDown => "up-down",
            Self::LeftRightUpDown => "left-right and up-down",
            Self::None => "none",
        }
    }
}

/// Intensities of a luminaire over vertical and horizontal angles.
///
/// Plain data; [`Web::new`] checks it, and a web that was not checked gives numbers without meaning but no panic
/// as long as `candela` holds `horizontal_deg.len() * vertical_deg.len()` values.
#[derive(Debug, Clone, PartialEq)]
pub struct Web {
    /// The coordinate system.
    pub photometric_type: PhotometricType,
    /// Stored vertical angles V, degrees, strictly increasing.
    pub vertical_deg: Vec<f64>,
    /// Stored horizontal angles H, degrees, strictly increasing.
    pub horizontal_deg: Vec<f64>,
    /// Intensities, cd, value x multiplier: `[h * n_v + v]`.
    pub candela: Vec<f64>,
}

/// The largest intensity of a web and where it is.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaxIntensity {
    /// Candela.
    pub intensity_cd: f64,
    /// V of the first such node, degrees.
    pub vertical_deg: f64,
    /// H of the first such node, degrees.
    pub horizontal_deg: f64,
}

impl Web {
    /// Checks the axes and values of a web.
    ///
    /// # Errors
    /// [`Kind::Range`] for angles that do not increase or lie outside what the type allows, for a table of the
    /// wrong size, and for intensities that are negative or not finite.
    pub fn new(
        photometric_type: PhotometricType,
        vertical_deg: Vec<f64>,
        horizontal_deg: Vec<f64>,
        candela: Vec<f64>,
    ) -> Result<Self> {
        if let Err(note) = check_axes(photometric_type, &vertical_deg, &horizontal_deg) {
            return Err(Diagnostic::new(Kind::Range, note.found, note.required));
        }
        if Some(candela.len()) != vertical_deg.len().checked_mul(horizontal_deg.len()) {
            let required = format!("{} x {}", horizontal_deg.len(), vertical_deg.len());
            return Err(Diagnostic::new(Kind::Range, format!("{} intensities", candela.len()), required));
        }
        if let Some(bad) = candela.iter().find(|&&c| !(c >= 0.0 && c.is_finite())) {
            return Err(Diagnostic::new(Kind::Range, format!("{bad} cd"), "a finite intensity, 0 or more"));
        }
        Ok(Self { photometric_type, vertical_deg, horizontal_deg, candela })
    }

    pub(crate) fn vertical_fold(&self) -> Fold {
        match self.photometric_type {
            PhotometricType::C => Fold::AsStored,
            _ => flat_fold(&self.vertical_deg),
        }
    }

    pub(crate) fn horizontal_fold(&self) -> Fold {
        match self.photometric_type {
            PhotometricType::C => circle_fold(&self.horizontal_deg),
            _ => flat_fold(&self.horizontal_deg),
        }
    }

    /// How the stored planes stand for the sphere.
    pub fn symmetry(&self) -> Symmetry {
        match (self.horizontal_fold(), self.vertical_fold()) {
            (Fold::Rotational, _) => Symmetry::Rotational,
            (Fold::Quadrants, _) => Symmetry::Quadrants,
            (Fold::Mirror0, _) => Symmetry::Bilateral0To180,
            (Fold::Mirror90, _) => Symmetry::Bilateral90To270,
            (Fold::MirrorZero, Fold::MirrorZero) => Symmetry::LeftRightUpDown,
            (Fold::MirrorZero, _) => Symmetry::LeftRight,
            (_, Fold::MirrorZero) => Symmetry::UpDown,
            _ => Symmetry::None,
        }
    }

    /// The largest stored intensity; of equal ones the first in the file.
    pub fn max_intensity(&self) -> MaxIntensity {
        let n_v = self.vertical_deg.len().max(1);
        let larger = |best: (usize, f64), (i, &c): (usize, &f64)| if c > best.1 { (i, c) } else { best };
        let best = self.candela.iter().enumerate().fold((0, 0.0), larger);
        let angle = |axis: &[f64], i: usize| axis.get(i).copied().unwrap_or(0.0);
        MaxIntensity {
            intensity_cd: best.1,
            vertical_deg: angle(&self.vertical_deg, best.0 % n_v),
            horizontal_deg: angle(&self.horizontal_deg, best.0 / n_v),
        }
    }

    /// Intensity (cd, without [`super::Photometry::factor`]) in the direction (V, H), degrees: bilinear between the
    /// stored angles (Dmitriev, "From Monte Carlo to quasi-Monte Carlo", eq. 7), mirrored by the symmetry, zero
    /// outside the stored range. H of type C is taken modulo 360; V of type C runs from 0 to 180, the angles of types
    /// A and B from -180 to 180.
    pub fn intensity_cd(&self, vertical_deg: f64, horizontal_deg: f64) -> f64 {
        let v = place(self.vertical_fold(), &self.vertical_deg, vertical_deg);
        let h = place(self.horizontal_fold(), &self.horizontal_deg, horizontal_deg);
        let (Some(v), Some(h)) = (v, h) else {
            return 0.0;
        };
        self.blended(v, h)
    }

    /// The intensity between stored angles, cd.
    pub(super) fn blended(&self, v: Between, h: Between) -> f64 {
        let n_v = self.vertical_deg.len();
        let along_v = |plane: usize| {
            let row = plane * n_v;
            blend(self.candela[row + v.low], self.candela[row + v.high], v.weight)
        };
        blend(along_v(h.low), along_v(h.high), h.weight)
    }
}

/// The value at `weight` of the way from `a` to `b`; exactly `a` and `b` at the ends.
fn blend(a: f64, b: f64, weight: f64) -> f64 {
    (1.0 - weight) * a + weight * b
}

/// Between which stored angles a direction lies.
#[derive(Debug, Clone, Copy)]
pub(super) struct Between {
    pub low: usize,
    pub high: usize,
    pub weight: f64,
}

impl Between {
    /// At a stored angle.
    pub(super) fn node(index: usize) -> Self {
        Self { low: index, high: index, weight: 0.0 }
    }
}

/// The stored angles around `x` after folding; `None` outside.
fn place(fold: Fold, axis: &[f64], x: f64) -> Option<Between> {
    let turn = |x: f64| x.rem_euclid(360.0);
    match fold {
        Fold::AsStored => between(axis, x),
        Fold::MirrorZero => between(axis, x.abs()),
        Fold::Constant => (x.abs() <= 90.0).then_some(Between::node(0)),
        Fold::Rotational => Some(Between::node(0)),
        Fold::Mirror0 => between(axis, fold_0(turn(x))),
        Fold::Quadrants => {
            let x = fold_0(turn(x));
            between(axis, if x > 90.0 { 180.0 - x } else { x })
        }
        Fold::Mirror90 => match turn(x) {
            x if x < 90.0 => between(axis, 180.0 - x),
            x if x > 270.0 => between(axis, 540.0 - x),
            x => between(axis, x),
        },
        Fold::Circle => between(axis, turn(x)).or_else(|| across_the_end(axis, turn(x))),
    }
}

fn fold_0(x: f64) -> f64 {
    if x > 180.0 { 360.0 - x } else { x }
}

fn between(axis: &[f64], x: f64) -> Option<Between> {
    let (first, last) = (*axis.first()?, *axis.last()?);
    if !(x >= first && x <= last) {
        return None;
    }
    if axis.len() == 1 {
        return Some(Between::node(0));
    }
    let high = axis.partition_point(|&a| a <= x).clamp(1, axis.len() - 1);
    let low = high - 1;
    Some(Between { low, high, weight: (x - axis[low]) / (axis[high] - axis[low]) })
}

/// Between the last plane and the first one, a turn further.
fn across_the_end(axis: &[f64], x: f64) -> Option<Between> {
    let (first, last) = (*axis.first()?, *axis.last()?);
    let gap = first + 360.0 - last;
    let beyond = if x >= last { x - last } else { x + 360.0 - last };
    (gap > 0.0 && x.is_finite()).then(|| Between { low: axis.len() - 1, high: 0, weight: beyond / gap })
}

#[cfg(test)]
mod tests {
    use super::*;
    use PhotometricType::{A, B, C};

    /// A web whose value at stored (V, H) is 1000 + 7 V + H: linear, so interpolation is exact inside the range.
    fn plane(t: PhotometricType, v: &[f64], h: &[f64]) -> Web {
        let candela = h.iter().flat_map(|h| v.iter().map(move |v| 2000.0 + 7.0 * v + h)).collect();
        Web::new(t, v.to_vec(), h.to_vec(), candela).unwrap()
    }

    #[test]
    fn symmetries_mirror_where_they_say() {
        let v = [0.0, 40.0, 90.0];
        for (h, symmetry, pairs) in [
            (vec![0.0], Symmetry::Rotational, vec![(123.0, 0.0)]),
            (
                vec![0.0, 30.0, 90.0],
                Symmetry::Quadrants,
                vec![(20.0, 20.0), (160.0, 20.0), (200.0, 20.0), (-20.0, 20.0)],
            ),
            (
                vec![0.0, 30.0, 180.0],
                Symmetry::Bilateral0To180,
                vec![(150.0, 150.0), (210.0, 150.0), (-10.0, 10.0)],
            ),
            (
                vec![90.0, 100.0, 270.0],
                Symmetry::Bilateral90To270,
                vec![(95.0, 95.0), (80.0, 100.0), (280.0, 260.0), (0.0, 180.0)],
            ),
            (vec![0.0, 100.0, 360.0], Symmetry::None, vec![(310.0, 310.0), (-50.0, 310.0)]),
        ] {
            let web = plane(C, &v, &h);
            assert_eq!(web.symmetry(), symmetry);
            for (asked, stored) in pairs {
                let expected = 2000.0 + 7.0 * 25.0 + stored;
                let got = web.intensity_cd(25.0, asked);
                assert!((got - expected).abs() <= 1e-12 * expected, "{symmetry:?} {asked}: {got} {expected}");
            }
            assert_eq!(web.intensity_cd(90.5, 0.0), 0.0, "zero beyond the last angle");
        }
        let web = plane(B, &[0.0, 90.0], &[-30.0, 60.0]);
        assert_eq!(web.symmetry(), Symmetry::UpDown);
        assert_eq!(web.intensity_cd(-45.0, 15.0), web.intensity_cd(45.0, 15.0));
        assert_eq!(web.intensity_cd(45.0, -31.0), 0.0);
        assert_eq!(plane(A, &[0.0, 90.0], &[0.0, 60.0]).symmetry(), Symmetry::LeftRightUpDown);
        assert_eq!(plane(A, &[-9.0, 90.0], &[0.0, 60.0]).symmetry(), Symmetry::LeftRight);
    }

    #[test]
    fn the_circle_is_closed_between_the_last_and_the_first_plane() {
        let h: Vec<f64> = (0..24).map(|i| f64::from(i) * 15.0).collect();
        let web = plane(C, &[0.0, 90.0], &h);
        // Between H = 345 and H = 360, which is H = 0.
        let expected = 2000.0 + 345.0 * 2.0 / 3.0;
        assert!((web.intensity_cd(0.0, 350.0) - expected).abs() < 1e-9);
        assert!(check_axes(C, &[0.0, 90.0], &h).unwrap().is_empty());
        let web = plane(C, &[0.0, 90.0], &[5.0, 125.0, 245.0]);
        assert!((web.intensity_cd(0.0, 0.0) - (2005.0 + 240.0 / 24.0)).abs() < 1e-9);
        assert_eq!(check_axes(C, &[0.0, 90.0], &[5.0, 125.0, 245.0]).unwrap().len(), 1);
    }

    #[test]
    fn a_web_is_checked() {
        assert!(Web::new(C, vec![0.0, 90.0], vec![0.0], vec![1.0, f64::NAN]).is_err());
        assert!(Web::new(C, vec![0.0, 90.0], vec![0.0], vec![1.0]).is_err());
        assert!(Web::new(C, vec![0.0, 90.0, 45.0], vec![0.0], vec![1.0; 3]).is_err());
    }
}
