//! A table on the sphere by quadrature: values, masses of cells, and the coordinates that a point comes from.
//! Bilinear between nodes, under sin(theta) dtheta dphi; no formula of the sampler is used, no
//! antiderivative.

use super::quadrature::Gauss;

/// Angles in radians and values `[polar][azimuth]`.
#[derive(Debug, Clone)]
pub struct SphereTable {
    pub polar: Vec<f64>,
    pub azimuth: Vec<f64>,
    pub values: Vec<f64>,
    rule: Gauss,
    /// Integrals over the cells before each, row by row, and over all.
    below: Vec<f64>,
}

impl SphereTable {
    pub fn new(polar: Vec<f64>, azimuth: Vec<f64>, values: Vec<f64>) -> Self {
        assert_eq!(values.len(), polar.len() * azimuth.len());
        let mut table = Self { polar, azimuth, values, rule: Gauss::new(12), below: vec![0.0] };
        // Compensated (Kahan), so that many small cells add up to the last digit.
        let (mut sum, mut lost) = (0.0, 0.0);
        for i in 0..table.polar.len() - 1 {
            let ends = table.towards_edges(i, table.polar[i + 1]);
            for j in 0..table.columns() {
                let mass = table.inside(i, j, ends) - lost;
                let next = sum + mass;
                lost = (next - sum) - mass;
                sum = next;
                table.below.push(sum);
            }
        }
        table
    }

    /// `rows` x `columns` equal steps over the sphere, azimuths from `first`.
    pub fn over_the_sphere([rows, columns]: [usize; 2], first: f64, f: impl Fn(usize, usize) -> f64) -> Self {
        use std::f64::consts::PI;
        let polar = (0..=rows).map(|i| PI * i as f64 / rows as f64).collect();
        let azimuth = (0..=columns).map(|j| first + 2.0 * PI * j as f64 / columns as f64).collect();
        let nodes = (0..=rows).flat_map(|i| (0..=columns).map(move |j| (i, j)));
        Self::new(polar, azimuth, nodes.map(|(i, j)| f(i, j)).collect())
    }

    fn columns(&self) -> usize {
        self.azimuth.len() - 1
    }

    fn at(&self, i: usize, j: usize) -> f64 {
        self.values[i * self.azimuth.len() + j]
    }

    /// Integrals from the near edge of row i to theta, of sin(theta) times the weight of the near and of the
    /// far edge.
    fn towards_edges(&self, i: usize, theta: f64) -> [f64; 2] {
        let (from, width) = (self.polar[i], self.polar[i + 1] - self.polar[i]);
        let (s, mut near, mut far) = (theta - from, 0.0, 0.0);
        for panel in 0..4 {
            let (low, high) = (s * f64::from(panel) / 4.0, s * f64::from(panel + 1) / 4.0);
            for (x, weight) in self.rule.points(low, high) {
                let weight = weight * (from + x).sin();
                near += weight * (1.0 - x / width);
                far += weight * (x / width);
            }
        }
        [near, far]
    }

    /// Integral over column j of what [`Self::towards_edges`] covers.
    fn inside(&self, i: usize, j: usize, [near, far]: [f64; 2]) -> f64 {
        let (a, b) = (self.at(i, j) + self.at(i, j + 1), self.at(i + 1, j) + self.at(i + 1, j + 1));
        0.5 * (self.azimuth[j + 1] - self.azimuth[j]) * (a * near + b * far)
    }

    /// Integral over all.
    pub fn total(&self) -> f64 {
        self.below[self.below.len() - 1]
    }

    /// Part of all that a cell has.
    pub fn part(&self, i: usize, j: usize) -> f64 {
        let cell = i * self.columns() + j;
        (self.below[cell + 1] - self.below[cell]) / self.total()
    }

    /// (row, column) of the cell that holds a point of the table; the outer edges belong to it.
    pub fn cell(&self, theta: f64, phi: f64) -> (usize, usize) {
        let find = |edges: &[f64], x: f64| edges[1..edges.len() - 1].partition_point(|e| *e <= x);
        (find(&self.polar, theta), find(&self.azimuth, phi))
    }

    /// Values at both sides of the point's column, at theta; and the fraction of the column.
    fn ends(&self, theta: f64, phi: f64) -> (f64, f64, f64) {
        let (i, j) = self.cell(theta, phi);
        let t = (theta - self.polar[i]) / (self.polar[i + 1] - self.polar[i]);
        let x = (phi - self.azimuth[j]) / (self.azimuth[j + 1] - self.azimuth[j]);
        let side = |j: usize| self.at(i, j) * (1.0 - t) + self.at(i + 1, j) * t;
        (side(j), side(j + 1), x)
    }

    pub fn value(&self, theta: f64, phi: f64) -> f64 {
        let (l, r, x) = self.ends(theta, phi);
        l * (1.0 - x) + r * x
    }

    /// Density in solid angle, 1/sr.
    pub fn density(&self, theta: f64, phi: f64) -> f64 {
        self.value(theta, phi) / self.total()
    }

    /// Distribution functions inside the point's cell: of theta, of phi given theta.
    pub fn inside_cell(&self, theta: f64, phi: f64) -> [f64; 2] {
        let (i, j) = self.cell(theta, phi);
        let whole = self.inside(i, j, self.towards_edges(i, self.polar[i + 1]));
        let (l, r, x) = self.ends(theta, phi);
        let along = self.inside(i, j, self.towards_edges(i, theta)) / whole;
        [along, if l + r > 0.0 { x * (2.0 * l + (r - l) * x) / (l + r) } else { x }]
    }

    /// The coordinates of a point where the first one chooses the cell, row by row, and its remainder theta.
    pub fn by_cell(&self, theta: f64, phi: f64) -> [f64; 2] {
        let (i, j) = self.cell(theta, phi);
        let [along, across] = self.inside_cell(theta, phi);
        let (below, here) = (self.below[i * self.columns() + j], self.part(i, j));
        [below / self.total() + here * along, across]
    }

    /// The coordinates of a point where the first one chooses the row and theta, the second one the column
    /// and phi.
    pub fn by_row(&self, theta: f64, phi: f64) -> [f64; 2] {
        let (i, j) = self.cell(theta, phi);
        let [along, across] = self.inside_cell(theta, phi);
        let n = self.columns();
        let (first, here, after) = (self.below[i * n], self.below[i * n + j], self.below[(i + 1) * n]);
        let row = after - first;
        [
            (first + row * along) / self.total(),
            (here - first + (self.below[i * n + j + 1] - here) * across) / row,
        ]
    }
}
