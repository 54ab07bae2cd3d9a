//! Kolmogorov-Smirnov against the uniform distribution, of any number of values in fixed memory.

use crate::lab::certificate::statistics::kolmogorov_smirnov_tail;
use crate::lab::certificate::{Test, TestName};

/// Bins of [0, 1]: the distance is measured at their edges. That is at most the distance of the test, so its
/// p-value is an upper bound; of n values it is short by some 1/sqrt(bins n), a five-hundredth of the
/// distances that matter.
const BINS: usize = 1 << 18;

/// Counts of values in bins of [0, 1].
#[derive(Debug, Clone)]
pub(crate) struct Uniformity {
    bins: Vec<u64>,
    values: u64,
}

impl Uniformity {
    pub(crate) fn new() -> Self {
        Self { bins: vec![0; BINS], values: 0 }
    }

    /// Takes a value of [0, 1].
    #[inline]
    pub(crate) fn add(&mut self, value: f64) {
        let bin = ((value * BINS as f64) as usize).min(BINS - 1);
        self.bins[bin] += 1;
        self.values += 1;
    }

    /// The largest distance between the share of values below an edge and the edge.
    fn distance(&self) -> f64 {
        let (mut below, mut largest) = (0, 0.0f64);
        for (bin, count) in self.bins.iter().enumerate() {
            below += count;
            let edge = (bin + 1) as f64 / BINS as f64;
            largest = largest.max((below as f64 / self.values as f64 - edge).abs());
        }
        largest
    }

    pub(crate) fn test(&self, name: TestName) -> Test {
        if self.values == 0 {
            return Test::new(name, 0.0, None, 1.0);
        }
        let distance = self.distance();
        Test::new(name, distance, None, kolmogorov_smirnov_tail(distance, self.values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_of_known_samples() {
        let of = |values: &[f64]| {
            let mut uniformity = Uniformity::new();
            values.iter().for_each(|v| uniformity.add(*v));
            uniformity.distance()
        };
        let bin = 1.0 / BINS as f64;
        assert!((of(&[0.5]) - 0.5).abs() <= bin);
        assert!((of(&[0.0]) - 1.0).abs() <= bin);
        assert!((of(&[1.0]) - 1.0).abs() <= bin);
        assert!((of(&[0.1, 0.2, 0.3, 0.4]) - 0.6).abs() <= bin);
        let even: Vec<f64> = (0..1000).map(|i| (f64::from(i) + 0.5) / 1000.0).collect();
        assert!((of(&even) - 0.0005).abs() <= bin);
    }
}
