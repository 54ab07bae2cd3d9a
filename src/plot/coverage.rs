//! What part of a pixel lies under a stroke or a rectangle.

use std::ops::Range;

use super::chain::distance;

/// A pixel square seen along a line: a trapezium, the convolution of the two sides' projections. Its integral gives the
/// exact share of the pixel that a long straight stroke covers.
pub struct Footprint {
    /// Longer and shorter projection of a side on the line's normal.
    long: f64,
    short: f64,
}

impl Footprint {
    pub fn across(from: [f64; 2], to: [f64; 2]) -> Self {
        let length = distance(from, to);
        if length == 0.0 {
            return Self { long: 1.0, short: 0.0 };
        }
        let (a, b) = (((to[0] - from[0]) / length).abs(), ((to[1] - from[1]) / length).abs());
        Self { long: a.max(b), short: a.min(b) }
    }

    pub fn half_width(&self) -> f64 {
        0.5 * (self.long + self.short)
    }

    /// Share of the pixel on the near side of a line at this signed distance from its centre.
    pub fn below(&self, distance: f64) -> f64 {
        let t = distance.abs();
        let share = if t <= 0.5 * (self.long - self.short) {
            t / self.long
        } else if t < self.half_width() {
            let rest = self.half_width() - t;
            0.5 - rest * rest / (2.0 * self.long * self.short)
        } else {
            0.5
        };
        if distance < 0.0 { 0.5 - share } else { 0.5 + share }
    }
}

/// Pixels of [low, high) that the interval from `a` to `b` touches, each with the share it covers.
pub fn covered(a: f64, b: f64, low: usize, high: usize) -> Vec<(usize, f64)> {
    pixels(a, b, low, high).map(|i| (i, (b.min(i as f64 + 1.0) - a.max(i as f64)).clamp(0.0, 1.0))).collect()
}

/// Pixels of [low, high) that the interval from `a` to `b` touches. Casts saturate: whatever lies left of the picture becomes 0,
/// and an interval without end or beginning is empty or the whole.
pub fn pixels(a: f64, b: f64, low: usize, high: usize) -> Range<usize> {
    (a.floor() as usize).max(low)..(b.ceil().max(0.0) as usize).min(high)
}
