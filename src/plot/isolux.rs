//! Isolux lines for a picture: smoothed as little as legibility allows, with places for their values.

use crate::report::colour::scale::{Axis, Tick};

use super::chain::{along, distance, length};
use super::contour::level_lines;
use super::font;
use super::resample::{area_average, gaussian};

/// Type size of the values on the lines.
pub const LABEL_SIZE_PX: f64 = 11.0;
/// More samples than this along a side make no better line.
const GRID_LIMIT: usize = 600;
/// Shorter lines are specks.
const SHORTEST_PX: f64 = 60.0;
/// Shorter lines carry no value.
const SHORTEST_LABELLED_PX: f64 = 150.0;
/// Mean distance between lines below which a picture is a scribble.
const SPACING_PX: f64 = 24.0;
/// Smoothing that is tried, standard deviation as a share of the longer side.
const SMOOTHING: [f64; 8] = [0.0, 0.002, 0.004, 0.008, 0.012, 0.018, 0.027, 0.04];
/// Distance of the points along which a place for a value is sought.
const STEP_PX: f64 = 3.0;

/// An isolux line in pixels of the displayed map.
#[derive(Debug, Clone, PartialEq)]
pub struct IsoluxLine {
    /// Its value.
    pub tick: Tick,
    /// The pieces to ink: one, or those that leave room for the label.
    pub pieces: Vec<Vec<[f64; 2]>>,
    /// Where its value is written.
    pub label: Option<Label>,
}

/// Where a value is written along its line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Label {
    /// Middle of the text, half the height of a digit above its baseline.
    pub centre: [f64; 2],
    /// Angle of the baseline in radians, clockwise on the screen, between -90 and 90 degrees.
    pub angle: f64,
}

/// The lines of a map and how much it was smoothed for them.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Isolux {
    /// All lines, by level.
    pub lines: Vec<IsoluxLine>,
    /// Standard deviation of the Gaussian as a share of the map's longer displayed side; 0 for none.
    pub smoothing: f64,
}

/// Isolux lines at the scale's ticks of a map of `cells` that is displayed on `display` pixels.
pub fn isolux(
    values: &[f64],
    cells: [usize; 2],
    display: [usize; 2],
    axis: &Axis,
    have_labels: bool,
) -> Isolux {
    let mut levels: Vec<&Tick> = axis.ticks.iter().filter(|t| t.value > 0.0).collect();
    if levels.len() > 8 {
        levels.retain(|t| !t.label.trim_start_matches(['0', '.']).starts_with('2'));
    }
    let grid = [cells[0].min(GRID_LIMIT), cells[1].min(GRID_LIMIT)];
    if grid[0] < 3 || grid[1] < 3 || levels.is_empty() {
        return Isolux::default();
    }
    let samples = area_average(values, cells, grid);
    let mut best = (Vec::new(), 0.0);
    for smoothing in SMOOTHING {
        let sigma = smoothing * grid[0].max(grid[1]) as f64;
        // Less than half a cell changes nothing.
        if smoothing > 0.0 && sigma < 0.5 {
            continue;
        }
        let smooth = extended(&gaussian(&samples, grid, sigma), grid);
        let (lines, legible) = lines_of(&smooth, grid, display, &levels);
        best = (lines, smoothing);
        if legible {
            break;
        }
    }
    let lines = if have_labels { labelled(best.0, display) } else { whole(best.0) };
    Isolux { lines, smoothing: best.1 }
}

/// One more ring of samples that repeats the border, so that lines reach the edge of the map.
fn extended(values: &[f64], [width, height]: [usize; 2]) -> Vec<f64> {
    let inner = |i: usize, n: usize| i.saturating_sub(1).min(n - 1);
    (0..height + 2)
        .flat_map(|y| (0..width + 2).map(move |x| (x, y)))
        .map(|(x, y)| values[inner(y, height) * width + inner(x, width)])
        .collect()
}

type Line = (Tick, Vec<[f64; 2]>);

/// Lines long enough to show, in display pixels, and whether they can be told apart.
fn lines_of(extended: &[f64], grid: [usize; 2], display: [usize; 2], levels: &[&Tick]) -> (Vec<Line>, bool) {
    let scale = [display[0] as f64 / grid[0] as f64, display[1] as f64 / grid[1] as f64];
    let (mut lines, mut kept, mut dropped) = (Vec::new(), 0.0, 0.0);
    for &level in levels {
        for line in level_lines(extended, grid[0] + 2, grid[1] + 2, level.value) {
            let place = |p: &[f64; 2]| [(p[0] - 1.0) * scale[0], (p[1] - 1.0) * scale[1]];
            let points: Vec<_> = line.iter().map(place).collect();
            let length = length(&points);
            if length >= SHORTEST_PX {
                kept += length;
                lines.push((level.clone(), points));
            } else {
                dropped += length;
            }
        }
    }
    let area = (display[0] * display[1]) as f64;
    let legible = (kept + dropped) * SPACING_PX <= area && dropped <= 0.08 * kept + SHORTEST_PX;
    (lines, legible)
}

fn whole(lines: Vec<Line>) -> Vec<IsoluxLine> {
    lines.into_iter().map(|(tick, points)| IsoluxLine { tick, pieces: vec![points], label: None }).collect()
}

fn labelled(lines: Vec<Line>, display: [usize; 2]) -> Vec<IsoluxLine> {
    let even: Vec<Vec<[f64; 2]>> = lines.iter().map(|(_, points)| evenly(points)).collect();
    let mut taken: Vec<([f64; 2], f64)> = Vec::new();
    let mut labels = vec![None; lines.len()];
    let mut order: Vec<usize> =
        (0..lines.len()).filter(|&i| length(&lines[i].1) >= SHORTEST_LABELLED_PX).collect();
    // Long lines choose first; the sort is stable.
    order.sort_by_key(|&i| std::cmp::Reverse(even[i].len()));
    for index in order {
        let width = font::width_px(&lines[index].0.label, LABEL_SIZE_PX, false) + 8.0;
        if let Some((from, to)) = best_window(&even, index, width, display, &taken) {
            let label = label_on([even[index][from], even[index][to]]);
            taken.push((label.centre, width));
            labels[index] = Some((from, to, label));
        }
    }
    let lines = lines.into_iter().zip(even).zip(labels).map(|(((tick, points), even), window)| {
        let pieces = match window {
            None => vec![points],
            Some((from, to, _)) => vec![even[..=from].to_vec(), even[to..].to_vec()],
        };
        IsoluxLine { tick, pieces, label: window.map(|(_, _, label)| label) }
    });
    lines.collect()
}

/// The label that lies on a chord, readable from below or from the right.
fn label_on([a, b]: [[f64; 2]; 2]) -> Label {
    let (mut dx, mut dy) = (b[0] - a[0], b[1] - a[1]);
    if dx < 0.0 || (dx == 0.0 && dy > 0.0) {
        (dx, dy) = (-dx, -dy);
    }
    Label { centre: [0.5 * (a[0] + b[0]), 0.5 * (a[1] + b[1])], angle: libm::atan2(dy, dx) }
}

/// The straightest, most level stretch of a line with room for `width` pixels of text.
fn best_window(
    even: &[Vec<[f64; 2]>],
    index: usize,
    width: f64,
    display: [usize; 2],
    taken: &[([f64; 2], f64)],
) -> Option<(usize, usize)> {
    let line = &even[index];
    let span = (width / STEP_PX).ceil() as usize;
    let mut best: Option<(f64, usize)> = None;
    for from in (0..line.len().saturating_sub(span)).step_by(4) {
        let (a, b) = (line[from], line[from + span]);
        let bend = 1.0 - distance(a, b) / (span as f64 * STEP_PX);
        let label = label_on([a, b]);
        let score = 30.0 * bend + libm::sin(label.angle).abs();
        if bend > 0.08 || best.is_some_and(|(least, _)| least <= score) {
            continue;
        }
        let inside = |p: f64, side: usize| p > 0.5 * width + 6.0 && p < side as f64 - 0.5 * width - 6.0;
        let free = taken.iter().all(|&(c, w)| distance(c, label.centre) > 0.5 * (w + width) + 14.0);
        if inside(label.centre[0], display[0])
            && inside(label.centre[1], display[1])
            && free
            && clear(even, index, from..=from + span, &label, width)
        {
            best = Some((score, from));
        }
    }
    best.map(|(_, from)| (from, from + span))
}

/// Whether no other line, nor another part of this one, runs through the label.
fn clear(
    even: &[Vec<[f64; 2]>],
    own: usize,
    window: std::ops::RangeInclusive<usize>,
    label: &Label,
    width: f64,
) -> bool {
    let (sin, cos) = (libm::sin(label.angle), libm::cos(label.angle));
    even.iter().enumerate().all(|(index, line)| {
        line.iter().enumerate().all(|(i, p)| {
            let [dx, dy] = [p[0] - label.centre[0], p[1] - label.centre[1]];
            let (along, across) = (dx * cos + dy * sin, dy * cos - dx * sin);
            (index == own && window.contains(&i))
                || along.abs() > 0.5 * width
                || across.abs() > 0.6 * LABEL_SIZE_PX
        })
    })
}

/// Points of a chain at equal steps along it, the ends included.
fn evenly(points: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut even: Vec<[f64; 2]> = points.first().copied().into_iter().collect();
    let mut next = STEP_PX;
    for pair in points.windows(2) {
        let step = distance(pair[0], pair[1]);
        while next <= step && step > 0.0 {
            even.push(along(pair[0], pair[1], next / step));
            next += STEP_PX;
        }
        next -= step;
    }
    even.extend(points.last());
    even
}
