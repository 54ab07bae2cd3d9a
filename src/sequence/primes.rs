//! The first primes: bases of radical inverses, radicands of Weyl's square roots.

use super::LOW_DISCREPANCY_COORDINATES;

/// The first 64 primes, 2 to 311: one a coordinate.
pub const PRIMES: [u64; LOW_DISCREPANCY_COORDINATES as usize] = first_primes();

const fn first_primes() -> [u64; LOW_DISCREPANCY_COORDINATES as usize] {
    let mut primes = [0; LOW_DISCREPANCY_COORDINATES as usize];
    let (mut found, mut candidate) = (0, 2);
    while found < primes.len() {
        let mut k = 0;
        while k < found && candidate % primes[k] != 0 {
            k += 1;
        }
        if k == found {
            primes[found] = candidate;
            found += 1;
        }
        candidate += 1;
    }
    primes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn they_are_the_first_64_primes() {
        assert_eq!(PRIMES[..10], [2, 3, 5, 7, 11, 13, 17, 19, 23, 29]);
        // The 64th prime and the sum of the first 64 (OEIS A000040, A007504).
        assert_eq!((PRIMES[63], PRIMES.iter().sum::<u64>()), (311, 8893));
    }
}
