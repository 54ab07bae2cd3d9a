//! The polar candela diagram, as luminaire data sheets draw it.
//!
//! 0 degrees (nadir) points down, 90 degrees to both sides, the distance from the centre is the luminous intensity.
//! A curve shows a plane through the luminaire: positive angles on the right, negative ones, the opposite half plane, on
//! the left; C0-C180 solid, C90-C270 dashed. The upper half is left out when nothing is emitted there.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use crate::error::Result;
use crate::plot::canvas::{Anchor, Colour, TextStyle};
use crate::plot::drawing::{Drawing, Pen, Shape};
use crate::plot::font;
use crate::plot::scale::{Tick, linear_ticks};

/// Luminous intensity in one plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in the legend, such as "C0 - C180".
    pub label: String,
    /// Angle from nadir in degrees, -180 to 180, and luminous intensity in candela; linear between the points. Negative
    /// angles are the opposite half plane. Points that are not finite interrupt the curve.
    pub points: Vec<(f64, f64)>,
    /// Dashed instead of solid.
    pub dashed: bool,
}

/// What is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct PolarPlot {
    /// Headline: the luminaire's name.
    pub title: String,
    /// The planes, at most four different colours.
    pub curves: Vec<Curve>,
    /// Lines of text below: flux, maximum, beam angle.
    pub footer: Vec<String>,
}

pub(super) const WIDTH: usize = 640;
pub(super) const RADIUS: f64 = 236.0;
pub(super) const MARGIN: f64 = 24.0;
pub(super) const TITLE_SIZE: f64 = 18.0;
pub(super) const TEXT_SIZE: f64 = 13.0;
pub(super) const TICK_SIZE: f64 = 12.0;
pub(super) const LINE_HEIGHT: f64 = 20.0;
pub(super) const RAY_STEP_DEG: usize = 15;
/// Most rings there are.
pub(super) const RINGS: usize = 7;

/// The measures of one diagram.
struct Frame {
    centre: [f64; 2],
    /// Whether directions above the horizontal are shown.
    full: bool,
    /// Intensity at the outer ring, candela.
    outer_cd: f64,
    rings: Vec<Tick>,
}

/// Width between the margins.
const ROOM: f64 = WIDTH as f64 - 2.0 * MARGIN;

/// The title of a polar diagram.
pub(super) fn draw_title(shapes: &mut Vec<Shape>, title: &str) {
    let style = TextStyle::new(fitting(title, TITLE_SIZE, ROOM), Colour::grey(20)).weighing(1.25);
    shapes.push(text([MARGIN, MARGIN + 16.0], title, style));
}

/// The lines under a polar diagram, from y down.
pub(super) fn draw_footer(shapes: &mut Vec<Shape>, y: &mut f64, lines: &[String]) {
    for line in lines {
        let style = TextStyle::new(TEXT_SIZE, ink());
        shapes.push(text([MARGIN, *y], line, TextStyle { size_px: fitting(line, TEXT_SIZE, ROOM), ..style }));
        *y += LINE_HEIGHT;
    }
}

impl PolarPlot {
    /// The diagram as an SVG document.
    pub fn to_svg(&self) -> String {
        self.drawing().to_svg()
    }

    /// The diagram as a PNG file.
    ///
    /// # Errors
    /// [`crate::error::Kind::Io`] with the path.
    pub fn to_png(&self, path: impl AsRef<Path>) -> Result<()> {
        self.drawing().to_canvas().write_png(path)
    }

    /// The diagram as shapes; both files are renderings of it.
    pub fn drawing(&self) -> Drawing {
        let frame = self.frame();
        let mut shapes = Vec::new();
        draw_title(&mut shapes, &self.title);
        draw_grid(&mut shapes, &frame);
        for (i, curve) in self.curves.iter().enumerate() {
            for points in chains(curve, &frame) {
                shapes.push(Shape::Polyline { points, pen: curve_pen(i, curve.dashed) });
            }
        }
        let mut y = frame.centre[1] + RADIUS + 52.0;
        self.draw_legend(&mut shapes, &mut y);
        draw_footer(&mut shapes, &mut y, &self.footer);
        Drawing { width: WIDTH, height: (y + MARGIN - LINE_HEIGHT + 4.0) as usize, shapes }
    }

    fn frame(&self) -> Frame {
        let finite =
            || self.curves.iter().flat_map(|c| &c.points).filter(|p| p.0.is_finite() && p.1.is_finite());
        let max = finite().map(|p| p.1).fold(0.0, f64::max);
        let full = finite().any(|p| p.0.abs() > 90.0 && p.1 > 0.0);
        // Subnormal candela have no round numbers.
        let max = if max > f64::MIN_POSITIVE / f64::EPSILON { max } else { 1.0 };
        let step = linear_ticks(0.0, max, RINGS).get(1).map_or(max, |tick| tick.value);
        let rings: Vec<Tick> = linear_ticks(0.0, (max / step).ceil() * step, RINGS).split_off(1);
        let outer_cd = rings.last().map_or(max, |tick| tick.value).max(max);
        let above = if full { RADIUS + 30.0 } else { 28.0 };
        Frame { centre: [0.5 * WIDTH as f64, MARGIN + 30.0 + above], full, outer_cd, rings }
    }

    /// A line of each curve's kind and its name, as many in a row as fit.
    fn draw_legend(&self, shapes: &mut Vec<Shape>, y: &mut f64) {
        let style = TextStyle::new(TEXT_SIZE, ink());
        let sample = 34.0;
        let mut x = MARGIN;
        for (i, curve) in self.curves.iter().enumerate() {
            let width = sample + 8.0 + font::width_px(&curve.label, TEXT_SIZE, true);
            if x > MARGIN && x + width > WIDTH as f64 - MARGIN {
                x = MARGIN;
                *y += LINE_HEIGHT;
            }
            let line = vec![[x, *y - 4.5], [x + sample, *y - 4.5]];
            shapes.push(Shape::Polyline { points: line, pen: curve_pen(i, curve.dashed) });
            shapes.push(text([x + sample + 8.0, *y], &curve.label, style));
            x += width + 28.0;
        }
        if !self.curves.is_empty() {
            *y += LINE_HEIGHT + 4.0;
        }
    }
}

impl Frame {
    /// Where a direction and an intensity lie; positive angles to the right of nadir.
    fn place(&self, angle_deg: f64, candela: f64) -> [f64; 2] {
        let r = candela.max(0.0) / self.outer_cd * RADIUS;
        let angle = angle_deg * (PI / 180.0);
        [self.centre[0] + r * libm::sin(angle), self.centre[1] + r * libm::cos(angle)]
    }
}

/// The curve in pixels, interrupted where it has no value.
fn chains(curve: &Curve, frame: &Frame) -> Vec<Vec<[f64; 2]>> {
    let finite = |p: &(f64, f64)| p.0.is_finite() && p.1.is_finite();
    curve
        .points
        .split(|p| !finite(p))
        .filter(|run| !run.is_empty())
        .map(|run| {
            let mut chain = vec![frame.place(run[0].0, run[0].1)];
            for pair in run.windows(2) {
                let ((a, cd_a), (b, cd_b)) = (pair[0], pair[1]);
                // Linear in angle is curved on paper: a point a degree.
                let steps = (b - a).abs().ceil().clamp(1.0, 360.0);
                chain.extend((1..=steps as usize).map(|i| {
                    let share = i as f64 / steps;
                    frame.place(a + share * (b - a), cd_a + share * (cd_b - cd_a))
                }));
            }
            chain
        })
        .collect()
}

fn draw_grid(shapes: &mut Vec<Shape>, frame: &Frame) {
    let [cx, cy] = frame.centre;
    let fine = Pen { width_px: 1.0, colour: Colour::grey(216), dash_px: None };
    let strong = Pen { colour: Colour::grey(140), ..fine };
    // Clockwise on the screen from +x: the lower half is 0 to pi.
    let angles = if frame.full { [0.0, TAU] } else { [0.0, PI] };
    for ring in &frame.rings {
        let radius = ring.value / frame.outer_cd * RADIUS;
        let pen = if ring.value == frame.outer_cd { strong } else { fine };
        shapes.push(Shape::Arc { centre: frame.centre, radius, angles, pen });
    }
    let last = if frame.full { 180 } else { 90 };
    for angle in (0..=last).step_by(RAY_STEP_DEG) {
        let pen = if angle % 90 == 0 { strong } else { fine };
        for side in [1.0, -1.0] {
            if side > 0.0 || angle % 180 != 0 {
                let end = frame.place(side * angle as f64, frame.outer_cd);
                // Fine rays would fill the centre.
                let start = if angle % 30 == 0 { 0.0 } else { 0.2 * frame.outer_cd };
                shapes.push(Shape::Polyline {
                    points: vec![frame.place(side * angle as f64, start), end],
                    pen,
                });
                shapes.push(angle_label([cx, cy], side, angle));
            }
        }
    }
    draw_ring_labels(shapes, frame);
}

/// The angle beyond the outer ring, set so that it stands off it equally everywhere.
fn angle_label([cx, cy]: [f64; 2], side: f64, angle_deg: usize) -> Shape {
    let angle = angle_deg as f64 * (PI / 180.0);
    let (sin, cos) = (side * libm::sin(angle), libm::cos(angle));
    let label = format!("{angle_deg}°");
    let half = 0.5 * font::width_px(&label, TICK_SIZE, true);
    let reach = RADIUS + 9.0;
    let at = [cx + sin * (reach + half), cy + cos * (reach + 5.0) + 4.0];
    text(at, &label, TextStyle::new(TICK_SIZE, ink()).anchored(Anchor::Middle))
}

/// Candela along the horizontal to the right, where most luminaires emit least; above the line, inside their ring.
fn draw_ring_labels(shapes: &mut Vec<Shape>, frame: &Frame) {
    let style = TextStyle::new(TICK_SIZE, Colour::grey(90)).anchored(Anchor::End);
    let baseline = frame.centre[1] - 5.0;
    let mut free_until = f64::INFINITY;
    for (i, ring) in frame.rings.iter().enumerate().rev() {
        let unit = if i + 1 == frame.rings.len() { " cd" } else { "" };
        let label = format!("{}{unit}", ring.label);
        let width = font::width_px(&label, TICK_SIZE, true);
        let x = frame.centre[0] + ring.value / frame.outer_cd * RADIUS - 4.0;
        // Long numbers on narrow rings: the outer one says more.
        if x > free_until || x - width < frame.centre[0] {
            continue;
        }
        free_until = x - width - 10.0;
        if frame.full {
            let area = [x - width - 1.0, baseline - 10.0, width + 2.0, 12.0];
            shapes.push(Shape::Rect { area, colour: Colour::WHITE });
        }
        shapes.push(text([x, baseline], &label, style));
    }
}

pub(super) fn curve_pen(index: usize, dashed: bool) -> Pen {
    let colours = [(0x14, 0x5d, 0xa8), (0xd2, 0x3b, 0x2a), (0x2e, 0x8b, 0x57), (0x8a, 0x4f, 0xa3)];
    let (r, g, b) = colours[index % colours.len()];
    Pen { width_px: 2.2, colour: Colour::srgb(r, g, b), dash_px: dashed.then_some([8.0, 5.5]) }
}

pub(super) fn text(at: [f64; 2], text: &str, style: TextStyle) -> Shape {
    Shape::Text { at, text: text.to_owned(), style }
}

/// The wanted type size, or the smaller one at which the text fits, not below 8.
pub(super) fn fitting(text: &str, size_px: f64, room_px: f64) -> f64 {
    let width = font::width_px(text, size_px, true);
    if width > room_px { (size_px * room_px / width).floor().max(8.0) } else { size_px }
}

pub(super) fn ink() -> Colour {
    Colour::grey(50)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn plot(points: Vec<(f64, f64)>) -> PolarPlot {
        let curve = Curve { label: "C0 - C180".into(), points, dashed: false };
        PolarPlot { title: "t".into(), curves: vec![curve], footer: vec![] }
    }

    /// The points of the first curve: the only line wider than 2 px outside the legend.
    fn first_curve(plot: &PolarPlot) -> Vec<[f64; 2]> {
        let wide = |shape: &Shape| match shape {
            Shape::Polyline { points, pen } if pen.width_px > 2.0 => Some(points.clone()),
            _ => None,
        };
        plot.drawing().shapes.iter().find_map(wide).unwrap_or_default()
    }

    #[test]
    fn directions_and_lengths_follow_the_convention() {
        let plot = plot(vec![(-90.0, 250.0), (0.0, 1000.0), (90.0, 500.0)]);
        let frame = plot.frame();
        assert!(!frame.full);
        assert_eq!(frame.outer_cd, 1000.0);
        let curve = first_curve(&plot);
        let [cx, cy] = frame.centre;
        let close = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() < 1e-9 && (p[1] - q[1]).abs() < 1e-9;
        assert!(close(curve[0], [cx - 0.25 * RADIUS, cy]));
        assert!(close(curve[90], [cx, cy + RADIUS]), "nadir is down");
        assert!(close(curve[180], [cx + 0.5 * RADIUS, cy]), "positive angles are right");
        // Half way in angle is half way in candela: 750 cd at 45 degrees.
        let half = 0.75 * RADIUS * 0.5_f64.sqrt();
        assert!(close(curve[135], [cx + half, cy + half]));
    }

    #[test]
    fn a_lambertian_source_draws_a_circle() {
        let plot =
            plot((-90..=90).map(|a| (f64::from(a), 500.0 * f64::from(a).to_radians().cos())).collect());
        let frame = plot.frame();
        let middle = [frame.centre[0], frame.centre[1] + 0.5 * RADIUS];
        for p in first_curve(&plot) {
            let r = ((p[0] - middle[0]).powi(2) + (p[1] - middle[1]).powi(2)).sqrt();
            assert!((r - 0.5 * RADIUS).abs() < 1e-9, "{r}");
        }
    }

    #[test]
    fn rings_are_round_and_reach_the_maximum() {
        for (max, top) in [
            (1000.0, 1000.0),
            (1001.0, 1200.0),
            (87.0, 100.0),
            (0.013, 0.014),
            (5.3e6, 6e6),
            (1401.0, 1500.0),
        ] {
            let frame = plot(vec![(0.0, max)]).frame();
            assert_eq!(frame.outer_cd, top, "for {max}");
            assert!((3..=8).contains(&frame.rings.len()), "{:?}", frame.rings);
        }
    }

    #[test]
    fn the_upper_half_is_there_only_when_lit() {
        assert!(!plot(vec![(0.0, 5.0), (90.0, 1.0), (180.0, 0.0)]).frame().full);
        assert!(plot(vec![(0.0, 5.0), (-120.0, 1e-3)]).frame().full);
        let (half, full) = (plot(vec![(0.0, 5.0)]).drawing(), plot(vec![(180.0, 5.0)]).drawing());
        assert!(half.height + 200 < full.height);
        assert!(full.to_svg().contains(">180°<") && !half.to_svg().contains(">105°<"));
    }

    #[test]
    fn nothing_breaks_on_empty_zero_or_broken_curves() {
        for points in [
            vec![],
            vec![(0.0, 0.0)],
            vec![(f64::NAN, 1.0), (0.0, f64::INFINITY)],
            vec![(0.0, -5.0), (10.0, -1.0)],
            vec![(0.0, 5e-324), (1.0, 1e300)],
            vec![(-1e9, 1.0), (1e9, 2.0)],
        ] {
            let drawing = plot(points).drawing();
            assert!(!drawing.to_svg().contains("NaN") && !drawing.to_svg().contains("inf"));
            drawing.to_canvas();
        }
        let nothing = PolarPlot { title: String::new(), curves: vec![], footer: vec![] };
        assert!(nothing.to_svg().ends_with("</svg>\n"));
    }

    #[test]
    fn no_shape_leaves_the_page() {
        let mut plot = plot(vec![(180.0, 5.0), (0.0, 700.0)]);
        plot.footer = vec!["Luminous flux 1234 lm".into(); 3];
        let drawing = plot.drawing();
        for shape in &drawing.shapes {
            if let Shape::Text { at, text, style } = shape {
                let width = font::width_px(text, style.size_px, true);
                let start = match style.anchor {
                    Anchor::Start => at[0],
                    Anchor::Middle => at[0] - 0.5 * width,
                    Anchor::End => at[0] - width,
                };
                assert!(start >= 4.0 && start + width <= WIDTH as f64 - 4.0, "{text}");
                assert!(at[1] >= 12.0 && at[1] <= drawing.height as f64 - 6.0, "{text} at {}", at[1]);
            }
        }
    }
}
