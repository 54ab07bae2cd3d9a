//! A stroke font of our own: printable ASCII, the degree sign, superscript 2 and a few signs of measurement.
//!
//! Glyphs are pen strokes in units of a twentieth of the type size: baseline 0, x-height 10, capitals and digits 14,
//! descenders -4, y upwards. Digits share one width so that columns of numbers stand still. Upright text is fitted
//! to the pixel grid: heights, glyph widths and advances are whole pixels, which keeps stems sharp at 11 px.

use std::f64::consts::PI;

use super::glyphs::Stroke::{self, A, D, L};
use super::glyphs::glyph;

/// Units of the glyph tables per type size.
const UNITS_PER_EM: f64 = 20.0;
/// Free space after each glyph box, units.
const SPACING: f64 = 3.3;
/// Width of a regular pen, units.
const PEN: f64 = 1.8;

/// Part of a line of text laid out in pixels, origin at the pen's start, y downwards.
#[derive(Debug, Clone, PartialEq)]
pub struct PenStroke {
    /// The chain of points, at least one; a single point is a dot.
    pub points: Vec<[f64; 2]>,
    /// Pen width in pixels.
    pub width_px: f64,
}

/// Width of a regular pen at this type size, in pixels; never less than one, which would be grey.
pub fn pen_width_px(size_px: f64) -> f64 {
    (size_px * PEN / UNITS_PER_EM).max(1.0)
}

/// Width of a line of text in pixels; `hinted` as in [`strokes`].
pub fn width_px(text: &str, size_px: f64, hinted: bool) -> f64 {
    let advances: f64 = text.chars().map(|c| advance(c, size_px, hinted)).sum();
    // The space after the last glyph belongs to nobody.
    (advances - SPACING * size_px / UNITS_PER_EM).max(0.0)
}

/// The strokes of a line of text that starts at the origin. `hinted` fits glyphs to whole pixels: for upright text
/// whose origin lies on a pixel centre.
pub fn strokes(text: &str, size_px: f64, hinted: bool) -> Vec<PenStroke> {
    let mut pen_x = 0.0;
    let mut laid = Vec::new();
    for c in text.chars() {
        let (width, glyph_strokes) = lookup(c);
        for stroke in glyph_strokes {
            let (points, wider) = flatten(stroke);
            let points = points
                .iter()
                .map(|&(x, y)| [pen_x + fit_x(x, width, size_px, hinted), -fit_y(y, size_px, hinted)]);
            laid.push(PenStroke { points: points.collect(), width_px: pen_width_px(size_px) * wider });
        }
        pen_x += advance(c, size_px, hinted);
    }
    laid
}

/// The text, or as much of it as fits the room with `dots` at its end.
pub fn shortened(text: &str, size_px: f64, room_px: f64, dots: &str) -> String {
    if width_px(text, size_px, true) <= room_px {
        return text.to_owned();
    }
    let mut short = String::new();
    for c in text.chars() {
        if width_px(&format!("{short}{c}{dots}"), size_px, true) > room_px {
            break;
        }
        short.push(c);
    }
    short + dots
}

/// Lines that fit the room: text that is too long is broken between words.
pub fn wrapped(text: &str, size_px: f64, room_px: f64) -> Vec<String> {
    if width_px(text, size_px, true) <= room_px {
        return vec![text.to_owned()];
    }
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if width_px(&format!("{line} {word}"), size_px, true) <= room_px => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

fn advance(c: char, size_px: f64, hinted: bool) -> f64 {
    let (width, _) = lookup(c);
    let unit = size_px / UNITS_PER_EM;
    if hinted { (width * unit).round() + (SPACING * unit).round().max(1.0) } else { (width + SPACING) * unit }
}

fn fit_x(x: f64, width: f64, size_px: f64, hinted: bool) -> f64 {
    let unit = size_px / UNITS_PER_EM;
    if hinted && width > 0.0 { x / width * (width * unit).round() } else { x * unit }
}

/// Baseline, x-height, capitals and descenders fall on whole pixels; what lies between is interpolated.
fn fit_y(y: f64, size_px: f64, hinted: bool) -> f64 {
    let unit = size_px / UNITS_PER_EM;
    if !hinted {
        return y * unit;
    }
    let zones = [-4.0, 0.0, 10.0, 14.0];
    let zone = if y < 0.0 {
        0
    } else if y <= 10.0 {
        1
    } else {
        2
    };
    let (low, high) = (zones[zone], zones[zone + 1]);
    let (low_px, high_px) = ((low * unit).round(), (high * unit).round());
    low_px + (y - low) / (high - low) * (high_px - low_px)
}

/// A stroke as a chain of points and how much wider than the pen it is.
fn flatten(stroke: &Stroke) -> (Vec<(f64, f64)>, f64) {
    match *stroke {
        L(points) => (points.to_vec(), 1.0),
        D(x, y) => (vec![(x, y)], 1.3),
        A(cx, cy, rx, ry, from, to) => {
            let steps = ((to - from).abs() / 12.0).ceil().max(1.0);
            let point = |i: usize| {
                let angle = (from + (to - from) * i as f64 / steps) * (PI / 180.0);
                (cx + rx * libm::cos(angle), cy + ry * libm::sin(angle))
            };
            ((0..=steps as usize).map(point).collect(), 1.0)
        }
    }
}

fn lookup(c: char) -> (f64, &'static [Stroke]) {
    glyph(c)
        .or_else(|| glyph(plain_letter(c)))
        .unwrap_or((7.0, &[L(&[(0.0, 0.0), (7.0, 0.0), (7.0, 14.0), (0.0, 14.0), (0.0, 0.0)])]))
}

/// Letters with the commonest accents, and typographers' signs; in [`PLAIN`] what is drawn instead of each.
const ACCENTED: &str = "àáâãäåèéêëìíîïòóôõöøùúûüÀÁÂÃÄÅÈÉÊËÌÍÎÏÒÓÔÕÖØÙÚÛÜçÇñÑ\u{a0}\t\u{2018}\u{2019}\u{201c}\u{201d}\u{2014}\u{2212}";
const PLAIN: &str = "aaaaaaeeeeiiiioooooouuuuAAAAAAEEEEIIIIOOOOOOUUUUcCnN  ''\"\"––";

/// The letter under an accent, so that names in labels stay readable.
fn plain_letter(c: char) -> char {
    ACCENTED.chars().zip(PLAIN.chars()).find(|(accented, _)| *accented == c).map_or(c, |(_, plain)| plain)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn covers_printable_ascii_and_the_signs_of_our_units() {
        for c in (' '..='~').chain(['°', '²', '±', '×', 'µ', '·', '–']) {
            assert!(glyph(c).is_some(), "no glyph for {c:?}");
            let inked = !strokes(&c.to_string(), 12.0, true).is_empty();
            assert_eq!(inked, c != ' ', "{c:?}");
        }
        assert!(glyph('\u{4e2d}').is_none());
        assert!(!strokes("\u{4e2d}", 12.0, true).is_empty(), "unknown characters show as a box");
        assert_eq!(strokes("ü", 12.0, true), strokes("u", 12.0, true));
    }

    #[test]
    fn glyphs_differ_and_stay_in_their_box() {
        let mut seen: Vec<(char, Vec<PenStroke>)> = Vec::new();
        for c in '!'..='~' {
            let drawn = strokes(&c.to_string(), UNITS_PER_EM, false);
            for [x, y] in drawn.iter().flat_map(|s| s.points.iter().copied()) {
                let (width, _) = lookup(c);
                assert!((-0.06..=width + 0.06).contains(&x), "{c:?}: x = {x} of {width}");
                assert!((-16.0..=4.0).contains(&y), "{c:?}: y = {y}");
            }
            for (other, strokes) in &seen {
                assert_ne!(strokes, &drawn, "{c:?} looks like {other:?}");
            }
            seen.push((c, drawn));
        }
    }

    #[test]
    fn digits_share_one_width_and_widths_add_up() {
        for size in [11.0, 12.5, 14.0, 20.0] {
            for hinted in [false, true] {
                let zero = width_px("0", size, hinted);
                for digit in '1'..='9' {
                    assert_eq!(width_px(&digit.to_string(), size, hinted), zero);
                }
                let gap = width_px("00", size, hinted) - 2.0 * zero;
                assert!(gap > 0.0 && gap < zero);
            }
        }
        assert_eq!(width_px("", 12.0, true), 0.0);
    }

    #[test]
    fn hinted_heights_are_whole_pixels() {
        for size in [11.0, 12.0, 13.0, 14.0, 17.0] {
            for y in [-4.0, 0.0, 10.0, 14.0] {
                let px = fit_y(y, size, true);
                assert_eq!(px, px.round());
                assert!((px - y * size / UNITS_PER_EM).abs() <= 0.5);
            }
        }
    }
}
