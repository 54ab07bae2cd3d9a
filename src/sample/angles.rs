//! The angles of a table on the sphere: rows between polar angles, columns between azimuths, and the cell
//! that holds a direction.
//!
//! Measure: solid angle, sin(theta) dtheta dphi; theta is counted from the pole, where that weight vanishes.
//! Between nodes values are bilinear in theta and phi (METHOD 3, eq. 7).

use std::f64::consts::PI;

use crate::error::{Diagnostic, Kind, Result};
use crate::math::trig::{InCell, sin_cos};

/// Most nodes of a table: 16 times the largest one seen in the wild (721 x 361).
pub const MAX_NODES: usize = 1 << 22;

/// Rounding that angles of a table and angles of directions are allowed, relative to the largest angle
/// involved.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// A band of the sphere between two polar angles.
#[derive(Debug, Clone, Copy)]
pub struct Row {
    /// Polar angle of the near edge, theta1.
    pub theta: f64,
    /// dt, positive.
    pub width: f64,
    pub(super) inverse_width: f64,
    /// sin theta1 and cos theta1.
    pub(super) sin: f64,
    pub(super) cos: f64,
    /// sin theta2, at least 0.
    pub(super) sin_end: f64,
}

impl Row {
    /// The row between two polar angles, 0 <= theta1 < theta2 <= pi.
    pub fn new(theta1: f64, theta2: f64) -> Self {
        let (sin, cos) = libm::sincos(theta1);
        let width = theta2 - theta1;
        let sin_end = libm::sin(theta2).max(0.0);
        Self { theta: theta1, width, inverse_width: 1.0 / width, sin, cos, sin_end }
    }

    /// cos(theta1) - cos(theta2).
    pub(super) fn cap(&self) -> f64 {
        let t = InCell::at(self.width);
        self.sin * t.sin + self.cos * t.versine
    }
}

/// A lune of the sphere between two azimuths.
#[derive(Debug, Clone, Copy)]
pub struct Column {
    /// Azimuth of the near edge, phi1.
    pub phi: f64,
    /// dp, positive.
    pub width: f64,
    sin: f64,
    cos: f64,
}

impl Column {
    /// The column between two azimuths, phi1 < phi2.
    pub fn new(phi1: f64, phi2: f64) -> Self {
        let (sin, cos) = libm::sincos(phi1);
        Self { phi: phi1, width: phi2 - phi1, sin, cos }
    }

    /// (sin, cos) of the azimuth a fraction x into the column.
    #[inline]
    pub(super) fn azimuth(&self, x: f64) -> (f64, f64) {
        let (sin, cos) = sin_cos(x * self.width);
        (self.sin * cos + self.cos * sin, self.cos * cos - self.sin * sin)
    }
}

/// The angles of a table.
#[derive(Debug, Clone)]
pub(super) struct Angles {
    pub rows: Vec<Row>,
    pub columns: Vec<Column>,
}

/// A direction's place in a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Located {
    /// Index of the row.
    pub row: usize,
    /// Index of the column.
    pub column: usize,
    /// theta - theta1, in [0, dt].
    pub s: f64,
    /// Fraction of the column, in [0, 1].
    pub x: f64,
}

fn out_of_range<T>(found: String, required: &str) -> Result<T> {
    Err(Diagnostic::new(Kind::Range, found, required))
}

impl Angles {
    /// Polar angles within [0, pi] and azimuths within one turn, radians, both strictly rising.
    ///
    /// # Errors
    /// Anything else; fewer than two angles of either kind; more than [`MAX_NODES`] pairs.
    pub fn new(polar: &[f64], azimuth: &[f64]) -> Result<Self> {
        if polar.len() < 2 || azimuth.len() < 2 {
            let found = format!("{} polar and {} azimuth angles", polar.len(), azimuth.len());
            return out_of_range(found, "at least two of each");
        }
        if polar.len().checked_mul(azimuth.len()).is_none_or(|n| n > MAX_NODES) {
            let found = format!("{} x {} angles", polar.len(), azimuth.len());
            return out_of_range(found, "at most 2^22 pairs");
        }
        let rising = |angles: &[f64]| angles.windows(2).all(|w| w[0] < w[1]);
        if !rising(polar) || !rising(azimuth) {
            return out_of_range(
                "angles that do not rise".into(),
                "strictly rising polar angles and azimuths",
            );
        }
        let (first, last) = (polar[0], polar[polar.len() - 1]);
        let turn = azimuth[azimuth.len() - 1] - azimuth[0];
        // A full turn in radians is known to rounding only. Infinities rise too.
        if !(first >= 0.0 && last <= PI && turn <= 2.0 * PI * (1.0 + 2.0 * ROUNDING)) {
            let found = format!("polar {first} to {last}, azimuth over {turn}");
            return out_of_range(found, "polar angles within [0, pi] and azimuths within one turn");
        }
        Ok(Self {
            rows: polar.windows(2).map(|w| Row::new(w[0], w[1])).collect(),
            columns: azimuth.windows(2).map(|w| Column::new(w[0], w[1])).collect(),
        })
    }

    /// The largest of a table's values, `values[i * azimuths + j]`.
    ///
    /// # Errors
    /// Another number of values than nodes; values that are negative or not finite.
    pub fn largest(&self, values: &[f64]) -> Result<f64> {
        if values.len() != self.node_count() {
            let found = format!("{} values for {} nodes", values.len(), self.node_count());
            return out_of_range(found, "one value for each node");
        }
        match values.iter().find(|v| !(**v >= 0.0 && v.is_finite())) {
            Some(bad) => out_of_range(bad.to_string(), "finite values that are not negative"),
            None => Ok(values.iter().copied().fold(0.0, f64::max)),
        }
    }

    pub fn node_count(&self) -> usize {
        (self.rows.len() + 1) * (self.columns.len() + 1)
    }

    pub fn cell_count(&self) -> usize {
        self.rows.len() * self.columns.len()
    }

    /// First and last polar angle, first and last azimuth, radians.
    pub fn range(&self) -> ([f64; 2], [f64; 2]) {
        let (first, last) = (&self.rows[0], &self.rows[self.rows.len() - 1]);
        ([first.theta, (last.theta + last.width).min(PI)], self.azimuths())
    }

    /// The place of (theta, phi), phi up to full turns; `None` outside the table. An edge between two cells
    /// belongs to the second of them; the outer edges belong to the table, with the rounding of an angle.
    pub fn locate(&self, theta: f64, phi: f64) -> Option<Located> {
        let [first, last] = self.azimuths();
        let turn = last - first;
        let turns = libm::floor((phi - first) / (2.0 * PI));
        let phi = if (first..=first + turn).contains(&phi) { phi } else { phi - 2.0 * PI * turns };
        let start = self.rows[0].theta;
        let theta = if theta < start && start - theta <= ROUNDING * start { start } else { theta };
        let i = self.rows.partition_point(|r| r.theta <= theta).checked_sub(1)?;
        let j = self.columns.partition_point(|c| c.phi <= phi).checked_sub(1)?;
        let (row, column) = (&self.rows[i], &self.columns[j]);
        let (s, t) = (theta - row.theta, phi - column.phi);
        // Only in the last row and column can a point lie beyond the far edge by more than rounding.
        let is_over = |over: f64, angle: f64, is_last: bool| is_last && over > ROUNDING * angle;
        if is_over(s - row.width, theta, i + 1 == self.rows.len())
            || is_over(t - column.width, phi.abs().max(turn), j + 1 == self.columns.len())
        {
            return None;
        }
        Some(Located { row: i, column: j, s: s.min(row.width), x: (t / column.width).min(1.0) })
    }

    /// First and last azimuth, radians.
    fn azimuths(&self) -> [f64; 2] {
        let (left, right) = (&self.columns[0], &self.columns[self.columns.len() - 1]);
        [left.phi, right.phi + right.width]
    }

    /// A1, A2, B1, B2 of a cell.
    #[inline]
    pub fn corners<N: Copy + Into<f64>>(&self, nodes: &[N], row: usize, column: usize) -> [f64; 4] {
        let stride = self.columns.len() + 1;
        let near = &nodes[row * stride + column..][..2];
        let far = &nodes[(row + 1) * stride + column..][..2];
        [near[0], near[1], far[0], far[1]].map(Into::into)
    }

    /// The bilinear value (7) of nodes.
    #[inline]
    pub fn value<N: Copy + Into<f64>>(&self, nodes: &[N], at: &Located) -> f64 {
        let [a1, a2, b1, b2] = self.corners(nodes, at.row, at.column);
        let t = at.s / self.rows[at.row].width;
        let near = a1 * (1.0 - at.x) + a2 * at.x;
        let far = b1 * (1.0 - at.x) + b2 * at.x;
        near * (1.0 - t) + far * t
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.rows.capacity() * size_of::<Row>() + self.columns.capacity() * size_of::<Column>()
    }
}
