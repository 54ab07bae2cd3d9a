//! Level lines of a map by marching squares.
//!
//! W. E. Lorensen, H. E. Cline, "Marching cubes", SIGGRAPH 1987, in the plane; a saddle is decided by the mean of its
//! four corners. Sample (i, j) lies at (i + 0.5, j + 0.5), so lines are in cells of the map.

const NONE: u32 = u32::MAX;

/// The lines on which the bilinear map has this level, as points in cells, x right and y down; values at or above it are
/// inside. A closed line repeats its first point at the end; others end at the border or at a hole: squares with a corner that
/// is NaN are left out. None for maps narrower than two samples.
pub fn level_lines(values: &[f64], width: usize, height: usize, level: f64) -> Vec<Vec<[f64; 2]>> {
    if width < 2 || height < 2 || values.len() != width.saturating_mul(height) || values.len() >= 1 << 30 {
        return Vec::new();
    }
    let grid = Grid { values, width, height, level };
    let mut links = vec![[NONE; 2]; grid.horizontal_edges() + width * (height - 1)];
    let mut crossed = Vec::new();
    for y in 0..height - 1 {
        for x in 0..width - 1 {
            for [a, b] in grid.segments(x, y).into_iter().flatten() {
                join(&mut links, &mut crossed, a, b);
                join(&mut links, &mut crossed, b, a);
            }
        }
    }
    // Open lines first, from an end; what is left then is closed. The order is that of the squares.
    let mut lines = Vec::new();
    for open in [true, false] {
        for &edge in &crossed {
            let [first, second] = links[edge];
            if first != NONE && (second == NONE) == open {
                lines.push(follow(&grid, &mut links, edge));
            }
        }
    }
    lines
}

fn join(links: &mut [[u32; 2]], crossed: &mut Vec<usize>, from: usize, to: usize) {
    let slots = &mut links[from];
    if slots[0] == NONE {
        slots[0] = to as u32;
        crossed.push(from);
    } else {
        slots[1] = to as u32;
    }
}

/// Walks from edge to edge, removing the links it has used.
fn follow(grid: &Grid, links: &mut [[u32; 2]], start: usize) -> Vec<[f64; 2]> {
    let mut points = vec![grid.crossing(start)];
    let mut edge = start;
    while links[edge][0] != NONE {
        let next = links[edge][0] as usize;
        links[edge] = [links[edge][1], NONE];
        let back = &mut links[next];
        *back = if back[0] == edge as u32 { [back[1], NONE] } else { [back[0], NONE] };
        points.push(grid.crossing(next));
        edge = next;
    }
    points
}

struct Grid<'a> {
    values: &'a [f64],
    width: usize,
    height: usize,
    level: f64,
}

impl Grid<'_> {
    fn horizontal_edges(&self) -> usize {
        (self.width - 1) * self.height
    }

    /// Up to two segments of the square whose top left sample is (x, y), each from edge to edge.
    fn segments(&self, x: usize, y: usize) -> [Option<[usize; 2]>; 2] {
        let at = |i, j| self.values[j * self.width + i];
        let corners = [at(x, y), at(x + 1, y), at(x + 1, y + 1), at(x, y + 1)];
        if corners.iter().any(|v| !v.is_finite()) {
            return [None; 2];
        }
        let inside = corners.map(|v| v >= self.level);
        let top = y * (self.width - 1) + x;
        let left = self.horizontal_edges() + y * self.width + x;
        let edges = [top, left + 1, top + self.width - 1, left];
        // Edge k runs from corner k to corner k + 1.
        let mut cut = (0..4).filter(|&k| inside[k] != inside[(k + 1) % 4]).map(|k| edges[k]);
        match (cut.next(), cut.next(), cut.next(), cut.next()) {
            (Some(a), Some(b), None, None) => [Some([a, b]), None],
            (Some(a), Some(b), Some(c), Some(d)) => {
                let centre = 0.25 * corners.iter().sum::<f64>() >= self.level;
                // A centre like corner 0 joins it with corner 2; the lines then cut off corners 1 and 3.
                if centre == inside[0] { [Some([a, b]), Some([c, d])] } else { [Some([d, a]), Some([b, c])] }
            }
            _ => [None; 2],
        }
    }

    /// Where the level lies on an edge.
    fn crossing(&self, edge: usize) -> [f64; 2] {
        let (x, y, step) = if edge < self.horizontal_edges() {
            (edge % (self.width - 1), edge / (self.width - 1), [1, 0])
        } else {
            let rest = edge - self.horizontal_edges();
            (rest % self.width, rest / self.width, [0, 1])
        };
        let from = self.values[y * self.width + x];
        let to = self.values[(y + step[1]) * self.width + x + step[0]];
        let share = ((self.level - from) / (to - from)).clamp(0.0, 1.0);
        [x as f64 + 0.5 + share * step[0] as f64, y as f64 + 0.5 + share * step[1] as f64]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::chain::{distance, length};

    fn is_closed(line: &[[f64; 2]]) -> bool {
        line.first() == line.last()
    }

    fn map(width: usize, height: usize, f: impl Fn(f64, f64) -> f64) -> Vec<f64> {
        (0..width * height).map(|i| f((i % width) as f64 + 0.5, (i / width) as f64 + 0.5)).collect()
    }

    #[test]
    fn a_cone_has_one_circle_of_the_right_radius() {
        let (cx, cy) = (50.3, 47.9);
        let cone = map(100, 96, |x, y| 100.0 - ((x - cx) * (x - cx) + (y - cy) * (y - cy)).sqrt());
        for radius in [5.0, 17.0, 40.25] {
            let lines = level_lines(&cone, 100, 96, 100.0 - radius);
            assert_eq!(lines.len(), 1, "radius {radius}");
            assert!(is_closed(&lines[0]));
            for &p in &lines[0] {
                // Linear interpolation along an edge of length 1: curvature 1/r leaves at most 1/(8 r).
                let error = (distance(p, [cx, cy]) - radius).abs();
                assert!(error <= 1.0 / (8.0 * radius) * 1.1, "{p:?} is off by {error}");
            }
            let circumference = std::f64::consts::TAU * radius;
            assert!((length(&lines[0]) / circumference - 1.0).abs() < 0.01);
        }
    }

    #[test]
    fn a_plane_has_one_straight_open_line() {
        let plane = map(30, 20, |x, y| 2.0 * x + 3.0 * y);
        let lines = level_lines(&plane, 30, 20, 60.0);
        assert_eq!(lines.len(), 1);
        assert!(!is_closed(&lines[0]));
        for p in &lines[0] {
            assert!((2.0 * p[0] + 3.0 * p[1] - 60.0).abs() < 1e-9, "{p:?}");
        }
        assert!(level_lines(&plane, 30, 20, 1000.0).is_empty());
    }

    #[test]
    fn noise_uses_every_segment_once_and_closes() {
        let noise = map(40, 40, |x, y| (((x * 12.9898 + y * 78.233).sin() * 43758.5453).fract()).abs());
        let grid = Grid { values: &noise, width: 40, height: 40, level: 0.5 };
        let segments: usize =
            (0..39 * 39).map(|i| grid.segments(i % 39, i / 39).iter().flatten().count()).sum();
        let lines = level_lines(&noise, 40, 40, 0.5);
        assert_eq!(lines.iter().map(|l| l.len() - 1).sum::<usize>(), segments);
        for line in &lines {
            for pair in line.windows(2) {
                assert!(distance(pair[0], pair[1]) <= 2f64.sqrt() + 1e-12);
            }
        }
    }

    #[test]
    fn saddles_follow_their_centre() {
        // Diagonal highs with a high centre are one ridge: its two lines cut off the low corners.
        let ridge = level_lines(&[1.0, 0.0, 0.0, 1.0], 2, 2, 0.4);
        let mut pits = level_lines(&[1.0, 0.0, 0.0, 1.0], 2, 2, 0.6);
        assert_eq!((ridge.len(), pits.len()), (2, 2));
        let near = |line: &[[f64; 2]], corner: [f64; 2]| line.iter().all(|&p| distance(p, corner) < 0.7);
        assert!(ridge.iter().any(|l| near(l, [1.5, 0.5])) && ridge.iter().any(|l| near(l, [0.5, 1.5])));
        pits.sort_by(|a, b| a[0][0].total_cmp(&b[0][0]));
        assert!(near(&pits[0], [0.5, 0.5]) && near(&pits[1], [1.5, 1.5]));
    }

    #[test]
    fn holes_and_degenerate_maps() {
        let mut cone = map(21, 21, |x, y| -((x - 10.5) * (x - 10.5) + (y - 10.5) * (y - 10.5)).sqrt());
        cone[10 * 21 + 16] = f64::NAN;
        let lines = level_lines(&cone, 21, 21, -6.0);
        assert_eq!(lines.len(), 1);
        assert!(!is_closed(&lines[0]));
        assert!(level_lines(&[1.0, 2.0], 1, 2, 1.5).is_empty());
        assert!(level_lines(&[], 0, 0, 1.0).is_empty());
        assert!(level_lines(&[f64::NAN; 9], 3, 3, 1.0).is_empty());
    }
}
