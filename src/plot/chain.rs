//! Chains of points in the plane.

/// The distance of two points.
pub fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    let [dx, dy] = [b[0] - a[0], b[1] - a[1]];
    (dx * dx + dy * dy).sqrt()
}

/// The point at a share of the way from one to another.
pub fn along(from: [f64; 2], to: [f64; 2], share: f64) -> [f64; 2] {
    [from[0] + (to[0] - from[0]) * share, from[1] + (to[1] - from[1]) * share]
}

/// The length of a chain.
pub fn length(points: &[[f64; 2]]) -> f64 {
    points.windows(2).map(|p| distance(p[0], p[1])).sum()
}

/// The distance of a point from a segment.
pub fn distance_to_segment(p: [f64; 2], from: [f64; 2], to: [f64; 2]) -> f64 {
    let [dx, dy] = [to[0] - from[0], to[1] - from[1]];
    let square = dx * dx + dy * dy;
    let share = if square > 0.0 { ((p[0] - from[0]) * dx + (p[1] - from[1]) * dy) / square } else { 0.0 };
    distance(p, along(from, to, share.clamp(0.0, 1.0)))
}

/// Whether a ray from the point to the right crosses the polygon's outline an odd number of times.
pub fn contains(corners: &[[f64; 2]], [x, y]: [f64; 2]) -> bool {
    let edges = corners.iter().zip(corners.iter().cycle().skip(1));
    let crossed = edges
        .filter(|(a, b)| (a[1] > y) != (b[1] > y) && x < a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]));
    crossed.count() % 2 == 1
}

/// The chain of points of an arc, fine enough for a pixel grid; angles in radians, from +x
/// towards +y, that is clockwise on the screen.
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
            from = along(from, to, left / length);
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dashes_share_the_length() {
        let points = [[0.0, 0.0], [30.0, 0.0], [30.0, 40.0]];
        let pieces = dashes(&points, [5.0, 3.0]);
        let total: f64 = pieces.iter().map(|piece| length(piece)).sum();
        // 70 = 8 periods of 8 and 6 more, of which 5 are ink.
        assert!((total - 45.0).abs() < 1e-9, "{total}");
        assert_eq!(pieces.len(), 9);
    }
}
