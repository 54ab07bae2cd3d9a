//! The iso-candela diagram of a photometric file: lines of equal intensity, as shares of the largest.
//!
//! Type C: the half spaces below and above the luminaire as discs, seen from above, C = 0 to the right and C
//! = 90 up; the distance from the middle is the angle from the axis. Types A and B: H to the right and V up,
//! as one looks along the aim. What is darker than 1 % of the maximum is left out at the edges.

use std::f64::consts::TAU;

use crate::photometry::web::PhotometricType;
use crate::photometry::{Photometry, Summary, Web};
use crate::report::colour::Colour;
use crate::report::colour::map::colour;
use crate::report::colour::scale::linear_ticks;
use crate::report::numbers::digits;

use super::candela::{footer, title_of};
use super::canvas::{Anchor, TextStyle};
use super::contour::level_lines;
use super::disc::RADIUS;
use super::drawing::{Drawing, Pen, Shape, ink, polyline, text};
use super::font;
use super::page::{MARGIN, WIDTH, base_drawing, title};

/// Shares of the maximum that have a line.
const LEVELS: [f64; 9] = [0.01, 0.02, 0.05, 0.1, 0.2, 0.3, 0.5, 0.7, 0.9];
/// Of them, those by which beam and field are defined.
const BEAM: f64 = 0.5;
const FIELD: f64 = 0.1;
/// Reaches of a disc that are tried, degrees: the first that holds all lines.
const REACHES_DEG: [f64; 7] = [10.0, 15.0, 20.0, 30.0, 45.0, 60.0, 90.0];
/// Samples along a side.
const SAMPLES: usize = 241;
const TICK_SIZE: f64 = 12.0;
const CENTRE_X: f64 = 0.5 * WIDTH as f64;

/// The diagram of a file.
pub fn drawing(photometry: &Photometry, summary: &Summary) -> Drawing {
    let web = &photometry.web;
    let mut shapes = vec![title(&title_of(photometry))];
    let max = summary.max_candela;
    let mut y = MARGIN + 30.0;
    let charts: Vec<Chart> = match web.photometric_type {
        PhotometricType::C => {
            [Part::Below, Part::Above].into_iter().filter_map(|part| Chart::disc(web, part, max)).collect()
        }
        _ => vec![Chart::rectangle(web, max)],
    };
    for chart in charts {
        y = chart.draw(&mut shapes, y, max);
    }
    y = scale(&mut shapes, y + 30.0, max);
    base_drawing(shapes, y + 30.0, &footer(summary))
}

/// What a chart shows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    /// The half space around V = 0, type C.
    Below,
    /// That around V = 180.
    Above,
    /// H and V of types A and B.
    Flat,
}

impl Part {
    /// V of type C as an angle from the axis of the half space, and the other way round.
    fn angle_from_axis(self, angle_deg: f64) -> f64 {
        if self == Self::Above { 180.0 - angle_deg } else { angle_deg }
    }
}

/// A map of directions.
struct Chart<'a> {
    part: Part,
    /// Half its extent to the right and up, degrees.
    reach_deg: [f64; 2],
    web: &'a Web,
}

impl<'a> Chart<'a> {
    /// A half space of type C; `None` where it is dark.
    fn disc(web: &'a Web, part: Part, max: f64) -> Option<Self> {
        let n_v = web.vertical_deg.len();
        let angle = |v: f64| part.angle_from_axis(v);
        let is_lit =
            (0..web.candela.len()).any(|i| web.candela[i] > 0.0 && angle(web.vertical_deg[i % n_v]) < 90.0);
        let widest =
            extent(web, &web.vertical_deg, max, |i| i % n_v, |v| Some(angle(v)).filter(|&v| v <= 90.0));
        let reach = REACHES_DEG.into_iter().find(|&reach| reach >= widest).unwrap_or(90.0);
        // Light at 90 degrees alone belongs to the other half space.
        is_lit.then_some(Self { part, reach_deg: [reach; 2], web })
    }

    /// All directions of types A and B.
    fn rectangle(web: &'a Web, max: f64) -> Self {
        let n_v = web.vertical_deg.len();
        let ten = |widest: f64| (widest.max(10.0) / 10.0).ceil() * 10.0;
        let h = extent(web, &web.horizontal_deg, max, |i| i / n_v, |h| Some(h.abs()));
        let v = extent(web, &web.vertical_deg, max, |i| i % n_v, |v| Some(v.abs()));
        Self { part: Part::Flat, reach_deg: [ten(h), ten(v)], web }
    }

    fn is_disc(&self) -> bool {
        self.part != Part::Flat
    }

    /// Intensity at a place, degrees from the middle to the right and up. Beyond a half space its edge goes
    /// on.
    fn intensity_cd(&self, [x, y]: [f64; 2]) -> f64 {
        if !self.is_disc() {
            return self.web.intensity_cd(y, x);
        }
        let angle = libm::hypot(x, y).min(90.0);
        self.web.intensity_cd(self.part.angle_from_axis(angle), libm::atan2(y, x) * (360.0 / TAU))
    }

    /// Draws it below `y`; where it ends.
    fn draw(&self, shapes: &mut Vec<Shape>, y: f64, max: f64) -> f64 {
        let [x_deg, y_deg] = self.reach_deg;
        let per_deg = if self.is_disc() { RADIUS / x_deg } else { (260.0 / x_deg).min(240.0 / y_deg) };
        let half = [x_deg * per_deg, y_deg * per_deg];
        let above = if self.is_disc() { 48.0 } else { 16.0 };
        let middle = [CENTRE_X, y + above + half[1]];
        if self.is_disc() {
            let side = if self.part == Part::Above { "above" } else { "below" };
            let name = format!("{side} the horizontal, to {x_deg}\u{b0} from the axis; seen from above");
            shapes.push(text([MARGIN, y + 14.0], &name, TextStyle::new(13.0, ink())));
        }
        let place = |[a, b]: [f64; 2]| [middle[0] + a * per_deg, middle[1] - b * per_deg];
        self.draw_bands(shapes, place, max);
        let edge = self.edge(place);
        let far = [half[0] + 14.0, half[1] + 14.0];
        let frame = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let outside = frame.map(|[a, b]| [middle[0] + a * far[0], middle[1] + b * far[1]]).to_vec();
        shapes.push(Shape::Region { loops: vec![outside, edge.clone()], colour: Colour::WHITE });
        if self.is_disc() {
            self.draw_polar_grid(shapes, place);
        } else {
            self.draw_square_grid(shapes, place);
        }
        shapes.push(polyline([edge.clone(), vec![edge[0]]].concat(), Pen::solid(1.2, Colour::grey(60))));
        self.mark_maximum(shapes, place);
        middle[1] + half[1] + 30.0
    }

    fn edge(&self, place: impl Fn([f64; 2]) -> [f64; 2]) -> Vec<[f64; 2]> {
        let [x, y] = self.reach_deg;
        if !self.is_disc() {
            return [[-x, -y], [x, -y], [x, y], [-x, y]].map(place).to_vec();
        }
        let point = |i: i32| f64::from(i) * (TAU / 360.0);
        (0..360).map(point).map(|t| place([x * libm::cos(t), x * libm::sin(t)])).collect()
    }

    /// The bands between levels, from the darkest, and their lines.
    fn draw_bands(&self, shapes: &mut Vec<Shape>, place: impl Fn([f64; 2]) -> [f64; 2], max: f64) {
        let [x, y] = self.reach_deg;
        let step = |i: usize| 2.0 * i as f64 / (SAMPLES - 1) as f64 - 1.0;
        // A ring of darkness around closes all lines.
        let side = SAMPLES + 2;
        let mut values = vec![0.0; side * side];
        for row in 0..SAMPLES {
            for column in 0..SAMPLES {
                values[(row + 1) * side + column + 1] = self.intensity_cd([step(column) * x, step(row) * y]);
            }
        }
        let degrees = |sample: f64| 2.0 * (sample - 1.5) / (SAMPLES - 1) as f64 - 1.0;
        let all = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]].map(|[a, b]| place([a * x, b * y]));
        shapes.push(Shape::Region { loops: vec![all.to_vec()], colour: band(0) });
        let loops = LEVELS.map(|level| {
            let lines = level_lines(&values, side, side, level * max);
            let line = |line: Vec<[f64; 2]>| {
                line.iter().map(|p| place([degrees(p[0]) * x, degrees(p[1]) * y])).collect::<Vec<_>>()
            };
            lines.into_iter().map(line).collect::<Vec<_>>()
        });
        for (i, loops) in loops.iter().enumerate().filter(|(_, loops)| !loops.is_empty()) {
            shapes.push(Shape::Region { loops: loops.clone(), colour: band(i + 1) });
        }
        for (&level, loops) in LEVELS.iter().zip(loops) {
            shapes.extend(loops.into_iter().map(|points| polyline(points, line_pen(level))));
        }
    }

    fn draw_polar_grid(&self, shapes: &mut Vec<Shape>, place: impl Fn([f64; 2]) -> [f64; 2]) {
        let reach = self.reach_deg[0];
        let step = reach / 3.0;
        let at = |radius: f64, c_deg: f64| {
            let c = c_deg * (TAU / 360.0);
            place([radius * libm::cos(c), radius * libm::sin(c)])
        };
        let centre = place([0.0, 0.0]);
        let pen = Pen::solid(0.8, Colour::grey(150));
        for ring in 1..3 {
            let radius = at(f64::from(ring) * step, 0.0)[0] - centre[0];
            shapes.push(Shape::Arc { centre, radius, angles: [0.0, TAU], pen });
        }
        for c in (0..360).step_by(30) {
            let c_deg = f64::from(c);
            shapes.push(polyline([at(0.1 * reach, c_deg), at(reach, c_deg)], pen));
            let label = if c == 0 { "C 0\u{b0}".to_owned() } else { format!("{c}\u{b0}") };
            let half = 0.5 * font::width_px(&label, TICK_SIZE, true);
            let [edge_x, edge_y] = at(reach, c_deg);
            let [out_x, out_y] = [(edge_x - centre[0]) / RADIUS, (edge_y - centre[1]) / RADIUS];
            let foot = [edge_x + out_x * (8.0 + half), edge_y + out_y * 14.0 + 4.0];
            shapes.push(text(foot, &label, TextStyle::new(TICK_SIZE, ink()).anchored(Anchor::Middle)));
        }
        for ring in 1..=3 {
            let angle = f64::from(ring) * step;
            let label = format!("{}\u{b0}", digits(self.part.angle_from_axis(angle)));
            // Half way between two rays, within its ring.
            boxed(shapes, at(angle - 0.055 * reach, 285.0), &label);
        }
    }

    fn draw_square_grid(&self, shapes: &mut Vec<Shape>, place: impl Fn([f64; 2]) -> [f64; 2]) {
        let [x, y] = self.reach_deg;
        let pen = |value: f64| Pen::solid(0.8, Colour::grey(if value == 0.0 { 190 } else { 130 }));
        let style = TextStyle::new(TICK_SIZE, ink());
        for tick in linear_ticks(-x, x, 8) {
            let foot = place([tick.value, -y]);
            shapes.push(polyline([foot, place([tick.value, y])], pen(tick.value)));
            let label = format!("{}\u{b0}", tick.label);
            shapes.push(text([foot[0], foot[1] + 17.0], &label, style.anchored(Anchor::Middle)));
        }
        for tick in linear_ticks(-y, y, 9) {
            let left = place([-x, tick.value]);
            shapes.push(polyline([left, place([x, tick.value])], pen(tick.value)));
            let label = format!("{}\u{b0}", tick.label);
            shapes.push(text([left[0] - 8.0, left[1] + 4.0], &label, style.anchored(Anchor::End)));
        }
        let [right, foot] = place([x, -y]);
        shapes.push(text([right + 26.0, foot + 17.0], "H", style));
        let [left, top] = place([-x, y]);
        shapes.push(text([left - 8.0, top - 8.0], "V", style.anchored(Anchor::End)));
    }

    /// A ring around the place of the largest intensity.
    fn mark_maximum(&self, shapes: &mut Vec<Shape>, place: impl Fn([f64; 2]) -> [f64; 2]) {
        let max = self.web.max_intensity();
        let at = if self.is_disc() {
            let angle = self.part.angle_from_axis(max.vertical_deg);
            let c = max.horizontal_deg * (TAU / 360.0);
            [angle * libm::cos(c), angle * libm::sin(c)]
        } else {
            [max.horizontal_deg, max.vertical_deg]
        };
        let inside = libm::hypot(at[0], at[1]) <= self.reach_deg[0].max(self.reach_deg[1]);
        if max.intensity_cd > 0.0 && inside {
            for (width, grey) in [(4.0, 20), (1.6, 255)] {
                let pen = Pen::solid(width, Colour::grey(grey));
                shapes.push(Shape::Arc { centre: place(at), radius: 5.0, angles: [0.0, TAU], pen });
            }
        }
    }
}

/// How far what has a line reaches along an axis of the table: to the stored angle beyond the last bright
/// one.
fn extent(
    web: &Web,
    axis_deg: &[f64],
    max: f64,
    place: impl Fn(usize) -> usize,
    angle: impl Fn(f64) -> Option<f64>,
) -> f64 {
    let bright = (0..web.candela.len()).filter(|&i| web.candela[i] > LEVELS[0] * max).map(place);
    let near = bright.flat_map(|i| axis_deg[i.saturating_sub(1)..axis_deg.len().min(i + 2)].iter());
    near.filter_map(|&stored| angle(stored)).fold(0.0, f64::max)
}

/// The colour of a band: below the first level, between two, above the last.
fn band(index: usize) -> Colour {
    colour(0.04 + 0.92 * index as f64 / LEVELS.len() as f64)
}

fn line_pen(level: f64) -> Pen {
    let grey = Colour::grey(if level > BEAM { 60 } else { 245 });
    match level {
        BEAM => Pen::solid(2.4, grey),
        FIELD => Pen { width_px: 2.2, colour: grey, dash_px: Some([7.0, 5.0]) },
        _ => Pen::solid(0.7, grey),
    }
}

/// Small pale text on dark, centred.
fn boxed(shapes: &mut Vec<Shape>, [x, y]: [f64; 2], label: &str) {
    let width = font::width_px(label, TICK_SIZE, true);
    shapes.push(Shape::Rect { area: [x - 0.5 * width - 3.0, y - 8.0, width + 6.0, 16.0], colour: band(0) });
    let style = TextStyle::new(TICK_SIZE, Colour::grey(235)).anchored(Anchor::Middle);
    shapes.push(text([x, y + 4.0], label, style));
}

/// The bar of colours: shares above it, candela below; where it ends.
fn scale(shapes: &mut Vec<Shape>, y: f64, max: f64) -> f64 {
    let (room, height) = (WIDTH as f64 - 2.0 * MARGIN, 16.0);
    let width = room / (LEVELS.len() + 1) as f64;
    let style = TextStyle::new(TICK_SIZE, ink());
    for i in 0..=LEVELS.len() {
        let x = MARGIN + i as f64 * width;
        // Half a pixel more: no seams between neighbours.
        let area = [x, y, if i < LEVELS.len() { width + 0.5 } else { width }, height];
        shapes.push(Shape::Rect { area, colour: band(i) });
    }
    for (i, level) in LEVELS.iter().enumerate() {
        let x = MARGIN + (i + 1) as f64 * width;
        let pen = match *level {
            BEAM => Pen::solid(2.4, ink()),
            FIELD => Pen { dash_px: Some([4.0, 3.0]), ..Pen::solid(2.2, ink()) },
            _ => Pen::solid(0.8, ink()),
        };
        shapes.push(polyline([[x, y - 4.0], [x, y + height + 4.0]], pen));
        let share = format!("{} %", digits(100.0 * level));
        shapes.push(text([x, y - 9.0], &share, style.anchored(Anchor::Middle)));
        let candela = crate::report::numbers::three_digits(level * max);
        shapes.push(text([x, y + height + 18.0], &candela, style.anchored(Anchor::Middle)));
    }
    shapes.push(text([WIDTH as f64 - MARGIN, y + height + 18.0], "cd", style.anchored(Anchor::End)));
    y + height + 24.0
}

#[cfg(test)]
mod tests;
