//! Maps at another resolution, and smoothed maps. NaN and infinities are cells without a value: they take no part in
//! an average, and where nothing else is there the result is NaN.

/// Area-weighted average of a `width` x `height` map on as many cells as `new` says, over the same rectangle.
/// At a multiple of the resolution this is the nearest neighbour.
pub fn area_average(values: &[f64], [width, height]: [usize; 2], new: [usize; 2]) -> Vec<f64> {
    let [new_width, new_height] = new;
    let columns: Vec<_> = (0..new_width).map(|i| overlaps(i, width, new_width)).collect();
    let mut result = Vec::with_capacity(new_width * new_height);
    // Magnified rows repeat; the last one made is kept.
    let mut last: Option<Vec<(usize, f64)>> = None;
    for j in 0..new_height {
        let rows = overlaps(j, height, new_height);
        let repeats = rows.len() == 1 && last.as_ref().is_some_and(|l| l.len() == 1 && l[0].0 == rows[0].0);
        if repeats {
            let start = result.len() - new_width;
            result.extend_from_within(start..);
            continue;
        }
        for column in &columns {
            let (mut sum, mut weight) = (0.0, 0.0);
            for &(y, share_y) in &rows {
                for &(x, share_x) in column {
                    let value = values[y * width + x];
                    if value.is_finite() {
                        sum += value * share_x * share_y;
                        weight += share_x * share_y;
                    }
                }
            }
            result.push(if weight > 0.0 { sum / weight } else { f64::NAN });
        }
        last = Some(rows);
    }
    result
}

/// Source cells that cell `i` of `new` covers when `old` cells span the same length, with the covered share.
fn overlaps(i: usize, old: usize, new: usize) -> Vec<(usize, f64)> {
    // In units of 1 / (old new) everything is an integer: no sliver of a neighbour by rounding.
    let (start, end) = (i * old, (i + 1) * old);
    (start / new..end.div_ceil(new))
        .map(|k| (k, (end.min((k + 1) * new) - start.max(k * new)) as f64 / new as f64))
        .collect()
}

/// The map convolved with a Gaussian of this standard deviation in cells, normalised over the cells that have a value
/// (so borders neither darken nor pull); cells without one keep none.
pub fn gaussian(values: &[f64], [width, height]: [usize; 2], sigma: f64) -> Vec<f64> {
    if sigma.is_nan() || sigma <= 0.0 {
        return values.to_vec();
    }
    let reach = (3.0 * sigma).ceil() as usize;
    let kernel: Vec<f64> =
        (0..=reach).map(|k| libm::exp(-0.5 * (k as f64 / sigma) * (k as f64 / sigma))).collect();
    let sums: Vec<[f64; 2]> =
        values.iter().map(|&v| if v.is_finite() { [v, 1.0] } else { [0.0; 2] }).collect();
    let rows = convolve(&sums, width, 1, &kernel);
    let both = convolve(&rows, height, width, &kernel);
    let value = |(sum, old): (&[f64; 2], &f64)| if old.is_finite() { sum[0] / sum[1] } else { f64::NAN };
    both.iter().zip(values).map(value).collect()
}

/// Sums and weights convolved along lines of `count` cells that lie `stride` apart.
fn convolve(cells: &[[f64; 2]], count: usize, stride: usize, kernel: &[f64]) -> Vec<[f64; 2]> {
    let reach = kernel.len() - 1;
    (0..cells.len())
        .map(|index| {
            let along = index / stride % count;
            let start = index - along * stride;
            let mut total = [0.0; 2];
            for k in along.saturating_sub(reach)..=(along + reach).min(count - 1) {
                let [sum, weight] = cells[start + k * stride];
                let factor = kernel[k.abs_diff(along)];
                total[0] += factor * sum;
                total[1] += factor * weight;
            }
            total
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn magnifying_repeats_cells_and_shrinking_keeps_the_mean() {
        let map = [1.0, 2.0, 3.0, 4.0, f64::NAN, 6.0];
        let big = area_average(&map, [3, 2], [12, 6]);
        for y in 0..6 {
            for x in 0..12 {
                let (value, cell) = (big[y * 12 + x], map[y / 3 * 3 + x / 4]);
                assert!(value.to_bits() == cell.to_bits() || (value.is_nan() && cell.is_nan()), "{x} {y}");
            }
        }
        let map: Vec<f64> = (0..35).map(|i| ((i * 37) % 35) as f64).collect();
        let small = area_average(&map, [7, 5], [3, 2]);
        let mean = small.iter().sum::<f64>() / 6.0;
        assert!((mean - 17.0).abs() < 1e-12, "{mean}");
        assert_eq!(area_average(&[5.0, f64::NAN], [2, 1], [1, 1]), [5.0]);
    }

    #[test]
    fn gaussian_has_its_variance_and_leaves_constants_and_holes() {
        let mut map = vec![0.0; 101 * 3];
        map[101 + 50] = 1.0;
        let smooth = gaussian(&map, [101, 3], 4.0);
        let row = &smooth[101..202];
        let total: f64 = row.iter().sum();
        let variance: f64 =
            row.iter().enumerate().map(|(i, v)| v * (i as f64 - 50.0).powi(2)).sum::<f64>() / total;
        // A Gaussian cut at three standard deviations has 0.9733 of its variance; a sample sum adds little.
        assert!((variance / 16.0 - 0.9733).abs() < 0.02, "{variance}");
        let flat = gaussian(&[2.0, 2.0, f64::NAN, 2.0], [2, 2], 1.3);
        assert!(flat[2].is_nan() && flat.iter().filter(|v| (**v - 2.0).abs() < 1e-15).count() == 3);
    }
}
