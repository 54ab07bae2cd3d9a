//! compare.svg: nRMS against the number of photons, both logarithmic, a panel for every grid.

use std::ops::Range;

use crate::lab::study::results::Study;
use crate::lab::study::table::{REFERENCE_MARGIN, Row, Table};
use crate::report::colour::Colour;
use crate::report::colour::scale::{log_ticks, round_125};
use crate::report::compare::remarks::{cells, seeds};
use crate::report::numbers::three_digits;

use super::canvas::{Anchor, TextStyle};
use super::drawing::{Drawing, Pen, Shape, ink, polyline, text};
use super::font;
use super::markers::{colour, marker};

const MARGIN: f64 = 22.0;
/// Room for the numbers at the left of a row of panels.
const LABELS: f64 = 50.0;
const GAP: f64 = 22.0;
const PANEL_HEIGHT: f64 = 400.0;
const MOST_COLUMNS: usize = 3;
const TITLE_SIZE: f64 = 18.0;
const TEXT_SIZE: f64 = 14.0;
const TICK_SIZE: f64 = 13.0;
const LINE_HEIGHT: f64 = 21.0;
/// Least share of the axis that is shown of a reference better than the best error.
const DEEPEST_REFERENCE: f64 = 30.0;
/// Exponents of the guides and their names.
const GUIDES: [(f64, &str); 2] = [(-0.5, "-1/2"), (-0.75, "-3/4")];

/// A plot's logarithmic ranges: photons, and nRMS as a fraction.
struct Axes {
    photons: Range<f64>,
    error: Range<f64>,
}

/// One panel: where it is and what it shows.
struct Panel<'a> {
    axes: &'a Axes,
    /// x, y, width, height.
    area: [f64; 4],
    grid: usize,
    labelled: bool,
}

/// The plot; svg and png are renderings of it.
pub fn drawing(study: &Study, table: &Table) -> Drawing {
    let columns = study.grids.len().clamp(1, MOST_COLUMNS);
    let width = if columns == 1 { 640.0 } else { 960.0 };
    let mut shapes = Vec::new();
    let mut y = MARGIN + TITLE_SIZE;
    let title = format!("Error of algorithm variants: {}", study.scene_name);
    let style = TextStyle::new(TITLE_SIZE, Colour::grey(20)).weighing(1.25);
    shapes.push(text([MARGIN, y], &font::shortened(&title, TITLE_SIZE, width - 2.0 * MARGIN, ".."), style));
    y += 10.0;
    legend(&mut shapes, study, width, &mut y);
    let axes = Axes::of(study, table);
    let panel_width = (width - 2.0 * MARGIN - LABELS - GAP * (columns - 1) as f64) / columns as f64;
    for (g, grid) in study.grids.iter().enumerate() {
        let column = g % columns;
        if column == 0 && g > 0 {
            y += PANEL_HEIGHT + 3.0 * LINE_HEIGHT + 14.0;
        }
        let x = MARGIN + LABELS + column as f64 * (panel_width + GAP);
        let middle = [x + 0.5 * panel_width, y + LINE_HEIGHT + 2.0];
        let style = TextStyle::new(TEXT_SIZE, ink()).anchored(Anchor::Middle).weighing(1.25);
        shapes.push(text(middle, &format!("{} cells", cells(*grid)), style));
        let area = [x, y + LINE_HEIGHT + 12.0, panel_width, PANEL_HEIGHT];
        Panel { axes: &axes, area, grid: g, labelled: column == 0 }.draw(&mut shapes, study, table);
    }
    y += PANEL_HEIGHT + 4.0 * LINE_HEIGHT + 16.0;
    for line in font::wrapped(&caption(study, table), TICK_SIZE, width - 2.0 * MARGIN) {
        shapes.push(text([MARGIN, y], &line, TextStyle::new(TICK_SIZE, ink())));
        y += LINE_HEIGHT - 2.0;
    }
    Drawing { width: width as usize, height: (y + MARGIN - LINE_HEIGHT + 6.0) as usize, shapes }
}

impl Axes {
    /// Ranges that hold every point of every panel with its bar, and the reference's own error unless far below.
    fn of(study: &Study, table: &Table) -> Self {
        let span = |values: &mut dyn Iterator<Item = f64>| {
            values.filter(positive).map(|v| [v, v]).reduce(|a, b| [a[0].min(b[0]), a[1].max(b[1])])
        };
        let with_bar = |r: &Row| [r.errors.nrms, r.errors.nrms + r.nrms_spread.unwrap_or(0.0)];
        let errors = span(&mut table.rows.iter().flat_map(with_bar));
        let [mut least, most] = errors.unwrap_or([1e-3, 1e-1]);
        for own in study.reference.own_nrms.iter().take(study.grids.len()).copied().filter(positive) {
            if own > least / DEEPEST_REFERENCE {
                least = least.min(own);
            }
        }
        let photons = span(&mut table.rows.iter().map(|r| r.photons as f64)).unwrap_or([1.0, 1e6]);
        let pad = if photons[0] < photons[1] { (photons[1] / photons[0]).powf(0.05).max(1.05) } else { 4.0 };
        Self {
            photons: photons[0] / pad..photons[1] * pad,
            // Below the reference's own error its label stands.
            error: round_125(0.72 * least, false)..round_125(1.1 * most, true),
        }
    }
}

fn positive(value: &f64) -> bool {
    *value > 0.0 && value.is_finite()
}

impl Panel<'_> {
    fn x(&self, photons: f64) -> f64 {
        self.area[0] + self.area[2] * share(&self.axes.photons, photons)
    }

    /// Held at the foot: an error bar may reach to nothing.
    fn y(&self, error: f64) -> f64 {
        let [_, top, _, height] = self.area;
        top + height * (1.0 - share(&self.axes.error, error.max(self.axes.error.start)))
    }

    fn draw(&self, shapes: &mut Vec<Shape>, study: &Study, table: &Table) {
        self.draw_grid(shapes);
        self.draw_guides(shapes);
        self.draw_reference(shapes, study);
        let shown = |r: &&Row| r.grid == self.grid && r.errors.nrms > 0.0;
        let of = |v: usize| table.rows.iter().filter(shown).filter(move |r| r.variant == v);
        let place = |row: &Row| [self.x(row.photons as f64), self.y(row.errors.nrms)];
        for v in (0..study.variants.len()).rev() {
            shapes.push(polyline(of(v).map(place).collect::<Vec<_>>(), Pen::solid(2.0, colour(v))));
        }
        for row in (0..study.variants.len()).rev().flat_map(of) {
            self.draw_bar(shapes, row);
            shapes.extend(marker(row.variant, place(row), row.limited_by_reference));
        }
    }

    fn draw_grid(&self, shapes: &mut Vec<Shape>) {
        let [left, top, width, height] = self.area;
        let (right, foot) = (left + width, top + height);
        let style = TextStyle::new(TICK_SIZE, ink());
        for tick in log_ticks(100.0 * self.axes.error.start, 100.0 * self.axes.error.end) {
            let y = self.y(0.01 * tick.value);
            let pen = hairline(if is_power_of_ten(tick.value) { 196 } else { 226 });
            shapes.push(polyline([[left, y], [right, y]], pen));
            if self.labelled {
                let label = format!("{} %", tick.label);
                shapes.push(text([left - 7.0, y + 4.5], &label, style.anchored(Anchor::End)));
            }
        }
        for photons in between_powers(&self.axes.photons) {
            let x = self.x(photons);
            shapes.push(polyline([[x, foot - 5.0], [x, foot]], hairline(130)));
        }
        let mut free_from = f64::NEG_INFINITY;
        for (photons, label) in photon_ticks(&self.axes.photons) {
            let x = self.x(photons);
            shapes.push(polyline([[x, top], [x, foot]], hairline(212)));
            let half = 0.5 * font::width_px(&label, TICK_SIZE, true);
            if x - half > free_from {
                shapes.push(text([x, foot + 18.0], &label, style.anchored(Anchor::Middle)));
                free_from = x + half + 8.0;
            }
        }
        let title_at = [left + 0.5 * width, foot + 18.0 + LINE_HEIGHT];
        shapes.push(text(title_at, "photons N", style.anchored(Anchor::Middle)));
        let frame = [[left, top], [right, top], [right, foot], [left, foot], [left, top]];
        shapes.push(polyline(frame, hairline(130)));
    }

    /// Two slopes from one point in the upper right corner, which errors that fall leave free.
    fn draw_guides(&self, shapes: &mut Vec<Shape>) {
        let decades = libm::log10(self.axes.photons.end / self.axes.photons.start);
        let fall = libm::log10(self.axes.error.end / self.axes.error.start);
        let reach = (0.3 * decades).min(0.4 * fall / 0.75);
        let start = [
            self.axes.photons.start * libm::exp10(0.86 * decades - reach),
            self.axes.error.end / libm::exp10(0.04 * fall),
        ];
        for (rate, name) in GUIDES {
            let (photons, error) = (start[0] * libm::exp10(reach), start[1] * libm::exp10(rate * reach));
            let end = [self.x(photons), self.y(error)];
            let grey = Colour::grey(110);
            let dotted = Pen { dash_px: Some([1.5, 4.0]), ..Pen::solid(1.6, grey) };
            shapes.push(polyline([[self.x(start[0]), self.y(start[1])], end], dotted));
            shapes.push(text([end[0] + 5.0, end[1] + 4.5], name, TextStyle::new(TICK_SIZE, grey)));
        }
    }

    fn draw_reference(&self, shapes: &mut Vec<Shape>, study: &Study) {
        let own = study.reference.own_nrms.get(self.grid).copied().filter(positive);
        let Some(own) = own else { return };
        let [left, top, width, height] = self.area;
        let grey = Colour::grey(70);
        let shown = own >= self.axes.error.start;
        let y = if shown { self.y(own) } else { top + height };
        if shown {
            let dashed = Pen { dash_px: Some([7.0, 5.0]), ..Pen::solid(1.5, grey) };
            shapes.push(polyline([[left, y], [left + width, y]], dashed));
        }
        let off_scale = if shown { "" } else { ", below" };
        let label = format!("reference {} %{off_scale}", three_digits(100.0 * own));
        let baseline = if shown && y + 19.0 < top + height { y + 15.0 } else { y - 6.0 };
        shapes.push(text([left + 6.0, baseline], &label, TextStyle::new(TICK_SIZE, grey)));
    }

    /// From nRMS less its spread to nRMS plus it.
    fn draw_bar(&self, shapes: &mut Vec<Shape>, row: &Row) {
        let Some(spread) = row.nrms_spread else { return };
        let x = self.x(row.photons as f64);
        let ends = [self.y(row.errors.nrms - spread), self.y(row.errors.nrms + spread)];
        let pen = Pen::solid(1.4, colour(row.variant));
        shapes.push(polyline([[x, ends[0]], [x, ends[1]]], pen));
        for y in ends {
            shapes.push(polyline([[x - 4.0, y], [x + 4.0, y]], pen));
        }
    }
}

fn hairline(grey: u8) -> Pen {
    Pen::solid(1.0, Colour::grey(grey))
}

/// Line, marker and name of every variant, as many in a row as fit.
fn legend(shapes: &mut Vec<Shape>, study: &Study, width: f64, y: &mut f64) {
    let sample = 36.0;
    let mut x = MARGIN;
    *y += LINE_HEIGHT;
    for (v, variant) in study.variants.iter().enumerate() {
        let name = font::shortened(&variant.name, TEXT_SIZE, width - 2.0 * MARGIN - sample - 8.0, "..");
        let entry = sample + 8.0 + font::width_px(&name, TEXT_SIZE, true);
        if x > MARGIN && x + entry > width - MARGIN {
            x = MARGIN;
            *y += LINE_HEIGHT;
        }
        shapes.push(polyline([[x, *y - 5.0], [x + sample, *y - 5.0]], Pen::solid(2.0, colour(v))));
        shapes.extend(marker(v, [x + 0.5 * sample, *y - 5.0], false));
        shapes.push(text([x + sample + 8.0, *y], &name, TextStyle::new(TEXT_SIZE, ink())));
        x += entry + 26.0;
    }
    *y += 6.0;
}

/// What lines and bars mean.
fn caption(study: &Study, table: &Table) -> String {
    let bars = if study.seeds.len() > 1 {
        format!("Root mean square over {}, bars: standard deviation.", seeds(study))
    } else {
        "One seed: no spread is known.".to_owned()
    };
    let hollow = format!(" Hollow markers: less than {REFERENCE_MARGIN} x that, limited by the reference.");
    let limited = if table.rows.iter().any(|r| r.limited_by_reference) { &hollow } else { "" };
    format!(
        "nRMS in % of the mean illuminance. {bars} Dashed: the reference's own error.{limited} Dotted: slopes of N^(-1/2) \
         and N^(-3/4)."
    )
}

/// Marks of the axis of photons: powers of ten, or 1, 2, 5 of them where those are fewer than two.
fn photon_ticks(range: &Range<f64>) -> Vec<(f64, String)> {
    let all = log_ticks(range.start, range.end);
    let powers = all.iter().filter(|t| is_power_of_ten(t.value)).count();
    all.iter().filter(|t| powers < 2 || is_power_of_ten(t.value)).map(|t| (t.value, short(t.value))).collect()
}

/// 2 to 9 times the powers of ten, within the range.
fn between_powers(range: &Range<f64>) -> Vec<f64> {
    let power = |value: f64| libm::floor(libm::log10(value)) as i32;
    (power(range.start)..=power(range.end))
        .flat_map(|p| (2..=9).map(move |digit| f64::from(digit) * libm::exp10(f64::from(p))))
        .filter(|n| range.contains(n))
        .collect()
}

fn is_power_of_ten(value: f64) -> bool {
    let exponent = libm::round(libm::log10(value));
    (value / libm::exp10(exponent) - 1.0).abs() < 1e-9
}

/// 20k, 5M, 1G.
fn short(value: f64) -> String {
    let units = [(1e12, "T"), (1e9, "G"), (1e6, "M"), (1e3, "k")];
    let (unit, name) = units.into_iter().find(|(unit, _)| value >= *unit).unwrap_or((1.0, ""));
    format!("{}{name}", value / unit)
}

/// Place on a logarithmic range, 0 at its start and 1 at its end.
fn share(range: &Range<f64>, value: f64) -> f64 {
    libm::log(value / range.start) / libm::log(range.end / range.start)
}
