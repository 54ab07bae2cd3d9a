//! False-colour pictures against known values, and maps at the edge of what is a map.

use super::*;
use crate::files::png::read_rgb8;

fn picture(values: &[f64], width: usize, height: usize) -> FalseColour<'_> {
    FalseColour {
        title: "receiver",
        width,
        height,
        quantity: Quantity::Illuminance,
        values,
        axes: Axes::Metres([0.0, 0.0]),
        points: None,
        isolux: false,
        footer: vec![],
    }
}

/// A picture that was drawn, in 8-bit sRGB, and where in it map and colour scale lie.
struct Drawn {
    bytes: Vec<u8>,
    width: usize,
    height: usize,
    map: [usize; 4],
    bar: [usize; 4],
}

impl Drawn {
    fn new(picture: &FalseColour<'_>) -> Self {
        let (values, cells) = picture.map();
        let labels = bar_labels(&fit_map(values, cells));
        let layout = picture.layout(display_size(cells, picture.axes.size_m()), &labels);
        let canvas = picture.render();
        let (bytes, width) = (canvas.to_srgb_bytes(), canvas.width());
        Self { height: bytes.len() / (3 * width), bytes, width, map: layout.map, bar: layout.bar }
    }

    fn pixel(&self, x: usize, y: usize) -> [u8; 3] {
        let at = 3 * (y * self.width + x);
        [self.bytes[at], self.bytes[at + 1], self.bytes[at + 2]]
    }

    /// The colour in the middle of a cell of the displayed map.
    fn cell(&self, cells: [usize; 2], cell: [usize; 2]) -> [u8; 3] {
        let at = |k: usize| self.map[k] + (2 * cell[k] + 1) * self.map[k + 2] / (2 * cells[k]);
        self.pixel(at(0), at(1))
    }
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
    let drawn = Drawn::new(&picture(&values, 3, 2));
    for (i, value) in values.iter().enumerate() {
        let expected = if value.is_nan() { [160; 3] } else { colour(value / 400.0).to_srgb() };
        assert_eq!(drawn.cell([3, 2], [i % 3, i / 3]), expected, "{value} lx");
    }
}

#[test]
fn the_colour_scale_shows_the_colours_of_its_ticks() {
    let linear: Vec<f64> = (0..400).map(|i| 2.0 + i as f64).collect();
    let log: Vec<f64> = (0..400).map(|i| 10f64.powf(i as f64 / 100.0)).collect();
    for values in [linear, log] {
        let drawn = Drawn::new(&picture(&values, 20, 20));
        let ([left, top, width, height], axis) = (drawn.bar, Axis::fit(&values));
        assert_eq!(axis.log, values[0] == 1.0);
        for tick in &axis.ticks {
            // One row beside the place of the tick, which may be the border.
            let from_top = (1.0 - axis.place(tick.value)) * height as f64;
            let row = (from_top as usize).min(height - 1);
            let shown = drawn.pixel(left + width / 2, top + row);
            let expected = colour(axis.place(tick.value)).to_srgb();
            for (a, b) in shown.iter().zip(expected) {
                assert!(a.abs_diff(b) <= 4, "{}: {shown:?} for {expected:?}", tick.label);
            }
        }
    }
}

#[test]
fn few_bright_cells_are_clipped_at_the_top_colour() {
    let mut values = vec![80.0; 100 * 100];
    values[5050] = 90_000.0;
    let drawn = Drawn::new(&picture(&values, 100, 100));
    assert_eq!(drawn.cell([100, 100], [3, 3]), colour(1.0).to_srgb());
    assert_eq!(drawn.cell([100, 100], [50, 50]), colour(1.0).to_srgb());
}

#[test]
fn isolux_lines_of_a_cone_are_circles_of_the_right_radius() {
    // A cone of light: 1000 lx in the middle, 100 lx less every 10 cells; 2 displayed pixels a cell, no smoothing.
    let n = 400;
    let at = |i: usize| (i as f64 + 0.5) - 200.0;
    let values: Vec<f64> = (0..n * n)
        .map(|i| (1000.0 - 10.0 * (at(i % n) * at(i % n) + at(i / n) * at(i / n)).sqrt()).max(0.0))
        .collect();
    let axis = Axis::fit(&values);
    let display = display_size([n, n], None);
    assert_eq!(display, [800, 800]);
    let found = isolux(&values, [n, n], display, &axis, true);
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
    let found = isolux(&values, [n, n], display, &Axis::fit(&values), true);
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
    let found = isolux(&values, [n, n], display, &Axis::fit(&values), true);
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
    for (cells, axes, display) in [
        ([64, 64], Axes::None, [704, 704]),
        ([512, 256], Axes::None, [1024, 512]),
        ([650, 650], Axes::None, [650, 650]),
        ([1000, 900], Axes::None, [1000, 900]),
        ([2400, 1200], Axes::None, [1200, 600]),
        ([1, 1], Axes::None, [700, 700]),
        ([1, 500], Axes::None, [48, 1000]),
        ([100, 100], Axes::Metres([2.0, 1.0]), [700, 350]),
        ([100, 100], Axes::Metres([f64::NAN, 1.0]), [700, 700]),
        ([100, 100], Axes::Metres([1e-300, 1e300]), [700, 700]),
    ] {
        assert_eq!(display_size(cells, axes.size_m()), display, "{cells:?} {axes:?}");
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
        for axes in
            [Axes::None, Axes::Sphere, Axes::Round, Axes::Metres([0.5, 2.0]), Axes::Metres([0.0, f64::NAN])]
        {
            let drawn = Drawn::new(&FalseColour {
                isolux: true,
                axes,
                footer: vec!["word ".repeat(60), "x".repeat(300)],
                title: &"long title ".repeat(30),
                ..picture(values, width, height)
            });
            let all_in =
                drawn.map[0] + drawn.map[2] < drawn.width && drawn.map[1] + drawn.map[3] < drawn.height;
            assert!(all_in && drawn.width < 1500 && drawn.height < 1700, "{name}");
            // The outermost pixels stay white: no text or line is cut off by the edge.
            let white = |x, y| drawn.pixel(x, y) == [255; 3];
            let (right, bottom) = (drawn.width - 1, drawn.height - 1);
            assert!((0..=right).all(|x| white(x, 0) && white(x, bottom)), "{name}");
            assert!((0..=bottom).all(|y| white(0, y) && white(right, y)), "{name}");
        }
    }
}

#[test]
fn what_is_typical_does_not_depend_on_how_few_photons_a_cell_got() {
    // One cell in 16 holds a photon worth 800 lx, a small spot holds 50 of them: 50 lx is typical, not 800.
    let n = 512;
    let mut values = vec![0.0; n * n];
    for i in (0..n * n).filter(|i| i % n % 4 == 0 && i / n % 4 == 0) {
        values[i] = 800.0;
    }
    for i in 0..n * 20 {
        values[i / 40 * n + i % 40] = 40_000.0;
    }
    assert!(fit_map(&values, [n, n]).log);
    assert!(!fit_map(&vec![50.0; n * n], [n, n]).log);
}

#[test]
fn the_png_holds_the_picture_and_is_the_same_every_time() {
    let directory = tempfile::tempdir().unwrap();
    let values: Vec<f64> = (0..100 * 80).map(|i| noise(i) * 500.0).collect();
    let map = FalseColour { isolux: true, axes: Axes::Metres([1.0, 0.8]), ..picture(&values, 100, 80) };
    let paths = [directory.path().join("a.png"), directory.path().join("b.png")];
    for path in &paths {
        map.render().write_png(path).unwrap();
    }
    assert!(std::fs::read(&paths[0]).unwrap() == std::fs::read(&paths[1]).unwrap());
    let (size, bytes) = read_rgb8(&paths[0]);
    let drawn = Drawn::new(&map);
    assert_eq!(size, [drawn.width, drawn.height]);
    assert!(bytes == drawn.bytes);
}
