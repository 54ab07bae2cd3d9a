//! The part of a rectangle inside a circle.

/// Area common to a circle about the origin and a rectangle between these sides.
pub fn area_in_circle(radius: f64, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> f64 {
    if radius <= 0.0 {
        return 0.0;
    }
    let (x0, x1) = (x0.clamp(-radius, radius), x1.clamp(-radius, radius));
    let below = |y: f64| below(radius, x0, x1, y.abs()).copysign(y);
    below(y1) - below(y0)
}

/// Integral over x of the lesser of y and the height of the circle there; y is not negative.
fn below(radius: f64, x0: f64, x1: f64, y: f64) -> f64 {
    if y >= radius {
        return half_disc(radius, x1) - half_disc(radius, x0);
    }
    // The circle is higher than y between -c and c.
    let c = ((radius - y) * (radius + y)).sqrt();
    let flat = y * (x1.clamp(-c, c) - x0.clamp(-c, c));
    let left = if x0 < -c { half_disc(radius, x1.min(-c)) - half_disc(radius, x0) } else { 0.0 };
    let right = if x1 > c { half_disc(radius, x1) - half_disc(radius, x0.max(c)) } else { 0.0 };
    flat + left + right
}

/// Integral of the height of the circle from 0 to x. The angle is that of a tangent: near a right one the arcsine loses half
/// of its digits.
fn half_disc(radius: f64, x: f64) -> f64 {
    let height = ((radius - x) * (radius + x)).max(0.0).sqrt();
    0.5 * (x * height + radius * radius * libm::atan2(x, height))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By the middles of 4000 x 4000 parts of the rectangle.
    fn counted(radius: f64, [x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> f64 {
        const N: i32 = 4000;
        let middle = |a: f64, b: f64, i: i32| a + (b - a) * (f64::from(i) + 0.5) / f64::from(N);
        let is_in = |i: i32, j: i32| {
            let (x, y) = (middle(x0, x1, i), middle(y0, y1, j));
            u32::from(x * x + y * y <= radius * radius)
        };
        let inside: u32 = (0..N).map(|i| (0..N).map(|j| is_in(i, j)).sum::<u32>()).sum();
        f64::from(inside) / f64::from(N * N) * (x1 - x0) * (y1 - y0)
    }

    #[test]
    fn areas_are_those_of_points_inside() {
        let cases = [
            (1.0, [0.6, 0.8], [0.5, 0.9]),
            (1.0, [-0.2, 0.3], [0.9, 1.1]),
            (1.0, [-0.1, 0.2], [-0.3, 0.1]),
            (1.0, [-1.2, 1.3], [-0.9, 1.1]),
            (1.0, [-1.1, -0.7], [-0.4, 0.2]),
            (0.1, [-0.5, 0.5], [-0.5, 0.5]),
            (1.0, [0.9, 1.4], [0.9, 1.4]),
        ];
        for (radius, x, y) in cases {
            let (area, expected) = (area_in_circle(radius, x, y), counted(radius, x, y));
            assert!((area - expected).abs() < 2e-4, "{x:?} {y:?}: {area} {expected}");
        }
        let disc = area_in_circle(0.5, [-1.0, 2.0], [-3.0, 0.7]);
        assert!((disc - 0.25 * std::f64::consts::PI).abs() < 1e-15, "{disc}");
        assert_eq!(area_in_circle(0.0, [-1.0, 1.0], [-1.0, 1.0]), 0.0);
    }
}
