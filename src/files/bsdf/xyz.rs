//! Tristimulus values to linear sRGB, luminance kept.

use crate::units::LUMINANCE_OF_RGB;

/// Linear sRGB to XYZ (IEC 61966-2-1, four decimals as printed there); the middle row are the luminances.
const XYZ_OF_RGB: [[f64; 3]; 3] = [[0.4124, 0.3576, 0.1805], LUMINANCE_OF_RGB, [0.0193, 0.1192, 0.9505]];

/// Linear sRGB of a tristimulus value (white of D65, Y = 1), with the same Y: what lies outside the gamut loses its
/// negative channels, and the others are scaled until the luminance is Y again. True where that was so.
pub(crate) fn linear_srgb(xyz: [f64; 3]) -> ([f64; 3], bool) {
    let m = &XYZ_OF_RGB;
    let minor = |r: [usize; 2], c: [usize; 2]| m[r[0]][c[0]] * m[r[1]][c[1]] - m[r[0]][c[1]] * m[r[1]][c[0]];
    // Cofactors of the first column and so on: Cramer's rule for the three channels.
    let others = [[1, 2], [0, 2], [0, 1]];
    let cofactor = |row: usize, column: usize| {
        let sign = if (row + column).is_multiple_of(2) { 1.0 } else { -1.0 };
        sign * minor(others[row], others[column])
    };
    let determinant: f64 = (0..3).map(|r| m[r][0] * cofactor(r, 0)).sum();
    let channel = |c: usize| (0..3).map(|r| xyz[r] * cofactor(r, c)).sum::<f64>() / determinant;
    let rgb = [channel(0), channel(1), channel(2)];
    let luminance = |rgb: [f64; 3]| (0..3).map(|c| LUMINANCE_OF_RGB[c] * rgb[c]).sum::<f64>();
    let kept = rgb.map(|x| x.max(0.0));
    // Rounding of a colour on the gamut's border is no clipping.
    let outside = (0..3).any(|c| rgb[c] < -1e-3 * luminance(kept));
    let y = luminance(kept);
    let scale = if y > 0.0 { xyz[1].max(0.0) / y } else { 0.0 };
    (kept.map(|x| x * scale), outside)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_is_white_and_luminance_stays() {
        let white = [0.9505, 1.0, 1.0890];
        let (rgb, outside) = linear_srgb(white);
        assert!(rgb.iter().all(|c| (c - 1.0).abs() < 1e-12) && !outside, "{rgb:?}");
        for xyz in [[0.2, 0.3, 0.1], [0.0, 0.5, 0.0], [0.9, 0.1, 0.0]] {
            let (rgb, outside) = linear_srgb(xyz);
            let y: f64 = rgb.iter().zip(LUMINANCE_OF_RGB).map(|(c, l)| c * l).sum();
            assert!((y - xyz[1]).abs() < 1e-15, "{xyz:?}: {rgb:?}");
            assert_eq!(outside, xyz != [0.2, 0.3, 0.1], "{rgb:?}");
        }
        assert_eq!(linear_srgb([0.0, 0.0, 0.3]).0, [0.0; 3], "no luminance, no light");
    }
}
