//! Mean luminance of the luminous opening: intensity over its projected area.

use super::opening::OpeningShape;
use super::{LuminousOpening, PhotometricType, Photometry};
use crate::units::RADIANS_PER_DEGREE;
use serde::Serialize;
use std::f64::consts::PI;

/// Angles from the axis for which luminances are asked (EN 12464-1 limits them from 55 or 65 degrees on).
const GAMMA_DEG: [f64; 9] = [45.0, 50.0, 55.0, 60.0, 65.0, 70.0, 75.0, 80.0, 85.0];
/// Step of the planes, degrees.
const C_STEP_DEG: u32 = 15;

/// Luminances of an opening over C and gamma, cd/m2, with the factors of what is emitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct LuminanceTable {
    /// Planes, degrees.
    pub c_deg: Vec<f64>,
    /// Angles from the axis, degrees.
    pub gamma_deg: Vec<f64>,
    /// A row for each plane; `None` where nothing of the opening is seen.
    pub cd_m2: Vec<Vec<Option<f64>>>,
}

impl LuminanceTable {
    /// Of a file, or why it has none.
    pub fn new(photometry: &Photometry) -> Result<Self, &'static str> {
        let web = &photometry.web;
        if web.photometric_type != PhotometricType::C {
            return Err("luminances are given over C and gamma, the angles of type C");
        }
        if photometry.opening.shape == OpeningShape::Point {
            return Err("the luminous opening is a point: it has no area");
        }
        let factor = photometry.factor();
        let c_deg: Vec<f64> = (0..360 / C_STEP_DEG).map(|i| f64::from(i * C_STEP_DEG)).collect();
        let at = |c: f64, gamma: f64| {
            let area = photometry.opening.projected_m2(gamma, c);
            // A face seen edge-on has no area but for the rounding of a cosine.
            (area > 0.0).then(|| web.intensity_cd(gamma, c) * factor / area)
        };
        let cd_m2 = c_deg.iter().map(|&c| GAMMA_DEG.iter().map(|&gamma| at(c, gamma)).collect()).collect();
        Ok(Self { c_deg, gamma_deg: GAMMA_DEG.into(), cd_m2 })
    }

    /// The luminance in a plane of the table.
    pub fn at(&self, c_deg: f64, gamma_deg: f64) -> Option<f64> {
        let c = self.c_deg.iter().position(|&c| c == c_deg)?;
        let gamma = self.gamma_deg.iter().position(|&gamma| gamma == gamma_deg)?;
        self.cd_m2[c][gamma]
    }
}

impl LuminousOpening {
    /// The area of its silhouette in the direction (V, H) of type C, m2; flat shapes shine to both sides. The
    /// frame of LM-63: length along H = 0, width across.
    pub fn projected_m2(&self, vertical_deg: f64, horizontal_deg: f64) -> f64 {
        use OpeningShape::*;
        let [width, length, height] = self.size_m;
        let towards = direction(vertical_deg, horizontal_deg);
        let [x, y, z] = towards.map(f64::abs);
        // Extent across the direction of an ellipse with these axes, which lies in the plane of a and b.
        let ellipse = |size_a: f64, size_b: f64, a: f64, b: f64| libm::hypot(size_a * b, size_b * a);
        let disc = |a: f64, b: f64| 0.25 * PI * a * b;
        match self.shape {
            Point => 0.0,
            Rectangle | VerticalRectangle | Box | BoundingBox => {
                // The sides that are seen, towards C0 or C180 and C90 or C270.
                let [c0, c90, c180, c270] = self.heights_m.unwrap_or([height; 4]);
                let side = |towards: f64, ahead: f64, behind: f64| if towards > 0.0 { ahead } else { behind };
                let [of_x, of_y] = [side(towards[0], c0, c180), side(towards[1], c90, c270)];
                length * width * z + width * of_x * x + length * of_y * y
            }
            Disk | Ellipse => disc(length, width) * z,
            VerticalDisk => disc(width, height) * x,
            VerticalCylinder | VerticalEllipticalCylinder => {
                disc(length, width) * z + height * ellipse(length, width, x, y)
            }
            HorizontalCylinderAlong => disc(width, height) * x + length * ellipse(width, height, y, z),
            HorizontalCylinderAcross => disc(length, height) * y + width * ellipse(length, height, x, z),
            Sphere | Ellipsoid => {
                let across =
                    libm::hypot(libm::hypot(width * height * x, length * height * y), length * width * z);
                0.25 * PI * across
            }
        }
    }
}

/// A direction along H = 0 (x), across it (y) and along the axis (z).
fn direction(vertical_deg: f64, horizontal_deg: f64) -> [f64; 3] {
    let (v, h) = (vertical_deg * RADIANS_PER_DEGREE, horizontal_deg * RADIANS_PER_DEGREE);
    // Multiples of 90 degrees have no rounded cosines: a face seen edge-on has no area.
    let [sin_h, cos_h] = match horizontal_deg.rem_euclid(360.0) {
        0.0 => [0.0, 1.0],
        90.0 => [1.0, 0.0],
        180.0 => [0.0, -1.0],
        270.0 => [-1.0, 0.0],
        _ => [libm::sin(h), libm::cos(h)],
    };
    let cos_v = if vertical_deg == 90.0 { 0.0 } else { libm::cos(v) };
    [libm::sin(v) * cos_h, libm::sin(v) * sin_h, cos_v]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::photometric;
    use OpeningShape::*;

    /// The silhouette by its shadow: of a convex shape half the integral of |n . d| over its surface, here by
    /// the support function's width along many directions in the plane across (Cauchy-Crofton in the plane).
    fn shadow_m2(points: &[[f64; 3]], d: [f64; 3]) -> f64 {
        // Two axes across d.
        let pick = if d[2].abs() < 0.9 { [0.0, 0.0, 1.0] } else { [1.0, 0.0, 0.0] };
        let cross = |a: [f64; 3], b: [f64; 3]| {
            [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
        };
        let dot = |a: [f64; 3], b: [f64; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        let u = cross(pick, d);
        let n = dot(u, u).sqrt();
        let u = u.map(|x| x / n);
        let v = cross(d, u);
        let mut flat: Vec<[f64; 2]> = points.iter().map(|&p| [dot(p, u), dot(p, v)]).collect();
        flat.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
        // Andrew's monotone chain, then the shoelace.
        let turn = |o: [f64; 2], a: [f64; 2], b: [f64; 2]| {
            (a[0] - o[0]) * (b[1] - o[1]) - (a[1] - o[1]) * (b[0] - o[0])
        };
        let half = |points: &mut dyn Iterator<Item = [f64; 2]>| {
            let mut hull: Vec<[f64; 2]> = Vec::new();
            for p in points {
                while hull.len() > 1 && turn(hull[hull.len() - 2], hull[hull.len() - 1], p) <= 0.0 {
                    hull.pop();
                }
                hull.push(p);
            }
            hull
        };
        let mut hull = half(&mut flat.iter().copied());
        hull.extend(half(&mut flat.iter().rev().copied()));
        let next = hull.iter().skip(1).chain(hull.first());
        0.5 * hull.iter().zip(next).map(|(a, b)| a[0] * b[1] - a[1] * b[0]).sum::<f64>()
    }

    /// Points on a shape of these sizes along x, y and z.
    fn points(shape: OpeningShape, [x, y, z]: [f64; 3]) -> Vec<[f64; 3]> {
        let turns = (0..720).map(|i| f64::from(i).to_radians() / 2.0);
        let ring = |at: &dyn Fn(f64, f64) -> [f64; 3]| {
            turns.clone().map(|t| at(t.cos(), t.sin())).collect::<Vec<_>>()
        };
        let both = |at: &dyn Fn(f64, f64, f64) -> [f64; 3]| {
            [ring(&|c, s| at(c, s, -0.5)), ring(&|c, s| at(c, s, 0.5))].concat()
        };
        match shape {
            Disk | Ellipse => ring(&|c, s| [0.5 * x * c, 0.5 * y * s, 0.0]),
            VerticalDisk => ring(&|c, s| [0.0, 0.5 * y * c, 0.5 * z * s]),
            VerticalCylinder | VerticalEllipticalCylinder => {
                both(&|c, s, e| [0.5 * x * c, 0.5 * y * s, z * e])
            }
            HorizontalCylinderAlong => both(&|c, s, e| [x * e, 0.5 * y * c, 0.5 * z * s]),
            HorizontalCylinderAcross => both(&|c, s, e| [0.5 * x * c, y * e, 0.5 * z * s]),
            Sphere | Ellipsoid => (0..=180)
                .flat_map(|i| {
                    let polar = f64::from(i).to_radians();
                    ring(&|c, s| {
                        [0.5 * x * polar.sin() * c, 0.5 * y * polar.sin() * s, 0.5 * z * polar.cos()]
                    })
                })
                .collect(),
            _ => (0..8)
                .map(|i| {
                    let side = |bit: i32, size: f64| if i >> bit & 1 == 0 { -0.5 * size } else { 0.5 * size };
                    [side(0, x), side(1, y), side(2, z)]
                })
                .collect(),
        }
    }

    #[test]
    fn projected_areas_are_shadows() {
        let (width, length, height) = (0.3, 1.2, 0.2);
        for (shape, size_m) in [
            (Rectangle, [width, length, 0.0]),
            (Box, [width, length, height]),
            (VerticalRectangle, [width, 0.0, height]),
            (VerticalRectangle, [0.0, length, height]),
            (BoundingBox, [width, length, height]),
            (Disk, [width, width, 0.0]),
            (Ellipse, [width, length, 0.0]),
            (VerticalDisk, [width, 0.0, height]),
            (VerticalCylinder, [width, width, height]),
            (VerticalEllipticalCylinder, [width, length, height]),
            (HorizontalCylinderAlong, [width, length, width]),
            (HorizontalCylinderAcross, [width, length, height]),
            (Sphere, [width, width, width]),
            (Ellipsoid, [width, length, height]),
        ] {
            let opening = LuminousOpening { shape, size_m, heights_m: None };
            let solid = points(shape, [size_m[1], size_m[0], size_m[2]]);
            for (v, h) in [(0.0, 0.0), (20.0, 10.0), (65.0, 130.0), (90.0, 0.0), (90.0, 90.0), (115.0, 255.0)]
            {
                let expected = shadow_m2(&solid, direction(v, h));
                let got = opening.projected_m2(v, h);
                // Inscribed polygons of 720 corners lack 1.3e-5 of a circle's area, spheres of 1 degree 2e-4.
                let allowed = if matches!(shape, Sphere | Ellipsoid) { 3e-4 } else { 3e-5 };
                assert!(
                    got >= expected - 1e-12 && got - expected <= allowed * got + 1e-12,
                    "{shape:?} {v} {h}: {got} {expected}"
                );
            }
        }
    }

    #[test]
    fn each_side_has_its_height() {
        let heights_m = Some([0.1, 0.2, 0.3, 0.4]);
        let opening = LuminousOpening { shape: Box, size_m: [2.0, 3.0, 0.4], heights_m };
        for (h, expected) in [(0.0, 2.0 * 0.1), (90.0, 3.0 * 0.2), (180.0, 2.0 * 0.3), (270.0, 3.0 * 0.4)] {
            assert!((opening.projected_m2(90.0, h) - expected).abs() < 1e-15, "{h}");
        }
    }

    #[test]
    fn a_cosine_table_over_a_flat_opening_has_one_luminance() {
        let v: Vec<f64> = (0..=18).map(|i| f64::from(i) * 5.0).collect();
        let candela: Vec<String> = v.iter().map(|v| format!("{}", 500.0 * v.to_radians().cos())).collect();
        let angles: Vec<String> = v.iter().map(ToString::to_string).collect();
        let file = |opening: &str, kind: &str| {
            let text = format!(
                "IESNA:LM-63-2002\nTILT=NONE\n1 -1 2 19 1 {kind} 2 {opening}\n0.5 1 10\n{}\n0\n{}\n",
                angles.join(" "),
                candela.join(" ")
            );
            photometric::parse(text.as_bytes(), "small.ies").unwrap()
        };
        let table = LuminanceTable::new(&file("0.5 1 0", "1")).unwrap();
        assert_eq!((table.c_deg.len(), table.gamma_deg.len()), (24, 9));
        for gamma in GAMMA_DEG {
            // 500 cos x 2 x 0.5 cd over 0.5 cos m2.
            assert!((table.at(45.0, gamma).unwrap() - 1000.0).abs() < 1e-9);
        }
        assert!(LuminanceTable::new(&file("0 0 0", "1")).unwrap_err().contains("point"));
        assert!(LuminanceTable::new(&file("0.5 1 0", "2")).is_err());
    }
}
