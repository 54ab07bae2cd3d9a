//! Tests of [`super`].

use super::*;
use crate::plot::chain::arc_points;

fn pixel(canvas: &Canvas, x: usize, y: usize) -> Colour {
    canvas.pixels[y * canvas.width + x]
}

/// Ink on a white picture drawn black, in pixel areas.
fn ink(canvas: &Canvas) -> f64 {
    canvas.pixels.iter().map(|p| 1.0 - f64::from(p.0[0])).sum()
}

#[test]
fn strokes_carry_the_area_they_should() {
    for width in [0.4, 1.0, 1.7, 6.0] {
        for angle in [0.0_f64, 0.3, 0.785, 1.2, 1.6] {
            let mut canvas = Canvas::new(120, 120, Colour::WHITE);
            let end = [60.3 + 45.0 * angle.cos(), 60.8 + 45.0 * angle.sin()];
            canvas.line([60.3, 60.8], end, width, Colour::BLACK);
            let expected = 45.0 * width + std::f64::consts::PI / 4.0 * width * width;
            // Round ends of hairlines are resolved to about a tenth of a pixel.
            let error = (ink(&canvas) - expected).abs();
            assert!(error < 0.03 * expected + 0.5, "{width} at {angle}: {} of {expected}", ink(&canvas));
        }
    }
    let mut canvas = Canvas::new(20, 20, Colour::WHITE);
    canvas.rect([3.25, 4.5, 7.5, 2.125], Colour::BLACK);
    assert!((ink(&canvas) - 7.5 * 2.125).abs() < 1e-4, "{}", ink(&canvas));
}

#[test]
fn nothing_is_inked_twice_or_outside() {
    let mut canvas = Canvas::new(40, 40, Colour::WHITE);
    canvas.polyline(&[[5.0, 20.0], [35.0, 20.0], [5.0, 20.0], [35.0, 20.0]], 3.0, Colour::BLACK, 0.5);
    let darkest = canvas.pixels.iter().map(|p| p.0[0]).fold(1.0, f32::min);
    assert!((darkest - 0.5).abs() < 1e-6, "{darkest}");
    let mut canvas = Canvas::new(40, 40, Colour::WHITE);
    canvas.clipped([10, 10, 20, 20], |c| c.line([-500.0, -500.0], [500.0, 500.0], 2.0, Colour::BLACK));
    canvas.line([f64::NAN, 0.0], [3.0, 3.0], 2.0, Colour::BLACK);
    canvas.line([f64::INFINITY, 0.0], [3.0, 3.0], 2.0, Colour::BLACK);
    for y in 0..40 {
        for x in 0..40 {
            let inside = (10..20).contains(&x) && (10..20).contains(&y);
            assert!(inside || pixel(&canvas, x, y) == Colour::WHITE, "{x} {y}");
        }
    }
    assert_eq!(pixel(&canvas, 15, 15), Colour::BLACK);
}

#[test]
fn text_of_eleven_pixels_has_sharp_stems_and_keeps_its_anchor() {
    let mut canvas = Canvas::new(60, 30, Colour::WHITE);
    canvas.text([4.0, 20.0], "l", &TextStyle::new(12.0, Colour::BLACK));
    let darkest = (0..60).map(|x| pixel(&canvas, x, 15).0[0]).fold(1.0, f32::min);
    assert!(darkest < 0.05, "a stem is one dark pixel wide: {darkest}");
    for (anchor, first, last) in [(Anchor::Start, 30, 45), (Anchor::End, 15, 30)] {
        let mut canvas = Canvas::new(60, 30, Colour::WHITE);
        canvas.text([30.0, 20.0], "100", &TextStyle::new(11.0, Colour::BLACK).anchored(anchor));
        let inked = |x: &usize| (0..30).any(|y| pixel(&canvas, *x, y).0[0] < 0.6);
        let columns: Vec<usize> = (0..60).filter(inked).collect();
        let (low, high) = (columns[0], columns[columns.len() - 1]);
        assert!(low + 1 >= first && high <= last + 1, "{anchor:?}: {low}..{high}");
    }
}

#[test]
fn a_polygon_covers_its_area() {
    let disc: Vec<[f64; 2]> = arc_points([10.3, 9.6], 5.0, [0.0, 2.0 * std::f64::consts::PI]);
    for (corners, area) in [
        (vec![[3.0, 3.0], [11.0, 3.0], [11.0, 7.5]], 18.0),
        (vec![[4.0, 4.0], [9.0, 9.0], [4.0, 14.0], [-1.0, 9.0]], 50.0 - 1.0),
        (disc, 25.0 * std::f64::consts::PI),
        (vec![], 0.0),
        (vec![[1.0, f64::NAN], [5.0, 5.0], [1.0, 5.0]], 0.0),
    ] {
        let mut canvas = Canvas::new(20, 20, Colour::WHITE);
        canvas.polygon(&corners, Colour::BLACK);
        assert!((ink(&canvas) - area).abs() <= 0.01 * area, "{} for {area}", ink(&canvas));
    }
}

#[test]
fn a_region_has_the_area_within_its_loops_and_not_in_its_holes() {
    let circle = |radius: f64| arc_points([40.3, 41.2], radius, [0.0, std::f64::consts::TAU]);
    let mut canvas = Canvas::new(80, 80, Colour::WHITE);
    canvas.region(&[circle(30.0), circle(12.5)], Colour::BLACK);
    let expected = std::f64::consts::PI * (30.0 * 30.0 - 12.5 * 12.5);
    assert!((ink(&canvas) / expected - 1.0).abs() < 2e-3, "{} of {expected}", ink(&canvas));
    assert_eq!(pixel(&canvas, 40, 41), Colour::WHITE);
    // Beyond the picture, and not finite: nothing.
    canvas.region(&[vec![[-50.0, -50.0], [200.0, -50.0], [200.0, -10.0]]], Colour::BLACK);
    canvas.region(&[vec![[0.0, 0.0], [f64::NAN, 50.0], [50.0, 0.0]], Vec::new()], Colour::BLACK);
    assert!((ink(&canvas) / expected - 1.0).abs() < 2e-3);
    let mut whole = Canvas::new(9, 7, Colour::WHITE);
    whole.region(&[vec![[-5.0, -5.0], [20.0, -5.0], [20.0, 20.0], [-5.0, 20.0]]], Colour::BLACK);
    assert!((ink(&whole) - 63.0).abs() < 1e-3);
}
