//! The disc of a polar diagram: rings, rays and their labels.

use std::f64::consts::PI;

use crate::report::colour::Colour;
use crate::report::colour::scale::linear_ticks;

use super::canvas::{Anchor, TextStyle};
use super::drawing::{Pen, Shape, ink, polyline, text};
use super::font;

/// Of the outer ring.
pub const RADIUS: f64 = 236.0;
const TICK_SIZE: f64 = 12.0;
const RAY_STEP_DEG: usize = 15;
/// Most rings of a diagram in proportion.
const RINGS: usize = 7;
/// Decades of a logarithmic diagram.
pub const DECADES: f64 = 5.0;

/// How a distance from the centre stands for an intensity.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Scale {
    /// In proportion, up to this intensity.
    Linear(f64),
    /// By its logarithm, over [`DECADES`] up to this intensity.
    Logarithmic(f64),
}

/// Where a diagram is and how far it reaches.
pub struct Disc {
    pub centre: [f64; 2],
    pub scale: Scale,
    /// Intensity and label of each ring, from the inside.
    pub rings: Vec<(f64, String)>,
    /// The whole disc, or one half of it.
    pub full: bool,
}

/// Round intensities and labels of the rings up to one above `max`, from the inside, and the scale that they make.
pub fn round_rings(max: f64) -> (Vec<(f64, String)>, Scale) {
    // Subnormal values have no round numbers.
    let max = if max > f64::MIN_POSITIVE / f64::EPSILON { max } else { 1.0 };
    let step = linear_ticks(0.0, max, RINGS).get(1).map_or(max, |tick| tick.value);
    let ticks = linear_ticks(0.0, (max / step).ceil() * step, RINGS).into_iter().skip(1);
    let rings: Vec<(f64, String)> = ticks.map(|tick| (tick.value, tick.label)).collect();
    let outer = rings.last().map_or(max, |ring| ring.0).max(max);
    (rings, Scale::Linear(outer))
}

impl Disc {
    /// Distance from the centre, pixels.
    pub fn radius(&self, candela: f64) -> f64 {
        match self.scale {
            Scale::Linear(outer) => RADIUS * candela / outer,
            Scale::Logarithmic(outer) => {
                RADIUS * (1.0 + libm::log10(candela / outer) / DECADES).clamp(0.0, 1.0)
            }
        }
    }

    /// A point at an angle from straight down, or from straight `up`; positive angles to the right.
    pub fn place(&self, up: bool, angle_deg: f64, radius: f64) -> [f64; 2] {
        let angle = angle_deg * (PI / 180.0);
        let down = if up { -radius } else { radius };
        [self.centre[0] + radius * libm::sin(angle), self.centre[1] + down * libm::cos(angle)]
    }

    /// The rings between two angles, in radians clockwise on the screen from +x.
    pub fn draw_rings(&self, shapes: &mut Vec<Shape>, angles: [f64; 2]) {
        for (i, (value, _)) in self.rings.iter().enumerate() {
            let pen = grid_pen(i + 1 == self.rings.len());
            shapes.push(Shape::Arc { centre: self.centre, radius: self.radius(*value), angles, pen });
        }
    }

    /// Labelled rays to both sides from 0 degrees to the last angle.
    pub fn draw_rays(&self, shapes: &mut Vec<Shape>, up: bool, last_deg: usize) {
        for angle in (0..=last_deg).step_by(RAY_STEP_DEG) {
            // Fine rays would fill the centre.
            let start = if angle % 30 == 0 { 0.0 } else { 0.2 * RADIUS };
            let sides: &[f64] = if angle % 180 == 0 { &[1.0] } else { &[1.0, -1.0] };
            for angle_deg in sides.iter().map(|side| side * angle as f64) {
                let ends = [start, RADIUS].map(|r| self.place(up, angle_deg, r));
                shapes.push(polyline(ends, grid_pen(angle % 90 == 0)));
                shapes.push(self.angle_label(up, angle_deg));
            }
        }
    }

    /// The angle beyond the outer ring, set so that it stands off it equally everywhere.
    pub fn angle_label(&self, up: bool, angle_deg: f64) -> Shape {
        let label = format!("{}\u{b0}", angle_deg.abs());
        let half = 0.5 * font::width_px(&label, TICK_SIZE, true);
        let [x, _] = self.place(up, angle_deg, RADIUS + 9.0 + half);
        let [_, y] = self.place(up, angle_deg, RADIUS + 14.0);
        text([x, y + 4.0], &label, TextStyle::new(TICK_SIZE, ink()).anchored(Anchor::Middle))
    }

    /// The intensities inside their rings along the horizontal, so many pixels below it; to the right, or to the left. On white
    /// where a curve may lie under them.
    pub fn draw_ring_labels(&self, shapes: &mut Vec<Shape>, to_right: bool, below: f64, unit: &str) {
        let style = TextStyle::new(TICK_SIZE, Colour::grey(90));
        let y = self.centre[1] + below;
        let mut free_until = f64::INFINITY;
        for (i, (value, label)) in self.rings.iter().enumerate().rev() {
            let label = if i + 1 == self.rings.len() { format!("{label}{unit}") } else { label.clone() };
            let width = font::width_px(&label, TICK_SIZE, true);
            let end = self.radius(*value) - 4.0;
            // Long numbers on narrow rings: the outer one says more.
            if end > free_until || end < width {
                continue;
            }
            free_until = end - width - 10.0;
            let (x, left, anchor) = if to_right {
                let x = self.centre[0] + end;
                (x, x - width, Anchor::End)
            } else {
                let x = self.centre[0] - end;
                (x, x, Anchor::Start)
            };
            if self.full {
                let area = [left - 1.0, y - 10.0, width + 2.0, 12.0];
                shapes.push(Shape::Rect { area, colour: Colour::WHITE });
            }
            shapes.push(text([x, y], &label, style.anchored(anchor)));
        }
    }
}

/// The pen of most rings and rays, and of those that bound the diagram.
fn grid_pen(strong: bool) -> Pen {
    Pen::solid(1.0, Colour::grey(if strong { 140 } else { 216 }))
}
