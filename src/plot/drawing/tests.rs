//! Tests of [`super`].

use super::*;

#[test]
fn text_is_escaped_and_numbers_are_short() {
    assert_eq!(escaped("a<b & \"c\"'\u{1}"), "a&lt;b &amp; &quot;c&quot;&#39;\u{fffd}");
    assert_eq!(["0", "1.5", "-3.33"], [-0.001, 1.5, -3.333].map(number).each_ref().map(String::as_str));
}

#[test]
fn both_renderings_hold_the_same_shapes() {
    let pen = Pen { width_px: 2.0, colour: Colour::srgb(200, 0, 0), dash_px: None };
    let drawing = Drawing {
        width: 60,
        height: 40,
        shapes: vec![
            Shape::Rect { area: [0.0, 0.0, 10.0, 10.0], colour: Colour::BLACK },
            Shape::Polyline { points: vec![[5.0, 20.0], [55.0, 20.0]], pen },
            Shape::Arc { centre: [30.0, 20.0], radius: 10.0, angles: [0.0, 3.0], pen },
            Shape::Polygon {
                corners: vec![[40.0, 0.0], [60.0, 0.0], [60.0, 20.0], [40.0, 20.0]],
                colour: Colour::srgb(0, 0, 200),
            },
            Shape::Text {
                at: [30.0, 39.0],
                text: "x < y".into(),
                style: TextStyle::new(11.0, Colour::BLACK),
            },
        ],
    };
    let svg = drawing.to_svg();
    for part in [
        "<polyline points=\"5,20 55,20\"",
        "<polygon points=\"40,0 60,0",
        "A 10 10 0 0 1",
        "x &lt; y</text>",
        "#c80000",
    ] {
        assert!(svg.contains(part), "{part} is not in {svg}");
    }
    let bytes = drawing.to_canvas().to_srgb_bytes();
    let pixel = |x: usize, y: usize| bytes[3 * (60 * y + x)..][..3].to_vec();
    assert_eq!(pixel(5, 5), [0, 0, 0]);
    assert_eq!(pixel(25, 20), [200, 0, 0]);
    assert_eq!(pixel(50, 5), [0, 0, 200]);
    assert_eq!(pixel(30, 29), [200, 0, 0]);
}

#[test]
fn the_ending_of_a_name_says_what_is_written() {
    let directory = tempfile::tempdir().unwrap();
    let drawing = Drawing { width: 8, height: 6, shapes: vec![] };
    for (name, first) in [("a.svg", &b"<svg "[..]), ("b.PNG", &b"\x89PNG"[..])] {
        drawing.write(&directory.path().join(name)).unwrap();
        assert!(std::fs::read(directory.path().join(name)).unwrap().starts_with(first), "{name}");
    }
    for name in ["c.jpg", "d"] {
        let path = directory.path().join(name);
        assert_eq!(drawing.write(&path).unwrap_err().kind(), Kind::Range);
        assert!(!path.exists());
    }
}
