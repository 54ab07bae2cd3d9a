//! Colours and markers that tell lines apart, also for the colour-blind and in grey.

use std::f64::consts::{PI, TAU};

use crate::plot::drawing::Shape;
use crate::report::colour::Colour;

/// Radius of a marker, pixels.
const RADIUS: f64 = 5.5;
/// White around a marker, and the width of a hollow one's rim, pixels.
const RIM: f64 = 1.7;

/// Colours of Okabe and Ito (2008), without their yellow, which white paper swallows.
const COLOURS: [[u8; 3]; 7] = [
    [0x00, 0x00, 0x00],
    [0xd5, 0x5e, 0x00],
    [0x00, 0x72, 0xb2],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0x56, 0xb4, 0xe9],
    [0xe6, 0x9f, 0x00],
];

/// The colour of line number `index`.
pub fn colour(index: usize) -> Colour {
    let [red, green, blue] = COLOURS[index % COLOURS.len()];
    Colour::srgb(red, green, blue)
}

/// The marker of line number `index`; eight shapes beside seven colours repeat only after 56 lines.
pub fn marker(index: usize, at: [f64; 2], hollow: bool) -> Vec<Shape> {
    let outline = |size: f64, colour: Colour| Shape::Polygon {
        corners: corners(index).into_iter().map(|[x, y]| [at[0] + size * x, at[1] + size * y]).collect(),
        colour,
    };
    let mut shapes = vec![outline(RADIUS + RIM, Colour::WHITE), outline(RADIUS, colour(index))];
    if hollow {
        shapes.push(outline(RADIUS - 2.0 * RIM, Colour::WHITE));
    }
    shapes
}

/// Corners about the origin, of about equal area; y down.
fn corners(index: usize) -> Vec<[f64; 2]> {
    let around = |n: usize, turn: f64, sizes: [f64; 2]| -> Vec<[f64; 2]> {
        let corner = |i: usize| {
            let (angle, size) = (turn + TAU * i as f64 / n as f64, sizes[i % 2]);
            [size * libm::cos(angle), size * libm::sin(angle)]
        };
        (0..n).map(corner).collect()
    };
    let regular = |n: usize, turn: f64, size: f64| around(n, turn, [size; 2]);
    let star = |arms: usize, turn: f64| around(2 * arms, turn, [1.35, 0.55]);
    match index % 8 {
        0 => regular(24, 0.0, 0.9),
        1 => regular(4, PI / 4.0, 1.15),
        2 => regular(3, -PI / 2.0, 1.3),
        3 => regular(4, 0.0, 1.2),
        4 => regular(3, PI / 2.0, 1.3),
        5 => star(4, -PI / 2.0),
        6 => regular(6, 0.0, 1.05),
        _ => star(5, -PI / 2.0),
    }
}
