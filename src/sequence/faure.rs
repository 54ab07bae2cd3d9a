//! Faure's permutations of digits, which loosen the ties between neighbouring large bases of a Halton sequence.
//!
//! H. Faure, "Good permutations for extreme discrepancy", J. Number Theory 42 (1992) 47-56. All of them leave 0 where it
//! is, so the infinitely many leading zeros of an index stay zeros and sums over digits stay finite.

/// The permutation sigma_b of the digits 0..b, by recursion from sigma_2 = (0 1): for even b, twice sigma_(b/2), then
/// the same plus 1; for odd b, sigma_(b-1) with its values from (b - 1) / 2 on raised by 1, and (b - 1) / 2 in the middle.
pub fn faure_permutation(base: u64) -> Vec<u64> {
    if base <= 2 {
        return (0..base).collect();
    }
    if base.is_multiple_of(2) {
        let half = faure_permutation(base / 2);
        return half.iter().map(|s| 2 * s).chain(half.iter().map(|s| 2 * s + 1)).collect();
    }
    let middle = (base - 1) / 2;
    let mut permutation: Vec<u64> =
        faure_permutation(base - 1).into_iter().map(|s| if s >= middle { s + 1 } else { s }).collect();
    permutation.insert(middle as usize, middle);
    permutation
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_bases_are_the_published_ones() {
        for (base, expected) in [
            (2, &[0, 1][..]),
            (3, &[0, 1, 2]),
            (4, &[0, 2, 1, 3]),
            (5, &[0, 3, 2, 1, 4]),
            (6, &[0, 2, 4, 1, 3, 5]),
            (7, &[0, 2, 5, 3, 1, 4, 6]),
            (8, &[0, 4, 2, 6, 1, 5, 3, 7]),
        ] {
            assert_eq!(faure_permutation(base), expected, "base {base}");
        }
    }

    #[test]
    fn each_is_a_permutation_that_keeps_zero_and_is_symmetric() {
        for base in 2..400 {
            let permutation = faure_permutation(base);
            let mut sorted = permutation.clone();
            sorted.sort_unstable();
            assert_eq!(sorted, (0..base).collect::<Vec<_>>());
            assert_eq!(permutation[0], 0);
            // sigma(b - 1 - d) = b - 1 - sigma(d): seen in every published one.
            for d in 0..base {
                assert_eq!(permutation[(base - 1 - d) as usize], base - 1 - permutation[d as usize]);
            }
        }
    }
}
