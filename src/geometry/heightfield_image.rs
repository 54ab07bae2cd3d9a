//! Heights from a grey picture.

use std::io::{BufReader, Seek, SeekFrom};
use std::path::Path;

use glam::DVec2;
use image::{ImageReader, Limits};

use crate::error::{Diagnostic, Kind, Result};

/// Samples a height image may have.
pub const MAX_HEIGHT_SAMPLES: usize = 1 << 26;

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
    /// Fewer than 2 columns or rows, a count that does not match, a height that is not finite.
    pub fn new(columns: usize, rows: usize, heights_m: Vec<f64>) -> Result<Self> {
        if columns < 2 || rows < 2 || columns.checked_mul(rows) != Some(heights_m.len()) {
            let found = format!("{} heights in {columns} columns and {rows} rows", heights_m.len());
            return Err(Diagnostic::new(
                Kind::Range,
                found,
                "at least 2 x 2 heights, as many as columns x rows",
            ));
        }
        if let Some(i) = heights_m.iter().position(|h| !h.is_finite()) {
            let found = format!("height {} at column {}, row {}", heights_m[i], i % columns, i / columns);
            return Err(Diagnostic::new(Kind::Range, found, "finite heights"));
        }
        Ok(Self { columns, rows, heights_m })
    }

    /// Reads a PNG of 8 or 16 bits: black is `low_m`, white `high_m` (m); colours count by their luma.
    ///
    /// # Errors
    /// A file that cannot be read, is no PNG, or has more than [`MAX_HEIGHT_SAMPLES`] pixels.
    pub fn read(path: &Path, low_m: f64, high_m: f64) -> Result<Self> {
        let refuse =
            |kind, found: String, required: &str| Diagnostic::new(kind, found, required).in_file(path);
        let file = std::fs::File::open(path)
            .map_err(|e| refuse(Kind::Io, format!("a file that cannot be opened: {e}"), "a PNG picture"))?;
        let no_png = |e: image::ImageError| {
            refuse(Kind::Syntax, format!("no readable PNG: {e}"), "a PNG of 8 or 16 bits")
        };
        let no_file =
            |e: std::io::Error| refuse(Kind::Io, format!("a file that cannot be read: {e}"), "a PNG picture");
        let mut source = BufReader::new(file);
        // The size is asked for before anything is decoded.
        let header = ImageReader::with_format(&mut source, image::ImageFormat::Png);
        let (width, height) = header.into_dimensions().map_err(no_png)?;
        let samples = u64::from(width) * u64::from(height);
        if samples > MAX_HEIGHT_SAMPLES as u64 {
            let required = format!("at most {MAX_HEIGHT_SAMPLES} pixels");
            return Err(refuse(Kind::Limit, format!("{width} x {height} pixels"), &required));
        }
        source.seek(SeekFrom::Start(0)).map_err(no_file)?;
        let mut reader = ImageReader::with_format(source, image::ImageFormat::Png);
        let mut limits = Limits::default();
        limits.max_alloc = Some(16 * MAX_HEIGHT_SAMPLES as u64);
        reader.limits(limits);
        let grey = reader.decode().map_err(no_png)?.into_luma16();
        let heights: Vec<f64> =
            grey.as_raw().iter().map(|&g| low_m + (high_m - low_m) * (f64::from(g) / 65535.0)).collect();
        Self::new(width as usize, height as usize, heights).map_err(|d| d.in_file(path))
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
    fn pictures_of_8_and_16_bits_are_read_and_damaged_ones_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("h.png");
        image::GrayImage::from_raw(3, 2, vec![0, 51, 255, 0, 0, 102]).unwrap().save(&path).unwrap();
        let h = HeightImage::read(&path, 1.0, 2.0).unwrap();
        assert_eq!(h.size(), [3, 2]);
        assert!((h.height_m(DVec2::new(0.5, 1.0)) - 1.2).abs() < 1e-15);
        assert!((h.height_m(DVec2::new(1.0, 0.0)) - 1.4).abs() < 1e-15);
        type Grey16 = image::ImageBuffer<image::Luma<u16>, Vec<u16>>;
        Grey16::from_raw(2, 2, vec![0, 1, 2, 65535]).unwrap().save(&path).unwrap();
        let h = HeightImage::read(&path, 0.0, 65.535).unwrap();
        assert!((h.height_m(DVec2::new(1.0, 1.0)) - 0.001).abs() < 1e-15);
        let bytes = std::fs::read(&path).unwrap();
        for cut in 0..bytes.len() - 12 {
            std::fs::write(&path, &bytes[..cut]).unwrap();
            assert_eq!(HeightImage::read(&path, 0.0, 1.0).unwrap_err().file(), path.to_str());
        }
        assert_eq!(
            HeightImage::read(&folder.path().join("none.png"), 0.0, 1.0).unwrap_err().kind(),
            Kind::Io
        );
    }

    #[test]
    fn wrong_counts_are_refused() {
        assert!(HeightImage::new(1, 3, vec![0.0; 3]).is_err());
        assert!(HeightImage::new(2, 2, vec![0.0; 5]).is_err());
        assert!(HeightImage::new(usize::MAX, 2, vec![0.0; 5]).is_err());
        assert!(HeightImage::new(2, 2, vec![0.0, 0.0, f64::NAN, 0.0]).is_err());
    }
}
