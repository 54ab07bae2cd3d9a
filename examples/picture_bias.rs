//! The bias of the photon map's pictures, measured against splatted ones: `cargo run --release --features measurements
//! --example picture_bias -- FOLDER` writes `picture_bias.csv` and `picture_bias.svg` there (docs/PICTURE.md, Bias);
//! about a quarter of an hour on two threads. Names of scenes after the folder leave out the others.
#![allow(clippy::print_stdout)]

#[path = "../tests/support/caustic_views.rs"]
mod views;

#[path = "../tests/pictures/picture_bias.rs"]
mod bias;

use std::error::Error;
use std::fmt::Write;
use std::path::Path;

use caustix::error::Diagnostic;
use caustix::plot::canvas::{Anchor, TextStyle};
use caustix::plot::drawing::{Drawing, Pen, Shape};
use caustix::report::colour::Colour;
use caustix::scene::camera::{Bandwidth, Camera};

use bias::{Row, mapped, rate, splatted};

/// 2^m photons of the reference, its replicates, its seed.
const REFERENCE: (u32, u32, u64) = (24, 16, 1000);
/// 2^m photons of the maps.
const LADDER: [u32; 4] = [16, 18, 20, 22];
const REPLICATES: u32 = 8;
const SEEDS: u64 = 4;
const COLUMNS: u32 = 48;

/// One scene's rows by one rule for the radius.
struct Series {
    scene: &'static str,
    radius: &'static str,
    rows: Vec<Row>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut args = std::env::args().skip(1);
    let folder = args.next().ok_or("usage: picture_bias FOLDER [SCENE...]")?;
    let wanted: Vec<String> = args.collect();
    let mut all = Vec::new();
    for make in [views::pane, views::ball, views::ring, views::wavy_glass] {
        let view = make(COLUMNS).map_err(in_lines)?;
        if wanted.is_empty() || wanted.iter().any(|w| w == view.name) {
            all.extend(measured(&view)?);
        }
    }
    std::fs::write(Path::new(&folder).join("picture_bias.csv"), csv(&all))?;
    drawing(&all).write(&Path::new(&folder).join("picture_bias.svg"))?;
    Ok(())
}

fn in_lines(errors: Vec<Diagnostic>) -> String {
    errors.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n")
}

/// With the automatic bandwidth, then, where photons cost little, with the radius that this has at the least number of photons, falling as N^(-1/6).
fn measured(view: &views::View) -> Result<Vec<Series>, Box<dyn Error>> {
    let (m, replicates, seed) = REFERENCE;
    let reference =
        splatted(&view.scene, &Camera::new(view.spec.clone())?, &views::plan(m, replicates, seed)?)?;
    let (compared, lit) = (reference.compared().count(), reference.lit().count());
    println!("{}: {compared} pixels compared, {lit} lit", view.name);
    let mut all: Vec<Series> = Vec::new();
    let rules: &[_] = if view.in_beam { &["automatic", "N^(-1/6)"] } else { &["automatic"] };
    for &radius in rules {
        let first_m = all.first().map(|s| s.rows[0].radius_m);
        println!("  radius {radius}\n{HEADER}");
        let mut rows = Vec::new();
        for m in LADDER {
            let mut spec = view.spec.clone();
            if let Some(first_m) = first_m {
                spec.bandwidth = Bandwidth::Radius(first_m * libm::exp2(-f64::from(m - LADDER[0]) / 6.0));
            }
            let camera = Camera::new(spec)?;
            let picture = |seed| mapped(&view.scene, &camera, &views::plan(m, REPLICATES, seed)?);
            let pictures = (1..=SEEDS).map(picture).collect::<Result<Vec<_>, _>>()?;
            let row = Row::new(&reference, 1 << m, &pictures);
            println!("{}", line(m, &row));
            rows.push(row);
        }
        let rates: [Rate; 3] =
            [("radius", |r| r.radius_m), ("bias figure", |r| r.figure), ("bias", Row::bias_without_noise)];
        for (name, value) in rates {
            println!("  {name} ~ N^{:.2}", rate(&rows, value));
        }
        all.push(Series { scene: view.name, radius, rows });
    }
    Ok(all)
}

/// What falls with the number of photons: name, number.
type Rate = (&'static str, fn(&Row) -> f64);

const HEADER: &str = "| photons | radius | error | standard error | bias figure | bias with noise (its error) | bias | figure covers \
                      error | bias | clear bias | agree |";

/// A line of a table in Markdown.
fn line(m: u32, row: &Row) -> String {
    let p = |x: f64| format!("{:.2} %", 100.0 * x);
    let share = |x: f64| format!("{:.1} %", 100.0 * x);
    format!(
        "| 2^{m} | {:.2} mm | {} | {} | {} | {} ({}) | {} | {} | {} | {} | {} |",
        1e3 * row.radius_m,
        p(row.error),
        p(row.standard_error),
        p(row.figure),
        p(row.bias),
        p(row.bias_error),
        p(row.bias_without_noise()),
        share(row.figure_covers_error),
        share(row.figure_covers_bias),
        share(row.figure_covers_clear_bias),
        share(row.agree),
    )
}

fn csv(all: &[Series]) -> String {
    let mut out = "scene,radius,photons,radius_m,error,standard_error,bias_figure,bias_with_noise,bias_error,bias,figure_covers_error,\
                   figure_covers_bias,figure_covers_clear_bias,agree\n"
        .to_string();
    for Series { scene, radius, rows } in all {
        for r in rows {
            // Writing to a String cannot fail.
            let _infallible = writeln!(
                out,
                "{scene},{radius},{},{},{},{},{},{},{},{},{},{},{},{}",
                r.photons,
                r.radius_m,
                r.error,
                r.standard_error,
                r.figure,
                r.bias,
                r.bias_error,
                r.bias_without_noise(),
                r.figure_covers_error,
                r.figure_covers_bias,
                r.figure_covers_clear_bias,
                r.agree
            );
        }
    }
    out
}

const MARGIN: f64 = 56.0;
const PANEL: [f64; 2] = [380.0, 250.0];
/// Fractions of the pixel at the ends of the axis.
const RANGE: [f64; 2] = [0.002, 0.5];

/// What a line shows: name, colour, dashes, number.
type Line = (&'static str, [u8; 3], Option<[f64; 2]>, fn(&Row) -> f64);

const LINES: [Line; 3] = [
    ("bias figure, median", [0xd5, 0x5e, 0x00], None, |r| r.figure),
    ("bias, median", [0x00, 0x72, 0xb2], None, Row::bias_without_noise),
    ("standard error, median", [0x70, 0x70, 0x70], Some([6.0, 4.0]), |r| r.standard_error),
];

/// A panel for each scene, automatic bandwidth.
fn drawing(all: &[Series]) -> Drawing {
    let mut shapes = Vec::new();
    let series: Vec<&Series> = all.iter().filter(|s| s.radius == "automatic").collect();
    for (k, (name, colour, dash_px, _)) in LINES.iter().enumerate() {
        let [x, y] = [MARGIN + 230.0 * k as f64, 24.0];
        let pen = Pen { width_px: 2.0, colour: rgb(*colour), dash_px: *dash_px };
        shapes.push(Shape::Polyline { points: vec![[x, y - 5.0], [x + 28.0, y - 5.0]], pen });
        shapes.push(text([x + 35.0, y], name, Anchor::Start));
    }
    for (k, series) in series.iter().enumerate() {
        let at = [MARGIN + (k % 2) as f64 * (PANEL[0] + MARGIN), 62.0 + (k / 2) as f64 * (PANEL[1] + 76.0)];
        panel(&mut shapes, at, series);
    }
    let rows = series.len().div_ceil(2) as f64;
    Drawing { width: 900, height: (56.0 + rows * (PANEL[1] + 76.0)) as usize, shapes }
}

fn panel(shapes: &mut Vec<Shape>, [left, top]: [f64; 2], series: &Series) {
    let [width, height] = PANEL;
    let x =
        |m: f64| left + width * (m - f64::from(LADDER[0]) + 0.4) / (f64::from(LADDER[3] - LADDER[0]) + 0.8);
    let y = |v: f64| top + height * libm::log(RANGE[1] / v.max(RANGE[0])) / libm::log(RANGE[1] / RANGE[0]);
    let pen = |colour: Colour| Pen { width_px: 1.0, colour, dash_px: None };
    for tick in [0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5] {
        let points = vec![[left, y(tick)], [left + width, y(tick)]];
        shapes.push(Shape::Polyline { points, pen: pen(Colour::grey(if tick == 0.02 { 150 } else { 222 })) });
        shapes.push(text([left - 6.0, y(tick) + 4.0], &format!("{} %", 100.0 * tick), Anchor::End));
    }
    for m in LADDER {
        let x = x(f64::from(m));
        let points = vec![[x, top], [x, top + height]];
        shapes.push(Shape::Polyline { points, pen: pen(Colour::grey(222)) });
        shapes.push(text([x, top + height + 17.0], &format!("2^{m}"), Anchor::Middle));
    }
    shapes.push(text([left + 0.5 * width, top + height + 36.0], "photons N", Anchor::Middle));
    shapes.push(text([left + 0.5 * width, top - 8.0], series.scene, Anchor::Middle));
    // What independent photons and a smooth density would give.
    let [from, to] = [f64::from(LADDER[0]), f64::from(LADDER[3])];
    let start = 0.4;
    let end = start * libm::exp2((from - to) / 3.0);
    let dotted = Pen { width_px: 1.5, colour: Colour::grey(120), dash_px: Some([1.5, 4.0]) };
    shapes.push(Shape::Polyline { points: vec![[x(from), y(start)], [x(to), y(end)]], pen: dotted });
    shapes.push(text([x(to) - 4.0, y(end) - 8.0], "N^(-1/3)", Anchor::End));
    for (_, colour, dash_px, value) in LINES {
        let pen = Pen { width_px: 2.0, colour: rgb(colour), dash_px };
        let shown: Vec<&Row> = series.rows.iter().filter(|r| value(r) > 0.0).collect();
        let points: Vec<[f64; 2]> =
            shown.iter().map(|r| [x(libm::log2(r.photons as f64)), y(value(r))]).collect();
        for [px, py] in &points {
            let corners =
                vec![[px - 3.0, py - 3.0], [px + 3.0, py - 3.0], [px + 3.0, py + 3.0], [px - 3.0, py + 3.0]];
            shapes.push(Shape::Polygon { corners, colour: rgb(colour) });
        }
        shapes.push(Shape::Polyline { points, pen });
    }
}

fn rgb([red, green, blue]: [u8; 3]) -> Colour {
    Colour::srgb(red, green, blue)
}

fn text(at: [f64; 2], text: &str, anchor: Anchor) -> Shape {
    Shape::Text { at, text: text.to_owned(), style: TextStyle::new(13.0, Colour::grey(50)).anchored(anchor) }
}
