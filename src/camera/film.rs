//! Pixels: luminance, standard error, bias.

/// A picture being made. `C` channels: 1 (luminance) or 3 (linear sRGB whose Y is luminance), cd/m2.
#[derive(Debug, Clone, PartialEq)]
pub struct Film<const C: usize> {
    /// Columns and rows.
    pub pixels: [u32; 2],
    /// Row by row from the top left.
    pub value: Vec<[f64; C]>,
    /// Standard error of the luminance, cd/m2; NaN where there is none.
    pub standard_error: Vec<f64>,
    /// Estimated bias of the luminance, cd/m2.
    pub bias: Vec<f64>,
}
