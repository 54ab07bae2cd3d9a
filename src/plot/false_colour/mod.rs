//! A map of illuminance (or luminance) as a picture: false colours with a scale, axes in metres, isolux lines, the numbers a
//! lighting engineer asks for first.

use crate::report::colour::Colour;
use crate::report::colour::map::{colour, lightness, value_colour};
use crate::report::colour::scale::{Axis, Tick};
use crate::report::numbers::three_digits;

use super::canvas::{Anchor, Canvas, TextStyle};
use super::drawing::ink;
use super::font;
use super::isolux::{Isolux, LABEL_SIZE_PX, isolux};
use super::resample::area_average;

mod axes;
mod points;

pub use axes::Axes;
pub use points::Points;

/// Maps below this on their longer side are magnified past it.
const MAGNIFY_BELOW: usize = 700;
/// Maps above this on their longer side are averaged down to it.
const SHRINK_ABOVE: usize = 1200;
/// Cells along a side over which a typical value is taken.
const TYPICAL_CELLS: usize = 128;
/// However narrow a map, this much of it can be seen.
const NARROWEST: usize = 48;
/// Least height of the colour scale.
const SHORTEST_BAR: usize = 200;
/// Least width of the whole, for its text.
const NARROWEST_PICTURE: usize = 560;

const MARGIN: usize = 22;
const TITLE_SIZE: f64 = 18.0;
const TEXT_SIZE: f64 = 13.0;
const TICK_SIZE: f64 = 12.0;
const LINE_HEIGHT: usize = 20;
const BAR_WIDTH: usize = 20;
const BAR_GAP: usize = 26;
const TICK_LENGTH: f64 = 5.0;

/// What is shown of a map. A map whose values do not fit its sides is shown as one without values.
#[derive(Debug, Clone)]
pub struct FalseColour<'a> {
    /// Headline: the receiver's name.
    pub title: &'a str,
    /// Cells along u.
    pub width: usize,
    /// Cells along v.
    pub height: usize,
    /// What the values are.
    pub quantity: Quantity,
    /// Values in the quantity's unit, `width` x `height`, the row of the largest v first; NaN and infinities are "no value".
    pub values: &'a [f64],
    /// What stands around the map.
    pub axes: Axes,
    /// Values printed at places of it; isolux lines then carry none.
    pub points: Option<Points>,
    /// Whether to draw isolux lines.
    pub isolux: bool,
    /// Lines of text under the picture, the first before what the drawing has to say.
    pub footer: Vec<String>,
}

/// What is shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Illuminance on a surface, lx.
    Illuminance,
    /// Luminance of a picture, cd/m2: it has no (u, v) axes.
    Luminance,
}

impl Quantity {
    /// Its unit.
    pub const fn unit(self) -> &'static str {
        match self {
            Self::Illuminance => "lx",
            Self::Luminance => "cd/m2",
        }
    }
}

/// Where things are, in pixels.
struct Layout {
    /// x, y, width, height of the map.
    map: [usize; 4],
    /// x, y, width, height of the colour scale.
    bar: [usize; 4],
    /// Top of the first line of the footer.
    footer_y: usize,
    size: [usize; 2],
}

impl FalseColour<'_> {
    /// Draws the picture.
    pub fn render(&self) -> Canvas {
        let (values, cells) = self.map();
        let axis = fit_map(values, cells);
        let display = display_size(cells, self.axes.size_m());
        let lines = if self.isolux {
            isolux(values, cells, display, &axis, self.points.is_none())
        } else {
            Isolux::default()
        };
        let labels = bar_labels(&axis);
        let text = self.footer_text(values, &lines, display);
        let mut layout = self.layout(display, &labels);
        let room = (layout.size[0] - 2 * MARGIN) as f64;
        let footer: Vec<String> = text
            .iter()
            .flat_map(|line| font::wrapped(line, TEXT_SIZE, room))
            .map(|line| font::shortened(&line, TEXT_SIZE, room, "..."))
            .collect();
        layout.size[1] = layout.footer_y + footer.len() * LINE_HEIGHT + MARGIN - 8;

        let mut canvas = Canvas::new(layout.size[0], layout.size[1], Colour::WHITE);
        self.draw_title(&mut canvas);
        let [left, top, width, height] = layout.map;
        for (i, &value) in area_average(values, cells, [width, height]).iter().enumerate() {
            canvas.set_pixel(left + i % width, top + i / width, value_colour(value, &axis));
        }
        draw_lines(&mut canvas, &layout, &axis, &lines);
        if let Some(points) = &self.points {
            points.draw(&mut canvas, layout.map);
        }
        frame(&mut canvas, layout.map);
        self.axes.draw(&mut canvas, layout.map);
        draw_bar(&mut canvas, &layout, &axis, &labels, self.quantity);
        for (i, line) in footer.iter().enumerate() {
            let y = layout.footer_y + (i + 1) * LINE_HEIGHT - 6;
            canvas.text([MARGIN as f64, y as f64], line, &TextStyle::new(TEXT_SIZE, ink()));
        }
        canvas
    }

    /// Values and sides; one cell without a value for a map that is none.
    fn map(&self) -> (&[f64], [usize; 2]) {
        let count = self.width.checked_mul(self.height).filter(|n| *n > 0);
        if count == Some(self.values.len()) {
            return (self.values, [self.width, self.height]);
        }
        (&[f64::NAN], [1, 1])
    }

    fn layout(&self, display: [usize; 2], labels: &[(f64, String)]) -> Layout {
        let [_, up] = self.axes.marks(display);
        let left = MARGIN + widest(up.marks.iter().map(|(_, label)| label.as_str())) + 34;
        let top = MARGIN + 36;
        let map = [left, top, display[0], display[1]];
        let bar_x = left + display[0] + BAR_GAP;
        let bar = [bar_x, top, BAR_WIDTH, display[1].max(SHORTEST_BAR)];
        let label_room = widest(labels.iter().map(|(_, l)| l.as_str())).max(16) + 12;
        let right = bar_x + BAR_WIDTH + label_room + MARGIN;
        let below = (top + display[1] + 48).max(top + bar[3] + 14);
        Layout { map, bar, footer_y: below + 6, size: [right.max(NARROWEST_PICTURE), 0] }
    }

    fn draw_title(&self, canvas: &mut Canvas) {
        let room = (canvas.width() - 2 * MARGIN) as f64;
        let mut size = TITLE_SIZE;
        while size > 13.0 && font::width_px(self.title, size, true) > room {
            size -= 1.0;
        }
        let title = font::shortened(self.title, size, room, "...");
        let style = TextStyle::new(size, Colour::grey(20)).weighing(1.25);
        canvas.text([MARGIN as f64, (MARGIN + 16) as f64], &title, &style);
    }

    fn footer_text(&self, values: &[f64], lines: &Isolux, display: [usize; 2]) -> Vec<String> {
        let mut text: Vec<_> = self.footer.iter().take(1).cloned().collect();
        let empty = values.iter().filter(|v| !v.is_finite()).count();
        if empty > 0 {
            text.push(format!("grey: no value ({empty} of {} cells)", values.len()));
        }
        if lines.smoothing > 0.0 {
            let width = match self.axes.size_m() {
                Some([u, v]) => format!("{} mm", three_digits(1e3 * lines.smoothing * u.max(v))),
                None => format!("{} % of the side", three_digits(100.0 * lines.smoothing)),
            };
            text.push(format!("isolux lines: of the map smoothed by a Gaussian, standard deviation {width}"));
        }
        text.extend(self.points.iter().map(|points| points.said(display)));
        text.extend(self.footer.iter().skip(1).cloned());
        text
    }
}

/// The scale of a map. Where photons are few, most cells hold none or one of them; what is typical is therefore taken from
/// averages over larger areas.
fn fit_map(values: &[f64], cells: [usize; 2]) -> Axis {
    let coarse = cells.map(|n| n.min(TYPICAL_CELLS));
    Axis::fit_with_typical(values, &area_average(values, cells, coarse))
}

/// Pixels on which a map of so many cells is shown; cells become squares, or follow `size_m`.
fn display_size(cells: [usize; 2], size_m: Option<[f64; 2]>) -> [usize; 2] {
    let longest = cells[0].max(cells[1]).max(1);
    let factor = MAGNIFY_BELOW.div_ceil(longest).min(SHRINK_ABOVE / longest).max(1);
    let side = (longest * factor).min(SHRINK_ABOVE);
    let aspect = |[a, b]: [f64; 2]| a / b;
    let grid = aspect([cells[0] as f64, cells[1] as f64]);
    let wanted = size_m.map_or(grid, aspect);
    let square = (wanted / grid - 1.0).abs() < 1e-3;
    let shape = if square && longest <= SHRINK_ABOVE {
        [cells[0] * factor, cells[1] * factor]
    } else if wanted >= 1.0 {
        [side, (side as f64 / wanted).round() as usize]
    } else {
        [(side as f64 * wanted).round() as usize, side]
    };
    shape.map(|pixels| pixels.max(NARROWEST))
}

fn draw_lines(canvas: &mut Canvas, layout: &Layout, axis: &Axis, isolux: &Isolux) {
    let [left, top, width, height] = layout.map;
    let shift = |p: &[f64; 2]| [p[0] + left as f64, p[1] + top as f64];
    canvas.clipped([left, top, left + width, top + height], |canvas| {
        for line in &isolux.lines {
            let contrast = line_colour(axis.place(line.tick.value));
            for piece in &line.pieces {
                let points: Vec<_> = piece.iter().map(shift).collect();
                canvas.polyline(&points, 1.0, contrast, 0.9);
            }
        }
        for line in &isolux.lines {
            let Some(label) = line.label else { continue };
            let place = axis.place(line.tick.value);
            // The baseline lies half a digit below the line.
            let drop = 0.35 * LABEL_SIZE_PX;
            let centre = shift(&label.centre);
            let at = [centre[0] - drop * libm::sin(label.angle), centre[1] + drop * libm::cos(label.angle)];
            let style = TextStyle::new(LABEL_SIZE_PX, colour(place)).anchored(Anchor::Middle);
            canvas.text_rotated(at, label.angle, &line.tick.label, &style, 1.8);
            let style = TextStyle { colour: line_colour(place), ..style };
            canvas.text_rotated(at, label.angle, &line.tick.label, &style, 0.0);
        }
    });
}

/// White on dark colours, black on light ones.
fn line_colour(place: f64) -> Colour {
    if lightness(place) < 0.62 { Colour::WHITE } else { Colour::BLACK }
}

/// Place from foot (0) to top (1) and text of the marks of the colour scale, foot first.
fn bar_labels(axis: &Axis) -> Vec<(f64, String)> {
    let last = axis.ticks.len().saturating_sub(1);
    let label = |(i, tick): (usize, &Tick)| {
        let below = if i == 0 && axis.clipped_below { "< " } else { "" };
        let above = if i == last && axis.clipped_above { "> " } else { "" };
        (axis.place(tick.value), format!("{above}{below}{}", tick.label))
    };
    axis.ticks.iter().enumerate().map(label).collect()
}

fn draw_bar(canvas: &mut Canvas, layout: &Layout, axis: &Axis, labels: &[(f64, String)], quantity: Quantity) {
    let [left, top, width, height] = layout.bar;
    for row in 0..height {
        let t = 1.0 - (row as f64 + 0.5) / height as f64;
        canvas.rect([left as f64, (top + row) as f64, width as f64, 1.0], colour(t));
    }
    frame(canvas, layout.bar);
    let [x, y] = [(left + width) as f64, top as f64];
    let mut free_below = f64::INFINITY;
    for (place, label) in labels {
        let at = crisp(y + (1.0 - place) * height as f64);
        canvas.line([x + 1.0, at], [x + TICK_LENGTH, at], 1.0, ink());
        // On a short scale the numbers would run into each other.
        if at < free_below {
            canvas.text([x + TICK_LENGTH + 5.0, at + 4.0], label, &TextStyle::new(TICK_SIZE, ink()));
            free_below = at - TICK_SIZE - 2.0;
        }
    }
    let unit = quantity.unit();
    let unit = if axis.log { format!("{unit} (log)") } else { unit.to_owned() };
    canvas.text([left as f64, y - 12.0], &unit, &TextStyle::new(TEXT_SIZE, ink()));
}

/// A line of one pixel around a rectangle.
fn frame(canvas: &mut Canvas, [x, y, width, height]: [usize; 4]) {
    let [x, y, width, height] = [x as f64, y as f64, width as f64, height as f64];
    canvas.rect([x - 1.0, y - 1.0, width + 2.0, 1.0], ink());
    canvas.rect([x - 1.0, y + height, width + 2.0, 1.0], ink());
    canvas.rect([x - 1.0, y, 1.0, height], ink());
    canvas.rect([x + width, y, 1.0, height], ink());
}

/// The pixel centre at or before a coordinate, where a line of one pixel is sharp.
fn crisp(x: f64) -> f64 {
    (x - 0.5).round() + 0.5
}

fn widest<'a>(labels: impl Iterator<Item = &'a str>) -> usize {
    labels.map(|l| font::width_px(l, TICK_SIZE, true).ceil() as usize).max().unwrap_or(0)
}

#[cfg(test)]
mod tests;
