//! Discrete events on one coordinate, and the renormalisation of what is left of it (METHOD 2, paper eq. 5).
//!
//! Everything works on 64-bit fractions: event k owns the integers [T_k, T_k + w_k), and u' = (u - T_k) / w_k
//! is again a 64-bit fraction, below 1 by construction because u - T_k < w_k. An event of probability zero
//! owns no integer and is never chosen.

use crate::sequence::to_unit_f64;

/// A coordinate that serves several discrete events in turn, and the record of how much of it is used up.
#[derive(Debug, Clone, Copy)]
pub struct Reusable {
    bits: u64,
    /// Product of the probabilities of the events chosen so far; -log2 of it is the number of bits spent.
    span: f64,
}

/// The fractions that an event owns.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Share {
    /// The first one.
    pub low: u64,
    /// How many; 0 stands for all 2^64.
    pub width: u64,
}

impl Share {
    /// All fractions.
    pub const ALL: Self = Self { low: 0, width: 0 };

    /// The part of all fractions that belongs to the event: its probability.
    #[inline]
    pub fn probability(self) -> f64 {
        if self.width == 0 { 1.0 } else { self.width as f64 / TWO_TO_64 }
    }

    /// What [`Reusable::take`] leaves of a fraction of the event, for a last use: to 53 bits and below 1.
    #[inline]
    pub fn rest(self, bits: u64) -> f64 {
        match self.width {
            0 => to_unit_f64(bits),
            width => below_one((bits - self.low) as f64 / width as f64),
        }
    }

    /// Chooses a part of this event. `v` is a fraction within the event; `find` gives the part that owns a fraction of the
    /// whole. Returns what was found, the part's probability in this event, and what is left of v for a last use.
    #[inline]
    pub fn choose_part<R>(self, v: u64, find: impl FnOnce(u64) -> (R, Self)) -> (R, f64, f64) {
        if self.width == 0 {
            let (found, part) = find(v);
            return (found, part.probability(), part.rest(v));
        }
        let product = u128::from(v) * u128::from(self.width);
        let at = self.low + (product >> 64) as u64;
        let (found, part) = find(at);
        // The part lies in this event, so it is narrower than all fractions.
        let (whole, width) = (self.width as f64, part.width as f64);
        let inside = (at - part.low) as f64 + product as u64 as f64 / TWO_TO_64;
        (found, width / whole, below_one(inside / width))
    }
}

/// The largest f64 below 1.
const ALMOST_ONE: f64 = 1.0 - f64::EPSILON / 2.0;

/// A quotient of integers d < w, which may have rounded to 1.
#[inline]
fn below_one(quotient: f64) -> f64 {
    quotient.min(ALMOST_ONE)
}

/// Of its 64 bits a coordinate must keep at least 24 for the next use: a span of 2^-40.
pub(super) const SMALLEST_SPAN: f64 = 1.0 / (1u64 << 40) as f64;

impl Reusable {
    /// A coordinate of which nothing is used.
    #[inline]
    pub fn fresh(bits: u64) -> Self {
        Self { bits, span: 1.0 }
    }

    /// What is left, as a 64-bit fraction.
    #[inline]
    pub fn bits(&self) -> u64 {
        self.bits
    }

    /// Product of the probabilities of the events chosen so far.
    #[inline]
    pub fn span(&self) -> f64 {
        self.span
    }

    /// Whether fewer than 24 of the 64 bits remain, so that the next use needs a fresh coordinate.
    #[inline]
    pub fn is_spent(&self) -> bool {
        self.span < SMALLEST_SPAN
    }

    /// Marks the coordinate as used up: what a photon without renormalisation does after every choice.
    #[inline]
    pub fn spend(&mut self) {
        self.span = 0.0;
    }

    /// Replaces the fraction after an event of this probability was chosen by other means (a table).
    #[inline]
    pub fn renormalised(&mut self, bits: u64, probability: f64) {
        self.bits = bits;
        self.span *= probability;
    }

    /// Renormalises after the event that owns the fractions [low, low + width) was found, this one among
    /// them.
    #[inline]
    pub fn take(&mut self, Share { low, width }: Share) {
        if width != 0 {
            self.renormalised(divide(self.bits - low, width), width as f64 / TWO_TO_64);
        }
    }

    /// Whether the event of this probability happens, 0 < probability < 1; renormalises the coordinate.
    #[inline]
    pub fn happens(&mut self, probability: f64) -> bool {
        let threshold = ((probability * TWO_TO_64) as u64).max(1);
        if self.bits < threshold {
            self.renormalised(divide(self.bits, threshold), probability);
            true
        } else {
            // 2^64 - threshold, which fits because the threshold is at least 1.
            let width = threshold.wrapping_neg();
            self.renormalised(divide(self.bits - threshold, width), 1.0 - probability);
            false
        }
    }
}

/// The number of 64-bit fractions.
pub(crate) const TWO_TO_64: f64 = 18_446_744_073_709_551_616.0;

/// d / width as a 64-bit fraction, d < width.
#[inline]
fn divide(d: u64, width: u64) -> u64 {
    ((u128::from(d) << 64) / u128::from(width)) as u64
}

/// Widths of events on the 64-bit integers, in proportion to weights; they sum to 2^64 exactly.
///
/// Each width is right to 53 bits of itself (not of the total), so rare events keep their ratio; the rounding
/// error of the sum goes to the largest. Weights are any non-negative finite numbers; a weight of zero gives
/// width 0. With one positive weight its width would be 2^64, which does not fit: `None`, as for no positive
/// weight.
pub fn integer_widths(weights: &[f64]) -> Option<Vec<u64>> {
    let largest = weights.iter().copied().fold(0.0, f64::max);
    let valid = weights.iter().all(|w| *w >= 0.0 && w.is_finite());
    if !valid || weights.iter().filter(|w| **w > 0.0).count() < 2 {
        return None;
    }
    let total: f64 = weights.iter().map(|w| w / largest).sum();
    // A width of 2^64 itself can come out when all other weights vanish beside one: the cast gives
    // 2^64 - 1, which is corrected below.
    let mut widths: Vec<u64> = weights.iter().map(|w| (w / largest / total * TWO_TO_64) as u64).collect();
    let sum: u128 = widths.iter().map(|w| u128::from(*w)).sum();
    let at = weights.iter().position(|w| *w == largest)?;
    let corrected = i128::from(widths[at]) + ((1i128 << 64) - sum as i128);
    widths[at] = u64::try_from(corrected).unwrap_or(u64::MAX);
    if corrected > i128::from(u64::MAX) {
        // Every other width rounded to zero: the largest of them gets the one integer that is left.
        let second =
            (0..weights.len()).filter(|k| *k != at).max_by(|a, b| weights[*a].total_cmp(&weights[*b]))?;
        widths[second] = 1;
    }
    Some(widths)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::Points;
    use crate::sequence::owen::OwenPoints;

    #[test]
    fn renormalised_fraction_is_uniform_again_and_below_one() {
        for probability in [0.5, 0.04, 1e-12, 1.0 - 1e-12, f64::EPSILON, 1.0 - f64::EPSILON / 2.0] {
            for bits in [0, 1, 1 << 20, 1 << 63, u64::MAX - 1, u64::MAX] {
                let mut u = Reusable::fresh(bits);
                let happened = u.happens(probability);
                // The exact quotient in 128 bits, by the definition.
                let t = (probability * TWO_TO_64) as u64;
                let (d, w) = if happened {
                    (u128::from(bits), u128::from(t))
                } else {
                    (u128::from(bits - t), (1u128 << 64) - u128::from(t))
                };
                assert_eq!(happened, bits < t);
                assert_eq!(u128::from(u.bits()), (d << 64) / w);
            }
        }
    }

    #[test]
    fn a_part_of_an_event_is_chosen_as_by_exact_division() {
        // An event and the parts of it, the widths of both far apart; the whole line as an event too.
        let event = Share { low: 1 << 40, width: (1 << 62) + 12_345 };
        for event in [event, Share::ALL] {
            let whole = if event.width == 0 { 1u128 << 64 } else { u128::from(event.width) };
            let cuts = [0, 1, 1 << 20, whole / 3, whole / 3 + 7, whole / 2, whole];
            for i in 0..20_000u64 {
                let v = crate::sequence::hash::mix64(i);
                let v = [v, 0, u64::MAX, v >> 40][(i % 4) as usize];
                let at = (u128::from(v) * whole) >> 64;
                let k = cuts.iter().rposition(|c| *c <= at).unwrap();
                let part = Share { low: event.low + cuts[k] as u64, width: (cuts[k + 1] - cuts[k]) as u64 };
                let (found, probability, rest) = event.choose_part(v, |fraction| {
                    assert_eq!(fraction, event.low + at as u64);
                    (k, part)
                });
                assert_eq!(found, k);
                let width = u128::from(part.width);
                assert!((probability / (width as f64 / whole as f64) - 1.0).abs() < 1e-15);
                // ((v whole / 2^64) - cut) / width in integers, to 2^-60.
                let behind = (u128::from(v) * whole - (cuts[k] << 64)) / width;
                let exact = (behind >> 4) as f64 / (1u64 << 60) as f64;
                assert!((rest - exact).abs() < 1e-15 && rest < 1.0, "{v} in {k}: {rest} {exact}");
            }
        }
        assert!(Share { low: 0, width: u64::MAX }.rest(u64::MAX - 1) < 1.0);
    }

    #[test]
    fn extremes_land_where_they_must() {
        let mut low = Reusable::fresh(0);
        assert!(low.happens(1e-300), "u = 0 always happens");
        let mut high = Reusable::fresh(u64::MAX);
        assert!(!high.happens(1.0 - f64::EPSILON / 2.0), "u = 1 - 2^-64 never does");
        assert_eq!(high.bits(), u64::MAX - ((1 << 53) - 1), "and is the last of the 2^11 that do not");
    }

    #[test]
    fn bits_spent_are_tracked_to_the_24_bit_rule() {
        let mut u = Reusable::fresh(u64::MAX / 3);
        let mut spent = 0.0;
        while !u.is_spent() {
            let probability = 0.3;
            spent -= if u.happens(probability) { 0.3f64.log2() } else { 0.7f64.log2() };
        }
        assert!(spent > 40.0 && spent < 42.0, "{spent}");
        u.spend();
        assert!(u.is_spent());
    }

    #[test]
    fn widths_sum_to_two_to_64_and_keep_ratios_of_1e12() {
        let weights = [1.0, 0.0, 1e-12, 3e-12, 0.7, 0.0];
        let widths = integer_widths(&weights).unwrap();
        assert_eq!(widths.iter().map(|w| u128::from(*w)).sum::<u128>(), 1 << 64);
        assert_eq!((widths[1], widths[5]), (0, 0));
        assert!((widths[3] as f64 / widths[2] as f64 - 3.0).abs() < 1e-6);
        for scale in [1e-300, 1e300] {
            let scaled: Vec<f64> = weights.iter().map(|w| w * scale).collect();
            let again = integer_widths(&scaled).unwrap();
            assert!(again.iter().zip(&widths).all(|(a, b)| a.abs_diff(*b) <= 1 << 13));
        }
    }

    #[test]
    fn widths_of_degenerate_weights() {
        assert!(integer_widths(&[]).is_none());
        assert!(integer_widths(&[0.0, 2.0]).is_none());
        assert!(integer_widths(&[1.0, f64::NAN]).is_none());
        assert!(integer_widths(&[1.0, -1.0]).is_none());
        let lost = integer_widths(&[1.0, 1e-300, 0.0]).unwrap();
        assert_eq!(lost, [u64::MAX, 1, 0]);
    }

    #[test]
    fn renormalised_net_keeps_its_strata_inside_the_event() {
        // 2^14 points, an event of probability 1/4: the 2^12 points inside are again a net in (u', v): every
        // box of 2^-6 x 2^-6 holds exactly one.
        let points = OwenPoints::new(3, 0);
        let mut count = vec![0; 1 << 12];
        for i in 0..1 << 14 {
            let mut u = Reusable::fresh(points.coordinate(i, 0));
            if u.happens(0.25) {
                let cell = ((u.bits() >> 58) << 6) | (points.coordinate(i, 1) >> 58);
                count[cell as usize] += 1;
            }
        }
        assert!(count.iter().all(|&c| c == 1));
    }

    #[test]
    fn probabilities_that_sum_to_one_but_for_rounding_fill_the_line() {
        let tenths = [0.1; 10];
        assert_eq!(tenths.iter().sum::<f64>(), 1.0 - f64::EPSILON / 2.0);
        let above = [0.25, 0.25, 0.25, 0.25 + f64::EPSILON];
        assert_eq!(above.iter().sum::<f64>(), 1.0 + f64::EPSILON);
        for weights in [&tenths[..], &above[..]] {
            let with_ends = [&[0.0], weights, &[0.0]].concat();
            let widths = integer_widths(&with_ends).unwrap();
            assert_eq!(widths.iter().map(|w| u128::from(*w)).sum::<u128>(), 1 << 64);
            assert_eq!((widths[0], widths[widths.len() - 1]), (0, 0), "nothing lands on the ends");
            for (w, p) in widths.iter().zip(&with_ends) {
                assert!((*w as f64 / TWO_TO_64 - p).abs() <= 4.0 * f64::EPSILON);
            }
        }
    }
}
