//! The polar diagram of a scattering table: what a surface does with light from a few directions, in the plane of
//! incidence.
//!
//! The surface is the horizontal line, the light comes from the left half above it (arrows in the colours of the curves),
//! reflected light goes up, transmitted light down, and what goes on forwards goes to the right. The distance from the
//! centre is the intensity of the scattered light, f cos(theta_o), in candela for each lumen that arrives: a perfect diffuser
//! draws a circle. Tables of more than [`LINEAR_RANGE`] between their weakest and strongest curve get a logarithmic
//! distance.

mod slices;

use std::f64::consts::{PI, TAU};

use crate::report::bsdf::{BsdfSummary, EnergySummary};
use crate::report::colour::Colour;
use crate::report::numbers::{digits, rounded};
use crate::scattering::{LobeSide, Quantity, ScatterTable};

use super::canvas::{Anchor, TextStyle};
use super::drawing::{Drawing, Pen, Shape, ink, polyline, text};
use super::font;
use super::page::{
    MARGIN, RADIUS, RAY_STEP_DEG, TICK_SIZE, WIDTH, base_name, curve_pen, draw_ring_label, draw_title,
    finished, grid_pens, round_rings,
};
use slices::{Slice, slices};

/// Largest ratio of the curves' maxima that is drawn with distances in proportion.
const LINEAR_RANGE: f64 = 30.0;

/// Decades of a logarithmic diagram.
const DECADES: f64 = 5.0;

/// The diagram of a table.
pub fn drawing(table: &ScatterTable, summary: &BsdfSummary) -> Drawing {
    // A table without a name of its own is called by its path.
    let title = if summary.name == summary.file { base_name(&summary.file) } else { summary.name.clone() };
    let most = |energy: &EnergySummary| {
        let (albedo, theta) = (rounded(energy.max_albedo, 4), rounded(energy.theta_i_deg, 4));
        format!("largest albedo {albedo} at {theta}\u{b0}")
    };
    BsdfPlot::new(table, &title, summary.energy.first().map(most)).drawing()
}

/// What is shown.
#[derive(Debug, Clone, PartialEq)]
struct BsdfPlot {
    /// Headline.
    title: String,
    /// The curves; those of one incidence next to each other.
    slices: Vec<Slice>,
    /// Lines of text below.
    footer: Vec<String>,
}

/// How a distance stands for an intensity.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Scale {
    /// In proportion, up to this intensity.
    Linear(f64),
    /// By its logarithm, over [`DECADES`] up to this intensity.
    Logarithmic(f64),
}

/// The measures of one diagram.
struct Page {
    centre: [f64; 2],
    scale: Scale,
    /// Intensity and label of each ring, from the inside.
    rings: Vec<(f64, String)>,
    /// Whether there is transmitted light.
    full: bool,
}

impl BsdfPlot {
    /// The diagram of a table for light from the front (from the back, where it has nothing for the front).
    fn new(table: &ScatterTable, title: &str, below: Option<String>) -> Self {
        let front = table.lobes.iter().any(|lobe| lobe.side != LobeSide::Back);
        let lobes = [Quantity::Reflection, Quantity::Transmission]
            .into_iter()
            .filter_map(|quantity| table.lobe(quantity, front));
        let slices: Vec<Slice> = lobes.flat_map(slices).collect();
        let side = if front { "front" } else { "back" };
        let shown = format!("light from the {side}, plane of incidence; f cos(theta) in cd for a lumen");
        Self { title: title.into(), slices, footer: [shown].into_iter().chain(below).collect() }
    }

    /// The diagram as shapes.
    fn drawing(&self) -> Drawing {
        let page = self.page();
        let mut shapes = Vec::new();
        draw_title(&mut shapes, &self.title);
        page.draw_grid(&mut shapes);
        let incidences = self.incidences();
        // One colour for each polar angle; azimuths beyond the first are dashed.
        let colour = |theta_i_deg: f64| incidences.iter().position(|i| i.0 == theta_i_deg).unwrap_or(0);
        let pen_of = |(theta_i_deg, phi_i_deg): (f64, Option<f64>)| {
            curve_pen(colour(theta_i_deg), incidences.first().is_some_and(|first| first.1 != phi_i_deg))
        };
        for slice in &self.slices {
            let points = slice.points.iter().map(|(a, g)| page.place(slice.quantity, *a, page.radius(*g)));
            shapes.push(polyline(points.collect::<Vec<_>>(), pen_of((slice.theta_i_deg, slice.phi_i_deg))));
        }
        for (i, (theta_i_deg, _)) in incidences.iter().enumerate().rev() {
            if colour(*theta_i_deg) == i {
                page.draw_arrow(&mut shapes, *theta_i_deg, curve_pen(i, false).colour);
            }
        }
        let foot = page.centre[1] + if page.full { RADIUS } else { 0.0 };
        let legend = incidences.iter().map(|incidence| (name(*incidence), pen_of(*incidence)));
        finished(shapes, foot, legend, &self.footer)
    }

    /// Directions of incidence in the order of the curves, each once.
    fn incidences(&self) -> Vec<(f64, Option<f64>)> {
        let mut incidences: Vec<(f64, Option<f64>)> = Vec::new();
        for slice in &self.slices {
            let incidence = (slice.theta_i_deg, slice.phi_i_deg);
            if !incidences.contains(&incidence) {
                incidences.push(incidence);
            }
        }
        incidences
    }

    fn page(&self) -> Page {
        let maxima: Vec<f64> = self.slices.iter().map(Slice::max).filter(|max| *max > 0.0).collect();
        let most = maxima.iter().copied().fold(0.0, f64::max);
        let least = maxima.iter().copied().fold(f64::INFINITY, f64::min);
        // Subnormal intensities have no round numbers.
        let most = if most > f64::MIN_POSITIVE / f64::EPSILON { most } else { 1.0 };
        let full = self.slices.iter().any(|s| s.quantity == Quantity::Transmission);
        let centre = [0.5 * WIDTH as f64, MARGIN + 60.0 + RADIUS];
        if most > LINEAR_RANGE * least {
            let outer = libm::exp10(libm::ceil(libm::log10(most)));
            let ring = |below: f64| outer * libm::exp10(-below);
            let rings = (0..DECADES as i32).rev().map(|i| ring(f64::from(i)));
            let rings = rings.map(|value| (value, digits(value))).collect();
            return Page { centre, scale: Scale::Logarithmic(outer), rings, full };
        }
        let (rings, outer) = round_rings(most);
        Page { centre, scale: Scale::Linear(outer), rings, full }
    }
}

/// An incidence in the legend.
fn name((theta_i_deg, phi_i_deg): (f64, Option<f64>)) -> String {
    let azimuth = phi_i_deg.map_or(String::new(), |phi| format!(", azimuth {}\u{b0}", digits(phi)));
    format!("from {}\u{b0}{azimuth}", digits(theta_i_deg))
}

impl Page {
    /// Distance from the centre, pixels.
    fn radius(&self, candela: f64) -> f64 {
        match self.scale {
            Scale::Linear(outer) => RADIUS * candela / outer,
            Scale::Logarithmic(outer) => {
                RADIUS * (1.0 + libm::log10(candela / outer) / DECADES).clamp(0.0, 1.0)
            }
        }
    }

    /// A point at an angle from the normal of the side light leaves on, forwards to the right.
    fn place(&self, quantity: Quantity, angle_deg: f64, radius: f64) -> [f64; 2] {
        let angle = angle_deg * (PI / 180.0);
        let up = if quantity == Quantity::Reflection { -1.0 } else { 1.0 };
        [self.centre[0] + radius * libm::sin(angle), self.centre[1] + up * radius * libm::cos(angle)]
    }

    fn draw_grid(&self, shapes: &mut Vec<Shape>) {
        let [fine, strong] = grid_pens();
        // Clockwise on the screen from +x: the upper half is pi to 2 pi.
        let angles = if self.full { [0.0, TAU] } else { [PI, TAU] };
        for (i, (value, _)) in self.rings.iter().enumerate() {
            let pen = if i + 1 == self.rings.len() { strong } else { fine };
            shapes.push(Shape::Arc { centre: self.centre, radius: self.radius(*value), angles, pen });
        }
        let halves: &[Quantity] =
            if self.full { &[Quantity::Reflection, Quantity::Transmission] } else { &[Quantity::Reflection] };
        for quantity in halves {
            for angle in (0..90).step_by(RAY_STEP_DEG) {
                for side in [1.0, -1.0] {
                    let pen = if angle == 0 { strong } else { fine };
                    if side > 0.0 || angle > 0 {
                        self.draw_ray(shapes, *quantity, side * angle as f64, pen);
                    }
                }
            }
        }
        let ends = [-1.0, 1.0].map(|side| [self.centre[0] + side * RADIUS, self.centre[1]]);
        shapes.push(polyline(ends, Pen::solid(2.0, Colour::grey(90))));
        for side in [90.0, -90.0] {
            shapes.push(self.angle_label(Quantity::Reflection, side));
        }
        self.draw_ring_labels(shapes);
    }

    fn draw_ray(&self, shapes: &mut Vec<Shape>, quantity: Quantity, angle_deg: f64, pen: Pen) {
        // Fine rays would fill the centre.
        let start = if angle_deg % 30.0 == 0.0 { 0.0 } else { 0.2 * RADIUS };
        let ends = [start, RADIUS].map(|r| self.place(quantity, angle_deg, r));
        shapes.push(polyline(ends, pen));
        shapes.push(self.angle_label(quantity, angle_deg));
    }

    /// The angle beyond the outer ring, set so that it stands off it equally everywhere.
    fn angle_label(&self, quantity: Quantity, angle_deg: f64) -> Shape {
        let label = format!("{}\u{b0}", angle_deg.abs());
        let half = 0.5 * font::width_px(&label, TICK_SIZE, true);
        let [x, _] = self.place(quantity, angle_deg, RADIUS + 9.0 + half);
        let [_, y] = self.place(quantity, angle_deg, RADIUS + 14.0);
        text([x, y + 4.0], &label, TextStyle::new(TICK_SIZE, ink()).anchored(Anchor::Middle))
    }

    /// Intensities along the surface on the side the light comes from, where least is scattered.
    fn draw_ring_labels(&self, shapes: &mut Vec<Shape>) {
        let mut free_from = f64::NEG_INFINITY;
        for (i, (value, label)) in self.rings.iter().enumerate().rev() {
            let unit = if i + 1 == self.rings.len() { " cd/lm" } else { "" };
            let label = format!("{label}{unit}");
            let width = font::width_px(&label, TICK_SIZE, true);
            let x = self.centre[0] - self.radius(*value) + 4.0;
            if x < free_from || x + width > self.centre[0] {
                continue;
            }
            free_from = x + width + 10.0;
            draw_ring_label(shapes, [x, self.centre[1] + 15.0], &label, Anchor::Start, self.full);
        }
    }

    /// An arrow along the incident light, just inside the outer ring.
    fn draw_arrow(&self, shapes: &mut Vec<Shape>, theta_i_deg: f64, colour: Colour) {
        let at = |radius: f64, aside: f64| {
            let [x, y] = self.place(Quantity::Reflection, -theta_i_deg, radius);
            let turn = theta_i_deg * (PI / 180.0);
            [x + aside * libm::cos(turn), y - aside * libm::sin(turn)]
        };
        shapes.push(polyline([at(RADIUS - 3.0, 0.0), at(RADIUS - 26.0, 0.0)], Pen::solid(2.2, colour)));
        let corners = vec![at(RADIUS - 36.0, 0.0), at(RADIUS - 25.0, 4.5), at(RADIUS - 25.0, -4.5)];
        shapes.push(Shape::Polygon { corners, colour });
    }
}

#[cfg(test)]
mod tests;
