//! A photon's coordinates: handed out in order of use, labelled, counted.
//!
//! The number of coordinates a photon consumes is its constructive dimension (METHOD 1). A coordinate is
//! counted when it is drawn; an event with one possible outcome draws none. With renormalisation all discrete
//! events of a photon share one coordinate until fewer than 24 of its 64 bits are left; without, each draws
//! its own.

use super::choose::Reusable;
use super::method::Sampling;
use crate::sequence::hash::mix64;
use crate::sequence::{Points, to_unit_f64};

pub use super::chooser::{Chooser, Purpose};

/// The coordinates of one photon.
#[derive(Debug)]
pub struct Coordinates<'p, P> {
    points: &'p P,
    index: u64,
    reuse: bool,
    sampling: Sampling,
    event: Option<Reusable>,
    /// The span of the coordinate of events below which survivals take an independent number ([`survivors_end`]).
    survivors_end: f64,
    drawn: u32,
    drawn_for: [u32; Purpose::LABELS.len()],
}

impl<'p, P: Points> Coordinates<'p, P> {
    /// The coordinates of photon `index`; `reuse` turns renormalisation on.
    #[inline]
    pub fn new(points: &'p P, index: u64, reuse: bool) -> Self {
        Self::sampling_by(points, index, reuse, Sampling::default())
    }

    /// The same for a photon that samples tables of scattering in a given way.
    #[inline]
    pub fn sampling_by(points: &'p P, index: u64, reuse: bool, sampling: Sampling) -> Self {
        let drawn_for = [0; Purpose::LABELS.len()];
        let survivors_end = survivors_end(index);
        Self { points, index, reuse, sampling, event: None, survivors_end, drawn: 0, drawn_for }
    }

    /// Coordinates consumed so far.
    #[inline]
    pub fn drawn(&self) -> u32 {
        self.drawn
    }

    /// Coordinates consumed so far for each purpose, in the order of [`Purpose::LABELS`].
    #[inline]
    pub fn drawn_for(&self) -> &[u32; Purpose::LABELS.len()] {
        &self.drawn_for
    }

    /// The next coordinate.
    #[inline]
    pub fn draw(&mut self, purpose: Purpose) -> u64 {
        let bits = self.points.coordinate(self.index, self.drawn);
        self.drawn += 1;
        self.drawn_for[purpose as usize] += 1;
        bits
    }

    /// The next coordinate, to be used for discrete events first.
    #[inline]
    pub fn draw_reusable(&mut self, purpose: Purpose) -> Reusable {
        Reusable::fresh(self.draw(purpose))
    }

    /// The coordinate of discrete events, a fresh one where too little of it is left.
    #[inline]
    fn event_coordinate(&mut self) -> Reusable {
        match self.event {
            Some(u) if !u.is_spent() => u,
            _ => self.draw_reusable(Purpose::Event),
        }
    }
}

/// Photons that survive by one shared coordinate, of each block of indices [2^k, 2^(k+1)).
///
/// The survivors of a net are counted exactly until one photon is left, the one of the lowest stratum, and the rest of its
/// life is all that replicates differ by: a total of many reflections would be skewed, and an interval of 8 replicates
/// cover 87 % instead of 95 %. The lives of 4 photons of each block, ended independently, are skewed little.
const LAST_SURVIVORS: f64 = 4.0;

/// The part of a block of indices that is its last [`LAST_SURVIVORS`] photons. It depends on the index alone, so that
/// a net's photons are those of every longer one.
#[inline]
pub fn survivors_end(index: u64) -> f64 {
    LAST_SURVIVORS / (1u64 << (index | 1).ilog2()) as f64
}

impl<P: Points> Chooser for Coordinates<'_, P> {
    #[inline]
    fn survives(&mut self, probability: f64) -> bool {
        if let Some(u) = self.event
            && u.span() < self.survivors_end
        {
            self.event = Some(Reusable::fresh(mix64(u.bits() ^ mix64(self.index))));
        }
        self.happens(probability)
    }

    #[inline]
    fn happens(&mut self, probability: f64) -> bool {
        if probability <= 0.0 {
            return false;
        }
        if probability >= 1.0 {
            return true;
        }
        let mut u = self.event_coordinate();
        let happened = u.happens(probability);
        self.event = self.reuse.then_some(u);
        happened
    }

    #[inline]
    fn uniform(&mut self, purpose: Purpose) -> f64 {
        to_unit_f64(self.draw(purpose))
    }

    #[inline]
    fn reusable(&mut self, purpose: Purpose) -> Reusable {
        self.draw_reusable(purpose)
    }

    #[inline]
    fn reuses(&self) -> bool {
        self.reuse
    }

    #[inline]
    fn decide<R>(&mut self, purpose: Purpose, choice: impl FnOnce(&mut Reusable) -> R) -> R {
        if !self.reuse {
            return choice(&mut self.draw_reusable(purpose));
        }
        let mut u = self.event_coordinate();
        let chosen = choice(&mut u);
        self.event = Some(u);
        chosen
    }

    #[inline]
    fn sampling(&self) -> Sampling {
        self.sampling
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sequence::independent::IndependentPoints;
    use crate::sequence::owen::OwenPoints;

    #[test]
    fn events_share_one_coordinate_with_reuse_and_draw_their_own_without() {
        let points = IndependentPoints::new(1, 0);
        let mut with = Coordinates::new(&points, 5, true);
        let mut without = Coordinates::new(&points, 5, false);
        for _ in 0..10 {
            with.happens(0.9);
            without.happens(0.9);
        }
        assert_eq!((with.drawn(), without.drawn()), (1, 10));
        assert_eq!(with.drawn_for()[Purpose::Event as usize], 1);
    }

    #[test]
    fn a_choice_is_one_more_event_with_reuse_and_has_its_own_coordinate_without() {
        let points = IndependentPoints::new(1, 0);
        for (reuse, drawn, label) in [(true, 1, Purpose::Event), (false, 2, Purpose::Scatter)] {
            let mut c = Coordinates::new(&points, 5, reuse);
            c.happens(0.9);
            let left = c.decide(Purpose::Scatter, |u| u.happens(0.5));
            assert_eq!(c.drawn(), drawn);
            assert!(c.drawn_for()[label as usize] == 1);
            // The event's remainder decides, or the photon's second coordinate.
            let mut first = Reusable::fresh(points.coordinate(5, 0));
            first.happens(0.9);
            let mut other = Reusable::fresh(points.coordinate(5, 1));
            assert_eq!(left, if reuse { &mut first } else { &mut other }.happens(0.5));
        }
    }

    #[test]
    fn too_little_left_of_a_choice_is_replaced() {
        let points = IndependentPoints::new(1, 0);
        let mut c = Coordinates::new(&points, 5, true);
        assert_eq!(c.left(0.3, 2f64.powi(-40), Purpose::Scatter), 0.3);
        assert_eq!(c.left(0.3, 2f64.powi(-41), Purpose::Scatter), to_unit_f64(points.coordinate(5, 0)));
    }

    #[test]
    fn certain_events_draw_nothing() {
        let points = IndependentPoints::new(1, 0);
        let mut c = Coordinates::new(&points, 0, true);
        assert!(c.happens(1.0) && !c.happens(0.0) && c.happens(1.5) && !c.happens(-0.1));
        assert_eq!(c.drawn(), 0);
    }

    #[test]
    fn a_spent_coordinate_is_replaced_before_fewer_than_24_bits_are_used() {
        let points = IndependentPoints::new(2, 0);
        let mut c = Coordinates::new(&points, 9, true);
        // Each fair event costs one bit: events 1 to 41 run on the first coordinate (after 40 just 24 bits
        // remain, which is still allowed), the 42nd draws the second.
        for event in 1..=41 {
            c.happens(0.5);
            assert_eq!(c.drawn(), 1, "event {event}");
        }
        c.happens(0.5);
        assert_eq!(c.drawn(), 2);
    }

    #[test]
    fn event_frequency_survives_forty_renormalisations() {
        // The 30th event on the same coordinate still has its probability: z-test over photons.
        let points = IndependentPoints::new(4, 0);
        let n = 200_000;
        let mut count = 0.0;
        for i in 0..n {
            let mut c = Coordinates::new(&points, i, true);
            for _ in 0..29 {
                c.happens(0.6);
            }
            count += f64::from(u8::from(c.happens(0.3)));
            assert!(c.drawn() <= 2);
        }
        let z = (count - 0.3 * n as f64) / (n as f64 * 0.21).sqrt();
        assert!(z.abs() < 4.0, "{z}");
    }

    #[test]
    fn lives_of_many_survivals_have_their_lengths_and_are_not_left_to_one_photon() {
        // Photons that go on with probability 1/2 on stratified points: photons of each length, and the spread of the sum of
        // all lengths, which is the sum of 4 geometric tails (variance 2 each) a block of indices, 4 log2(n) in all.
        let (m, replicates) = (12, 400);
        let n = 1u64 << m;
        let mut lengths = [0.0; 20];
        let mut sums = Vec::new();
        for replicate in 0..replicates {
            let points = OwenPoints::new(9, replicate);
            let mut sum = 0.0;
            for index in 0..n {
                let mut c = Coordinates::new(&points, index, true);
                let length = (0..60).take_while(|_| c.survives(0.5)).count();
                sum += length as f64;
                lengths[length.min(19)] += 1.0;
                assert!(c.drawn() == 1 || length > 40);
            }
            sums.push(sum - n as f64);
        }
        let all = n as f64 * f64::from(replicates);
        for (length, count) in lengths.iter().enumerate().take(19) {
            let expected = all * 0.5f64.powi(length as i32 + 1);
            assert!((count - expected).abs() < 4.0 * expected.sqrt(), "{length}: {count} {expected}");
        }
        let (mean, square) = (sums.iter().sum::<f64>(), sums.iter().map(|s| s * s).sum::<f64>());
        let variance = square / f64::from(replicates);
        assert!(mean.abs() < 4.0 * square.sqrt(), "{mean}");
        // One photon's tail alone has 2; independent lives would have 2 n.
        assert!((40.0..200.0).contains(&variance), "{variance}");
        let skewness =
            sums.iter().map(|s| s.powi(3)).sum::<f64>() / f64::from(replicates) / variance.powf(1.5);
        // One geometric tail has 2.1; 48 have 0.3, known here to sqrt(6 / 400) = 0.12.
        assert!(skewness.abs() < 0.8, "{skewness}");
    }

    #[test]
    fn sixty_reuses_in_a_row_keep_their_frequencies() {
        // Events of probability 0.9 spend 0.15 or 3.3 bits each: 60 of them share one or two coordinates. The
        // last and the one before it are as likely as the first, and independent of each other.
        let points = IndependentPoints::new(5, 0);
        let n = 100_000;
        let (mut first, mut last, mut both, mut most) = (0.0, 0.0, 0.0, 0);
        for i in 0..n {
            let mut c = Coordinates::new(&points, i, true);
            first += f64::from(u8::from(c.happens(0.9)));
            (0..57).for_each(|_| {
                c.happens(0.9);
            });
            let (a, b) = (c.happens(0.9), c.happens(0.9));
            last += f64::from(u8::from(b));
            both += f64::from(u8::from(a && b));
            most = most.max(c.drawn());
        }
        let z = |count: f64, p: f64| (count - p * n as f64) / (n as f64 * p * (1.0 - p)).sqrt();
        for z in [z(first, 0.9), z(last, 0.9), z(both, 0.81)] {
            assert!(z.abs() < 4.0, "{z}");
        }
        assert!(most == 2, "{most}");
    }
}
