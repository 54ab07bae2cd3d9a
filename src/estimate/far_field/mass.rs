//! The mass matrix of the bilinear hats of a table on the sphere, in the measure sin(gamma) dgamma dC.
//!
//! A hat of (gamma, C) is the product of two hats and so is the measure: M is a tridiagonal matrix in gamma times a cyclic
//! one in C, but for a pole, whose nodes are one. Its row sums are the integrals of the hats, since these sum to 1.

use crate::scene::nodes::Nodes;
use crate::units::RADIANS_PER_DEGREE;

/// Nodes and weights of Gauss and Legendre's rule of 10 points on -1..1, half of them (Abramowitz and Stegun, table 25.4).
/// Products of two hats and a sine over at most 180 degrees it integrates to rounding.
const GAUSS: [(f64, f64); 5] = [
    (0.148_874_338_981_631_21, 0.295_524_224_714_752_87),
    (0.433_395_394_129_247_2, 0.269_266_719_309_996_35),
    (0.679_409_568_299_024_4, 0.219_086_362_515_982_04),
    (0.865_063_366_688_984_5, 0.149_451_349_150_580_6),
    (0.973_906_528_517_171_7, 0.066_671_344_308_688_14),
];

/// M, for vectors numbered as [`Nodes`] are; of a pole's row all but the first entry are 0 and stay so.
#[derive(Debug, Clone)]
pub struct Mass {
    planes: usize,
    is_pole: Vec<bool>,
    /// In gamma: the diagonal, and what couples each row to the next.
    gamma: (Vec<f64>, Vec<f64>),
    /// In C: the diagonal, and what couples each plane to the next, the last to the first.
    c: (Vec<f64>, Vec<f64>),
}

impl Mass {
    /// Of these nodes.
    pub fn new(nodes: &Nodes) -> Self {
        let (rows, planes) = (nodes.gamma_deg.len(), nodes.planes());
        let (mut diagonal, mut next) = (vec![0.0; rows], vec![0.0; rows - 1]);
        for row in 0..rows - 1 {
            let ends = [nodes.gamma_deg[row], nodes.gamma_deg[row + 1]].map(|deg| deg * RADIANS_PER_DEGREE);
            let [low, both, high] = of_band(ends);
            diagonal[row] += low;
            next[row] = both;
            diagonal[row + 1] += high;
        }
        let (mut around, mut to_next) = (vec![0.0; planes], vec![0.0; planes]);
        for plane in 0..planes {
            let width = (nodes.next_c_deg(plane) - nodes.c_deg[plane]) * RADIANS_PER_DEGREE;
            around[plane] += width / 3.0;
            around[(plane + 1) % planes] += width / 3.0;
            to_next[plane] = width / 6.0;
        }
        let is_pole = (0..rows).map(|row| nodes.is_pole(row)).collect();
        Self { planes, is_pole, gamma: (diagonal, next), c: (around, to_next) }
    }

    /// Entries of a vector.
    pub fn entries(&self) -> usize {
        self.is_pole.len() * self.planes
    }

    /// Whether this entry is a node of its own.
    pub fn is_node(&self, entry: usize) -> bool {
        !self.is_pole[entry / self.planes] || entry.is_multiple_of(self.planes)
    }

    /// M x.
    pub fn apply(&self, x: &[f64]) -> Vec<f64> {
        let (planes, rows) = (self.planes, self.is_pole.len());
        // First along C, a pole's value in all planes.
        let mut along = vec![0.0; x.len()];
        for row in 0..rows {
            let (x, along) = (&x[row * planes..][..planes], &mut along[row * planes..][..planes]);
            let at = |plane: usize| if self.is_pole[row] { x[0] } else { x[plane] };
            let (mut before, mut coupling) = (at(planes - 1), self.c.1[planes - 1]);
            for (plane, along) in along.iter_mut().enumerate() {
                let after = if plane + 1 == planes { at(0) } else { at(plane + 1) };
                *along = coupling * before + self.c.0[plane] * at(plane) + self.c.1[plane] * after;
                (before, coupling) = (at(plane), self.c.1[plane]);
            }
        }
        // Then along gamma.
        let mut out = vec![0.0; x.len()];
        for row in 0..rows {
            let out = &mut out[row * planes..][..planes];
            let mut add = |from: usize, factor: f64| {
                for (out, along) in out.iter_mut().zip(&along[from * planes..]) {
                    *out += factor * along;
                }
            };
            if row > 0 {
                add(row - 1, self.gamma.1[row - 1]);
            }
            add(row, self.gamma.0[row]);
            if row + 1 < rows {
                add(row + 1, self.gamma.1[row]);
            }
            if self.is_pole[row] {
                let all = out.iter().sum();
                out.fill(0.0);
                out[0] = all;
            }
        }
        out
    }

    /// The diagonal; 0 where there is no node.
    pub fn diagonal(&self) -> Vec<f64> {
        let turn = std::f64::consts::TAU;
        let of = |entry: usize| {
            let (row, plane) = (entry / self.planes, entry % self.planes);
            let around = if self.is_pole[row] { turn } else { self.c.0[plane] };
            // Of one plane, or of two, the next is the one before, too.
            let again = match self.planes {
                1 if !self.is_pole[row] => 2.0 * self.c.1[0],
                _ => 0.0,
            };
            self.gamma.0[row] * (around + again)
        };
        (0..self.entries()).map(|entry| if self.is_node(entry) { of(entry) } else { 0.0 }).collect()
    }

    /// The integral of each node's hat, sr; they sum to the solid angle of the table.
    pub fn solid_angles_sr(&self) -> Vec<f64> {
        let ones: Vec<f64> =
            (0..self.entries()).map(|entry| f64::from(u8::from(self.is_node(entry)))).collect();
        self.apply(&ones)
    }
}

/// The integrals of the products of two hats of a band times sin(gamma): low by low, low by high, high by high.
fn of_band([low, high]: [f64; 2]) -> [f64; 3] {
    let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
    let mut sums = [0.0; 3];
    for (x, weight) in GAUSS.into_iter().flat_map(|(x, w)| [(-x, w), (x, w)]) {
        let (rising, measure) = (0.5 * (1.0 + x), weight * half * libm::sin(middle + x * half));
        let falling = 1.0 - rising;
        for (sum, product) in sums.iter_mut().zip([falling * falling, falling * rising, rising * rising]) {
            *sum += product * measure;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::{FullGrid, flux};
    use std::f64::consts::{PI, TAU};

    fn nodes() -> [Nodes; 4] {
        let of = |gamma: &[f64], c: &[f64]| Nodes { gamma_deg: gamma.to_vec(), c_deg: c.to_vec() };
        [
            of(&[0.0, 10.0, 45.0, 90.0, 180.0], &[0.0, 20.0, 100.0, 300.0]),
            of(&[0.0, 90.0], &[0.0]),
            of(&[90.0, 120.0, 180.0], &[0.0, 180.0]),
            of(&[0.0, 1.0, 90.0], &[0.0, 90.0, 180.0, 270.0]),
        ]
    }

    /// Polynomials in gamma times a sine, by hand: over 0..pi with hats 1 - g/pi and g/pi,
    /// Int (g/pi)^2 sin g = 1 - 4/pi^2, Int (g/pi)(1 - g/pi) sin g = 4/pi^2, and the same at the other end.
    #[test]
    fn a_band_of_half_a_turn_by_hand() {
        let [low, both, high] = of_band([0.0, PI]);
        assert!((low - (1.0 - 4.0 / (PI * PI))).abs() < 1e-14 && (both - 4.0 / (PI * PI)).abs() < 1e-14);
        assert!((high - low).abs() < 1e-14);
        // Near a pole, to leading order: h^2/12, h^2/12, h^2/4.
        let h = 1e-4;
        for (value, part) in of_band([0.0, h]).into_iter().zip([12.0, 12.0, 4.0]) {
            assert!((value * part / (h * h) - 1.0).abs() < 1e-8, "{value}");
        }
    }

    /// The hats' integrals against the closed form of the flux of a bilinear table (photometry/flux).
    #[test]
    fn row_sums_are_the_integrals_of_the_hats() {
        for nodes in nodes() {
            let mass = Mass::new(&nodes);
            let solid = mass.solid_angles_sr();
            let ends = [nodes.gamma_deg[0], nodes.gamma_deg[nodes.gamma_deg.len() - 1]];
            let [first, last] = ends.map(f64::to_radians);
            let all = TAU * (first.cos() - last.cos());
            assert!((solid.iter().sum::<f64>() - all).abs() < 1e-13 * all);
            for entry in (0..mass.entries()).filter(|entry| mass.is_node(*entry)) {
                let (row, plane) = (entry / nodes.planes(), entry % nodes.planes());
                let is_there =
                    |i: usize, j: usize| i == row && (nodes.is_pole(row) || j % nodes.planes() == plane);
                let azimuths: Vec<f64> = nodes.c_deg.iter().chain(&[360.0]).map(|c| c.to_radians()).collect();
                let value = |i| (0..azimuths.len()).map(move |j| if is_there(i, j) { 1.0 } else { 0.0 });
                let grid = FullGrid {
                    polar_rad: nodes.gamma_deg.iter().map(|g| g.to_radians()).collect(),
                    azimuth_rad: azimuths.clone(),
                    intensity_cd: (0..nodes.gamma_deg.len()).flat_map(value).collect(),
                };
                let expected = flux::bilinear_lm(&grid);
                assert!(
                    (solid[entry] - expected).abs() < 1e-13 * expected,
                    "{entry}: {} {expected}",
                    solid[entry]
                );
            }
        }
    }

    /// Entry by entry: M is symmetric, and its diagonal is what it says.
    #[test]
    fn the_matrix_is_symmetric_and_knows_its_diagonal() {
        for nodes in nodes() {
            let mass = Mass::new(&nodes);
            let unit =
                |k: usize| (0..mass.entries()).map(|i| f64::from(u8::from(i == k))).collect::<Vec<f64>>();
            let columns: Vec<_> = (0..mass.entries())
                .map(|k| if mass.is_node(k) { mass.apply(&unit(k)) } else { vec![0.0; mass.entries()] })
                .collect();
            let diagonal = mass.diagonal();
            for i in 0..mass.entries() {
                assert!(
                    (columns[i][i] - diagonal[i]).abs() < 1e-14,
                    "{i}: {} {}",
                    columns[i][i],
                    diagonal[i]
                );
                for (j, column) in columns.iter().enumerate().take(i) {
                    assert!((columns[i][j] - column[i]).abs() < 1e-15, "{i} {j}");
                }
            }
        }
    }
}
