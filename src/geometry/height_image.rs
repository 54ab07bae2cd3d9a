//! Heights at the nodes of a grid.

use glam::DVec2;

use crate::error::Invalid;
use crate::error::invalid::Interval;

/// Amplitudes of waves and heights of pictures, m.
pub const HEIGHT: Interval = Interval { low: -1e9, high: 1e9, words: "a height from -1e9 to 1e9 m" };

/// A grid of heights (m), rows from the far (greatest y) edge to the near one, as a picture is stored.
#[derive(Debug, Clone, PartialEq)]
pub struct HeightImage {
    columns: usize,
    rows: usize,
    heights_m: Vec<f64>,
}

impl HeightImage {
    /// Heights (m), row by row, the first row at the greatest y.
    ///
    /// # Errors
    /// Fewer than 2 columns or rows, a count that does not match, a height out of range.
    pub fn new(columns: usize, rows: usize, heights_m: Vec<f64>) -> Result<Self, Invalid> {
        if columns < 2 || rows < 2 || columns.checked_mul(rows) != Some(heights_m.len()) {
            return Err(Invalid::Shape {
                what: "image",
                found: format!("{} heights in {columns} columns and {rows} rows", heights_m.len()),
                required: "at least 2 x 2 heights, as many as columns x rows",
            });
        }
        heights_m.iter().try_for_each(|&h| HEIGHT.check("height", h).map(|_| ()))?;
        Ok(Self { columns, rows, heights_m })
    }

    /// Columns and rows.
    pub fn size(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// Height (m) at a fraction of the rectangle, (0, 0) at least x and y; bilinear between samples, which lie on the
    /// rectangle's edges too.
    pub fn height_m(&self, at: DVec2) -> f64 {
        let x = at.x.clamp(0.0, 1.0) * (self.columns - 1) as f64;
        let y = (1.0 - at.y.clamp(0.0, 1.0)) * (self.rows - 1) as f64;
        let (i, j) = ((x as usize).min(self.columns - 2), (y as usize).min(self.rows - 2));
        let (u, v) = (x - i as f64, y - j as f64);
        let h = |di: usize, dj: usize| self.heights_m[(j + dj) * self.columns + i + di];
        let near = h(0, 0) + u * (h(1, 0) - h(0, 0));
        let far = h(0, 1) + u * (h(1, 1) - h(0, 1));
        near + v * (far - near)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn first_row_is_the_far_edge_and_bilinear_is_exact_for_planes() {
        let heights = (0..12).map(|i| f64::from(i % 4) + 10.0 * f64::from(2 - i / 4)).collect();
        let image = HeightImage::new(4, 3, heights).unwrap();
        for (x, y) in [(0.0, 0.0), (1.0, 1.0), (0.3, 0.9), (0.77, 0.1)] {
            assert!((image.height_m(DVec2::new(x, y)) - (3.0 * x + 20.0 * y)).abs() < 1e-13);
        }
    }

    #[test]
    fn wrong_counts_are_refused() {
        assert!(HeightImage::new(1, 3, vec![0.0; 3]).is_err());
        assert!(HeightImage::new(2, 2, vec![0.0; 5]).is_err());
        assert!(HeightImage::new(usize::MAX, 2, vec![0.0; 5]).is_err());
        assert!(HeightImage::new(2, 2, vec![0.0, 0.0, f64::NAN, 0.0]).is_err());
    }
}
