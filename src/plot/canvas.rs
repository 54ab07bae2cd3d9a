//! A small antialiased picture: f32 linear light, written as 8-bit sRGB.
//!
//! Coordinates are pixels, x right and y down, the centre of the top left pixel at (0.5, 0.5). Blending is done in
//! linear light; coverage is the area of the pixel under the stroke, so thin lines keep their weight at any angle.

use std::path::Path;

use crate::error::Result;
use crate::files::png::write_rgb8;
use crate::report::colour::Colour;

use super::chain::{contains, distance, distance_to_segment};
use super::coverage::{Footprint, covered, pixels};
use super::font;

/// Longest run of a stroke that is rasterised at once: keeps the boxes of oblique lines small.
const RUN_PX: f64 = 24.0;

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

impl Anchor {
    /// Part of the text to the left of the given point.
    fn share(self) -> f64 {
        match self {
            Self::Start => 0.0,
            Self::Middle => 0.5,
            Self::End => 1.0,
        }
    }
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
        // No corners at all give an empty range.
        let clip = self.clip;
        let range = |k: usize| {
            let least = corners.iter().map(|c| c[k]).fold(f64::INFINITY, f64::min);
            let most = corners.iter().map(|c| c[k]).fold(f64::NEG_INFINITY, f64::max);
            pixels(least, most, clip[k], clip[k + 2])
        };
        let at = |pixel: usize, i: usize| pixel as f64 + (i as f64 + 0.5) / SAMPLES as f64;
        for y in range(1) {
            for x in range(0) {
                let samples = (0..SAMPLES * SAMPLES).map(|i| [at(x, i % SAMPLES), at(y, i / SAMPLES)]);
                let inside = samples.filter(|p| contains(corners, *p)).count();
                self.blend(y * self.width + x, colour, inside as f32 / (SAMPLES * SAMPLES) as f32);
            }
        }
    }

    /// Fills the area within closed loops, even-odd: 8 rows a pixel, exact along them.
    pub fn region(&mut self, loops: &[Vec<[f64; 2]>], colour: Colour) {
        const ROWS: usize = 8;
        let is_finite = |chain: &&Vec<[f64; 2]>| chain.iter().flatten().all(|c| c.is_finite());
        let edges: Vec<([f64; 2], [f64; 2])> = loops
            .iter()
            .filter(is_finite)
            .flat_map(|chain| chain.iter().copied().zip(chain.iter().copied().cycle().skip(1)))
            .collect();
        let clip = self.clip;
        // The edges that each row of pixels meets.
        let mut of_row: Vec<Vec<usize>> = vec![Vec::new(); self.height];
        for (i, (a, b)) in edges.iter().enumerate() {
            pixels(a[1].min(b[1]), a[1].max(b[1]), clip[1], clip[3]).for_each(|y| of_row[y].push(i));
        }
        let mut shares = vec![0.0; self.width];
        for (y, met) in of_row.iter().enumerate().filter(|(_, met)| !met.is_empty()) {
            for row in 0..ROWS {
                let at = y as f64 + (row as f64 + 0.5) / ROWS as f64;
                let crossing = |&i: &usize| {
                    let (a, b) = edges[i];
                    let crosses = (a[1] > at) != (b[1] > at);
                    crosses.then(|| a[0] + (at - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
                };
                let mut crossed: Vec<f64> = met.iter().filter_map(crossing).collect();
                crossed.sort_unstable_by(f64::total_cmp);
                for span in crossed.chunks_exact(2) {
                    for (x, share) in covered(span[0], span[1], clip[0], clip[2]) {
                        shares[x] += share / ROWS as f64;
                    }
                }
            }
            for (x, share) in shares.iter_mut().enumerate().filter(|(_, share)| **share > 0.0) {
                self.blend(y * self.width + x, colour, *share as f32);
                *share = 0.0;
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

    /// Upright text with its baseline at `y`, sharp on the pixel grid.
    pub fn text(&mut self, [x, y]: [f64; 2], text: &str, style: &TextStyle) {
        let width = font::width_px(text, style.size_px, true);
        let start = (x - width * style.anchor.share()).round() + 0.5;
        let baseline = (y - 0.5).round() + 0.5;
        for stroke in font::strokes(text, style.size_px, true) {
            let points: Vec<_> = stroke.points.iter().map(|p| [start + p[0], baseline + p[1]]).collect();
            self.cover_chain(&points, stroke.width_px * style.weight);
        }
        self.ink(style.colour, 1.0);
    }

    /// Text turned about its anchor on the baseline by an angle in radians, clockwise on the screen. Strokes wider by two rims
    /// lift text that is drawn over them from what lies under it.
    pub fn text_rotated(&mut self, at: [f64; 2], angle: f64, text: &str, style: &TextStyle, rim_px: f64) {
        let (sin, cos) = (libm::sin(angle), libm::cos(angle));
        let shift = font::width_px(text, style.size_px, false) * style.anchor.share();
        for stroke in font::strokes(text, style.size_px, false) {
            let place = |p: &[f64; 2]| {
                let [x, y] = [p[0] - shift, p[1]];
                [at[0] + x * cos - y * sin, at[1] + x * sin + y * cos]
            };
            let points: Vec<_> = stroke.points.iter().map(place).collect();
            self.cover_chain(&points, stroke.width_px * style.weight + 2.0 * rim_px);
        }
        self.ink(style.colour, 1.0);
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
        let range = |k: usize, clip: [usize; 4]| {
            pixels(from[k].min(to[k]) - reach, from[k].max(to[k]) + reach, clip[k], clip[k + 2])
        };
        for y in range(1, self.clip) {
            for x in range(0, self.clip) {
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

#[cfg(test)]
mod tests;
