//! Luminous openings as both formats write them, and turned with their table.

use super::LuminousOpening;
use super::opening::OpeningShape;

impl LuminousOpening {
    /// Width, length and height in metres with the signs of LM-63-2002 (and 2019): what [`Self::from_fields`]
    /// reads.
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

    /// EULUMDAT's luminous area, length (across H = 0) and width (along it; 0 where it is round), and its
    /// heights towards C0, C90, C180 and C270, m; and what it has no shape for.
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

    /// The opening turned about the axis with its table: what was towards H is towards H + `by_deg`. `None`
    /// where it has no shape for that: what is not round turns by multiples of 90 degrees, an upright disk by
    /// 180.
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

#[cfg(test)]
mod tests {
    use super::super::Revision;
    use super::*;
    use OpeningShape::*;

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
