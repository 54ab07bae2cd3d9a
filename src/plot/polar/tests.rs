//! Tests of [`super`].

use super::*;
use crate::plot::canvas::Anchor;
use crate::plot::disc::Scale;
use crate::plot::drawing::Shape;
use crate::plot::font;

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
    let disc = plot.disc();
    assert!(!disc.full);
    assert_eq!(disc.scale, Scale::Linear(1000.0));
    let curve = first_curve(&plot);
    let [cx, cy] = disc.centre;
    let close = |p: [f64; 2], q: [f64; 2]| (p[0] - q[0]).abs() < 1e-9 && (p[1] - q[1]).abs() < 1e-9;
    assert!(close(curve[0], [cx - 0.25 * RADIUS, cy]));
    assert!(close(curve[1], [cx, cy + RADIUS]), "nadir is down");
    assert!(close(curve[2], [cx + 0.5 * RADIUS, cy]), "positive angles are right");
}

#[test]
fn a_lambertian_source_draws_a_circle() {
    let plot = plot((-90..=90).map(|a| (f64::from(a), 500.0 * f64::from(a).to_radians().cos())).collect());
    let disc = plot.disc();
    let middle = [disc.centre[0], disc.centre[1] + 0.5 * RADIUS];
    for p in first_curve(&plot) {
        let r = ((p[0] - middle[0]).powi(2) + (p[1] - middle[1]).powi(2)).sqrt();
        assert!((r - 0.5 * RADIUS).abs() < 1e-9, "{r}");
    }
}

#[test]
fn rings_are_round_and_reach_the_maximum() {
    for (max, top) in
        [(1000.0, 1000.0), (1001.0, 1200.0), (87.0, 100.0), (0.013, 0.014), (5.3e6, 6e6), (1401.0, 1500.0)]
    {
        let disc = plot(vec![(0.0, max)]).disc();
        assert_eq!(disc.scale, Scale::Linear(top), "for {max}");
        assert!((3..=8).contains(&disc.rings.len()), "{:?}", disc.rings);
    }
}

#[test]
fn the_upper_half_is_there_only_when_lit() {
    assert!(!plot(vec![(0.0, 5.0), (90.0, 1.0), (180.0, 0.0)]).disc().full);
    assert!(plot(vec![(0.0, 5.0), (-120.0, 1e-3)]).disc().full);
    let (half, full) = (plot(vec![(0.0, 5.0)]).drawing(), plot(vec![(180.0, 5.0)]).drawing());
    assert!(half.height + 200 < full.height);
    assert!(full.to_svg().contains(">180°<") && !half.to_svg().contains(">105°<"));
}

#[test]
fn nothing_breaks_on_empty_zero_or_broken_curves() {
    for points in [
        vec![],
        vec![(0.0, 0.0)],
        vec![(0.0, f64::NAN), (0.0, f64::INFINITY)],
        vec![(0.0, -5.0), (10.0, -1.0)],
        vec![(0.0, 5e-324), (1.0, 1e300)],
        vec![(-1e9, 1.0), (1e9, 2.0)],
    ] {
        let drawing = plot(points).drawing();
        assert!(!drawing.to_svg().contains("NaN") && !drawing.to_svg().contains("inf"));
        drawing.to_canvas();
    }
    let nothing = PolarPlot { title: String::new(), curves: vec![], footer: vec![] };
    assert!(nothing.drawing().to_svg().ends_with("</svg>\n"));
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
