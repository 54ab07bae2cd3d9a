//! The density that a photometric file stands for, by quadrature of its own candela.
//!
//! Cells are those of the unfolded table ([`Web::full_grid`]), of which only the angles are used. Masses and
//! distribution functions come from [`Web::intensity_cd`], bilinear (eq. 7) in the angles as stored, by
//! Gauss-Legendre quadrature under sin(theta). Nothing is shared with the sampler (`sample::grid`,
//! `sample::cell`): no table of cells, no antiderivative.
//!
//! Inside a cell the candela is linear in either angle, so two nodes along each determine it. All nodes lie
//! inside cells, where rounding cannot put them into another one.

use super::quadrature::{GAUSS, TWO_POINT, at_nodes};
use crate::error::{Diagnostic, Kind, Result};
use crate::photometry::{PhotometricType, Web};

/// The density of directions of a file, over the grid angles theta and phi of [`Web::full_grid`].
#[derive(Debug, Clone)]
pub struct Density<'w> {
    web: &'w Web,
    polar_rad: Vec<f64>,
    azimuth_rad: Vec<f64>,
    /// Integral over phi from the first azimuth to each, cd rad, at the two nodes of theta in each row:
    /// `[row * azimuths + azimuth]`.
    along_phi: Vec<[f64; 2]>,
    /// Integral over each cell, lm without the file's factor: `[row * columns + column]`.
    mass_lm: Vec<f64>,
    /// Integral over the rows before each, and over all: rows + 1 values, lm.
    below_lm: Vec<f64>,
}

/// By how many ulps of the last angle a computed angle may lie beyond it.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

impl<'w> Density<'w> {
    /// The density of a web.
    ///
    /// # Errors
    /// A table without a cell or whose integral is zero.
    pub fn new(web: &'w Web) -> Result<Self> {
        let grid = web.full_grid();
        let (polar_rad, azimuth_rad) = (grid.polar_rad, grid.azimuth_rad);
        let (along_phi, mass_lm, below_lm) = (Vec::new(), Vec::new(), vec![0.0]);
        let mut density = Self { web, polar_rad, azimuth_rad, along_phi, mass_lm, below_lm };
        let mut total_lm = 0.0;
        for row in 1..density.polar_rad.len() {
            total_lm += density.add_row(row - 1);
            density.below_lm.push(total_lm);
        }
        if !(total_lm > 0.0 && total_lm.is_finite()) {
            let found = format!("a table whose integral over the sphere is {total_lm}");
            let required = "a table of at least one cell that emits something";
            return Err(Diagnostic::new(Kind::Range, found, required));
        }
        Ok(density)
    }

    /// Integrates one row; its mass.
    fn add_row(&mut self, row: usize) -> f64 {
        let (theta, width) = (self.polar_rad[row], width_of(&self.polar_rad, row));
        let thetas = TWO_POINT.map(|t| theta + t * width);
        let weights = self.sine_weights(row, width);
        let (mut to, mut row_lm) = ([0.0; 2], 0.0);
        self.along_phi.push(to);
        for column in 0..self.columns() {
            let (phi, width) = (self.azimuth_rad[column], width_of(&self.azimuth_rad, column));
            let cell = thetas.map(|theta| self.integral_over_phi(theta, phi, width));
            to = [to[0] + cell[0], to[1] + cell[1]];
            self.along_phi.push(to);
            let mass = weights[0] * cell[0] + weights[1] * cell[1];
            self.mass_lm.push(mass);
            row_lm += mass;
        }
        row_lm
    }

    /// Integrals over theta, from the row's near edge over a width s, of sin(theta) times the linear function
    /// that is 1 at one of the two nodes of the row and 0 at the other.
    fn sine_weights(&self, row: usize, s: f64) -> [f64; 2] {
        let (theta, width) = (self.polar_rad[row], width_of(&self.polar_rad, row));
        let mut weights = [0.0; 2];
        for (x, weight) in GAUSS {
            let sine = weight * libm::sin(theta + x * s);
            let nodes = at_nodes(x * s / width);
            weights = [weights[0] + sine * nodes[0], weights[1] + sine * nodes[1]];
        }
        weights.map(|w| w * s)
    }

    /// Integral of the candela over [phi, phi + width] inside one column, cd rad.
    fn integral_over_phi(&self, theta: f64, phi: f64, width: f64) -> f64 {
        let [near, far] = TWO_POINT.map(|x| self.intensity_cd(theta, phi + x * width));
        0.5 * width * (near + far)
    }

    /// Candela in the direction of grid angles, by the web.
    fn intensity_cd(&self, theta: f64, phi: f64) -> f64 {
        let (vertical_deg, horizontal_deg) = file_angles_deg(self.web.photometric_type, theta, phi);
        self.web.intensity_cd(vertical_deg, horizontal_deg)
    }

    /// Columns of the table.
    pub fn columns(&self) -> usize {
        self.azimuth_rad.len() - 1
    }

    /// Integral over the sphere, lm without the file's factor.
    pub fn total_lm(&self) -> f64 {
        self.below_lm[self.below_lm.len() - 1]
    }

    /// Probabilities of the cells, row by row; exactly 0 where all the corners are.
    pub fn probabilities(&self) -> Vec<f64> {
        self.mass_lm.iter().map(|m| m / self.total_lm()).collect()
    }

    /// The cell of a direction; an edge belongs to the cell after it. `None` outside the table.
    pub fn cell(&self, theta: f64, phi: f64) -> Option<usize> {
        let row = interval(&self.polar_rad, theta)?;
        Some(row * self.columns() + interval(&self.azimuth_rad, phi)?)
    }

    /// Distribution functions at a direction inside this cell, which is one of positive mass: of theta, of
    /// phi given theta, of theta given its row, of phi given theta and its column. Each is uniform on [0, 1]
    /// under the density.
    pub fn place(&self, cell: usize, theta: f64, phi: f64) -> [f64; 4] {
        let (row, column) = (cell / self.columns(), cell % self.columns());
        let s = (theta - self.polar_rad[row]).clamp(0.0, width_of(&self.polar_rad, row));
        let nodes = at_nodes(s / width_of(&self.polar_rad, row));
        let first = row * (self.columns() + 1);
        let [near, far, all] = [column, column + 1, self.columns()].map(|to| {
            let at = self.along_phi[first + to];
            nodes[0] * at[0] + nodes[1] * at[1]
        });
        let x = (phi - self.azimuth_rad[column]).clamp(0.0, width_of(&self.azimuth_rad, column));
        let part = self.integral_over_phi(theta, self.azimuth_rad[column], x);
        let whole = self.along_phi[first + self.columns()];
        let weights = self.sine_weights(row, s);
        let (below_lm, row_lm) = (self.below_lm[row], self.below_lm[row + 1] - self.below_lm[row]);
        let to_theta_lm = weights[0] * whole[0] + weights[1] * whole[1];
        // On an edge of the table where the candela is zero nothing is left to divide by; samples are there
        // by rounding only.
        let fraction = |part: f64, whole: f64| {
            let ratio = part / whole;
            if ratio.is_finite() { ratio.clamp(0.0, 1.0) } else { 0.5 }
        };
        [
            fraction(below_lm + to_theta_lm, self.total_lm()),
            fraction(near + part, all),
            fraction(to_theta_lm, row_lm),
            fraction(part, far - near),
        ]
    }
}

/// The width of an interval between edges.
fn width_of(edges: &[f64], interval: usize) -> f64 {
    edges[interval + 1] - edges[interval]
}

/// The interval between edges that holds x.
fn interval(edges: &[f64], x: f64) -> Option<usize> {
    let (first, last) = (edges[0], edges[edges.len() - 1]);
    let beyond = ROUNDING * last.abs().max(first.abs());
    if !(x >= first && x <= last + beyond) {
        return None;
    }
    Some(edges.partition_point(|edge| *edge <= x).min(edges.len() - 1) - 1)
}

/// (V, H) in the file's own convention, degrees, of grid angles: see [`crate::photometry::FullGrid`].
pub fn file_angles_deg(photometric_type: PhotometricType, theta_rad: f64, phi_rad: f64) -> (f64, f64) {
    let (polar, azimuth) = (theta_rad.to_degrees(), phi_rad.to_degrees());
    match photometric_type {
        PhotometricType::C => (polar, azimuth),
        PhotometricType::A => (polar - 90.0, azimuth),
        PhotometricType::B => (azimuth, polar - 90.0),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn web(kind: PhotometricType, v: &[f64], h: &[f64], f: impl Fn(f64, f64) -> f64) -> Web {
        let candela = h.iter().flat_map(|h| v.iter().map(|v| f(*v, *h)).collect::<Vec<_>>()).collect();
        Web::new(kind, v.to_vec(), h.to_vec(), candela).unwrap()
    }

    #[test]
    fn a_uniform_lamp_has_the_distribution_functions_of_the_sphere() {
        let sphere = web(PhotometricType::C, &[0.0, 30.0, 31.0, 180.0], &[0.0, 90.0, 360.0], |_, _| 2.0);
        let density = Density::new(&sphere).unwrap();
        assert!((density.total_lm() - 8.0 * PI).abs() < 1e-13);
        let p = density.probabilities();
        let cap = |deg: f64| 0.5 * (1.0 - deg.to_radians().cos());
        for (row, (low, high)) in [(0.0, 30.0), (30.0, 31.0), (31.0, 180.0)].into_iter().enumerate() {
            assert!((p[2 * row] - 0.25 * (cap(high) - cap(low))).abs() < 1e-15);
            assert!((p[2 * row + 1] - 0.75 * (cap(high) - cap(low))).abs() < 1e-15);
        }
        for (theta, phi) in [(0.1f64, 0.2), (0.53, 6.0), (1.7, 1.0), (3.1, 3.0), (PI, 2.0 * PI)] {
            let place = density.place(density.cell(theta, phi).unwrap(), theta, phi);
            assert!((place[0] - 0.5 * (1.0 - theta.cos())).abs() < 1e-14);
            assert!((place[1] - phi / (2.0 * PI)).abs() < 1e-14);
        }
    }

    #[test]
    fn one_cell_of_type_c_has_the_closed_form() {
        // I = theta (in degrees / 90) phi / 360 on the half sphere: marginals sin t - t cos t and phi^2.
        let lamp = web(PhotometricType::C, &[0.0, 90.0], &[0.0, 360.0], |v, h| v * h);
        let density = Density::new(&lamp).unwrap();
        // A circle that is not closed is read as stored only where both ends are given: H = 0 and 360 differ.
        for (theta, phi) in [(0.3f64, 5.0), (1.0, 0.4), (1.5, 2.0)] {
            let place = density.place(0, theta, phi);
            let exact = theta.sin() - theta * theta.cos();
            assert!((place[0] - exact).abs() < 1e-14, "{place:?} {exact}");
            assert!((place[1] - (phi / (2.0 * PI)).powi(2)).abs() < 1e-14);
            assert_eq!(place[..2], place[2..]);
        }
    }

    #[test]
    fn axes_of_types_a_and_b_are_told_apart() {
        // Bright where V > 0 (type A: theta beyond the equator; type B: azimuth above 0).
        let bright = |v: f64, _: f64| if v > 0.0 { 1.0 } else { 0.0 };
        let angles = [-90.0, -1.0, 1.0, 90.0];
        for (kind, up) in [(PhotometricType::A, 6), (PhotometricType::B, 2)] {
            let lamp = web(kind, &angles, &angles, bright);
            let p = Density::new(&lamp).unwrap().probabilities();
            let dark = if kind == PhotometricType::A { 0 } else { 6 };
            assert!(p[up] > 0.1 && p[dark] == 0.0, "{kind:?}: {p:?}");
        }
    }

    #[test]
    fn edges_belong_to_the_cell_after_them_and_the_last_to_the_last() {
        let lamp = web(PhotometricType::C, &[10.0, 20.0, 80.0], &[0.0, 90.0, 360.0], |_, _| 1.0);
        let density = Density::new(&lamp).unwrap();
        let at = |v: f64, h: f64| density.cell(v.to_radians(), h.to_radians());
        assert_eq!(at(10.0, 0.0), Some(0));
        assert_eq!(at(20.0, 90.0), Some(3));
        assert_eq!(at(80.0, 360.0), Some(3));
        assert_eq!((at(9.999_999, 0.0), at(80.000_001, 0.0), at(15.0, -1e-9)), (None, None, None));
        assert_eq!((density.cell(f64::NAN, 0.0), density.cell(0.2, f64::NAN)), (None, None));
        // Dark tables are refused. (A single angle is by `Web::new`.)
        assert!(Density::new(&web(PhotometricType::C, &[0.0, 90.0], &[0.0], |_, _| 0.0)).is_err());
    }
}
