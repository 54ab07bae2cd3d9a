//! Luminous opening: the shape and size a file gives to the part of a luminaire that shines.
//!
//! EULUMDAT has a rectangle or a circle with heights. An LM-63 file writes width, length and height, and codes the shape in their signs: two codes, that of 1995 (a circle is
//! one negative number) and that of 2002 (two). Both occur under every version line, so both are read everywhere;
//! where they clash the revision decides. The tracer uses the size only as information: the photometric web is that
//! of a point.

use super::Revision;
use crate::units::METRES_PER_FOOT;
use std::fmt;

/// Shape of a luminous opening.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum OpeningShape {
    /// No extent.
    Point,
    /// Flat, facing down.
    Rectangle,
    /// Flat and upright: width or length is 0.
    VerticalRectangle,
    /// A box with luminous sides.
    Box,
    /// Circle facing down.
    Disk,
    /// Ellipse facing down.
    Ellipse,
    /// Upright cylinder.
    VerticalCylinder,
    /// Upright cylinder over an ellipse.
    VerticalEllipticalCylinder,
    /// Sphere.
    Sphere,
    /// Ellipsoid.
    Ellipsoid,
    /// Lying cylinder, its axis along H = 0.
    HorizontalCylinderAlong,
    /// Lying cylinder, its axis across H = 0.
    HorizontalCylinderAcross,
    /// Circle or ellipse facing H = 0.
    VerticalDisk,
    /// The box around a combination of signs that no edition defines.
    BoundingBox,
}

impl OpeningShape {
    /// Name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Rectangle => "rectangle",
            Self::VerticalRectangle => "vertical rectangle",
            Self::Box => "box",
            Self::Disk => "disk",
            Self::Ellipse => "ellipse",
            Self::VerticalCylinder => "vertical cylinder",
            Self::VerticalEllipticalCylinder => "vertical elliptical cylinder",
            Self::Sphere => "sphere",
            Self::Ellipsoid => "ellipsoid",
            Self::HorizontalCylinderAlong => "horizontal cylinder along H = 0",
            Self::HorizontalCylinderAcross => "horizontal cylinder across H = 0",
            Self::VerticalDisk => "vertical disk facing H = 0",
            Self::BoundingBox => "bounding box",
        }
    }
}

impl fmt::Display for OpeningShape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// Shape and size of a luminous opening.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LuminousOpening {
    /// The shape.
    pub shape: OpeningShape,
    /// Extent of its bounding box in metres: width (across H = 0), length (along H = 0), height.
    pub size_m: [f64; 3],
    /// EULUMDAT: luminous heights towards C0, C90, C180 and C270, m. `None` in LM-63, whose height is the same all round.
    pub heights_m: Option<[f64; 4]>,
}

impl LuminousOpening {
    /// The opening of a file's width, length and height, in feet or metres, and whether the signs are in a table
    /// of the standard (NREL/Radiance `ies2rad.c`, `makeiesshape`, for the editions).
    pub fn from_fields(fields: [f64; 3], feet: bool, revision: Revision) -> (Self, bool) {
        let unit = if feet { METRES_PER_FOOT } else { 1.0 };
        let [w, l, h] = fields.map(|x| x.abs() * unit);
        let equal = fields[0].abs() == fields[1].abs();
        let early = revision <= Revision::Y1995;
        use OpeningShape::*;
        let round = |circle, ellipse| if equal { circle } else { ellipse };
        let (shape, size_m, defined) = match fields.map(sign) {
            ['0', '0', '0'] => (Point, [0.0; 3], true),
            ['+', '+', '0'] => (Rectangle, [w, l, 0.0], true),
            ['+', '+', '+'] => (Box, [w, l, h], true),
            ['+', '0', '+'] | ['0', '+', '+'] => (VerticalRectangle, [w, l, h], true),
            ['-', '0', '0'] => (Disk, [w, w, 0.0], true),
            // Some 2002 files put the diameter into the length: written so by the same exporters as the line above.
            ['0', '-', '0'] => (Disk, [l, l, 0.0], false),
            ['-', '-', '0'] => (round(Disk, Ellipse), [w, l, 0.0], true),
            ['-', '+', '0'] | ['+', '-', '0'] => (Ellipse, [w, l, 0.0], early),
            ['-', '0', '+'] => (VerticalCylinder, [w, w, h], true),
            ['0', '-', '+'] => (VerticalCylinder, [l, l, h], false),
            ['-', '-', '+'] => (round(VerticalCylinder, VerticalEllipticalCylinder), [w, l, h], true),
            ['-', '+', '+'] if revision <= Revision::Y1991 => (Ellipsoid, [w, l, h], true),
            ['-', '+', '+'] | ['+', '-', '+'] => (VerticalEllipticalCylinder, [w, l, h], early),
            ['-', '0', '-'] if early => (round_ball(w, h), [w, w, h], true),
            ['-', '0', '-'] => (VerticalDisk, [w, 0.0, h], true),
            ['0', '-', '-'] => (VerticalDisk, [l, 0.0, h], false),
            ['-', '-', '-'] => (if equal { round_ball(w, h) } else { Ellipsoid }, [w, l, h], true),
            ['-', '+', '-'] | ['+', '-', '-'] if early => (Ellipsoid, [w, l, h], true),
            ['-', '+', '-'] => (HorizontalCylinderAlong, [w, l, h], true),
            ['+', '-', '-'] => (HorizontalCylinderAcross, [w, l, h], true),
            ['0', '+', '-'] => (HorizontalCylinderAlong, [h, l, h], true),
            ['+', '0', '-'] => (HorizontalCylinderAcross, [w, h, h], true),
            _ => (BoundingBox, [w, l, h], false),
        };
        (Self { shape, size_m, heights_m: None }, defined)
    }

    /// The opening of EULUMDAT's luminous area: length (along C90-C270) or diameter, width (along C0-C180; 0 where it is
    /// round), and the luminous heights towards C0, C90, C180 and C270, all in metres.
    pub fn from_eulumdat([length, width]: [f64; 2], heights_m: [f64; 4]) -> Self {
        use OpeningShape::*;
        let height = heights_m.into_iter().fold(0.0, f64::max);
        let (shape, across, along) = match [length, width, height].map(|x| x > 0.0) {
            [false, false, false] => (Point, 0.0, 0.0),
            [true, false, false] => (Disk, length, length),
            [true, false, true] => (VerticalCylinder, length, length),
            [true, true, false] => (Rectangle, length, width),
            [true, true, true] => (Box, length, width),
            [false, true, true] => (VerticalRectangle, length, width),
            [false, ..] => (BoundingBox, length, width),
        };
        Self { shape, size_m: [across, along, height], heights_m: Some(heights_m) }
    }
}

fn round_ball(diameter: f64, height: f64) -> OpeningShape {
    if diameter == height { OpeningShape::Sphere } else { OpeningShape::Ellipsoid }
}

/// The sign of a field as the tables of the standard write it.
pub fn sign(x: f64) -> char {
    if x > 0.0 {
        '+'
    } else if x < 0.0 {
        '-'
    } else {
        '0'
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use OpeningShape::*;

    fn shape(fields: [f64; 3], revision: Revision) -> (OpeningShape, [f64; 3], bool) {
        let (opening, defined) = LuminousOpening::from_fields(fields, false, revision);
        (opening.shape, opening.size_m, defined)
    }

    #[test]
    fn the_tables_of_1995_and_2002() {
        let (old, new) = (Revision::Y1995, Revision::Y2002);
        for (fields, revision, expected, size) in [
            ([0.0, 0.0, 0.0], new, Point, [0.0, 0.0, 0.0]),
            ([1.0, 2.0, 0.0], new, Rectangle, [1.0, 2.0, 0.0]),
            ([1.0, 2.0, 3.0], new, Box, [1.0, 2.0, 3.0]),
            ([1.0, 0.0, 3.0], new, VerticalRectangle, [1.0, 0.0, 3.0]),
            ([-1.0, 0.0, 0.0], old, Disk, [1.0, 1.0, 0.0]),
            ([-1.0, 0.0, 0.0], new, Disk, [1.0, 1.0, 0.0]),
            ([-1.0, -1.0, 0.0], new, Disk, [1.0, 1.0, 0.0]),
            ([-1.0, -2.0, 0.0], new, Ellipse, [1.0, 2.0, 0.0]),
            ([-1.0, 2.0, 0.0], Revision::Y1986, Ellipse, [1.0, 2.0, 0.0]),
            ([-1.0, 0.0, 3.0], old, VerticalCylinder, [1.0, 1.0, 3.0]),
            ([-1.0, -1.0, 3.0], new, VerticalCylinder, [1.0, 1.0, 3.0]),
            ([-1.0, -2.0, 3.0], new, VerticalEllipticalCylinder, [1.0, 2.0, 3.0]),
            ([-1.0, 2.0, 3.0], old, VerticalEllipticalCylinder, [1.0, 2.0, 3.0]),
            ([-1.0, 2.0, 3.0], Revision::Y1991, Ellipsoid, [1.0, 2.0, 3.0]),
            ([-1.0, 0.0, -1.0], old, Sphere, [1.0, 1.0, 1.0]),
            ([-1.0, 0.0, -1.0], new, VerticalDisk, [1.0, 0.0, 1.0]),
            ([-1.0, -1.0, -1.0], new, Sphere, [1.0, 1.0, 1.0]),
            ([-1.0, -2.0, -3.0], new, Ellipsoid, [1.0, 2.0, 3.0]),
            ([-1.0, 2.0, -3.0], old, Ellipsoid, [1.0, 2.0, 3.0]),
            ([0.0, 2.0, -1.0], old, HorizontalCylinderAlong, [1.0, 2.0, 1.0]),
            ([2.0, 0.0, -1.0], old, HorizontalCylinderAcross, [2.0, 1.0, 1.0]),
            ([-1.0, 2.0, -1.0], new, HorizontalCylinderAlong, [1.0, 2.0, 1.0]),
            ([2.0, -1.0, -1.0], new, HorizontalCylinderAcross, [2.0, 1.0, 1.0]),
        ] {
            assert_eq!(shape(fields, revision), (expected, size, true), "{fields:?} {revision:?}");
        }
    }

    #[test]
    fn eulumdat_has_length_across_and_width_along() {
        let of = |area, heights| {
            let opening = LuminousOpening::from_eulumdat(area, heights);
            assert_eq!(opening.heights_m, Some(heights));
            (opening.shape, opening.size_m)
        };
        let (flat, high) = ([0.0; 4], [0.1, 0.2, 0.1, 0.3]);
        assert_eq!(of([0.0, 0.0], flat), (Point, [0.0; 3]));
        assert_eq!(of([1.1, 0.2], flat), (Rectangle, [1.1, 0.2, 0.0]));
        assert_eq!(of([1.1, 0.2], high), (Box, [1.1, 0.2, 0.3]));
        assert_eq!(of([0.4, 0.0], flat), (Disk, [0.4, 0.4, 0.0]));
        assert_eq!(of([0.4, 0.0], high), (VerticalCylinder, [0.4, 0.4, 0.3]));
        assert_eq!(of([0.0, 0.4], high), (VerticalRectangle, [0.0, 0.4, 0.3]));
        assert_eq!(of([0.0, 0.4], flat), (BoundingBox, [0.0, 0.4, 0.0]));
    }

    #[test]
    fn unknown_signs_are_a_box_and_feet_are_metres() {
        assert_eq!(shape([0.0, 0.0, -2.0], Revision::Y2002), (BoundingBox, [0.0, 0.0, 2.0], false));
        assert_eq!(shape([1.0, 1.0, -2.0], Revision::Y2002), (BoundingBox, [1.0, 1.0, 2.0], false));
        let (opening, _) = LuminousOpening::from_fields([1.0, 2.0, 0.0], true, Revision::Y2002);
        assert_eq!(opening.size_m, [0.3048, 0.6096, 0.0]);
    }
}
