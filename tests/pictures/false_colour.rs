//! False-colour pictures against known values, and maps at the edge of what is a map.

use caustix::plot::canvas::{Canvas, Colour};
use caustix::plot::colour_map::{colour, no_value};
use caustix::plot::false_colour::{FalseColour, Quantity, display_size};
use caustix::plot::isolux::isolux;
use caustix::plot::scale::{Axis, Scale};

fn picture(values: &[f64], width: usize, height: usize, scale: Scale) -> FalseColour<'_> {
    FalseColour {
        title: "receiver",
        width,
        height,
        quantity: Quantity::Illuminance,
        values,
        size_m: None,
        scale,
        isolux: false,
        footer: vec![],
    }
}

/// The colour in the middle of a cell of the displayed map.
fn cell_colour(canvas: &Canvas, area: [usize; 4], cells: [usize; 2], cell: [usize; 2]) -> Colour {
    let at = |k: usize| area[k] + (2 * cell[k] + 1) * area[k + 2] / (2 * cells[k]);
    canvas.pixel(at(0), at(1))
}

/// A number of [0, 1) for an index (SplitMix64's finaliser).
fn noise(index: u64) -> f64 {
    let mut z = index.wrapping_add(1).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    ((z ^ (z >> 31)) >> 11) as f64 / (1_u64 << 53) as f64
}

#[test]
fn cells_have_the_colour_of_their_value_and_rows_keep_their_order() {
    // The maximum 400 is its own round number: 0 to 400 lx.
    let values = [0.0, 100.0, 200.0, 300.0, 400.0, f64::NAN];
    let picture = picture(&values, 3, 2, Scale::Linear);
    let (canvas, [map, _]) = (picture.render(), picture.areas());
    for (i, value) in values.iter().enumerate() {
        let expected = if value.is_nan() { no_value() } else { colour(value / 400.0) };
        assert_eq!(cell_colour(&canvas, map, [3, 2], [i % 3, i / 3]), expected, "{value} lx");
    }
}

#[test]
fn the_colour_scale_shows_the_colours_of_its_ticks() {
    for scale in [Scale::Linear, Scale::Log] {
        let values: Vec<f64> = (0..400).map(|i| 2.0 + i as f64).collect();
        let picture = picture(&values, 20, 20, scale);
        let (canvas, [_, bar]) = (picture.render(), picture.areas());
        let axis = Axis::fit(&values, scale);
        for tick in &axis.ticks {
            // One row beside the place of the tick, which may be the border.
            let from_top = (1.0 - axis.place(tick.value)) * bar[3] as f64;
            let row = (from_top as usize).min(bar[3] - 1);
            let shown = canvas.pixel(bar[0] + bar[2] / 2, bar[1] + row).0;
            let expected = colour(axis.place(tick.value)).0;
            for (a, b) in shown.iter().zip(expected) {
                assert!((a - b).abs() < 0.02, "{scale:?} {}: {shown:?} for {expected:?}", tick.label);
            }
        }
    }
}

#[test]
fn bright_lines_are_clipped_at_the_top_colour_only_when_asked_or_automatic() {
    let mut values = vec![80.0; 100 * 100];
    values[5050] = 90_000.0;
    for (scale, share_of_background) in [(Scale::Auto, 1.0), (Scale::Linear, 80.0 / 100_000.0)] {
        let picture = picture(&values, 100, 100, scale);
        let (canvas, [map, _]) = (picture.render(), picture.areas());
        let background = cell_colour(&canvas, map, [100, 100], [3, 3]);
        assert_eq!(background, colour(share_of_background), "{scale:?}");
    }
}

#[test]
fn isolux_lines_of_a_cone_are_circles_of_the_right_radius() {
    // A cone of light: 1000 lx in the middle, 100 lx less every 10 cells; 2 displayed pixels a cell, no smoothing.
    let n = 400;
    let at = |i: usize| (i as f64 + 0.5) - 200.0;
    let values: Vec<f64> = (0..n * n)
        .map(|i| (1000.0 - 10.0 * (at(i % n) * at(i % n) + at(i / n) * at(i / n)).sqrt()).max(0.0))
        .collect();
    let axis = Axis::fit(&values, Scale::Linear);
    let display = display_size([n, n], None);
    assert_eq!(display, [800, 800]);
    let found = isolux(&values, [n, n], display, &axis);
    assert_eq!(found.smoothing, 0.0, "a smooth map is not smoothed further");
    let levels: Vec<f64> = found.lines.iter().map(|l| l.tick.value).collect();
    assert_eq!(levels, [200.0, 400.0, 600.0, 800.0]);
    for line in &found.lines {
        let radius_px = (1000.0 - line.tick.value) / 10.0 * 2.0;
        for p in line.pieces.iter().flatten() {
            let r = ((p[0] - 400.0).powi(2) + (p[1] - 400.0).powi(2)).sqrt();
            assert!((r - radius_px).abs() < 0.1, "{} lx: {r} px for {radius_px} px", line.tick.value);
        }
        let label = line.label.expect("a circle this large has room for its value");
        let r = ((label.centre[0] - 400.0).powi(2) + (label.centre[1] - 400.0).powi(2)).sqrt();
        assert!((r - radius_px).abs() < 3.0, "the value lies on its line");
        assert!(label.angle.abs() <= std::f64::consts::FRAC_PI_2);
    }
}

#[test]
fn isolux_lines_of_noise_are_smoothed_until_they_are_few_and_right() {
    // 100 lx at the left to 300 lx at the right, +-40 lx of noise: 200 lx lies in the middle.
    let n = 256;
    let values: Vec<f64> = (0..n * n)
        .map(|i| 100.0 + 200.0 * ((i % n) as f64 + 0.5) / n as f64 + 80.0 * (noise(i as u64) - 0.5))
        .collect();
    let display = display_size([n, n], None);
    let found = isolux(&values, [n, n], display, &Axis::fit(&values, Scale::Linear));
    assert!(found.smoothing > 0.0);
    let middle: Vec<_> = found.lines.iter().filter(|l| l.tick.value == 200.0).collect();
    assert_eq!(middle.len(), 1);
    let half = 0.5 * display[0] as f64;
    for p in middle[0].pieces.iter().flatten() {
        assert!((p[0] - half).abs() < 0.06 * display[0] as f64, "{p:?}");
    }
}

#[test]
fn labels_keep_off_each_other_and_inside_the_map() {
    let n = 300;
    let wave = |i: usize| 500.0 + 300.0 * ((i % n) as f64 / 25.0).sin() * ((i / n) as f64 / 31.0).cos();
    let values: Vec<f64> = (0..n * n).map(wave).collect();
    let display = display_size([n, n], None);
    let found = isolux(&values, [n, n], display, &Axis::fit(&values, Scale::Linear));
    let labels: Vec<_> = found.lines.iter().filter_map(|l| l.label).collect();
    assert!(labels.len() > 10, "{}", labels.len());
    for (i, a) in labels.iter().enumerate() {
        for (centre, side) in a.centre.iter().zip(display) {
            assert!(*centre > 12.0 && *centre < side as f64 - 12.0);
        }
        for b in &labels[..i] {
            let gap = ((a.centre[0] - b.centre[0]).powi(2) + (a.centre[1] - b.centre[1]).powi(2)).sqrt();
            assert!(gap > 25.0, "{gap}");
        }
    }
}

#[test]
fn maps_are_magnified_by_whole_factors_shown_as_they_are_or_averaged_down() {
    for (cells, size_m, display) in [
        ([64, 64], None, [704, 704]),
        ([512, 256], None, [1024, 512]),
        ([650, 650], None, [650, 650]),
        ([1000, 900], None, [1000, 900]),
        ([2400, 1200], None, [1200, 600]),
        ([1, 1], None, [700, 700]),
        ([1, 500], None, [48, 1000]),
        ([100, 100], Some([2.0, 1.0]), [700, 350]),
        ([100, 100], Some([f64::NAN, 1.0]), [700, 700]),
        ([100, 100], Some([1e-300, 1e300]), [700, 700]),
    ] {
        assert_eq!(display_size(cells, size_m), display, "{cells:?} {size_m:?}");
    }
}

#[test]
fn every_map_gives_a_picture() {
    let ramp: Vec<f64> = (0..1500).map(f64::from).collect();
    let mut spoiled = vec![3.0; 64];
    (spoiled[9], spoiled[10], spoiled[11]) = (f64::NAN, f64::INFINITY, -7.0);
    let huge: Vec<f64> = (0..64).map(|i| 1e300 * f64::from(i)).collect();
    let tiny: Vec<f64> = (0..64).map(|i| 5e-324 * f64::from(i)).collect();
    let cases: [(&str, &[f64], usize, usize); 11] = [
        ("one cell", &[5.0], 1, 1),
        ("row", &ramp, 1500, 1),
        ("column", &ramp, 1, 1500),
        ("constant", &[12.5; 256], 16, 16),
        ("zero", &[0.0; 256], 16, 16),
        ("NaN", &[f64::NAN; 256], 16, 16),
        ("spoiled", &spoiled, 8, 8),
        ("huge", &huge, 8, 8),
        ("tiny", &tiny, 8, 8),
        ("no cells", &[], 0, 0),
        ("sides that do not fit", &[1.0; 5], 2, 2),
    ];
    for (name, values, width, height) in cases {
        for scale in [Scale::Linear, Scale::Log, Scale::Auto] {
            for size_m in [None, Some([0.5, 2.0]), Some([0.0, f64::NAN])] {
                let map = FalseColour {
                    isolux: true,
                    size_m,
                    footer: vec!["word ".repeat(60), "x".repeat(300)],
                    title: &"long title ".repeat(30),
                    ..picture(values, width, height, scale)
                };
                let (canvas, [area, _]) = (map.render(), map.areas());
                let all_in = area[0] + area[2] < canvas.width() && area[1] + area[3] < canvas.height();
                assert!(all_in && canvas.width() < 1500 && canvas.height() < 1700, "{name} {scale:?}");
                // The outermost pixels stay white: no text or line is cut off by the edge.
                let white = |x, y| canvas.pixel(x, y) == Colour::WHITE;
                let (right, bottom) = (canvas.width() - 1, canvas.height() - 1);
                assert!((0..=right).all(|x| white(x, 0) && white(x, bottom)), "{name}");
                assert!((0..=bottom).all(|y| white(0, y) && white(right, y)), "{name}");
            }
        }
    }
}

#[test]
fn the_png_holds_the_picture_and_is_the_same_every_time() {
    let directory = tempfile::tempdir().unwrap();
    let values: Vec<f64> = (0..100 * 80).map(|i| noise(i) * 500.0).collect();
    let map =
        FalseColour { isolux: true, size_m: Some([1.0, 0.8]), ..picture(&values, 100, 80, Scale::Auto) };
    let paths = [directory.path().join("a.png"), directory.path().join("b.png")];
    for path in &paths {
        map.write_png(path).unwrap();
    }
    assert!(std::fs::read(&paths[0]).unwrap() == std::fs::read(&paths[1]).unwrap());
    let decoded = image::open(&paths[0]).unwrap().into_rgb8();
    let canvas = map.render();
    assert_eq!((decoded.width() as usize, decoded.height() as usize), (canvas.width(), canvas.height()));
    assert!(decoded.into_raw() == canvas.to_srgb_bytes());
}
