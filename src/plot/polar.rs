//! The polar candela diagram, as luminaire data sheets draw it.
//!
//! 0 degrees (nadir) points down, 90 degrees to both sides, the distance from the centre is the luminous intensity.
//! A curve shows a plane through the luminaire: positive angles on the right, negative ones, the opposite half plane, on
//! the left; C0-C180 solid, C90-C270 dashed. The upper half is left out when nothing is emitted there.

use std::f64::consts::{PI, TAU};

use super::disc::{Disc, RADIUS, round_rings};
use super::drawing::{Drawing, polyline};
use super::page::{MARGIN, WIDTH, curve_pen, finished, title};

/// Luminous intensity in one plane.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Its name in the legend, such as "C0 - C180".
    pub label: String,
    /// Angle from nadir in degrees, -180 to 180, and luminous intensity in candela. Negative angles are the opposite half
    /// plane. Intensities that are not finite interrupt the curve.
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

impl PolarPlot {
    /// The diagram as shapes.
    pub fn drawing(&self) -> Drawing {
        let disc = self.disc();
        let mut shapes = vec![title(&self.title)];
        // The lower half is 0 to pi.
        disc.draw_rings(&mut shapes, if disc.full { [0.0, TAU] } else { [0.0, PI] });
        disc.draw_rays(&mut shapes, false, if disc.full { 180 } else { 90 });
        // Above the line to the right, where most luminaires emit least.
        disc.draw_ring_labels(&mut shapes, true, -5.0, " cd");
        let place = |&(angle, candela): &(f64, f64)| disc.place(false, angle, disc.radius(candela.max(0.0)));
        let pens = self.curves.iter().enumerate().map(|(i, curve)| curve_pen(i, curve.dashed));
        for (curve, pen) in self.curves.iter().zip(pens.clone()) {
            let runs = curve.points.split(|p| !p.1.is_finite()).filter(|run| !run.is_empty());
            shapes.extend(runs.map(|run| polyline(run.iter().map(place).collect::<Vec<_>>(), pen)));
        }
        let legend = self.curves.iter().map(|curve| curve.label.clone()).zip(pens);
        finished(shapes, disc.centre[1] + RADIUS, legend, &self.footer)
    }

    fn disc(&self) -> Disc {
        let finite = || self.curves.iter().flat_map(|c| &c.points).filter(|p| p.1.is_finite());
        let full = finite().any(|p| p.0.abs() > 90.0 && p.1 > 0.0);
        let (rings, scale) = round_rings(finite().map(|p| p.1).fold(0.0, f64::max));
        let above = if full { RADIUS + 30.0 } else { 28.0 };
        Disc { centre: [0.5 * WIDTH as f64, MARGIN + 30.0 + above], scale, rings, full }
    }
}

#[cfg(test)]
mod tests;
