//! What polar diagrams have in common: the page, its rings and rays, title, legend and lines of text.

use std::path::Path;

use crate::report::colour::Colour;
use crate::report::colour::scale::linear_ticks;

use super::canvas::{Anchor, TextStyle};
use super::drawing::{Drawing, Pen, Shape, ink, polyline, text};
use super::font;

pub const WIDTH: usize = 640;
/// Of the outer ring.
pub const RADIUS: f64 = 236.0;
pub const MARGIN: f64 = 24.0;
pub const TICK_SIZE: f64 = 12.0;
pub const RAY_STEP_DEG: usize = 15;
const TITLE_SIZE: f64 = 18.0;
const TEXT_SIZE: f64 = 13.0;
const LINE_HEIGHT: f64 = 20.0;
/// Most rings there are.
const RINGS: usize = 7;
/// Width between the margins.
const ROOM: f64 = WIDTH as f64 - 2.0 * MARGIN;

/// The pens of the grid: of most rings and rays, and of those that bound the diagram.
pub fn grid_pens() -> [Pen; 2] {
    [216, 140].map(|grey| Pen::solid(1.0, Colour::grey(grey)))
}

/// The pen of a curve: one of four colours.
pub fn curve_pen(index: usize, dashed: bool) -> Pen {
    let colours = [(0x14, 0x5d, 0xa8), (0xd2, 0x3b, 0x2a), (0x2e, 0x8b, 0x57), (0x8a, 0x4f, 0xa3)];
    let (r, g, b) = colours[index % colours.len()];
    Pen { width_px: 2.2, colour: Colour::srgb(r, g, b), dash_px: dashed.then_some([8.0, 5.5]) }
}

/// Round values and labels of the rings up to one above `max`, from the inside, and the value of the outer one.
pub fn round_rings(max: f64) -> (Vec<(f64, String)>, f64) {
    // Subnormal values have no round numbers.
    let max = if max > f64::MIN_POSITIVE / f64::EPSILON { max } else { 1.0 };
    let step = linear_ticks(0.0, max, RINGS).get(1).map_or(max, |tick| tick.value);
    let ticks = linear_ticks(0.0, (max / step).ceil() * step, RINGS).into_iter().skip(1);
    let rings: Vec<(f64, String)> = ticks.map(|tick| (tick.value, tick.label)).collect();
    let outer = rings.last().map_or(max, |ring| ring.0).max(max);
    (rings, outer)
}

/// The title at the top of the page.
pub fn draw_title(shapes: &mut Vec<Shape>, title: &str) {
    let style = TextStyle::new(fitting(title, TITLE_SIZE), Colour::grey(20)).weighing(1.25);
    shapes.push(text([MARGIN, MARGIN + 16.0], title, style));
}

/// The number on a ring at `x`, its right or left end there; on white where something may lie under it.
pub fn draw_ring_label(
    shapes: &mut Vec<Shape>,
    [x, y]: [f64; 2],
    label: &str,
    anchor: Anchor,
    on_white: bool,
) {
    if on_white {
        let width = font::width_px(label, TICK_SIZE, true);
        let left = if anchor == Anchor::End { x - width } else { x };
        let area = [left - 1.0, y - 10.0, width + 2.0, 12.0];
        shapes.push(Shape::Rect { area, colour: Colour::WHITE });
    }
    shapes.push(text([x, y], label, TextStyle::new(TICK_SIZE, Colour::grey(90)).anchored(anchor)));
}

/// The whole page, from a diagram that reaches down to `foot`: a line of each curve's kind and its name, as many in a row as
/// fit, and under them lines of text.
pub fn finished(
    mut shapes: Vec<Shape>,
    foot: f64,
    legend: impl IntoIterator<Item = (String, Pen)>,
    footer: &[String],
) -> Drawing {
    let sample = 34.0;
    let (mut x, mut y, mut entries) = (MARGIN, foot + 52.0, 0);
    for (label, pen) in legend {
        let width = sample + 8.0 + font::width_px(&label, TEXT_SIZE, true);
        if x > MARGIN && x + width > WIDTH as f64 - MARGIN {
            x = MARGIN;
            y += LINE_HEIGHT;
        }
        shapes.push(polyline([[x, y - 4.5], [x + sample, y - 4.5]], pen));
        shapes.push(text([x + sample + 8.0, y], &label, TextStyle::new(TEXT_SIZE, ink())));
        x += width + 28.0;
        entries += 1;
    }
    if entries > 0 {
        y += LINE_HEIGHT + 4.0;
    }
    for line in footer {
        shapes.push(text([MARGIN, y], line, TextStyle::new(fitting(line, TEXT_SIZE), ink())));
        y += LINE_HEIGHT;
    }
    Drawing { width: WIDTH, height: (y + MARGIN - LINE_HEIGHT + 4.0) as usize, shapes }
}

/// A file's name without its folders.
pub fn base_name(file: &str) -> String {
    Path::new(file).file_name().map_or_else(|| file.to_owned(), |name| name.to_string_lossy().into_owned())
}

/// The wanted type size, or the smaller one at which the text fits between the margins, not below 8.
fn fitting(text: &str, size_px: f64) -> f64 {
    let width = font::width_px(text, size_px, true);
    if width > ROOM { (size_px * ROOM / width).floor().max(8.0) } else { size_px }
}
