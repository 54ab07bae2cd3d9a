//! The axes of a table: what a range of stored angles stands for, and what ranges are allowed.

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
        ["A", "B", "C"][self as usize]
    }
}

/// What one stored axis stands for.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fold {
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
pub(crate) enum Axis {
    Vertical,
    Horizontal,
}

/// Something to say about the angle `index` of an axis.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct AxisNote {
    pub axis: Axis,
    pub index: usize,
    pub found: String,
    pub required: &'static str,
    pub hint: &'static str,
}

/// What an axis of type A or B stands for.
pub(crate) fn flat_fold(axis: &[f64]) -> Fold {
    match axis {
        [_] => Fold::Constant,
        [first, ..] if *first == 0.0 => Fold::MirrorZero,
        _ => Fold::AsStored,
    }
}

/// What the horizontal axis of type C stands for.
pub(crate) fn circle_fold(axis: &[f64]) -> Fold {
    match (axis.len(), axis.first(), axis.last()) {
        (1, ..) => Fold::Rotational,
        (_, Some(0.0), Some(90.0)) => Fold::Quadrants,
        (_, Some(0.0), Some(180.0)) => Fold::Mirror0,
        (_, Some(90.0), Some(270.0)) => Fold::Mirror90,
        _ => Fold::Circle,
    }
}

/// Checks the axes of a table: what is tolerated is returned as notes, the first thing that is not as the error.
pub(crate) fn check_axes(
    photometric_type: PhotometricType,
    vertical_deg: &[f64],
    horizontal_deg: &[f64],
) -> Result<Vec<AxisNote>, AxisNote> {
    let mut v = AxisCheck { axis: Axis::Vertical, angles: vertical_deg, notes: Vec::new() };
    let mut h = AxisCheck { axis: Axis::Horizontal, angles: horizontal_deg, notes: Vec::new() };
    v.increasing()?;
    h.increasing()?;
    match photometric_type {
        PhotometricType::C => {
            v.check_vertical_c()?;
            h.check_horizontal_c()?;
        }
        PhotometricType::A => {
            v.check_flat(90.0, "angles within -90..90")?;
            h.check_flat(180.0, "angles within -180..180")?;
        }
        PhotometricType::B => {
            v.check_flat(180.0, "angles within -180..180")?;
            h.check_flat(90.0, "angles within -90..90")?;
        }
    }
    v.notes.append(&mut h.notes);
    Ok(v.notes)
}

struct AxisCheck<'a> {
    axis: Axis,
    angles: &'a [f64],
    /// What is tolerated.
    notes: Vec<AxisNote>,
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

    fn tolerate(&mut self, index: usize, required: &'static str, hint: &'static str) {
        self.notes.push(self.note(index, required, hint));
    }

    fn last(&self) -> usize {
        self.angles.len().saturating_sub(1)
    }

    fn increasing(&self) -> Result<(), AxisNote> {
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

    fn within(&self, low: f64, high: f64, required: &'static str) -> Result<(), AxisNote> {
        match self.angles.iter().position(|&a| !(a >= low && a <= high)) {
            Some(i) => Err(self.note(i, required, "")),
            None => Ok(()),
        }
    }

    fn check_vertical_c(&mut self) -> Result<(), AxisNote> {
        const ENDS: &str = "vertical angles of type C over 0..90, 90..180 or 0..180";
        self.within(0.0, 180.0, "vertical angles of type C within 0..180")?;
        if self.angles.len() < 2 {
            return Err(self.note(0, "at least 2 vertical angles: one has no solid angle", ""));
        }
        if ![0.0, 90.0].contains(&self.angles[0]) {
            self.tolerate(0, ENDS, "the intensity is taken as zero below it");
        }
        if ![90.0, 180.0].contains(&self.angles[self.last()]) {
            self.tolerate(self.last(), ENDS, "the intensity is taken as zero beyond it");
        }
        Ok(())
    }

    fn check_horizontal_c(&mut self) -> Result<(), AxisNote> {
        const RANGES: &str = "horizontal angles of type C: 0 alone, or over 0..90, 0..180, 90..270 or 0..360";
        self.within(0.0, 360.0, RANGES)?;
        let (first, last) = (self.angles[0], self.angles[self.last()]);
        if self.angles.len() == 1 {
            if first != 0.0 {
                self.tolerate(0, RANGES, "the one plane is taken for all horizontal angles");
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
            self.tolerate(self.last(), RANGES, "the circle is closed across the gap");
        } else if first != 0.0 {
            self.tolerate(0, RANGES, "the circle is closed");
        }
        Ok(())
    }

    fn check_flat(&mut self, most: f64, required: &'static str) -> Result<(), AxisNote> {
        const ENDS: &str = "angles of types A and B over -90..90 or 0..90";
        self.within(-most, most, required)?;
        let (first, last) = (self.angles[0], self.angles[self.last()]);
        if self.angles.len() == 1 {
            self.tolerate(0, ENDS, "the one angle is taken for all of -90..90");
            return Ok(());
        }
        if ![0.0, -90.0, -most].contains(&first) {
            self.tolerate(0, ENDS, "the intensity is taken as zero below it");
        }
        if ![90.0, most].contains(&last) {
            self.tolerate(self.last(), ENDS, "the intensity is taken as zero beyond it");
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use PhotometricType::{A, B, C};

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
    }
}
