//! The polar candela diagram, as luminaire data sheets draw it.
//!
//! 0 degrees (nadir) points down, 90 degrees to both sides, the distance from the centre is the luminous intensity.
//! A curve shows a plane through the luminaire: positive angles on the right, negative ones, the opposite half plane, on
//! the left; C0-C180 solid, C90-C270 dashed. The upper half is left out when nothing is emitted there.

use std::f64::consts::{PI, TAU};

use super::canvas::{Anchor, TextStyle};
use super::drawing::{Drawing, Shape, ink, polyline, text};
use super::font;
use super::page::{
    MARGIN, RADIUS, RAY_STEP_DEG, TICK_SIZE, WIDTH, curve_pen, draw_ring_label, draw_title, finished,
    grid_pens, round_rings,
};

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

/// The measures of one diagram.
struct Frame {
    centre: [f64; 2],
    /// Whether directions above the horizontal are shown.
    full: bool,
    /// Intensity at the outer ring, candela.
    outer_cd: f64,
    /// Intensity and label of each ring, from the inside.
    rings: Vec<(f64, String)>,
}

impl PolarPlot {
    /// The diagram as shapes.
    pub fn drawing(&self) -> Drawing {
        let frame = self.frame();
        let mut shapes = Vec::new();
        draw_title(&mut shapes, &self.title);
        draw_grid(&mut shapes, &frame);
        let pens = self.curves.iter().enumerate().map(|(i, curve)| curve_pen(i, curve.dashed));
        for (curve, pen) in self.curves.iter().zip(pens.clone()) {
            shapes.extend(chains(curve, &frame).into_iter().map(|points| polyline(points, pen)));
        }
        let legend = self.curves.iter().map(|curve| curve.label.clone()).zip(pens);
        finished(shapes, frame.centre[1] + RADIUS, legend, &self.footer)
    }

    fn frame(&self) -> Frame {
        let finite =
            || self.curves.iter().flat_map(|c| &c.points).filter(|p| p.0.is_finite() && p.1.is_finite());
        let full = finite().any(|p| p.0.abs() > 90.0 && p.1 > 0.0);
        let (rings, outer_cd) = round_rings(finite().map(|p| p.1).fold(0.0, f64::max));
        let above = if full { RADIUS + 30.0 } else { 28.0 };
        Frame { centre: [0.5 * WIDTH as f64, MARGIN + 30.0 + above], full, outer_cd, rings }
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
    let [fine, strong] = grid_pens();
    // Clockwise on the screen from +x: the lower half is 0 to pi.
    let angles = if frame.full { [0.0, TAU] } else { [0.0, PI] };
    for (value, _) in &frame.rings {
        let radius = value / frame.outer_cd * RADIUS;
        let pen = if *value == frame.outer_cd { strong } else { fine };
        shapes.push(Shape::Arc { centre: frame.centre, radius, angles, pen });
    }
    let last = if frame.full { 180 } else { 90 };
    for angle in (0..=last).step_by(RAY_STEP_DEG) {
        let pen = if angle % 90 == 0 { strong } else { fine };
        for side in [1.0, -1.0] {
            if side > 0.0 || angle % 180 != 0 {
                // Fine rays would fill the centre.
                let start = if angle % 30 == 0 { 0.0 } else { 0.2 * frame.outer_cd };
                let ends = [start, frame.outer_cd].map(|candela| frame.place(side * angle as f64, candela));
                shapes.push(polyline(ends, pen));
                shapes.push(angle_label(frame.centre, side, angle));
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
    let mut free_until = f64::INFINITY;
    for (i, (value, label)) in frame.rings.iter().enumerate().rev() {
        let unit = if i + 1 == frame.rings.len() { " cd" } else { "" };
        let label = format!("{label}{unit}");
        let width = font::width_px(&label, TICK_SIZE, true);
        let x = frame.centre[0] + value / frame.outer_cd * RADIUS - 4.0;
        // Long numbers on narrow rings: the outer one says more.
        if x > free_until || x - width < frame.centre[0] {
            continue;
        }
        free_until = x - width - 10.0;
        draw_ring_label(shapes, [x, frame.centre[1] - 5.0], &label, Anchor::End, frame.full);
    }
}

#[cfg(test)]
mod tests;
