//! The polar diagram of a photometric file: which planes are drawn.

use crate::photometry::web::PhotometricType;
use crate::photometry::{Photometry, Summary, Web};
use crate::report::numbers::digits;

use super::drawing::Drawing;
use super::page::{base_name, curve_angles};
use super::polar::{Curve, PolarPlot};

/// The diagram of a file: type C the planes C0-C180 and C90-C270; types A and B the vertical section (H = 0) and the
/// horizontal one (V = 0), with the aim at the bottom. One curve where both planes are the same.
pub fn drawing(photometry: &Photometry, summary: &Summary) -> Drawing {
    let curves = curves(&photometry.web);
    PolarPlot { title: title_of(photometry), curves, footer: footer(summary) }.drawing()
}

/// The curves of a table.
pub fn curves(web: &Web) -> Vec<Curve> {
    let (first, second) = match web.photometric_type {
        PhotometricType::C => {
            // Signed polar angle: negative angles lie in the opposite half plane.
            let plane = |positive_deg: f64, negative_deg: f64| {
                let at = |angle: f64| {
                    let h = if angle < 0.0 { negative_deg } else { positive_deg };
                    web.intensity_cd(angle.abs(), h)
                };
                section(at, &web.vertical_deg)
            };
            (("C0 - C180", plane(0.0, 180.0)), ("C90 - C270", plane(90.0, 270.0)))
        }
        PhotometricType::A | PhotometricType::B => (
            ("vertical (H = 0)", section(|v| web.intensity_cd(v, 0.0), &web.vertical_deg)),
            ("horizontal (V = 0)", section(|h| web.intensity_cd(0.0, h), &web.horizontal_deg)),
        ),
    };
    let curve =
        |(label, points): (&str, Vec<(f64, f64)>), dashed| Curve { label: label.into(), points, dashed };
    let mut curves = vec![curve(first, false), curve(second, true)];
    if curves[0].points == curves[1].points {
        curves.truncate(1);
        curves[0].label = "all planes".into();
    }
    curves
}

/// Intensities at the table's own angles on both sides, and at whole degrees between.
fn section(at: impl Fn(f64) -> f64, table_deg: &[f64]) -> Vec<(f64, f64)> {
    let own = table_deg.iter().flat_map(|a| [*a, -a]);
    curve_angles(180, 1, own).into_iter().map(|a| (a, at(a))).collect()
}

/// The headline: what the luminaire is called.
pub fn title_of(photometry: &Photometry) -> String {
    let named =
        ["LUMINAIRE", "LUMCAT"].iter().filter_map(|k| photometry.label(k)).find(|t| !t.trim().is_empty());
    match named {
        Some(text) => text.lines().next().unwrap_or_default().trim().to_string(),
        None => base_name(&photometry.file),
    }
}

/// Flux, maximum and angles, in lines.
pub fn footer(s: &Summary) -> Vec<String> {
    let flux = format!("flux {} lm, maximum {} cd", digits(s.flux_lm), digits(s.max_candela));
    let angle = |name: &str, degrees: Option<f64>| degrees.map(|d| format!("{name} {}\u{b0}", digits(d)));
    let angles = [angle("beam angle", s.beam_angle_deg), angle("field angle", s.field_angle_deg)];
    let angles = angles.into_iter().flatten().reduce(|beam, field| format!("{beam}, {field}"));
    [flux].into_iter().chain(angles).collect()
}
