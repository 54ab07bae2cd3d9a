//! Standard errors from independent replicates (METHOD 7).
//!
//! A run traces R sets of n = N / R points under independent randomisations. A count summed over the
//! replicates has the standard error sqrt(R s^2), s^2 the variance of the R counts with R - 1 degrees of
//! freedom. A cell with fewer than 10 hits in all, whose spread says nothing, gets the Poisson error of (hits
//! + 1) instead, so it is never 0.

/// Hits below which a cell's own spread is not used.
pub const FEWEST_HITS: u64 = 10;

/// Standard error of a count summed over `replicates` replicates, in photons, for a cell; `None` for one
/// replicate: the points of one set are not independent and say nothing about their error.
#[inline]
pub fn standard_error_of_cell(sum: u64, square: u128, replicates: u32) -> Option<f64> {
    if replicates < 2 {
        return None;
    }
    if sum < FEWEST_HITS {
        return Some(((sum + 1) as f64).sqrt());
    }
    spread(sum, square, replicates)
}

/// Standard error of a total over `replicates` replicates, in photons: from the spread, but no less than one
/// photon. Points that are evenly spread can give the same count in every replicate, and the flux still lies
/// between two counts. Few hits owe the error of counting, as in a cell.
#[inline]
pub fn standard_error_of_total(sum: u64, square: u128, replicates: u32) -> Option<f64> {
    standard_error_of_cell(sum, square, replicates).map(|error| error.max(1.0))
}

/// From the spread alone.
#[inline]
fn spread(sum: u64, square: u128, replicates: u32) -> Option<f64> {
    let r = u128::from(replicates);
    if r < 2 {
        return None;
    }
    // R s^2 = (R sum of squares - square of the sum) / (R - 1), the difference exact in integers. It
    // overflows only beyond 2^64 photons; saturation keeps that from wrapping.
    let spread = r.saturating_mul(square).saturating_sub(u128::from(sum) * u128::from(sum));
    Some((spread as f64 / (r - 1) as f64).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn matches_the_textbook_formula() {
        let counts = [101u64, 97, 110, 92, 100];
        let sum: u64 = counts.iter().sum();
        let square: u128 = counts.iter().map(|c| u128::from(c * c)).sum();
        let mean = 100.0;
        let variance = counts.iter().map(|c| (*c as f64 - mean).powi(2)).sum::<f64>() / 4.0;
        let expected = (5.0 * variance).sqrt();
        assert!((standard_error_of_cell(sum, square, 5).unwrap() - expected).abs() < 1e-12);
    }

    #[test]
    fn errors_by_hand() {
        // Counts 3 and 7: s^2 = 8, R s^2 = 16. Counts 1, 2, 3, 6: s^2 = 14 / 3, R s^2 = 56 / 3.
        assert_eq!(standard_error_of_cell(10, 58, 2), Some(4.0));
        assert_eq!(standard_error_of_cell(12, 50, 4), Some((56.0f64 / 3.0).sqrt()));
        assert_eq!(standard_error_of_total(12, 50, 4), standard_error_of_cell(12, 50, 4));
        // From ten hits on the spread counts, whatever it is; a total is never surer than one photon.
        assert_eq!(standard_error_of_cell(9, 81, 2), Some(10.0f64.sqrt()));
        assert_eq!(standard_error_of_total(9, 81, 2), Some(10.0f64.sqrt()));
        assert_eq!(standard_error_of_cell(10, 50, 2), Some(0.0));
        assert_eq!(standard_error_of_total(10, 50, 2), Some(1.0));
        assert_eq!(standard_error_of_total(9, 81, 1), None);
        // 2^48 photons in one of 2^16 replicates: exact in 128 bits; beyond, saturated and not wrapped.
        let whole = standard_error_of_total(1 << 48, 1 << 96, 1 << 16).unwrap();
        assert_eq!(whole, (1u64 << 48) as f64);
        assert!(standard_error_of_total(u64::MAX, u128::MAX, 1 << 16).unwrap() > 0.0);
    }

    #[test]
    fn few_hits_are_never_certain_and_one_replicate_knows_nothing() {
        assert_eq!(standard_error_of_cell(0, 0, 8), Some(1.0));
        assert_eq!(standard_error_of_cell(3, 9, 8), Some(2.0));
        assert_eq!(standard_error_of_cell(100, 10_000, 1), None);
        assert_eq!(standard_error_of_cell(3, 9, 1), None);
        assert_eq!(standard_error_of_total(0, 0, 8), Some(1.0));
    }
}
