//! A drawing as a list of shapes, rendered alike to SVG and to pixels.

use std::f64::consts::{PI, TAU};
use std::path::Path;

use crate::error::{Diagnostic, Kind, Result};
use crate::files::atomic::write_bytes;
use crate::report::colour::Colour;

use super::canvas::{Anchor, Canvas, TextStyle};
use super::chain::{arc_points, dashes};

/// How a line is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pen {
    /// Width in pixels.
    pub width_px: f64,
    /// Its colour.
    pub colour: Colour,
    /// Ink and gap in pixels; none for a solid line.
    pub dash_px: Option<[f64; 2]>,
}

impl Pen {
    /// A solid line.
    pub fn solid(width_px: f64, colour: Colour) -> Self {
        Self { width_px, colour, dash_px: None }
    }
}

/// The colour of text and marks.
pub fn ink() -> Colour {
    Colour::grey(50)
}

/// Upright text whose anchor, on the baseline, is here.
pub fn text(at: [f64; 2], text: &str, style: TextStyle) -> Shape {
    Shape::Text { at, text: text.to_owned(), style }
}

/// A chain of lines.
pub fn polyline(points: impl Into<Vec<[f64; 2]>>, pen: Pen) -> Shape {
    Shape::Polyline { points: points.into(), pen }
}

/// One shape; coordinates in pixels, x right and y down.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A chain of lines.
    Polyline {
        /// Its points.
        points: Vec<[f64; 2]>,
        /// How it is drawn.
        pen: Pen,
    },
    /// An arc of a circle; angles in radians, from +x towards +y, less than a full turn or exactly one.
    Arc {
        /// Its centre.
        centre: [f64; 2],
        /// Its radius.
        radius: f64,
        /// First and last angle.
        angles: [f64; 2],
        /// How it is drawn.
        pen: Pen,
    },
    /// A filled rectangle.
    Rect {
        /// x, y, width, height.
        area: [f64; 4],
        /// Its colour.
        colour: Colour,
    },
    /// A small filled shape, such as a marker.
    Polygon {
        /// Its corners; where it covers itself twice it is empty.
        corners: Vec<[f64; 2]>,
        /// Its colour.
        colour: Colour,
    },
    /// The area within closed loops, even-odd.
    Region {
        /// The loops.
        loops: Vec<Vec<[f64; 2]>>,
        /// Its colour.
        colour: Colour,
    },
    /// Upright text.
    Text {
        /// Where its anchor is, on the baseline.
        at: [f64; 2],
        /// The text.
        text: String,
        /// How it is drawn.
        style: TextStyle,
    },
}

/// A drawing on white.
#[derive(Debug, Clone, PartialEq)]
pub struct Drawing {
    /// Width in pixels.
    pub width: usize,
    /// Height in pixels.
    pub height: usize,
    /// What is drawn, in this order.
    pub shapes: Vec<Shape>,
}

impl Drawing {
    /// The drawing in pixels.
    pub fn to_canvas(&self) -> Canvas {
        let mut canvas = Canvas::new(self.width, self.height, Colour::WHITE);
        for shape in &self.shapes {
            match shape {
                Shape::Polyline { points, pen } => draw_chain(&mut canvas, points, pen),
                Shape::Arc { centre, radius, angles, pen } => {
                    draw_chain(&mut canvas, &arc_points(*centre, *radius, *angles), pen);
                }
                Shape::Rect { area, colour } => canvas.rect(*area, *colour),
                Shape::Polygon { corners, colour } => canvas.polygon(corners, *colour),
                Shape::Region { loops, colour } => canvas.region(loops, *colour),
                Shape::Text { at, text, style } => canvas.text(*at, text, style),
            }
        }
        canvas
    }

    /// The drawing as an SVG 1.1 document.
    pub fn to_svg(&self) -> String {
        let (width, height) = (self.width, self.height);
        let mut svg = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
             viewBox=\"0 0 {width} {height}\" font-family=\"Helvetica, Arial, 'Liberation Sans', sans-serif\">\n\
             <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
        );
        for shape in &self.shapes {
            svg += &svg_of(shape);
            svg.push('\n');
        }
        svg.push_str("</svg>\n");
        svg
    }

    /// Writes the drawing; the ending of the name says as what.
    ///
    /// # Errors
    /// [`Kind::Range`] for an ending other than `.svg` and `.png`; [`Kind::Io`] with the path.
    pub fn write(&self, path: &Path) -> Result<()> {
        match path.extension().map(|e| e.to_string_lossy().to_ascii_lowercase()).as_deref() {
            Some("svg") => write_bytes(path, self.to_svg().as_bytes()),
            Some("png") => self.to_canvas().write_png(path),
            _ => {
                Err(Diagnostic::new(Kind::Range, path.display().to_string(), "a name ending in .svg or .png"))
            }
        }
    }
}

fn draw_chain(canvas: &mut Canvas, points: &[[f64; 2]], pen: &Pen) {
    let pieces = pen.dash_px.map_or_else(|| vec![points.to_vec()], |dash| dashes(points, dash));
    pieces.iter().for_each(|piece| canvas.polyline(piece, pen.width_px, pen.colour, 1.0));
}

fn svg_of(shape: &Shape) -> String {
    match shape {
        Shape::Polyline { points, pen } => format!("<polyline points=\"{}\" {}/>", list(points), stroke(pen)),
        Shape::Arc { centre: [x, y], radius, angles: [from, to], pen } => {
            let (r, stroke) = (number(*radius), stroke(pen));
            if (to - from).abs() >= TAU * (1.0 - 1e-9) {
                return format!("<circle cx=\"{}\" cy=\"{}\" r=\"{r}\" {stroke}/>", number(*x), number(*y));
            }
            let end = |a: f64| {
                format!("{} {}", number(x + radius * libm::cos(a)), number(y + radius * libm::sin(a)))
            };
            let (large, sweep) = (u8::from((to - from).abs() > PI), u8::from(to > from));
            format!("<path d=\"M {} A {r} {r} 0 {large} {sweep} {}\" {stroke}/>", end(*from), end(*to))
        }
        Shape::Rect { area, colour } => {
            let ([x, y, width, height], fill) = (area.map(number), hex(*colour));
            format!("<rect x=\"{x}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" fill=\"{fill}\"/>")
        }
        Shape::Polygon { corners, colour } => {
            let (points, fill) = (list(corners), hex(*colour));
            format!("<polygon points=\"{points}\" fill=\"{fill}\" fill-rule=\"evenodd\"/>")
        }
        Shape::Region { loops, colour } => {
            let path: Vec<String> = loops.iter().map(|chain| format!("M {} Z", list(chain))).collect();
            format!("<path d=\"{}\" fill=\"{}\" fill-rule=\"evenodd\"/>", path.join(" "), hex(*colour))
        }
        Shape::Text { at, text, style } => {
            let anchor = match style.anchor {
                Anchor::Start => "start",
                Anchor::Middle => "middle",
                Anchor::End => "end",
            };
            let weight = if style.weight > 1.1 { " font-weight=\"bold\"" } else { "" };
            let [x, y, size] = [at[0], at[1], style.size_px].map(number);
            let (fill, text) = (hex(style.colour), escaped(text));
            format!(
                "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" text-anchor=\"{anchor}\"{weight} \
                 fill=\"{fill}\" xml:space=\"preserve\">{text}</text>"
            )
        }
    }
}

fn list(points: &[[f64; 2]]) -> String {
    let pairs: Vec<String> = points.iter().map(|p| format!("{},{}", number(p[0]), number(p[1]))).collect();
    pairs.join(" ")
}

fn stroke(pen: &Pen) -> String {
    let dash = pen
        .dash_px
        .map_or(String::new(), |[on, off]| format!(" stroke-dasharray=\"{} {}\"", number(on), number(off)));
    format!(
        "fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\" stroke-linecap=\"round\"{dash}",
        hex(pen.colour),
        number(pen.width_px)
    )
}

/// A coordinate to a hundredth of a pixel, without trailing zeros or a negative zero.
fn number(value: f64) -> String {
    let rounded = (value * 100.0).round() / 100.0;
    format!("{}", if rounded == 0.0 { 0.0 } else { rounded })
}

fn hex(colour: Colour) -> String {
    let [r, g, b] = colour.to_srgb();
    format!("#{r:02x}{g:02x}{b:02x}")
}

/// Text for an XML document; characters XML does not allow become U+FFFD.
pub fn escaped(text: &str) -> String {
    let is_allowed = |c: char| !matches!(c, '\0'..='\u{8}' | '\u{b}' | '\u{c}' | '\u{e}'..='\u{1f}' | '\u{fffe}' | '\u{ffff}');
    let text: String = text.chars().map(|c| if is_allowed(c) { c } else { '\u{fffd}' }).collect();
    let entities = [('&', "&amp;"), ('<', "&lt;"), ('>', "&gt;"), ('"', "&quot;"), ('\'', "&#39;")];
    entities.iter().fold(text, |text, (c, entity)| text.replace(*c, entity))
}

#[cfg(test)]
mod tests;
