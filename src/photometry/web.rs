//! The photometric web: intensities over the angles of a file, its symmetry, and the intensity in any direction.
//!
//! The frame, in words (aim is the direction (V, H) = (0, 0), up what the scene says): type C tilts from the aim
//! by V, towards H counted counter-clockwise seen from above when the lamp aims down; types A and B have the aim at
//! their equator, V grows towards up, H towards aim x up; A turns by H about the V axis, B by V about the H axis.

use crate::error::{Diagnostic, Kind, Result};

/// The goniometer's coordinate system.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PhotometricType {
    /// Type A: headlamps; solid angle cos V dV dH.
    A,
    /// Type B: floodlights; solid angle cos H dV dH.
    B,
    /// Type C: indoor and road lighting; solid angle sin V dV dH.
    C,
}

impl PhotometricType {
    /// `A`, `B` or `C`.
    pub fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::C => "C",
        }
    }
}

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

/// What one stored axis stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Fold {
    /// As stored, zero outside.
    AsStored,
    /// Stored from 0; negative angles mirror it.
    MirrorZero,
    /// One angle stands for all of -90..90 (types A and B).
    Constant,
    /// One plane stands for the circle.
    Rotational,
    /// 0..90 stands for the circle.
    Quadrants,
    /// 0..180 stands for the circle.
    Mirror0,
    /// 90..270 stands for the circle.
    Mirror90,
    /// More than half the circle is stored; the last plane is joined to the first.
    Circle,
}

/// The axis of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Axis {
    Vertical,
    Horizontal,
}

/// Something to say about the angle `index` of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AxisNote {
    pub axis: Axis,
    pub index: usize,
    pub found: String,
    pub required: &'static str,
    pub hint: &'static str,
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

    pub(super) fn vertical_fold(&self) -> Fold {
        match self.photometric_type {
            PhotometricType::C => Fold::AsStored,
            _ => flat_fold(&self.vertical_deg),
        }
    }

    pub(super) fn horizontal_fold(&self) -> Fold {
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
        let mut best = (0, 0.0);
        for (i, &c) in self.candela.iter().enumerate() {
            if c > best.1 {
                best = (i, c);
            }
        }
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
struct Between {
    low: usize,
    high: usize,
    weight: f64,
}

/// The stored angles around `x` after folding; `None` outside.
fn place(fold: Fold, axis: &[f64], x: f64) -> Option<Between> {
    let turn = |x: f64| x.rem_euclid(360.0);
    match fold {
        Fold::AsStored => between(axis, x),
        Fold::MirrorZero => between(axis, x.abs()),
        Fold::Constant => (x.abs() <= 90.0).then_some(Between { low: 0, high: 0, weight: 0.0 }),
        Fold::Rotational => Some(Between { low: 0, high: 0, weight: 0.0 }),
        Fold::Mirror0 => between(axis, fold_0(turn(x))),
        Fold::Quadrants => {
            let x = fold_0(turn(x));
            between(axis, if x > 90.0 { 180.0 - x } else { x })
        }
        Fold::Mirror90 => {
            let x = turn(x);
            between(
                axis,
                if x < 90.0 {
                    180.0 - x
                } else if x > 270.0 {
                    540.0 - x
                } else {
                    x
                },
            )
        }
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
        return Some(Between { low: 0, high: 0, weight: 0.0 });
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

fn flat_fold(axis: &[f64]) -> Fold {
    match axis {
        [_] => Fold::Constant,
        [first, ..] if *first == 0.0 => Fold::MirrorZero,
        _ => Fold::AsStored,
    }
}

fn circle_fold(axis: &[f64]) -> Fold {
    match (axis.len(), axis.first(), axis.last()) {
        (1, ..) => Fold::Rotational,
        (_, Some(0.0), Some(90.0)) => Fold::Quadrants,
        (_, Some(0.0), Some(180.0)) => Fold::Mirror0,
        (_, Some(90.0), Some(270.0)) => Fold::Mirror90,
        _ => Fold::Circle,
    }
}

/// Checks the axes of a table: what is tolerated is returned as notes, the first thing that is not as the error.
pub(super) fn check_axes(
    photometric_type: PhotometricType,
    vertical_deg: &[f64],
    horizontal_deg: &[f64],
) -> std::result::Result<Vec<AxisNote>, AxisNote> {
    let mut notes = Vec::new();
    let v = AxisCheck { axis: Axis::Vertical, angles: vertical_deg };
    let h = AxisCheck { axis: Axis::Horizontal, angles: horizontal_deg };
    v.increasing()?;
    h.increasing()?;
    match photometric_type {
        PhotometricType::C => {
            v.check_vertical_c(&mut notes)?;
            h.check_horizontal_c(&mut notes)?;
        }
        PhotometricType::A => {
            v.check_flat(90.0, "angles within -90..90", &mut notes)?;
            h.check_flat(180.0, "angles within -180..180", &mut notes)?;
        }
        PhotometricType::B => {
            v.check_flat(180.0, "angles within -180..180", &mut notes)?;
            h.check_flat(90.0, "angles within -90..90", &mut notes)?;
        }
    }
    Ok(notes)
}

struct AxisCheck<'a> {
    axis: Axis,
    angles: &'a [f64],
}

impl AxisCheck<'_> {
    fn note(&self, index: usize, required: &'static str, hint: &'static str) -> AxisNote {
        let name = match self.axis {
            Axis::Vertical => "vertical",
            Axis::Horizontal => "horizontal",
        };
        let found = match self.angles.get(index) {
            Some(angle) => format!("{name} angle {angle}"),
            None => format!("no {name} angles"),
        };
        AxisNote { axis: self.axis, index, found, required, hint }
    }

    fn last(&self) -> usize {
        self.angles.len().saturating_sub(1)
    }

    fn increasing(&self) -> std::result::Result<(), AxisNote> {
        if self.angles.is_empty() {
            return Err(self.note(0, "at least one angle", ""));
        }
        if let Some(i) = self.angles.iter().position(|a| !a.is_finite()) {
            return Err(self.note(i, "a finite angle", ""));
        }
        match (1..self.angles.len()).find(|&i| self.angles[i] <= self.angles[i - 1]) {
            Some(i) => {
                let mut note = self.note(i, "angles in strictly increasing order", "");
                note.found = format!("{} after {}", note.found, self.angles[i - 1]);
                Err(note)
            }
            None => Ok(()),
        }
    }

    fn within(&self, low: f64, high: f64, required: &'static str) -> std::result::Result<(), AxisNote> {
        match self.angles.iter().position(|&a| !(a >= low && a <= high)) {
            Some(i) => Err(self.note(i, required, "")),
            None => Ok(()),
        }
    }

    fn check_vertical_c(&self, notes: &mut Vec<AxisNote>) -> std::result::Result<(), AxisNote> {
        const ENDS: &str = "vertical angles of type C over 0..90, 90..180 or 0..180";
        self.within(0.0, 180.0, "vertical angles of type C within 0..180")?;
        if self.angles.len() < 2 {
            return Err(self.note(0, "at least 2 vertical angles: one has no solid angle", ""));
        }
        if ![0.0, 90.0].contains(&self.angles[0]) {
            notes.push(self.note(0, ENDS, "the intensity is taken as zero below it"));
        }
        if ![90.0, 180.0].contains(&self.angles[self.last()]) {
            notes.push(self.note(self.last(), ENDS, "the intensity is taken as zero beyond it"));
        }
        Ok(())
    }

    fn check_horizontal_c(&self, notes: &mut Vec<AxisNote>) -> std::result::Result<(), AxisNote> {
        const RANGES: &str = "horizontal angles of type C: 0 alone, or over 0..90, 0..180, 90..270 or 0..360";
        self.within(0.0, 360.0, RANGES)?;
        let (first, last) = (self.angles[0], self.angles[self.last()]);
        if self.angles.len() == 1 {
            if first != 0.0 {
                notes.push(self.note(0, RANGES, "the one plane is taken for all horizontal angles"));
            }
            return Ok(());
        }
        if circle_fold(self.angles) != Fold::Circle {
            return Ok(());
        }
        if last - first <= 180.0 {
            return Err(self.note(self.last(), RANGES, ""));
        }
        let largest = self.angles.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        if first + 360.0 - last > 1.5 * largest {
            notes.push(self.note(self.last(), RANGES, "the circle is closed across the gap"));
        } else if first != 0.0 {
            notes.push(self.note(0, RANGES, "the circle is closed"));
        }
        Ok(())
    }

    fn check_flat(
        &self,
        most: f64,
        required: &'static str,
        notes: &mut Vec<AxisNote>,
    ) -> std::result::Result<(), AxisNote> {
        const ENDS: &str = "angles of types A and B over -90..90 or 0..90";
        self.within(-most, most, required)?;
        let (first, last) = (self.angles[0], self.angles[self.last()]);
        if self.angles.len() == 1 {
            notes.push(self.note(0, ENDS, "the one angle is taken for all of -90..90"));
            return Ok(());
        }
        if first != 0.0 && first != -90.0 {
            notes.push(self.note(0, ENDS, "the intensity is taken as zero below it"));
        }
        if last != 90.0 {
            notes.push(self.note(self.last(), ENDS, "the intensity is taken as zero beyond it"));
        }
        Ok(())
    }
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
    fn axes_outside_the_rules_are_refused_or_noted() {
        let refused = |t, v: &[f64], h: &[f64]| check_axes(t, v, h).unwrap_err();
        assert_eq!(refused(C, &[0.0, 45.0, 45.0], &[0.0]).index, 2);
        assert_eq!(refused(C, &[0.0, 190.0], &[0.0]).index, 1);
        assert_eq!(refused(C, &[-5.0, 90.0], &[0.0]).index, 0);
        assert_eq!(refused(C, &[0.0, 90.0], &[0.0, 45.0]).axis, Axis::Horizontal);
        assert_eq!(refused(C, &[0.0, 90.0], &[0.0, 400.0]).index, 1);
        assert_eq!(refused(C, &[0.0], &[0.0]).axis, Axis::Vertical);
        assert_eq!(refused(A, &[-100.0, 90.0], &[0.0, 90.0]).axis, Axis::Vertical);
        assert_eq!(refused(B, &[-90.0, 90.0], &[0.0, 100.0]).axis, Axis::Horizontal);
        assert_eq!(check_axes(C, &[0.0, 140.0], &[0.0]).unwrap().len(), 1);
        assert_eq!(check_axes(B, &[-90.0, 90.0], &[-90.0, 90.0]).unwrap().len(), 0);
        assert_eq!(check_axes(B, &[-20.0, 20.0], &[0.0]).unwrap().len(), 3);
        assert!(Web::new(C, vec![0.0, 90.0], vec![0.0], vec![1.0, f64::NAN]).is_err());
        assert!(Web::new(C, vec![0.0, 90.0], vec![0.0], vec![1.0]).is_err());
    }
}
