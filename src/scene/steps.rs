//! Heights of an image of 8 bits: 256 steps, of which glass makes facets.

use crate::error::warning::{Severity, Warning};

/// Slopes that bend no light that one would see.
const FLAT_DEG: f64 = 0.1;

/// A heightfield's steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Steps {
    /// One of them, m.
    pub height_m: f64,
    /// The least distance over which it rises, m: that of pixels, or of vertices where these are coarser.
    pub distance_m: f64,
}

impl Steps {
    /// What is to be said of them on a surface that refracts or reflects like a mirror.
    pub fn warning(&self, surface: &str) -> Option<Warning> {
        let slope_deg = libm::atan2(self.height_m, self.distance_m).to_degrees();
        (slope_deg > FLAT_DEG).then(|| Warning {
            severity: Severity::Doubtful,
            code: "steps-of-image",
            message: format!(
                "the heights of \"{surface}\" come from an image of 8 bits, in steps of {:.2e} m: each is a facet that slopes by \
                 up to {slope_deg:.1} degrees, and the light shows these facets",
                self.height_m
            ),
            surfaces: vec![surface.to_owned()],
            share: None,
            remedy: "write the image with 16 bits (a grey PNG), from the heights themselves: what was 8 bits once must be smoothed"
                .into(),
        })
    }
}
