//! Tests of [`super`].

use super::*;
use crate::files::photometric;
use crate::plot::chain::distance;

fn drawn(text: &str) -> Drawing {
    let photometry = photometric::parse(text.as_bytes(), "a.ies").unwrap();
    drawing(&photometry, &Summary::new(&photometry))
}

/// The lines of half the maximum in the chart, without their marks in the scale.
fn half_lines(drawing: &Drawing) -> Vec<&Vec<[f64; 2]>> {
    let of_beam = |shape: &Shape| matches!(shape, Shape::Polyline { pen, .. } if pen.width_px == 2.4);
    let lines = drawing.shapes.iter().filter(|shape| of_beam(shape)).filter_map(|shape| match shape {
        Shape::Polyline { points, .. } if points.len() > 2 => Some(points),
        _ => None,
    });
    lines.collect()
}

#[test]
fn half_of_a_cone_is_a_circle_of_its_beam() {
    // 100 cd at 0, 0 at 40 degrees: 1 % at 39.6 degrees, so the disc reaches 45; half at 20.
    let cone = drawn("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 0\n0 40 180\n0\n100 0 0\n");
    let lines = half_lines(&cone);
    assert_eq!(lines.len(), 1);
    let left = lines[0].iter().map(|p| p[0]).fold(f64::INFINITY, f64::min);
    let centre = [CENTRE_X, MARGIN + 30.0 + 48.0 + RADIUS];
    assert!((left - (CENTRE_X - RADIUS * 20.0 / 45.0)).abs() < 0.05, "{left}");
    assert!(lines[0].iter().all(|&p| (distance(p, centre) - RADIUS * 20.0 / 45.0).abs() < 0.05));
    // The same upwards: one disc, for the other half space.
    let up = drawn("IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 0 0 0\n1 1 0\n0 140 180\n0\n0 0 100\n");
    assert_eq!(half_lines(&up)[0].len(), lines[0].len());
    assert_eq!(up.height, cone.height);
    let texts = |drawing: &Drawing| {
        let words = drawing.shapes.iter().filter_map(|shape| match shape {
            Shape::Text { text, .. } => Some(text.clone()),
            _ => None,
        });
        words.collect::<Vec<_>>().join("|")
    };
    assert!(texts(&cone).contains("below the horizontal, to 45") && texts(&cone).contains("|30\u{b0}|"));
    assert!(texts(&up).contains("above the horizontal, to 45") && texts(&up).contains("|150\u{b0}|"));
}

#[test]
fn planes_are_where_they_are_named() {
    // Light around C = 90 alone, which is up on the page.
    let wall = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 5 1 2 0 0 0\n1 1 0\n0 30 60\n0 60 90 120 360\n\
        0 0 0\n0 0 0\n0 9 0\n0 0 0\n0 0 0\n";
    let drawing = drawn(wall);
    let y = MARGIN + 30.0 + 48.0 + RADIUS;
    assert!(half_lines(&drawing).iter().all(|line| line.iter().all(|p| p[1] < y)), "above the middle");
}

#[test]
fn floodlights_are_drawn_over_both_angles_and_darkness_is_no_trouble() {
    let flood = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 3 2 2 0 0 0\n1 1 0\n-10 0 10\n-40 0 40\n\
        0 0 0\n0 9 0\n0 0 0\n";
    let drawing = drawn(flood);
    let line = half_lines(&drawing)[0];
    // Bilinear from 9 cd: half at V = 5 and at H = 20. The chart is 80 degrees wide, on 520 pixels.
    let extent = |k: usize| {
        let ends = line.iter().map(|p| p[k]).fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        ends.1 - ends.0
    };
    assert!((extent(0) - 40.0 * 6.5).abs() < 0.1 && (extent(1) - 10.0 * 6.5).abs() < 0.1);
    for dark in
        [flood.replace('9', "0"), "IESNA91\nTILT=NONE\n1 -1 1 2 1 1 2 0 0 0\n1 1 0\n0 90\n0\n0 0\n".into()]
    {
        let canvas = drawn(&dark).to_canvas();
        assert_eq!(canvas.width(), WIDTH);
    }
}
