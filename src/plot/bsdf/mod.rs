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

use super::disc::{DECADES, Disc, RADIUS, Scale, round_rings};
use super::drawing::{Drawing, Pen, Shape, polyline};
use super::page::{MARGIN, WIDTH, base_name, curve_pen, finished, title};
use slices::{Slice, slices};

/// Largest ratio of the curves' maxima that is drawn with distances in proportion.
const LINEAR_RANGE: f64 = 30.0;

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
        let disc = self.disc();
        let mut shapes = vec![title(&self.title)];
        draw_grid(&mut shapes, &disc);
        let incidences = self.incidences();
        // One colour for each polar angle; azimuths beyond the first are dashed.
        let colour = |theta_i_deg: f64| incidences.iter().position(|i| i.0 == theta_i_deg).unwrap_or(0);
        let pen_of = |(theta_i_deg, phi_i_deg): (f64, Option<f64>)| {
            curve_pen(colour(theta_i_deg), incidences.first().is_some_and(|first| first.1 != phi_i_deg))
        };
        for slice in &self.slices {
            let up = slice.quantity == Quantity::Reflection;
            let points = slice.points.iter().map(|(a, g)| disc.place(up, *a, disc.radius(*g)));
            shapes.push(polyline(points.collect::<Vec<_>>(), pen_of((slice.theta_i_deg, slice.phi_i_deg))));
        }
        for (i, (theta_i_deg, _)) in incidences.iter().enumerate().rev() {
            if colour(*theta_i_deg) == i {
                draw_arrow(&mut shapes, &disc, *theta_i_deg, curve_pen(i, false).colour);
            }
        }
        let foot = disc.centre[1] + if disc.full { RADIUS } else { 0.0 };
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

    fn disc(&self) -> Disc {
        let maxima: Vec<f64> = self.slices.iter().map(Slice::max).filter(|max| *max > 0.0).collect();
        let most = maxima.iter().copied().fold(0.0, f64::max);
        let least = maxima.iter().copied().fold(f64::INFINITY, f64::min);
        // Subnormal intensities have no round numbers.
        let most = if most > f64::MIN_POSITIVE / f64::EPSILON { most } else { 1.0 };
        let full = self.slices.iter().any(|s| s.quantity == Quantity::Transmission);
        let centre = [0.5 * WIDTH as f64, MARGIN + 60.0 + RADIUS];
        let (rings, scale) = if most > LINEAR_RANGE * least {
            let outer = libm::exp10(libm::ceil(libm::log10(most)));
            let ring = |below: f64| outer * libm::exp10(-below);
            let rings = (0..DECADES as i32).rev().map(|i| ring(f64::from(i)));
            (rings.map(|value| (value, digits(value))).collect(), Scale::Logarithmic(outer))
        } else {
            round_rings(most)
        };
        Disc { centre, scale, rings, full }
    }
}

/// An incidence in the legend.
fn name((theta_i_deg, phi_i_deg): (f64, Option<f64>)) -> String {
    let azimuth = phi_i_deg.map_or(String::new(), |phi| format!(", azimuth {}\u{b0}", digits(phi)));
    format!("from {}\u{b0}{azimuth}", digits(theta_i_deg))
}

/// Rings and rays, the surface, and the intensities along it on the side the light comes from, where least is scattered.
fn draw_grid(shapes: &mut Vec<Shape>, disc: &Disc) {
    // The upper half is pi to 2 pi.
    disc.draw_rings(shapes, if disc.full { [0.0, TAU] } else { [PI, TAU] });
    disc.draw_rays(shapes, true, 75);
    if disc.full {
        disc.draw_rays(shapes, false, 75);
    }
    let ends = [-1.0, 1.0].map(|side| [disc.centre[0] + side * RADIUS, disc.centre[1]]);
    shapes.push(polyline(ends, Pen::solid(2.0, Colour::grey(90))));
    shapes.extend([90.0, -90.0].map(|side| disc.angle_label(true, side)));
    disc.draw_ring_labels(shapes, false, 15.0, " cd/lm");
}

/// An arrow along the incident light, just inside the outer ring.
fn draw_arrow(shapes: &mut Vec<Shape>, disc: &Disc, theta_i_deg: f64, colour: Colour) {
    let at = |radius: f64, aside: f64| {
        let [x, y] = disc.place(true, -theta_i_deg, radius);
        let turn = theta_i_deg * (PI / 180.0);
        [x + aside * libm::cos(turn), y - aside * libm::sin(turn)]
    };
    shapes.push(polyline([at(RADIUS - 3.0, 0.0), at(RADIUS - 26.0, 0.0)], Pen::solid(2.2, colour)));
    let corners = vec![at(RADIUS - 36.0, 0.0), at(RADIUS - 25.0, 4.5), at(RADIUS - 25.0, -4.5)];
    shapes.push(Shape::Polygon { corners, colour });
}

#[cfg(test)]
mod tests;
