//! The web unfolded over the sphere, for sampling and integration.

use super::axes::Fold;
use super::web::Between;
use super::{PhotometricType, Web};
use crate::units::RADIANS_PER_DEGREE;
use std::f64::consts::{PI, TAU};

/// A web's intensities on a full grid of polar and azimuthal angles, symmetry spelt out, pole along the axis where
/// the solid angle sin(polar) d polar d azimuth vanishes. Zero outside the grid; bilinear inside.
///
/// | type | polar | azimuth |
/// |---|---|---|
/// | C | V | H, over the whole circle, 0 and 2 pi both present |
/// | A | V + 90 degrees | H |
/// | B | H + 90 degrees | V |
#[derive(Debug, Clone, PartialEq)]
pub struct FullGrid {
    /// Polar angles, rad, strictly increasing, within 0..=PI; the poles are exactly 0.0 and PI.
    pub polar_rad: Vec<f64>,
    /// Azimuths, rad, strictly increasing; type C: from 0.0 to exactly TAU.
    pub azimuth_rad: Vec<f64>,
    /// Intensities, cd, value x multiplier: `[polar * azimuth_rad.len() + azimuth]`.
    pub intensity_cd: Vec<f64>,
}

/// An angle of an unfolded axis, and the stored angles its value comes from.
#[derive(Debug, Clone, Copy)]
struct Node {
    angle_deg: f64,
    at: Between,
}

fn stored(angle_deg: f64, index: usize) -> Node {
    Node { angle_deg, at: Between::node(index) }
}

impl Web {
    /// The table unfolded by its symmetry; intensities without [`super::Photometry::factor`].
    ///
    /// Mirroring never doubles a plane. Where no stored plane lies on the seam of the circle one is interpolated
    /// there, which leaves the bilinear function as it is. One plane alone is spread over 0..2 pi (type C) or
    /// -90..90 degrees (types A and B).
    pub fn full_grid(&self) -> FullGrid {
        let vertical = unfold(self.vertical_fold(), &self.vertical_deg);
        let horizontal = unfold(self.horizontal_fold(), &self.horizontal_deg);
        let (polar, azimuth, shift) = match self.photometric_type {
            PhotometricType::C => (&vertical, &horizontal, 0.0),
            PhotometricType::A => (&vertical, &horizontal, 90.0),
            PhotometricType::B => (&horizontal, &vertical, 90.0),
        };
        let swapped = self.photometric_type == PhotometricType::B;
        let mut intensity_cd = Vec::with_capacity(polar.len() * azimuth.len());
        for p in polar {
            for a in azimuth {
                intensity_cd.push(if swapped { self.blended(a.at, p.at) } else { self.blended(p.at, a.at) });
            }
        }
        FullGrid {
            polar_rad: polar.iter().map(|n| radians(n.angle_deg + shift)).collect(),
            azimuth_rad: azimuth.iter().map(|n| radians(n.angle_deg)).collect(),
            intensity_cd,
        }
    }
}

impl Web {
    /// A table of type C with its planes over 0..360, both ends present; other types as they are.
    pub fn over_circle(&self) -> Self {
        if self.photometric_type != PhotometricType::C {
            return self.clone();
        }
        let planes = unfold(self.horizontal_fold(), &self.horizontal_deg);
        let rows = 0..self.vertical_deg.len();
        let row =
            |plane: &Node| rows.clone().map(|v| self.blended(Between::node(v), plane.at)).collect::<Vec<_>>();
        Self {
            photometric_type: self.photometric_type,
            vertical_deg: self.vertical_deg.clone(),
            horizontal_deg: planes.iter().map(|plane| plane.angle_deg).collect(),
            candela: planes.iter().flat_map(row).collect(),
        }
    }
}

/// Radians, the half and the full turn exact.
pub(super) fn radians(degrees: f64) -> f64 {
    match degrees {
        180.0 => PI,
        360.0 => TAU,
        _ => degrees * RADIANS_PER_DEGREE,
    }
}

/// The nodes of a folded axis over its whole range, in increasing order.
fn unfold(fold: Fold, axis: &[f64]) -> Vec<Node> {
    let nodes: Vec<Node> = axis.iter().enumerate().map(|(i, &a)| stored(a, i)).collect();
    match fold {
        Fold::AsStored => nodes,
        Fold::Constant => vec![stored(-90.0, 0), stored(90.0, 0)],
        Fold::Rotational => vec![stored(0.0, 0), stored(360.0, 0)],
        Fold::MirrorZero => reflected(&nodes, 0.0, Side::Before),
        Fold::Mirror0 => reflected(&nodes, 180.0, Side::After),
        Fold::Quadrants => reflected(&reflected(&nodes, 90.0, Side::After), 180.0, Side::After),
        Fold::Mirror90 => unfold_90_270(nodes, axis),
        Fold::Circle => close_circle(nodes, axis),
    }
}

/// Where the mirrored half goes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Side {
    Before,
    After,
}

/// The nodes with their reflection at `mirror`, on which the last (first) of them lies and is not doubled.
fn reflected(nodes: &[Node], mirror: f64, side: Side) -> Vec<Node> {
    let image = |n: &Node| Node { angle_deg: 2.0 * mirror - n.angle_deg, ..*n };
    let reversed = nodes.iter().rev().filter(|n| n.angle_deg != mirror).map(image);
    match side {
        Side::Before => reversed.chain(nodes.iter().copied()).collect(),
        Side::After => nodes.iter().copied().chain(reversed).collect(),
    }
}

/// H = 90..270 mirrored in the 90-270 plane: H stands for 180 - H too. The seam is the image of H = 180.
fn unfold_90_270(mut nodes: Vec<Node>, axis: &[f64]) -> Vec<Node> {
    let above = axis.partition_point(|&a| a < 180.0);
    if axis.get(above) != Some(&180.0) && above > 0 && above < axis.len() {
        let weight = (180.0 - axis[above - 1]) / (axis[above] - axis[above - 1]);
        nodes.insert(above, Node { angle_deg: 180.0, at: Between { low: above - 1, high: above, weight } });
    }
    let mut circle = reflected(&reflected(&nodes, 90.0, Side::Before), 270.0, Side::After);
    circle.retain(|n| (0.0..=360.0).contains(&n.angle_deg));
    circle
}

/// More than half a circle: the last plane is joined to the first, a turn further.
fn close_circle(mut nodes: Vec<Node>, axis: &[f64]) -> Vec<Node> {
    let (Some(&first), Some(&last)) = (axis.first(), axis.last()) else {
        return nodes;
    };
    if first == 0.0 && last == 360.0 {
        return nodes;
    }
    let end = axis.len() - 1;
    let weight = (360.0 - last) / (first + 360.0 - last);
    let seam = Node { angle_deg: 0.0, at: Between { low: end, high: 0, weight } };
    if first != 0.0 {
        nodes.insert(0, seam);
    }
    if last != 360.0 {
        nodes.push(Node { angle_deg: 360.0, ..seam });
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use PhotometricType::{A, B, C};

    /// Numbers in [0, 1) without a pattern: SplitMix64 (Steele, Lea, Flood 2014).
    fn uniforms(mut state: u64) -> impl FnMut() -> f64 {
        move || {
            state = state.wrapping_add(0x9e37_79b9_7f4a_7c15);
            let mut z = state;
            z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
            ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
        }
    }

    /// Bilinear in the grid's own angles, by a linear scan: shares nothing with `Web::intensity_cd`.
    fn in_grid(grid: &FullGrid, polar: f64, azimuth: f64) -> f64 {
        let cell = |axis: &[f64], x: f64| (0..axis.len() - 1).find(|&i| x >= axis[i] && x <= axis[i + 1]);
        let (Some(i), Some(j)) = (cell(&grid.polar_rad, polar), cell(&grid.azimuth_rad, azimuth)) else {
            return 0.0;
        };
        let n = grid.azimuth_rad.len();
        let s = (polar - grid.polar_rad[i]) / (grid.polar_rad[i + 1] - grid.polar_rad[i]);
        let t = (azimuth - grid.azimuth_rad[j]) / (grid.azimuth_rad[j + 1] - grid.azimuth_rad[j]);
        let row = |i: usize| grid.intensity_cd[i * n + j] * (1.0 - t) + grid.intensity_cd[i * n + j + 1] * t;
        row(i) * (1.0 - s) + row(i + 1) * s
    }

    #[test]
    fn unfolded_and_folded_agree_in_every_symmetry() {
        let mut u = uniforms(7);
        for (t, v, h) in [
            (C, vec![0.0, 10.0, 55.0, 90.0], vec![0.0]),
            (C, vec![90.0, 130.0, 180.0], vec![0.0, 20.0, 90.0]),
            (C, vec![0.0, 50.0, 180.0], vec![0.0, 33.0, 100.0, 180.0]),
            (C, vec![0.0, 50.0, 140.0], vec![90.0, 135.0, 180.0, 200.0, 270.0]),
            (C, vec![0.0, 50.0, 140.0], vec![90.0, 110.0, 190.0, 270.0]),
            (C, vec![0.0, 50.0, 90.0], vec![0.0, 100.0, 222.5, 360.0]),
            (C, vec![0.0, 50.0, 90.0], vec![0.0, 100.0, 222.5, 345.0]),
            (C, vec![20.0, 50.0, 80.0], vec![5.0, 100.0, 222.5, 350.0]),
            (C, vec![20.0, 50.0, 80.0], vec![5.0, 100.0, 222.5, 360.0]),
            (A, vec![-90.0, -20.0, 30.0, 90.0], vec![-90.0, 10.0, 90.0]),
            (A, vec![0.0, 30.0, 90.0], vec![0.0, 10.0, 45.0]),
            (A, vec![-20.0, 30.0, 50.0], vec![0.0]),
            (B, vec![-90.0, -20.0, 30.0, 90.0], vec![-90.0, 10.0, 90.0]),
            (B, vec![-40.0, 30.0], vec![0.0, 10.0, 90.0]),
            (B, vec![0.0], vec![0.0, 10.0, 90.0]),
            (B, vec![0.0, 15.0], vec![0.0]),
        ] {
            let candela = (0..v.len() * h.len()).map(|_| 1.0 + u()).collect();
            let web = Web::new(t, v.clone(), h.clone(), candela).unwrap();
            let grid = web.full_grid();
            assert_eq!(grid.intensity_cd.len(), grid.polar_rad.len() * grid.azimuth_rad.len());
            for axis in [&grid.polar_rad, &grid.azimuth_rad] {
                assert!(axis.windows(2).all(|w| w[0] < w[1]), "{t:?} {v:?} {h:?}: {axis:?}");
            }
            if t == C {
                assert_eq!((grid.azimuth_rad[0], *grid.azimuth_rad.last().unwrap()), (0.0, TAU));
            }
            if t == C {
                assert_eq!(web.over_circle().full_grid(), grid, "{v:?} {h:?}");
            }
            let (mut inside, mut outside) = (0, 0);
            for _ in 0..4000 {
                let polar = PI * u();
                let azimuth = if t == C { TAU * u() } else { PI * (u() - 0.5) };
                let (p, a) = (polar.to_degrees(), azimuth.to_degrees());
                let expected = match t {
                    C => web.intensity_cd(p, a),
                    A => web.intensity_cd(p - 90.0, a),
                    B => web.intensity_cd(a, p - 90.0),
                };
                let got = in_grid(&grid, polar, azimuth);
                assert!((got - expected).abs() <= 1e-12, "{t:?} {v:?} {h:?} {p} {a}: {got} {expected}");
                if expected > 0.0 { inside += 1 } else { outside += 1 }
            }
            assert!(inside > 100, "{t:?} {v:?} {h:?}: {inside} {outside}");
        }
    }

    #[test]
    fn poles_are_exact_and_no_plane_is_doubled() {
        let web = Web::new(C, vec![0.0, 180.0], vec![0.0, 45.0, 90.0], vec![1.0; 6]).unwrap();
        let grid = web.full_grid();
        assert_eq!(grid.polar_rad, [0.0, PI]);
        let degrees: Vec<f64> = grid.azimuth_rad.iter().map(|a| a.to_degrees().round()).collect();
        assert_eq!(degrees, [0.0, 45.0, 90.0, 135.0, 180.0, 225.0, 270.0, 315.0, 360.0]);
        let web = Web::new(B, vec![0.0, 90.0], vec![-90.0, 0.0, 90.0], vec![1.0; 6]).unwrap();
        let grid = web.full_grid();
        assert_eq!((grid.polar_rad[0], grid.polar_rad[2]), (0.0, PI));
        assert_eq!(grid.azimuth_rad.len(), 3, "V = -90, 0, 90");
    }
}
