//! A small antialiased picture: f32 linear light, written as 8-bit sRGB.
//!
//! Coordinates are pixels, x right and y down, the centre of the top left pixel at (0.5, 0.5). Blending is done in
//! linear light; coverage is the area of the pixel under the stroke, so thin lines keep their weight at any angle.

use std::path::Path;
use std::sync::OnceLock;

use crate::error::Result;
use crate::files::png::write_rgb8;
use crate::plot::font;

/// Longest run of a stroke that is rasterised at once: keeps the boxes of oblique lines small.
const RUN_PX: f64 = 24.0;

/// A colour in linear light, sRGB primaries, nominally 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Colour(pub [f32; 3]);

impl Colour {
    /// White.
    pub const WHITE: Self = Self([1.0; 3]);
    /// Black.
    pub const BLACK: Self = Self([0.0; 3]);

    /// The colour of an 8-bit sRGB triple.
    pub fn srgb(red: u8, green: u8, blue: u8) -> Self {
        Self([red, green, blue].map(|c| srgb_to_linear(f64::from(c) / 255.0) as f32))
    }

    /// A grey of this 8-bit sRGB value.
    pub fn grey(value: u8) -> Self {
        Self::srgb(value, value, value)
    }

    /// The nearest 8-bit sRGB triple.
    pub fn to_srgb(self) -> [u8; 3] {
        self.0.map(encode)
    }
}

/// sRGB transfer function, IEC 61966-2-1: encoded value to linear light.
fn srgb_to_linear(value: f64) -> f64 {
    if value <= 0.04045 { value / 12.92 } else { libm::pow((value + 0.055) / 1.055, 2.4) }
}

/// 8-bit code of a linear value: the number of code boundaries at or below it.
fn encode(linear: f32) -> u8 {
    static BOUNDARIES: OnceLock<[f32; 255]> = OnceLock::new();
    let boundaries =
        BOUNDARIES.get_or_init(|| std::array::from_fn(|i| srgb_to_linear((i as f64 + 0.5) / 255.0) as f32));
    boundaries.partition_point(|&boundary| boundary <= linear) as u8
}

/// Where the given point lies in a line of text.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Anchor {
    /// At its left end.
    Start,
    /// At its middle.
    Middle,
    /// At its right end.
    End,
}

/// How text is drawn.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TextStyle {
    /// Type size in pixels; capitals are 0.7 of it.
    pub size_px: f64,
    /// Its colour.
    pub colour: Colour,
    /// Where the given point lies in the text.
    pub anchor: Anchor,
    /// Pen width relative to the regular pen.
    pub weight: f64,
}

impl TextStyle {
    /// Regular text from its left end.
    pub fn new(size_px: f64, colour: Colour) -> Self {
        Self { size_px, colour, anchor: Anchor::Start, weight: 1.0 }
    }

    /// The same at another anchor.
    #[must_use]
    pub fn anchored(self, anchor: Anchor) -> Self {
        Self { anchor, ..self }
    }

    /// The same with another weight.
    #[must_use]
    pub fn weighing(self, weight: f64) -> Self {
        Self { weight, ..self }
    }
}

/// A picture in the making.
#[derive(Debug, Clone)]
pub struct Canvas {
    width: usize,
    height: usize,
    pixels: Vec<Colour>,
    /// x0, y0, x1, y1: strokes and text leave no ink outside.
    clip: [usize; 4],
    /// Coverage of the stroke being drawn; zero between strokes.
    mask: Vec<f32>,
    /// Pixels whose mask is not zero.
    touched: Vec<usize>,
}

impl Canvas {
    /// A picture of one colour; both sides are made at least one pixel.
    pub fn new(width: usize, height: usize, background: Colour) -> Self {
        let (width, height) = (width.max(1), height.max(1));
        Self {
            width,
            height,
            pixels: vec![background; width * height],
            clip: [0, 0, width, height],
            mask: vec![0.0; width * height],
            touched: Vec::new(),
        }
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The colour of a pixel; black outside.
    pub fn pixel(&self, x: usize, y: usize) -> Colour {
        if x < self.width && y < self.height { self.pixels[y * self.width + x] } else { Colour::BLACK }
    }

    /// Sets a pixel, if it is inside.
    pub fn set_pixel(&mut self, x: usize, y: usize, colour: Colour) {
        if x < self.width && y < self.height {
            self.pixels[y * self.width + x] = colour;
        }
    }

    /// Draws with everything outside the rectangle x0, y0, x1, y1 (pixels, right and bottom excluded) protected.
    pub fn clipped(&mut self, [x0, y0, x1, y1]: [usize; 4], draw: impl FnOnce(&mut Self)) {
        let before = self.clip;
        self.clip = [x0, y0, x1.min(self.width), y1.min(self.height)];
        draw(self);
        self.clip = before;
    }

    /// Fills the rectangle x, y, width, height exactly: edges between pixels get their share.
    pub fn rect(&mut self, [x, y, width, height]: [f64; 4], colour: Colour) {
        let columns = covered(x, x + width, self.clip[0], self.clip[2]);
        let rows = covered(y, y + height, self.clip[1], self.clip[3]);
        for (row, share_y) in rows {
            for &(column, share_x) in &columns {
                self.blend(row * self.width + column, colour, (share_x * share_y) as f32);
            }
        }
    }

    /// Fills a polygon, even-odd, by 8 x 8 samples a pixel; meant for markers, not for large areas.
    pub fn polygon(&mut self, corners: &[[f64; 2]], colour: Colour) {
        const SAMPLES: usize = 8;
        if corners.iter().flatten().any(|c| !c.is_finite()) {
            return;
        }
        let range = |k: usize, low: usize, high: usize| {
            let least = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
            let most = corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
            // Casts saturate, so no corners at all give an empty range.
            (least.floor() as usize).max(low)..(most.ceil().max(0.0) as usize).min(high)
        };
        let at = |pixel: usize, i: usize| pixel as f64 + (i as f64 + 0.5) / SAMPLES as f64;
        for y in range(1, self.clip[1], self.clip[3]) {
            for x in range(0, self.clip[0], self.clip[2]) {
                let samples = (0..SAMPLES * SAMPLES).map(|i| [at(x, i % SAMPLES), at(y, i / SAMPLES)]);
                let inside = samples.filter(|p| contains(corners, *p)).count();
                self.blend(y * self.width + x, colour, inside as f32 / (SAMPLES * SAMPLES) as f32);
            }
        }
    }

    /// A straight line of this width with round ends.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], width_px: f64, colour: Colour) {
        self.polyline(&[from, to], width_px, colour, 1.0);
    }

    /// A chain of lines with round joints; where it crosses itself it is not darker. A single point is a dot.
    pub fn polyline(&mut self, points: &[[f64; 2]], width_px: f64, colour: Colour, opacity: f64) {
        self.cover_chain(points, width_px);
        self.ink(colour, opacity);
    }

    /// An arc of a circle; angles in radians, from +x towards +y, that is clockwise on the screen.
    pub fn arc(
        &mut self,
        centre: [f64; 2],
        radius: f64,
        [from, to]: [f64; 2],
        width_px: f64,
        colour: Colour,
    ) {
        self.polyline(&arc_points(centre, radius, [from, to]), width_px, colour, 1.0);
    }

    /// Upright text with its baseline at `y`, sharp on the pixel grid.
    pub fn text(&mut self, [x, y]: [f64; 2], text: &str, style: &TextStyle) {
        let width = font::width_px(text, style.size_px, true);
        let start = (x - width * anchor_share(style.anchor)).round() + 0.5;
        let baseline = (y - 0.5).round() + 0.5;
        for stroke in font::strokes(text, style.size_px, true) {
            let points: Vec<_> = stroke.points.iter().map(|p| [start + p[0], baseline + p[1]]).collect();
            self.cover_chain(&points, stroke.width_px * style.weight);
        }
        self.ink(style.colour, 1.0);
    }

    /// Text turned about its anchor on the baseline by an angle in radians, clockwise on the screen.
    pub fn text_rotated(&mut self, at: [f64; 2], angle: f64, text: &str, style: &TextStyle) {
        self.rotated_strokes(at, angle, text, style, 0.0);
        self.ink(style.colour, 1.0);
    }

    /// A rim of `rim_px` around the text that [`Canvas::text_rotated`] draws, to lift it from what lies under it.
    pub fn text_halo(&mut self, at: [f64; 2], angle: f64, text: &str, style: &TextStyle, rim_px: f64) {
        self.rotated_strokes(at, angle, text, style, 2.0 * rim_px);
        self.ink(style.colour, 1.0);
    }

    fn rotated_strokes(&mut self, at: [f64; 2], angle: f64, text: &str, style: &TextStyle, extra_px: f64) {
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let shift = font::width_px(text, style.size_px, false) * anchor_share(style.anchor);
        for stroke in font::strokes(text, style.size_px, false) {
            let place = |p: &[f64; 2]| {
                let [x, y] = [p[0] - shift, p[1]];
                [at[0] + x * cos - y * sin, at[1] + x * sin + y * cos]
            };
            let points: Vec<_> = stroke.points.iter().map(place).collect();
            self.cover_chain(&points, stroke.width_px * style.weight + extra_px);
        }
    }

    /// 8-bit sRGB bytes, three a pixel, rows from the top.
    pub fn to_srgb_bytes(&self) -> Vec<u8> {
        self.pixels.iter().flat_map(|pixel| pixel.to_srgb()).collect()
    }

    /// Writes a PNG; the same picture gives the same bytes.
    ///
    /// # Errors
    /// [`crate::error::Kind::Io`] with the path; an older file of that name then stands as it was.
    pub fn write_png(&self, path: impl AsRef<Path>) -> Result<()> {
        write_rgb8(path, self.width, self.height, &self.to_srgb_bytes())
    }

    fn blend(&mut self, index: usize, colour: Colour, share: f32) {
        let share = share.clamp(0.0, 1.0);
        for (old, new) in self.pixels[index].0.iter_mut().zip(colour.0) {
            *old = *old * (1.0 - share) + new * share;
        }
    }

    /// Turns the collected coverage into colour and clears it.
    fn ink(&mut self, colour: Colour, opacity: f64) {
        let mut touched = std::mem::take(&mut self.touched);
        for &index in &touched {
            let share = self.mask[index] * opacity as f32;
            self.mask[index] = 0.0;
            self.blend(index, colour, share);
        }
        touched.clear();
        self.touched = touched;
    }

    fn cover_chain(&mut self, points: &[[f64; 2]], width_px: f64) {
        if let [point] = points {
            self.cover_segment(*point, *point, width_px);
        }
        for pair in points.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let length = distance(from, to);
            if !length.is_finite() || length > 1e6 {
                continue;
            }
            let runs = (length / RUN_PX).ceil().max(1.0);
            let at =
                |i: f64| [from[0] + (to[0] - from[0]) * i / runs, from[1] + (to[1] - from[1]) * i / runs];
            for run in 0..runs as usize {
                self.cover_segment(at(run as f64), at(run as f64 + 1.0), width_px);
            }
        }
    }

    /// Coverage of one round-ended segment: the largest so far wins, so joints are not inked twice.
    fn cover_segment(&mut self, from: [f64; 2], to: [f64; 2], width_px: f64) {
        let half = 0.5 * width_px;
        let footprint = Footprint::across(from, to);
        let reach = half + footprint.half_width();
        let range = |a: f64, b: f64, low: usize, high: usize| {
            // Casts saturate: whatever lies left of the picture becomes 0.
            let first = ((a.min(b) - reach).floor() as usize).max(low);
            (first, ((a.max(b) + reach).ceil().max(0.0) as usize).min(high))
        };
        let (x0, x1) = range(from[0], to[0], self.clip[0], self.clip[2]);
        let (y0, y1) = range(from[1], to[1], self.clip[1], self.clip[3]);
        for y in y0..y1 {
            for x in x0..x1 {
                let d = distance_to_segment([x as f64 + 0.5, y as f64 + 0.5], from, to);
                let cover = (footprint.below(d + half) - footprint.below(d - half)) as f32;
                let index = y * self.width + x;
                if cover > self.mask[index] {
                    if self.mask[index] == 0.0 {
                        self.touched.push(index);
                    }
                    self.mask[index] = cover;
                }
            }
        }
    }
}

/// Whether a ray from the point to the right crosses the polygon's outline an odd number of times.
fn contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossed = edges
        .filter(|(a, b)| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    crossed.count() % 2 == 1
}

/// The chain of points of an arc, fine enough for a pixel grid; angles as in [`Canvas::arc`].
pub fn arc_points(centre: [f64; 2], radius: f64, [from, to]: [f64; 2]) -> Vec<[f64; 2]> {
    let steps = ((to - from).abs() * radius.abs().max(1.0).sqrt() * 2.0).ceil().clamp(4.0, 2000.0);
    let point = |i: usize| {
        let angle = from + (to - from) * i as f64 / steps;
        [centre[0] + radius * libm::cos(angle), centre[1] + radius * libm::sin(angle)]
    };
    (0..=steps as usize).map(point).collect()
}

/// The inked pieces of a dashed line of `on` pixels ink and `off` pixels gap, measured along the chain.
pub fn dashes(points: &[[f64; 2]], [on, off]: [f64; 2]) -> Vec<Vec<[f64; 2]>> {
    let mut pieces: Vec<Vec<[f64; 2]>> = Vec::new();
    let (mut inked, mut left) = (true, on);
    let mut piece: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    for pair in points.windows(2) {
        let (mut from, to) = (pair[0], pair[1]);
        let mut length = distance(from, to);
        while length > left && left > 0.0 {
            let share = left / length;
            from = [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share];
            piece.push(from);
            if inked {
                pieces.push(std::mem::take(&mut piece));
            }
            length -= left;
            inked = !inked;
            left = if inked { on } else { off };
            piece = vec![from];
        }
        left -= length;
        piece.push(to);
    }
    if inked && piece.len() > 1 {
        pieces.push(piece);
    }
    pieces
}

/// A pixel square seen along a line: a trapezium, the convolution of the two sides' projections. Its integral gives the
/// exact share of the pixel that a long straight stroke covers.
struct Footprint {
    /// Longer and shorter projection of a side on the line's normal.
    long: f64,
    short: f64,
}

impl Footprint {
    fn across(from: [f64; 2], to: [f64; 2]) -> Self {
        let length = distance(from, to);
        if length == 0.0 {
            return Self { long: 1.0, short: 0.0 };
        }
        let (a, b) = (((to[0] - from[0]) / length).abs(), ((to[1] - from[1]) / length).abs());
        Self { long: a.max(b), short: a.min(b) }
    }

    fn half_width(&self) -> f64 {
        0.5 * (self.long + self.short)
    }

    /// Share of the pixel on the near side of a line at this signed distance from its centre.
    fn below(&self, distance: f64) -> f64 {
        let t = distance.abs();
        let share = if t <= 0.5 * (self.long - self.short) {
            t / self.long
        } else if t < self.half_width() {
            let rest = self.half_width() - t;
            0.5 - rest * rest / (2.0 * self.long * self.short)
        } else {
            0.5
        };
        if distance < 0.0 { 0.5 - share } else { 0.5 + share }
    }
}

fn anchor_share(anchor: Anchor) -> f64 {
    match anchor {
        Anchor::Start => 0.0,
        Anchor::Middle => 0.5,
        Anchor::End => 1.0,
    }
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    (dx * dx + dy * dy).sqrt()
}

fn distance_to_segment(p: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let square = dx * dx + dy * dy;
    let along = if square > 0.0 {
        (((p[0] - from[0]) * dx + (p[1] - from[1]) * dy) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(p, [from[0] + along * dx, from[1] + along * dy])
}

/// Pixels of [low, high) that the interval from `a` to `b` touches, each with the share it covers.
fn covered(a: f64, b: f64, low: usize, high: usize) -> Vec<(usize, f64)> {
    let first = (a.floor() as usize).max(low);
    let last = (b.ceil().max(0.0) as usize).min(high);
    (first..last).map(|i| (i, (b.min(i as f64 + 1.0) - a.max(i as f64)).clamp(0.0, 1.0))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Ink on a white picture drawn black, in pixel areas.
    fn ink(canvas: &Canvas) -> f64 {
        canvas.pixels.iter().map(|p| 1.0 - f64::from(p.0[0])).sum()
    }

    #[test]
    fn codes_round_trip_and_are_nearest() {
        for code in 0..=255 {
            assert_eq!(Colour::grey(code).to_srgb(), [code; 3]);
        }
        // IEC 61966-2-1: linear 0.5 is 187.516 of 255, linear 0.0031308 is 10.31.
        assert_eq!(encode(0.5), 188);
        assert_eq!(encode(0.003_130_8), 10);
        assert_eq!((encode(-1.0), encode(2.0), encode(f32::NAN)), (0, 255, 0));
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
                assert!(inside || canvas.pixel(x, y) == Colour::WHITE, "{x} {y}");
            }
        }
        assert_eq!(canvas.pixel(15, 15), Colour::BLACK);
        assert_eq!(canvas.pixel(99, 0), Colour::BLACK);
    }

    #[test]
    fn text_of_eleven_pixels_has_sharp_stems_and_keeps_its_anchor() {
        let mut canvas = Canvas::new(60, 30, Colour::WHITE);
        canvas.text([4.0, 20.0], "l", &TextStyle::new(12.0, Colour::BLACK));
        let darkest = (0..60).map(|x| canvas.pixel(x, 15).0[0]).fold(1.0, f32::min);
        assert!(darkest < 0.05, "a stem is one dark pixel wide: {darkest}");
        for (anchor, first, last) in [(Anchor::Start, 30, 45), (Anchor::End, 15, 30)] {
            let mut canvas = Canvas::new(60, 30, Colour::WHITE);
            canvas.text([30.0, 20.0], "100", &TextStyle::new(11.0, Colour::BLACK).anchored(anchor));
            let inked = |x: &usize| (0..30).any(|y| canvas.pixel(*x, y).0[0] < 0.6);
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
    fn dashes_share_the_length() {
        let points = [[0.0, 0.0], [30.0, 0.0], [30.0, 40.0]];
        let pieces = dashes(&points, [5.0, 3.0]);
        let total: f64 =
            pieces.iter().flat_map(|p| p.windows(2).map(|w| distance(w[0], w[1])).collect::<Vec<_>>()).sum();
        // 70 = 8 periods of 8 and 6 more, of which 5 are ink.
        assert!((total - 45.0).abs() < 1e-9, "{total}");
        assert_eq!(pieces.len(), 9);
    }
}
