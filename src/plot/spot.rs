//! Drawings of a spot: encircled flux against the radius, and sections of the map through a point.

use std::ops::Range;

use crate::estimate::spot::{Encircled, Figure};
use crate::report::colour::Colour;
use crate::report::colour::scale::linear_ticks;
use crate::report::numbers::{digits, rounded, with_error};
use crate::report::spot::{SectionCell, SpotFigures, diameter_text, unit_of};

use super::canvas::{Anchor, TextStyle};
use super::drawing::{Drawing, Pen, Shape, ink, polyline, text};
use super::font;
use super::page::{MARGIN, WIDTH, curve_pen, finished, title};

const TICK_SIZE: f64 = 13.0;
const TOP: f64 = 84.0;
const HEIGHT: f64 = 330.0;
/// Room for the name of the axis along the foot.
const NAME: f64 = 16.0;
/// Room for the numbers of the upright axis.
const LABELS: f64 = 52.0;
/// Parts of the peak below which a section is not worth its width.
const DIM: f64 = 2e-3;
/// Share of the flux at which a curve is at its end.
const FULL: f64 = 0.999;

/// Share of the receiver's flux within a circle about the centroid, with its band of 95 % and both diameters.
pub fn encircled(name: &str, figures: &SpotFigures) -> Drawing {
    let outermost = figures.encircled.last().map_or(0.0, |point| point.radius_m);
    // To where nearly all of it is in, unless that is a halo far outside.
    let full = figures.encircled.iter().find(|point| point.share.value >= FULL);
    let of_d86 = 0.5 * figures.d86_m.by_cells[1];
    let end_m = (1.08 * full.map_or(outermost, |point| point.radius_m))
        .clamp(1.15 * of_d86, 4.0 * of_d86)
        .max(f64::MIN_POSITIVE);
    let (unit, unit_name) = unit_of(2.0 * end_m);
    let chart = Chart { x: 0.0..unit * end_m, y: 0.0..100.0 };
    let mut shown: Vec<_> =
        figures.encircled.iter().filter(|point| point.radius_m <= end_m).cloned().collect();
    // Beyond the last photon nothing is left to come.
    let last = if outermost < end_m { shown.last().cloned() } else { at_radius(&figures.encircled, end_m) };
    shown.extend(last.map(|point| Encircled { radius_m: end_m, ..point }));
    let mut shapes = vec![title(&format!("Encircled flux: {name}"))];
    let t = figures.student.unwrap_or(0.0);
    let ends = shown.iter().map(|point| {
        let noise = t * point.share.standard_error.unwrap_or(0.0);
        let [low, high] = point.by_cells;
        (unit * point.radius_m, [low - noise, high + noise].map(|share| 100.0 * share.clamp(0.0, 1.0)))
    });
    shapes.push(chart.band(ends, 0));
    chart.grid(&mut shapes, "share of the flux [%]", &format!("radius about the centroid [{unit_name}]"));
    let of_curve = shown.iter().map(|point| [unit * point.radius_m, 100.0 * point.share.value]);
    shapes.push(chart.curve(of_curve, 0));
    for (label, share, d) in [("D50", 50.0, &figures.d50_m), ("D86.5", 86.466, &figures.d86_m)] {
        let at = [chart.at_x(0.5 * unit * d.value), chart.at_y(share)];
        let pen = Pen { dash_px: Some([5.0, 4.0]), ..Pen::solid(1.3, Colour::grey(90)) };
        shapes.push(polyline([[chart.at_x(0.0), at[1]], at, [at[0], chart.at_y(0.0)]], pen));
        let label = format!("{label} = {} {unit_name}", rounded(unit * d.value, 4));
        let style = TextStyle::new(TICK_SIZE, Colour::grey(20)).weighing(1.25);
        shapes.push(beside_curve(at, &label, style));
    }
    let legend = [("flux in the circle; band: 95 %, noise and fine cells".to_owned(), curve_pen(0, false))];
    let [d50, d86] = [&figures.d50_m, &figures.d86_m].map(|d| diameter_text(d, (unit, unit_name)));
    let [u, v] = centroid(figures);
    let radius = &figures.rms_radius_m;
    let rms = with_error(unit * radius.value, radius.standard_error.map(|e| unit * e), unit_name);
    let footer = [
        format!("D50 {d50}"),
        format!("D86.5 {d86}"),
        format!("centroid u {u}, v {v}"),
        format!("RMS radius {rms}"),
    ];
    finished(shapes, TOP + HEIGHT + NAME, legend, &footer)
}

/// Illuminance of the cells along u and along v through a point, each with its band of 95 %.
pub fn sections(name: &str, figures: &SpotFigures) -> Drawing {
    let most = figures.sections.iter().flatten().map(|cell| cell.lx).fold(0.0, f64::max);
    let lit = |along: usize| {
        let from = figures.sections_at_m[along];
        let is_lit = move |cell: &&SectionCell| cell.lx > DIM * most;
        figures.sections[along].iter().filter(is_lit).map(move |cell| cell.along_m - from)
    };
    let (low, high) = lit(0).chain(lit(1)).fold((0.0f64, 0.0f64), |(a, b), x| (a.min(x), b.max(x)));
    let spacing = |cells: &[SectionCell]| match cells {
        [first, second, ..] => second.along_m - first.along_m,
        _ => 0.0,
    };
    let pad = (0.08 * (high - low))
        .max(figures.sections.iter().map(|cells| 1.02 * spacing(cells)).fold(0.0, f64::max))
        .max(f64::MIN_POSITIVE);
    let range_m = low - pad..high + pad;
    let (unit, unit_name) = unit_of(range_m.end - range_m.start);
    let t = figures.student.unwrap_or(0.0);
    let ends = figures.sections.iter().flatten().map(|c| c.lx + t * c.standard_error_lx.unwrap_or(0.0));
    // Whole bands, unless they are wider than what they are about.
    let top = (1.05 * ends.fold(0.0, f64::max)).clamp(1.08 * most, 2.0 * most).max(f64::MIN_POSITIVE);
    let chart = Chart { x: unit * range_m.start..unit * range_m.end, y: 0.0..top };
    let mut shapes = vec![title(&format!("Sections: {name}"))];
    let shown = |along: usize| {
        let from = figures.sections_at_m[along];
        let of = move |cell: &SectionCell| (unit * (cell.along_m - from), cell.lx, cell.standard_error_lx);
        let inside = |(x, ..): &(f64, f64, Option<f64>)| chart.x.contains(x);
        figures.sections[along].iter().map(of).filter(inside).collect::<Vec<_>>()
    };
    let both = [shown(0), shown(1)];
    for along in [1, 0] {
        let ends = both[along].iter().map(|(x, lx, error)| {
            let noise = t * error.unwrap_or(0.0);
            (*x, [lx - noise, lx + noise].map(|lx| lx.clamp(0.0, top)))
        });
        shapes.push(chart.band(ends, along));
    }
    chart.grid(&mut shapes, "illuminance [lx]", &format!("from the point, along u or v [{unit_name}]"));
    for along in [1, 0] {
        shapes.push(chart.curve(both[along].iter().map(|(x, lx, _)| [*x, *lx]), along));
    }
    let legend = ["along u", "along v"].into_iter().enumerate();
    let legend = legend.map(|(along, label)| (label.to_owned(), curve_pen(along, false)));
    let [u, v] = figures.sections_at_m.map(digits);
    let peak = figures
        .peak
        .illuminance_lx
        .map_or("not known: one replicate, or fewer than ten photons in its cell".into(), |lx| {
            with_error(lx.value, Some(lx.standard_error), "lx")
        });
    let band = if figures.student.is_some() { "; bands: 95 % of each cell" } else { "" };
    let footer = [format!("through u {u} m, v {v} m{band}"), format!("peak {peak}")];
    finished(shapes, TOP + HEIGHT + NAME, legend, &footer)
}

/// The curve between two of its points.
fn at_radius(curve: &[Encircled], radius_m: f64) -> Option<Encircled> {
    let pair = curve.windows(2).find(|pair| (pair[0].radius_m..=pair[1].radius_m).contains(&radius_m))?;
    let [a, b] = [pair[0], pair[1]];
    let part = (radius_m - a.radius_m) / (b.radius_m - a.radius_m);
    let between = |a: f64, b: f64| a + part * (b - a);
    let share = Figure { value: between(a.share.value, b.share.value), ..b.share };
    let by_cells = [0, 1].map(|i| between(a.by_cells[i], b.by_cells[i]));
    Some(Encircled { radius_m, share, by_cells })
}

fn centroid(figures: &SpotFigures) -> [String; 2] {
    figures.centroid_m.map(|figure| {
        let text = with_error(figure.value, figure.standard_error, "m");
        text.rsplit_once(" (").map_or(text.clone(), |(text, _)| text.to_owned())
    })
}

/// A label left of and above a point of the curve, which rises to the right; right of and below it where there is no room.
fn beside_curve([x, y]: [f64; 2], label: &str, style: TextStyle) -> Shape {
    let width = 1.06 * font::width_px(label, TICK_SIZE, true);
    if x - 8.0 - width > Chart::LEFT + 4.0 {
        text([x - 8.0, y - 7.0], label, style.anchored(Anchor::End))
    } else {
        text([x + 8.0, y + 18.0], label, style)
    }
}

/// The ranges of a chart in the units of its axes.
struct Chart {
    x: Range<f64>,
    y: Range<f64>,
}

impl Chart {
    const LEFT: f64 = MARGIN + LABELS;
    const RIGHT: f64 = WIDTH as f64 - MARGIN;

    fn at_x(&self, x: f64) -> f64 {
        Self::LEFT + (Self::RIGHT - Self::LEFT) * (x - self.x.start) / (self.x.end - self.x.start)
    }

    fn at_y(&self, y: f64) -> f64 {
        TOP + HEIGHT * (1.0 - (y - self.y.start) / (self.y.end - self.y.start))
    }

    fn curve(&self, points: impl Iterator<Item = [f64; 2]>, index: usize) -> Shape {
        let points: Vec<_> = points.map(|[x, y]| [self.at_x(x), self.at_y(y)]).collect();
        polyline(points, curve_pen(index, false))
    }

    /// The area between both ends at each x.
    fn band(&self, ends: impl Iterator<Item = (f64, [f64; 2])>, index: usize) -> Shape {
        let (mut along, mut back) = (Vec::new(), Vec::new());
        for (x, [low, high]) in ends {
            along.push([self.at_x(x), self.at_y(low)]);
            back.push([self.at_x(x), self.at_y(high)]);
        }
        along.extend(back.into_iter().rev());
        let colours = [(0xcd, 0xdf, 0xf1), (0xf7, 0xd9, 0xd4)];
        let (r, g, b) = colours[index % colours.len()];
        Shape::Region { loops: vec![along], colour: Colour::srgb(r, g, b) }
    }

    /// Lines, numbers and names of both axes, and the frame.
    fn grid(&self, shapes: &mut Vec<Shape>, upright: &str, along: &str) {
        let (left, right, foot) = (Self::LEFT, Self::RIGHT, TOP + HEIGHT);
        let style = TextStyle::new(TICK_SIZE, ink());
        let hairline = |grey| Pen::solid(1.0, Colour::grey(grey));
        for tick in linear_ticks(self.y.start, self.y.end, 6) {
            let y = self.at_y(tick.value);
            shapes.push(polyline([[left, y], [right, y]], hairline(222)));
            shapes.push(text([left - 7.0, y + 4.5], &tick.label, style.anchored(Anchor::End)));
        }
        for tick in linear_ticks(self.x.start, self.x.end, 8) {
            let x = self.at_x(tick.value);
            shapes.push(polyline([[x, TOP], [x, foot]], hairline(222)));
            shapes.push(text([x, foot + 18.0], &tick.label, style.anchored(Anchor::Middle)));
        }
        let frame = [[left, TOP], [right, TOP], [right, foot], [left, foot], [left, TOP]];
        shapes.push(polyline(frame, hairline(130)));
        shapes.push(text([MARGIN, TOP - 12.0], upright, style));
        shapes.push(text([0.5 * (left + right), foot + 38.0], along, style.anchored(Anchor::Middle)));
    }
}
