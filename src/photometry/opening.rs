//! Luminous opening: the shape and size an LM-63 file gives to the part of a luminaire that shines.
//!
//! A file writes width, length and height, and codes the shape in their signs: two codes, that of 1995 (a circle is
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

    /// Width, length and height in metres with the signs of LM-63-2002 (and 2019): what [`Self::from_fields`] reads.
    pub fn fields(&self) -> [f64; 3] {
        use OpeningShape::*;
        let [w, l, h] = self.size_m;
        match self.shape {
            Point => [0.0; 3],
            Rectangle | VerticalRectangle | Box | BoundingBox => [w, l, h],
            Disk => [-w, -w, 0.0],
            Ellipse => [-w, -l, 0.0],
            VerticalCylinder => [-w, -w, h],
            VerticalEllipticalCylinder => [-w, -l, h],
            Sphere => [-w, -w, -w],
            Ellipsoid => [-w, -l, -h],
            HorizontalCylinderAlong => [-w, l, -h],
            HorizontalCylinderAcross => [w, -l, -h],
            VerticalDisk => [-w, 0.0, -h],
        }
    }

    /// EULUMDAT's luminous area, length (across H = 0) and width (along it; 0 where it is round), and its heights towards C0, C90,
    /// C180 and C270, m; and what it has no shape for.
    pub fn eulumdat_sizes(&self) -> ([f64; 2], [f64; 4], Option<&'static str>) {
        use OpeningShape::*;
        let [w, l, h] = self.size_m;
        let heights_m = self.heights_m.unwrap_or([h; 4]);
        match self.shape {
            Disk | VerticalCylinder => ([w, 0.0], heights_m, None),
            Sphere => {
                ([w, 0.0], heights_m, Some("EULUMDAT has no spheres: the opening is written as a cylinder"))
            }
            Point | Rectangle | Box => ([w, l], heights_m, None),
            // A width of 0 would be a circle.
            _ if w > 0.0 && l == 0.0 => {
                let note = "EULUMDAT has no upright openings along C90: it is written 1 mm wide";
                ([w, 1e-3], heights_m, Some(note))
            }
            VerticalRectangle | BoundingBox => ([w, l], heights_m, None),
            _ => (
                [w, l],
                heights_m,
                Some("EULUMDAT has rectangles and circles: the opening is written as its bounding box"),
            ),
        }
    }

    /// The opening turned about the axis with its table: what was towards H is towards H + `by_deg`. `None` where it has no shape
    /// for that: what is not round turns by multiples of 90 degrees, an upright disk by 180.
    pub fn turned(&self, by_deg: f64) -> Option<Self> {
        use OpeningShape::*;
        let is_even = self.heights_m.is_none_or(|heights| heights.iter().all(|&h| h == heights[0]));
        if is_even && matches!(self.shape, Point | Disk | VerticalCylinder | Sphere) {
            return Some(*self);
        }
        let quarters = by_deg.rem_euclid(360.0) / 90.0;
        if quarters.fract() != 0.0 {
            return None;
        }
        let quarters = quarters as usize;
        let heights_m =
            self.heights_m.map(|heights| std::array::from_fn(|i| heights[(i + 4 - quarters) % 4]));
        let is_across = quarters % 2 == 1;
        let shape = match self.shape {
            VerticalDisk if is_across => return None,
            HorizontalCylinderAlong if is_across => HorizontalCylinderAcross,
            HorizontalCylinderAcross if is_across => HorizontalCylinderAlong,
            shape => shape,
        };
        let [w, l, h] = self.size_m;
        Some(Self { shape, size_m: if is_across { [l, w, h] } else { [w, l, h] }, heights_m })
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
    fn unknown_signs_are_a_box_and_feet_are_metres() {
        assert_eq!(shape([0.0, 0.0, -2.0], Revision::Y2002), (BoundingBox, [0.0, 0.0, 2.0], false));
        assert_eq!(shape([1.0, 1.0, -2.0], Revision::Y2002), (BoundingBox, [1.0, 1.0, 2.0], false));
        let (opening, _) = LuminousOpening::from_fields([1.0, 2.0, 0.0], true, Revision::Y2002);
        assert_eq!(opening.size_m, [0.3048, 0.6096, 0.0]);
    }

    #[test]
    fn what_is_written_is_read_again() {
        for (shape, size_m) in [
            (Point, [0.0; 3]),
            (Rectangle, [0.3, 1.2, 0.0]),
            (VerticalRectangle, [0.3, 0.0, 0.1]),
            (Box, [0.3, 1.2, 0.1]),
            (Disk, [0.3, 0.3, 0.0]),
            (Ellipse, [0.3, 1.2, 0.0]),
            (VerticalCylinder, [0.3, 0.3, 0.1]),
            (VerticalEllipticalCylinder, [0.3, 1.2, 0.1]),
            (Sphere, [0.3, 0.3, 0.3]),
            (Ellipsoid, [0.3, 1.2, 0.1]),
            (HorizontalCylinderAlong, [0.3, 1.2, 0.3]),
            (HorizontalCylinderAcross, [1.2, 0.3, 0.3]),
            (VerticalDisk, [0.3, 0.0, 0.3]),
        ] {
            let opening = LuminousOpening { shape, size_m, heights_m: None };
            assert_eq!(
                LuminousOpening::from_fields(opening.fields(), false, Revision::Y2002),
                (opening, true)
            );
            // Seen from where it was turned to, it is what it was.
            for by_deg in [-90.0, 90.0, 180.0, 270.0] {
                let Some(turned) = opening.turned(by_deg) else {
                    assert_eq!((shape, by_deg % 180.0 == 0.0), (VerticalDisk, false));
                    continue;
                };
                let (was, is) = (opening.projected_m2(70.0, 25.0), turned.projected_m2(70.0, 25.0 + by_deg));
                assert!((was - is).abs() <= 1e-12, "{shape:?} {by_deg}: {was} {is}");
            }
            let is_round = matches!(shape, Point | Disk | VerticalCylinder | Sphere);
            assert_eq!(opening.turned(45.0).is_some(), is_round, "{shape:?}");
        }
        let heights_m = Some([0.1, 0.2, 0.3, 0.4]);
        let opening = LuminousOpening { shape: Box, size_m: [0.3, 1.2, 0.4], heights_m };
        let turned = opening.turned(90.0).unwrap();
        assert_eq!((turned.size_m, turned.heights_m), ([1.2, 0.3, 0.4], Some([0.4, 0.1, 0.2, 0.3])));
    }
}
