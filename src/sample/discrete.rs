//! A table of discrete events with a guide: choice by one look-up and a short walk, monotone in u.
//!
//! Guide tables (Chen and Asau 1974) keep u monotone, so a net stays a net in the chosen event; an alias
//! table would not. Division by an event's width is a multiplication by its stored reciprocal.

use super::choose::{Reusable, TWO_TO_64, integer_widths};

/// One event of positive probability.
#[derive(Debug, Clone, Copy)]
struct Entry {
    /// First 64-bit fraction that belongs to the event.
    low: u64,
    /// Number of fractions that belong to it; 0 stands for all 2^64 (a single event).
    width: u64,
    /// floor((2^128 - 1) / w) - 2^64 for the width w shifted to the left end of the word.
    reciprocal: u64,
    /// Index of the event in the weights the table was made from.
    event: u32,
}

/// Events chosen in proportion to weights.
#[derive(Debug, Clone)]
pub struct Discrete {
    entries: Vec<Entry>,
    /// For each leading bits of u, the entry that owns the first fraction with those bits.
    guide: Vec<u32>,
    shift: u32,
}

impl Discrete {
    /// Events in proportion to these weights (non-negative, finite, fewer than 2^32); `None` where none is
    /// positive.
    pub fn new(weights: &[f64]) -> Option<Self> {
        let positive = |k: &usize| weights[*k] > 0.0;
        let mut entries = Vec::with_capacity(weights.len());
        match integer_widths(weights) {
            Some(widths) => {
                let mut low = 0u64;
                for (event, &width) in widths.iter().enumerate().filter(|(_, w)| **w > 0) {
                    entries.push(Entry { low, width, reciprocal: reciprocal(width), event: event as u32 });
                    low = low.wrapping_add(width);
                }
            }
            None => {
                let all_valid = weights.iter().all(|w| *w >= 0.0 && w.is_finite());
                let event = (0..weights.len()).find(positive).filter(|_| all_valid)?;
                entries.push(Entry { low: 0, width: 0, reciprocal: 0, event: event as u32 });
            }
        }
        let bits = (2 * entries.len()).next_power_of_two().trailing_zeros().clamp(1, 31);
        let shift = 64 - bits;
        let mut guide = Vec::with_capacity(1 << bits);
        let mut at = 0;
        for slot in 0..1u64 << bits {
            while at + 1 < entries.len() && entries[at + 1].low <= slot << shift {
                at += 1;
            }
            guide.push(at as u32);
        }
        Some(Self { entries, guide, shift })
    }

    /// Chooses an event with what is left of `u`, and renormalises it: (index of the event, its probability).
    /// A table of one event leaves u as it is.
    #[inline]
    pub fn choose(&self, u: &mut Reusable) -> (usize, f64) {
        let bits = u.bits();
        let mut at = self.guide[(bits >> self.shift) as usize] as usize;
        while at + 1 < self.entries.len() && self.entries[at + 1].low <= bits {
            at += 1;
        }
        let entry = self.entries[at];
        if entry.width == 0 {
            return (entry.event as usize, 1.0);
        }
        let probability = entry.width as f64 / TWO_TO_64;
        u.renormalised(quotient(bits - entry.low, entry), probability);
        (entry.event as usize, probability)
    }

    /// Whether there is anything to choose.
    pub fn is_single(&self) -> bool {
        self.entries.len() == 1
    }

    /// Bytes held.
    pub fn memory_bytes(&self) -> usize {
        self.entries.capacity() * size_of::<Entry>() + self.guide.capacity() * size_of::<u32>()
    }
}

fn reciprocal(width: u64) -> u64 {
    let normalised = width << width.leading_zeros();
    (u128::MAX / u128::from(normalised) - (1 << 64)) as u64
}

/// d / width as a 64-bit fraction, at most two units too small, never too large (Moeller and Granlund 2011).
#[inline]
fn quotient(d: u64, entry: Entry) -> u64 {
    let d = d << entry.width.leading_zeros();
    ((u128::from(d) * u128::from(entry.reciprocal)) >> 64) as u64 + d
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::hash::mix64;

    #[test]
    fn choice_and_remainder_match_exact_division() {
        let weights = [0.0, 3.0, 1e-9, 0.0, 5.0, 0.1, 1e-12, 0.0];
        let table = Discrete::new(&weights).unwrap();
        let widths = integer_widths(&weights).unwrap();
        let mut lows = vec![0u128];
        for w in &widths {
            lows.push(lows[lows.len() - 1] + u128::from(*w));
        }
        let edges = lows.iter().flat_map(|l| [l.wrapping_sub(1) as u64, *l as u64, (l + 1) as u64]);
        for bits in (0..20_000).map(mix64).chain(edges) {
            let mut u = Reusable::fresh(bits);
            let (k, p) = table.choose(&mut u);
            let expected = (0..weights.len())
                .find(|&k| lows[k] <= u128::from(bits) && u128::from(bits) < lows[k + 1])
                .unwrap();
            assert_eq!(k, expected);
            assert!(weights[k] > 0.0);
            let exact = ((u128::from(bits) - lows[k]) << 64) / u128::from(widths[k]);
            assert!(exact - u128::from(u.bits()) <= 2, "{bits}");
            assert!((p - weights[k] / weights.iter().sum::<f64>()).abs() <= 1e-15);
        }
    }

    #[test]
    fn single_and_empty_tables() {
        assert!(Discrete::new(&[]).is_none());
        assert!(Discrete::new(&[0.0, 0.0]).is_none());
        assert!(Discrete::new(&[0.0, f64::NAN]).is_none());
        let one = Discrete::new(&[0.0, 7.0, 0.0]).unwrap();
        for bits in [0, 12345, u64::MAX] {
            let mut u = Reusable::fresh(bits);
            assert_eq!(one.choose(&mut u), (1, 1.0));
            assert_eq!(u.bits(), bits);
        }
        assert!(one.is_single());
    }

    #[test]
    fn frequencies_match_weights_by_chi_square() {
        let weights: Vec<f64> =
            (0..300).map(|k| if k % 7 == 0 { 0.0 } else { f64::from(k * k % 97) }).collect();
        let table = Discrete::new(&weights).unwrap();
        let total: f64 = weights.iter().sum();
        let n = 1_000_000u64;
        let mut count = vec![0u64; weights.len()];
        for i in 0..n {
            let (k, _) = table.choose(&mut Reusable::fresh(mix64(i.wrapping_mul(0x9e37_79b9_7f4a_7c15))));
            count[k] += 1;
        }
        let mut chi2 = 0.0;
        let mut degrees = -1.0;
        for (c, w) in count.iter().zip(&weights) {
            let expected = w / total * n as f64;
            if expected == 0.0 {
                assert_eq!(*c, 0);
            } else {
                chi2 += (*c as f64 - expected).powi(2) / expected;
                degrees += 1.0;
            }
        }
        let z = (chi2 - degrees) / f64::sqrt(2.0 * degrees);
        assert!(z.abs() < 4.5, "chi2 {chi2} for {degrees} degrees");
    }
}
