//! sweep.svg: every figure against the first swept key, a line for each combination of the others.

use std::ops::Range;

use crate::error::words::{NAMED, names};
use crate::lab::sweep::results::Sweep;
use crate::report::colour::Colour;
use crate::report::colour::scale::linear_ticks;

use super::canvas::{Anchor, TextStyle};
use super::drawing::{Drawing, Pen, Shape, ink, polyline, text};
use super::font;
use super::markers::{colour, marker};

const MARGIN: f64 = 22.0;
/// Room for the numbers at the left of a panel.
const LABELS: f64 = 78.0;
const PANEL_HEIGHT: f64 = 250.0;
const WIDTH: f64 = 960.0;
const TITLE_SIZE: f64 = 18.0;
const TEXT_SIZE: f64 = 14.0;
const TICK_SIZE: f64 = 13.0;
const LINE_HEIGHT: f64 = 21.0;
/// Most lines of a panel: as many colours as are told apart.
const MOST_LINES: usize = 7;
/// Most panels.
const MOST_PANELS: usize = 12;
/// Most words along an axis.
const MOST_WORDS: usize = 8;

/// One panel: where it is and what it shows.
struct Panel<'a> {
    sweep: &'a Sweep,
    shown: usize,
    /// x, y, width, height.
    area: [f64; 4],
    x: Range<f64>,
    y: Range<f64>,
}

/// The plot.
pub fn drawing(sweep: &Sweep) -> Drawing {
    let mut panels: Vec<usize> = (0..sweep.shown.len()).filter(|shown| sweep.is_known(*shown)).collect();
    panels.truncate(MOST_PANELS);
    let columns = if panels.len() > 1 { 2 } else { 1 };
    let mut shapes = Vec::new();
    let mut y = MARGIN + TITLE_SIZE;
    let style = TextStyle::new(TITLE_SIZE, Colour::grey(20)).weighing(1.25);
    let title =
        font::shortened(&format!("Sweep: {}", sweep.scene_name), TITLE_SIZE, WIDTH - 2.0 * MARGIN, "..");
    shapes.push(text([MARGIN, y], &title, style));
    y += 10.0;
    legend(&mut shapes, sweep, &mut y);
    let width = WIDTH / columns as f64 - LABELS - 2.0 * MARGIN;
    let row_height = PANEL_HEIGHT + 4.0 * LINE_HEIGHT;
    for (i, &shown) in panels.iter().enumerate() {
        let x = MARGIN + LABELS + (i % columns) as f64 * (WIDTH / columns as f64);
        let top = y + (i / columns) as f64 * row_height + LINE_HEIGHT + 8.0;
        let middle = [x + 0.5 * width, top - 9.0];
        let style = TextStyle::new(TEXT_SIZE, ink()).anchored(Anchor::Middle).weighing(1.25);
        shapes.push(text(middle, &sweep.shown[shown], style));
        let [xs, ys] = [places(sweep), values(sweep, shown)].map(padded);
        Panel { sweep, shown, area: [x, top, width, PANEL_HEIGHT], x: xs, y: ys }.draw(&mut shapes);
    }
    y += panels.len().div_ceil(columns) as f64 * row_height + LINE_HEIGHT;
    for line in font::wrapped(&caption(sweep), TICK_SIZE, WIDTH - 2.0 * MARGIN) {
        shapes.push(text([MARGIN, y], &line, TextStyle::new(TICK_SIZE, ink())));
        y += LINE_HEIGHT - 2.0;
    }
    Drawing { width: WIDTH as usize, height: (y + MARGIN - LINE_HEIGHT + 6.0) as usize, shapes }
}

/// Where a point stands along the first key: its number, or which of its words.
fn place(sweep: &Sweep, point: usize) -> f64 {
    let is_numbers = sweep.grid.axes()[0].values.iter().all(|value| value.number.is_some());
    let number = sweep.grid.value(point, 0).number.filter(|_| is_numbers);
    number.unwrap_or(sweep.grid.at(point, 0) as f64)
}

fn places(sweep: &Sweep) -> Vec<f64> {
    (0..sweep.points.len()).map(|point| place(sweep, point)).collect()
}

/// Both ends of every error bar.
fn values(sweep: &Sweep, shown: usize) -> Vec<f64> {
    let ends = |point| {
        let figure = sweep.figure(point, shown)?;
        let (value, error) = (figure.value?, figure.standard_error.unwrap_or(0.0));
        Some([value - error, value + error])
    };
    (0..sweep.points.len()).filter_map(ends).flatten().collect()
}

/// A range that holds all values with some room about them.
fn padded(values: Vec<f64>) -> Range<f64> {
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let (low, high) = if low <= high { (low, high) } else { (0.0, 1.0) };
    let room = match high - low {
        0.0 if high == 0.0 => 1.0,
        0.0 => 0.05 * high.abs(),
        span => 0.06 * span,
    };
    low - room..high + room
}

/// Points of each line: those that agree in all keys but the first. The first is the slowest, so they are a stride apart.
fn lines(sweep: &Sweep) -> usize {
    sweep.grid.points() / sweep.grid.axes()[0].values.len()
}

impl Panel<'_> {
    fn at(&self, place: f64, value: f64) -> [f64; 2] {
        let [left, top, width, height] = self.area;
        let share = |range: &Range<f64>, x: f64| (x - range.start) / (range.end - range.start);
        [left + width * share(&self.x, place), top + height * (1.0 - share(&self.y, value))]
    }

    fn draw(&self, shapes: &mut Vec<Shape>) {
        self.draw_grid(shapes);
        let lines = lines(self.sweep);
        for line in (0..lines.min(MOST_LINES)).rev() {
            let points = (line..self.sweep.points.len()).step_by(lines);
            let of = |point| {
                let figure = self.sweep.figure(point, self.shown)?;
                Some((place(self.sweep, point), figure.value?, figure.standard_error))
            };
            let mut known: Vec<_> = points.filter_map(of).collect();
            known.sort_by(|a, b| a.0.total_cmp(&b.0));
            let chain: Vec<_> = known.iter().map(|(place, value, _)| self.at(*place, *value)).collect();
            shapes.push(polyline(chain.clone(), Pen::solid(1.6, colour(line))));
            for (at, (place, value, error)) in chain.into_iter().zip(known) {
                if let Some(error) = error {
                    let ends = [value - error, value + error].map(|value| self.at(place, value));
                    shapes.push(polyline(ends.to_vec(), Pen::solid(1.4, colour(line))));
                    for [x, y] in ends {
                        shapes.push(polyline([[x - 4.0, y], [x + 4.0, y]], Pen::solid(1.4, colour(line))));
                    }
                }
                shapes.extend(marker(line, at, false));
            }
        }
    }

    fn draw_grid(&self, shapes: &mut Vec<Shape>) {
        let [left, top, width, height] = self.area;
        let (right, foot) = (left + width, top + height);
        let style = TextStyle::new(TICK_SIZE, ink());
        for tick in linear_ticks(self.y.start, self.y.end, 5) {
            let [_, y] = self.at(self.x.start, tick.value);
            shapes.push(polyline([[left, y], [right, y]], hairline(222)));
            shapes.push(text([left - 7.0, y + 4.5], &tick.label, style.anchored(Anchor::End)));
        }
        let mut free_from = f64::NEG_INFINITY;
        for (place, label) in self.ticks() {
            let [x, _] = self.at(place, self.y.start);
            shapes.push(polyline([[x, top], [x, foot]], hairline(222)));
            let label = font::shortened(&label, TICK_SIZE, 0.4 * width, "..");
            let half = 0.5 * font::width_px(&label, TICK_SIZE, true);
            if x - half > free_from {
                shapes.push(text([x, foot + 18.0], &label, style.anchored(Anchor::Middle)));
                free_from = x + half + 8.0;
            }
        }
        let key = font::shortened(&self.sweep.grid.axes()[0].key, TICK_SIZE, width, "..");
        let below = [left + 0.5 * width, foot + 18.0 + LINE_HEIGHT];
        shapes.push(text(below, &key, style.anchored(Anchor::Middle)));
        let frame = [[left, top], [right, top], [right, foot], [left, foot], [left, top]];
        shapes.push(polyline(frame, hairline(130)));
    }

    /// Marks along the first key.
    fn ticks(&self) -> Vec<(f64, String)> {
        let values = &self.sweep.grid.axes()[0].values;
        if values.iter().all(|value| value.number.is_some()) {
            let count = if values.len() == 1 { 1 } else { 6 };
            return match values.as_slice() {
                [only] => vec![(only.number.unwrap_or(0.0), only.shown.clone())],
                _ => linear_ticks(self.x.start, self.x.end, count)
                    .into_iter()
                    .map(|t| (t.value, t.label))
                    .collect(),
            };
        }
        let step = values.len().div_ceil(MOST_WORDS);
        let word = |at: usize| (at as f64, values[at].shown.clone());
        (0..values.len()).step_by(step).map(word).collect()
    }
}

fn hairline(grey: u8) -> Pen {
    Pen::solid(1.0, Colour::grey(grey))
}

/// Line, marker and values of every combination that is drawn; nothing where there is one.
fn legend(shapes: &mut Vec<Shape>, sweep: &Sweep, y: &mut f64) {
    let sample = 36.0;
    if lines(sweep) < 2 {
        return;
    }
    let mut x = MARGIN;
    *y += LINE_HEIGHT;
    for line in 0..lines(sweep).min(MOST_LINES) {
        let values = sweep.grid.values(line).skip(1).map(|(key, value)| format!("{key} = {}", value.shown));
        let name = values.collect::<Vec<_>>().join(", ");
        let name = font::shortened(&name, TEXT_SIZE, WIDTH - 2.0 * MARGIN - sample - 8.0, "..");
        let entry = sample + 8.0 + font::width_px(&name, TEXT_SIZE, true);
        if x > MARGIN && x + entry > WIDTH - MARGIN {
            x = MARGIN;
            *y += LINE_HEIGHT;
        }
        shapes.push(polyline([[x, *y - 5.0], [x + sample, *y - 5.0]], Pen::solid(1.6, colour(line))));
        shapes.extend(marker(line, [x + 0.5 * sample, *y - 5.0], false));
        shapes.push(text([x + sample + 8.0, *y], &name, TextStyle::new(TEXT_SIZE, ink())));
        // Other fonts than ours are wider.
        x += 1.15 * entry + 26.0;
    }
    *y += 6.0;
}

/// What bars mean, and what is left out.
fn caption(sweep: &Sweep) -> String {
    let mut caption =
        "Bars: one standard error of each value. Errors of differences are in sweep.md.".to_owned();
    if lines(sweep) > MOST_LINES {
        caption += &format!(" The first {MOST_LINES} of {} combinations of the other keys.", lines(sweep));
    }
    if sweep.shown.len() > MOST_PANELS {
        caption += &format!(" The first {MOST_PANELS} of {} figures.", sweep.shown.len());
    }
    let unknown = (0..sweep.shown.len()).filter(|shown| !sweep.is_known(*shown));
    let unknown = names(unknown.map(|shown| &sweep.shown[shown]), NAMED);
    if !unknown.is_empty() {
        caption += &format!(" Not given at any point: {unknown}.");
    }
    caption
}
