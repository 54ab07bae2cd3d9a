//! The page of a polar diagram: title, legend and lines of text.

use std::path::Path;

use crate::report::colour::Colour;

use super::canvas::TextStyle;
use super::drawing::{Drawing, Pen, Shape, ink, polyline, text};
use super::font;

pub const WIDTH: usize = 640;
pub const MARGIN: f64 = 24.0;
const TITLE_SIZE: f64 = 18.0;
const TEXT_SIZE: f64 = 13.0;
const LINE_HEIGHT: f64 = 20.0;
/// Width between the margins.
const ROOM: f64 = WIDTH as f64 - 2.0 * MARGIN;

/// The pen of a curve: one of four colours.
pub fn curve_pen(index: usize, dashed: bool) -> Pen {
    let colours = [(0x14, 0x5d, 0xa8), (0xd2, 0x3b, 0x2a), (0x2e, 0x8b, 0x57), (0x8a, 0x4f, 0xa3)];
    let (r, g, b) = colours[index % colours.len()];
    Pen { width_px: 2.2, colour: Colour::srgb(r, g, b), dash_px: dashed.then_some([8.0, 5.5]) }
}

/// Angles from `-reach_deg` to `reach_deg`, so many a degree, and among them the table's own: where curves have their points.
pub fn curve_angles(reach_deg: i32, per_degree: i32, own_deg: impl Iterator<Item = f64>) -> Vec<f64> {
    let steps = reach_deg * per_degree;
    let mut angles: Vec<f64> = (-steps..=steps).map(|i| f64::from(i) / f64::from(per_degree)).collect();
    angles.extend(own_deg.filter(|a| a.abs() <= f64::from(reach_deg)));
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    angles
}

/// The title at the top of the page.
pub fn title(title: &str) -> Shape {
    let style = TextStyle::new(fitting(title, TITLE_SIZE), Colour::grey(20)).weighing(1.25);
    text([MARGIN, MARGIN + 16.0], title, style)
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
    base_drawing(shapes, y, footer)
}

/// The page with lines of text from `y` on.
pub fn base_drawing(mut shapes: Vec<Shape>, mut y: f64, footer: &[String]) -> Drawing {
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
