//! The polar diagram of a scattering table: what a surface does with light from a few directions, in the plane of
//! incidence.
//!
//! The surface is the horizontal line, the light comes from the left half above it (arrows in the colours of the curves),
//! reflected light goes up, transmitted light down, and what goes on forwards goes to the right. The distance from the
//! centre is the intensity of the scattered light, f cos(theta_o), in candela for each lumen that arrives: a perfect diffuser
//! draws a circle. Tables of more than [`LINEAR_RANGE`] between their weakest and strongest curve get a logarithmic
//! distance.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use glam::DVec3;

use crate::error::Result;
use crate::plot::canvas::{Anchor, Colour, TextStyle};
use crate::plot::drawing::{Drawing, Pen, Shape};
use crate::plot::font;
use crate::plot::scale::linear_ticks;
use crate::scattering::value::value;
use crate::scattering::{Frame, Lobe, LobeSide, Quantity, ScatterTable};
use crate::units::LUMINANCE_OF_RGB;

use super::polar::{
    LINE_HEIGHT, MARGIN, RADIUS, RAY_STEP_DEG, RINGS, TEXT_SIZE, TICK_SIZE, WIDTH, curve_pen, draw_footer,
    draw_title, ink, text,
};
use super::text::digits;

/// Largest ratio of the curves' maxima that is drawn with distances in proportion.
pub const LINEAR_RANGE: f64 = 30.0;

/// Decades of a logarithmic diagram.
const DECADES: f64 = 5.0;

/// Incidences that are looked for, degrees; the table's nearest are drawn.
const WANTED_DEG: [f64; 4] = [0.0, 30.0, 60.0, 80.0];

/// Step of a curve, degrees; the table's own angles are added.
const STEP_DEG: f64 = 0.5;

/// Scattered intensity in the plane of incidence, for light from one direction.
#[derive(Debug, Clone, PartialEq)]
pub struct Slice {
    /// Incident polar angle, degrees.
    pub theta_i_deg: f64,
    /// Incident azimuth, degrees; `None` where the table is isotropic.
    pub phi_i_deg: Option<f64>,
    /// Which way the light goes.
    pub quantity: Quantity,
    /// (angle from the normal of the side light leaves on, degrees, positive forwards; candela per lumen).
    pub points: Vec<(f64, f64)>,
}

/// What is shown.
#[derive(Debug, Clone, PartialEq)]
pub struct BsdfPlot {
    /// Headline.
    pub title: String,
    /// The curves; those of one incidence next to each other.
    pub slices: Vec<Slice>,
    /// Lines of text below.
    pub footer: Vec<String>,
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
    pub fn new(table: &ScatterTable, title: &str, mut footer: Vec<String>) -> Self {
        let front = table.lobes.iter().any(|lobe| lobe.side != LobeSide::Back);
        let lobes = [Quantity::Reflection, Quantity::Transmission]
            .into_iter()
            .filter_map(|quantity| table.lobe(quantity, front));
        let slices: Vec<Slice> = lobes.flat_map(slices).collect();
        let side = if front { "front" } else { "back" };
        footer
            .insert(0, format!("light from the {side}, plane of incidence; f cos(theta) in cd for a lumen"));
        Self { title: title.into(), slices, footer }
    }

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
        let page = self.page();
        let mut shapes = Vec::new();
        draw_title(&mut shapes, &self.title);
        page.draw_grid(&mut shapes);
        let incidences = self.incidences();
        let colour_of = |slice: &Slice| incidences.iter().position(|i| i.0 == slice.theta_i_deg).unwrap_or(0);
        for slice in &self.slices {
            let pen = curve_pen(colour_of(slice), is_dashed(slice.phi_i_deg, &incidences));
            let points = slice.points.iter().map(|(a, g)| page.place(slice.quantity, *a, page.radius(*g)));
            shapes.push(Shape::Polyline { points: points.collect(), pen });
        }
        for (i, (theta_i_deg, _)) in incidences.iter().enumerate().rev() {
            if !incidences[..i].iter().any(|other| other.0 == *theta_i_deg) {
                page.draw_arrow(&mut shapes, *theta_i_deg, curve_pen(colour(&incidences, i), false).colour);
            }
        }
        let mut y = page.centre[1] + if page.full { RADIUS } else { 0.0 } + 52.0;
        draw_legend(&mut shapes, &mut y, &incidences);
        draw_footer(&mut shapes, &mut y, &self.footer);
        Drawing { width: WIDTH, height: (y + MARGIN - LINE_HEIGHT + 4.0) as usize, shapes }
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
        let step = linear_ticks(0.0, most, RINGS).get(1).map_or(most, |tick| tick.value);
        let rings = linear_ticks(0.0, (most / step).ceil() * step, RINGS).split_off(1);
        let outer = rings.last().map_or(most, |tick| tick.value).max(most);
        let rings = rings.into_iter().map(|tick| (tick.value, tick.label)).collect();
        Page { centre, scale: Scale::Linear(outer), rings, full }
    }
}

impl Slice {
    fn max(&self) -> f64 {
        self.points.iter().map(|p| p.1).fold(0.0, f64::max)
    }
}

/// The colour of an incidence: one for each polar angle.
fn colour(incidences: &[(f64, Option<f64>)], index: usize) -> usize {
    incidences.iter().position(|i| i.0 == incidences[index].0).unwrap_or(index)
}

/// Azimuths beyond the first are dashed.
fn is_dashed(phi_i_deg: Option<f64>, incidences: &[(f64, Option<f64>)]) -> bool {
    incidences.first().is_some_and(|first| first.1 != phi_i_deg)
}

/// The slices of a lobe that are drawn: at most four incident polar angles, in the first plane of an anisotropic surface
/// and in the one across it.
fn slices(lobe: &Lobe) -> Vec<Slice> {
    let thetas = nearest(&lobe.theta_i_deg, &WANTED_DEG);
    let azimuths: &[f64] = if lobe.is_isotropic() { &[0.0] } else { &[0.0, 90.0] };
    let first = lobe.phi_i_deg[0];
    let phis = nearest(&lobe.phi_i_deg, &azimuths.iter().map(|a| a + first).collect::<Vec<_>>());
    let mut slices = Vec::new();
    for phi in &phis {
        slices.extend(thetas.iter().map(|theta| Slice {
            theta_i_deg: lobe.theta_i_deg[*theta],
            phi_i_deg: (!lobe.is_isotropic()).then(|| lobe.phi_i_deg[*phi]),
            quantity: lobe.quantity,
            points: in_plane(lobe, *phi, *theta),
        }));
    }
    slices
}

/// Indices of the angles nearest to the wanted ones, each once, rising.
fn nearest(angles_deg: &[f64], wanted_deg: &[f64]) -> Vec<usize> {
    let distance = |i: usize, wanted: f64| (angles_deg[i] - wanted).abs();
    let mut chosen: Vec<usize> = wanted_deg
        .iter()
        .filter_map(|w| (0..angles_deg.len()).min_by(|a, b| distance(*a, *w).total_cmp(&distance(*b, *w))))
        .collect();
    chosen.sort_unstable();
    chosen.dedup();
    chosen
}

/// (signed angle, candela per lumen) in the plane of incidence; luminance of colours.
fn in_plane(lobe: &Lobe, phi_i: usize, theta_i: usize) -> Vec<(f64, f64)> {
    let theta_i_deg = lobe.theta_i_deg[theta_i];
    // At normal incidence the table's azimuths are the limit from larger angles.
    let theta = theta_i_deg.to_radians().max(f64::EPSILON);
    let phi = lobe.phi_i_deg[phi_i].to_radians();
    let along = DVec3::new(libm::cos(phi), libm::sin(phi), 0.0);
    // At grazing incidence light still arrives.
    let wi = along * libm::sin(theta) + DVec3::Z * libm::cos(theta).max(f64::MIN_POSITIVE);
    let normal = if lobe.quantity == Quantity::Reflection { DVec3::Z } else { DVec3::NEG_Z };
    // Where the pole of the grid lies in the plane.
    let pole_deg = match lobe.frame {
        Frame::Surface => 0.0,
        Frame::Specular => theta_i_deg,
    };
    let steps = (180.0 / STEP_DEG) as i32;
    let mut angles: Vec<f64> = (0..=steps).map(|i| f64::from(i) * STEP_DEG - 90.0).collect();
    angles
        .extend(lobe.polar_deg.iter().flat_map(|p| [pole_deg + p, pole_deg - p]).filter(|a| a.abs() <= 90.0));
    angles.sort_by(f64::total_cmp);
    angles.dedup();
    let weights: &[f64] = if lobe.channels == 3 { &LUMINANCE_OF_RGB } else { &[1.0] };
    let intensity = |angle_deg: f64| {
        let angle = angle_deg.to_radians();
        let cosine = libm::cos(angle);
        let wo = normal * cosine - along * libm::sin(angle);
        let f = weights.iter().enumerate().map(|(channel, weight)| weight * value(lobe, channel, wi, wo));
        f.sum::<f64>() * cosine
    };
    angles.into_iter().map(|a| (a, intensity(a))).collect()
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
        let fine = Pen { width_px: 1.0, colour: Colour::grey(216), dash_px: None };
        let strong = Pen { colour: Colour::grey(140), ..fine };
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
                    if side > 0.0 || angle > 0 {
                        self.draw_ray(
                            shapes,
                            *quantity,
                            side * angle as f64,
                            if angle == 0 { strong } else { fine },
                        );
                    }
                }
            }
        }
        let surface = Pen { width_px: 2.0, colour: Colour::grey(90), dash_px: None };
        let ends = [-1.0, 1.0].map(|side| [self.centre[0] + side * RADIUS, self.centre[1]]);
        shapes.push(Shape::Polyline { points: ends.to_vec(), pen: surface });
        for side in [90.0, -90.0] {
            shapes.push(self.angle_label(Quantity::Reflection, side));
        }
        self.draw_ring_labels(shapes);
    }

    fn draw_ray(&self, shapes: &mut Vec<Shape>, quantity: Quantity, angle_deg: f64, pen: Pen) {
        // Fine rays would fill the centre.
        let start = if angle_deg % 30.0 == 0.0 { 0.0 } else { 0.2 * RADIUS };
        let ends = [start, RADIUS].map(|r| self.place(quantity, angle_deg, r));
        shapes.push(Shape::Polyline { points: ends.to_vec(), pen });
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
        let style = TextStyle::new(TICK_SIZE, Colour::grey(90));
        let baseline = self.centre[1] + 15.0;
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
            if self.full {
                let area = [x - 1.0, baseline - 10.0, width + 2.0, 12.0];
                shapes.push(Shape::Rect { area, colour: Colour::WHITE });
            }
            shapes.push(text([x, baseline], &label, style));
        }
    }

    /// An arrow along the incident light, just inside the outer ring.
    fn draw_arrow(&self, shapes: &mut Vec<Shape>, theta_i_deg: f64, colour: Colour) {
        let at = |radius: f64, aside: f64| {
            let [x, y] = self.place(Quantity::Reflection, -theta_i_deg, radius);
            let turn = theta_i_deg * (PI / 180.0);
            [x + aside * libm::cos(turn), y - aside * libm::sin(turn)]
        };
        let pen = Pen { width_px: 2.2, colour, dash_px: None };
        shapes.push(Shape::Polyline { points: vec![at(RADIUS - 3.0, 0.0), at(RADIUS - 26.0, 0.0)], pen });
        let corners = vec![at(RADIUS - 36.0, 0.0), at(RADIUS - 25.0, 4.5), at(RADIUS - 25.0, -4.5)];
        shapes.push(Shape::Polygon { corners, colour });
    }
}

/// A line of each curve's kind and its incidence, as many in a row as fit.
fn draw_legend(shapes: &mut Vec<Shape>, y: &mut f64, incidences: &[(f64, Option<f64>)]) {
    let style = TextStyle::new(TEXT_SIZE, ink());
    let sample = 34.0;
    let mut x = MARGIN;
    for (i, (theta_i_deg, phi_i_deg)) in incidences.iter().enumerate() {
        let azimuth = phi_i_deg.map_or(String::new(), |phi| format!(", azimuth {}\u{b0}", digits(phi)));
        let label = format!("from {}\u{b0}{azimuth}", digits(*theta_i_deg));
        let width = sample + 8.0 + font::width_px(&label, TEXT_SIZE, true);
        if x > MARGIN && x + width > WIDTH as f64 - MARGIN {
            x = MARGIN;
            *y += LINE_HEIGHT;
        }
        let line = vec![[x, *y - 4.5], [x + sample, *y - 4.5]];
        let pen = curve_pen(colour(incidences, i), is_dashed(*phi_i_deg, incidences));
        shapes.push(Shape::Polyline { points: line, pen });
        shapes.push(text([x + sample + 8.0, *y], &label, style));
        x += width + 28.0;
    }
    *y += LINE_HEIGHT + 4.0;
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::bsdf::text::parse;

    /// A table in the surface frame, of one slice a list of f at 0, 45 and 90 degrees.
    fn table(lobes: &str) -> ScatterTable {
        parse(format!("caustix-scattering 1\n{lobes}").as_bytes(), "test").unwrap()
    }

    /// A lobe 4 degrees wide about the mirrored or straight-through direction of light from 40 degrees.
    fn narrow(quantity: &str) -> ScatterTable {
        table(&format!(
            "frame specular\nsymmetry rotational\nchannels 1\ntheta_i 40\npolar 0 2\nlobe {quantity} both\n\
             incidence 40\n9 0\n"
        ))
    }

    fn largest(slice: &Slice) -> (f64, f64) {
        slice.points.iter().copied().max_by(|a, b| a.1.total_cmp(&b.1)).unwrap()
    }

    #[test]
    fn lobes_point_forwards_and_to_their_side() {
        for (quantity, up) in [("reflection", true), ("transmission", false)] {
            let plot = BsdfPlot::new(&narrow(quantity), "t", vec![]);
            let (angle, intensity) = largest(&plot.slices[0]);
            assert!((angle - 40.0).abs() < 1e-9, "{quantity}: {angle}");
            assert!((intensity - 9.0 * 40f64.to_radians().cos()).abs() < 1e-6, "{quantity}: {intensity}");
            let page = plot.page();
            let [x, y] = page.place(plot.slices[0].quantity, angle, page.radius(intensity));
            assert!(x > page.centre[0] && (y < page.centre[1]) == up, "{quantity}");
            assert_eq!(page.full, !up);
        }
    }

    #[test]
    fn a_diffuser_draws_a_circle() {
        let polar: Vec<String> = (0..=90).map(|a| a.to_string()).collect();
        let values = "0.25 ".repeat(91);
        let plot = BsdfPlot::new(
            &table(&format!(
                "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0 50\npolar {}\nlobe reflection both\n\
                 incidence 0\n{values}\nincidence 50\n{values}\n",
                polar.join(" ")
            )),
            "t",
            vec![],
        );
        let page = plot.page();
        assert!(matches!(page.scale, Scale::Linear(outer) if outer == 0.25));
        for slice in &plot.slices {
            for (angle, intensity) in &slice.points {
                let [x, y] = page.place(slice.quantity, *angle, page.radius(*intensity));
                let from_middle = (x - page.centre[0]).hypot(y - page.centre[1] + 0.5 * RADIUS);
                // The table's chords, a degree wide, lie inside the circle.
                assert!((from_middle - 0.5 * RADIUS).abs() < 0.01, "{angle}: {from_middle}");
            }
        }
    }

    #[test]
    fn grooves_show_in_both_planes_even_at_normal_incidence() {
        let slices = [3.0, 1.0, 3.0, 1.0, 3.0].iter().zip([0, 90, 180, 270, 360]);
        let blocks: String = slices.map(|(f, phi)| format!("incidence 0 {phi}\n{f} {f}\n")).collect();
        let head = "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0\nphi_i 0 90 180 270 360\npolar 0 90\n\
                    lobe reflection both\n";
        let plot = BsdfPlot::new(&table(&(head.to_owned() + &blocks)), "t", vec![]);
        let drawn: Vec<_> = plot.slices.iter().map(|s| (s.phi_i_deg, largest(s).1)).collect();
        assert_eq!(drawn, [(Some(0.0), 3.0), (Some(90.0), 1.0)]);
        let pens = plot.drawing().shapes.into_iter().filter_map(|s| match s {
            Shape::Polyline { points, pen } if points.len() > 100 => Some(pen),
            _ => None,
        });
        let pens: Vec<Pen> = pens.collect();
        assert_eq!((pens.len(), pens[0].dash_px, pens[1].dash_px.is_some()), (2, None, true));
        assert_eq!(pens[0].colour, pens[1].colour, "one colour for one polar angle");
    }

    #[test]
    fn four_incidences_at_most_and_a_logarithm_where_they_differ_much() {
        let blocks: String =
            (0..=8).map(|i| format!("incidence {}\n{f} {f}\n", 10 * i, f = 1 << i)).collect();
        let angles: Vec<String> = (0..=8).map(|i| (10 * i).to_string()).collect();
        let head = format!(
            "frame surface\nsymmetry rotational\nchannels 1\ntheta_i {}\npolar 0 90\nlobe reflection both\n",
            angles.join(" ")
        );
        let plot = BsdfPlot::new(&table(&(head + &blocks)), "t", vec![]);
        assert_eq!(plot.slices.iter().map(|s| s.theta_i_deg).collect::<Vec<_>>(), WANTED_DEG);
        let page = plot.page();
        assert_eq!(page.scale, Scale::Logarithmic(1000.0));
        assert!(
            (page.radius(1000.0) - RADIUS).abs() < 1e-9 && (page.radius(10.0) - 0.6 * RADIUS).abs() < 1e-9
        );
        assert_eq!((page.radius(1e-3), page.radius(0.0)), (0.0, 0.0));
        assert_eq!(page.rings.len(), 5);
    }

    #[test]
    fn dark_and_grazing_tables_draw_without_a_broken_number() {
        for lobes in [
            "frame surface\nsymmetry rotational\nchannels 1\ntheta_i 0\npolar 0 90\nlobe reflection back\nincidence 0\n0 0\n",
            "frame specular\nsymmetry rotational\nchannels 1\ntheta_i 90\npolar 0 180\nlobe transmission both\n\
             incidence 90\n1e-38 1e-38\n",
        ] {
            let svg = BsdfPlot::new(&table(lobes), "<a & b>", vec!["x".into()]).to_svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"), "{svg}");
            assert!(svg.contains("&lt;a &amp; b&gt;"));
        }
    }
}
