//! Albedo of a table's slices: the integral of f cos(theta_o) over the hemisphere that light leaves to.
//!
//! By the interpolation rule of [`super::table`]: g = f cos(theta_o) is bilinear between nodes, zero at nodes below the
//! horizon. With the sine of the grid's own polar angle as weight the integral over a cell is closed: for g = a + (b - a) s / w
//! on [p, p + w], the integral of g sin is a (cos p - cos(p + w)) + (b - a) (w J), J the mean of s/w weighted by the sine.

use std::f64::consts::FRAC_PI_2;

use libm::{cos, sin};

use super::{Frame, Lobe};

/// Cosine between the scattered direction of a node and the normal of the side light leaves on; angles in degrees.
///
/// In the specular frame the normal stands at theta_i from the pole, on azimuth 0.
pub fn node_cosine(frame: Frame, theta_i_deg: f64, polar_deg: f64, azimuth_deg: f64) -> f64 {
    let polar = polar_deg.to_radians();
    match frame {
        // Exact at the horizon: cos of the double nearest to pi/2 is not zero.
        Frame::Surface if polar == FRAC_PI_2 => 0.0,
        Frame::Surface => cos(polar),
        Frame::Specular => {
            let theta_i = theta_i_deg.to_radians();
            cos(polar) * cos(theta_i) + sin(polar) * sin(theta_i) * cos(azimuth_deg.to_radians())
        }
    }
}

/// g = f cos(theta_o) at the nodes of a slice, 1/sr, index `[polar][azimuth]`; zero below the horizon.
pub fn node_values(lobe: &Lobe, channel: usize, phi_i: usize, theta_i: usize) -> Vec<f64> {
    let azimuths = lobe.azimuth_deg.len();
    let slice = lobe.slice(channel, phi_i, theta_i);
    let value = |(at, f): (usize, &f32)| {
        let (polar, azimuth) = (lobe.polar_deg[at / azimuths], lobe.azimuth_deg[at % azimuths]);
        f64::from(*f) * node_cosine(lobe.frame, lobe.theta_i_deg[theta_i], polar, azimuth).max(0.0)
    };
    slice.iter().enumerate().map(value).collect()
}

/// Albedo of the slice of one channel at one incidence of the table.
pub fn slice_albedo(lobe: &Lobe, channel: usize, phi_i: usize, theta_i: usize) -> f64 {
    let g = node_values(lobe, channel, phi_i, theta_i);
    let azimuths = lobe.azimuth_deg.len();
    let ring = |i: usize| -> f64 {
        let row = &g[i * azimuths..(i + 1) * azimuths];
        let cells = row.windows(2).zip(lobe.azimuth_deg.windows(2));
        cells.map(|(v, a)| 0.5 * (v[0] + v[1]) * (a[1] - a[0]).to_radians()).sum()
    };
    let mut total = 0.0;
    let mut inner = ring(0);
    for (i, w) in lobe.polar_deg.windows(2).enumerate() {
        let outer = ring(i + 1);
        let (p, width) = (w[0].to_radians(), (w[1] - w[0]).to_radians());
        let (all, far) = sine_moments(p, width);
        total += inner * (all - far) + outer * far;
        inner = outer;
    }
    total
}

/// Integrals of sin(p + s) and of (s / w) sin(p + s) over s from 0 to w, without cancellation for narrow rings.
fn sine_moments(p: f64, w: f64) -> (f64, f64) {
    let middle = p + 0.5 * w;
    let half = 0.5 * w;
    let all = 2.0 * sin(middle) * sin(half);
    // About the middle: int s' cos s' of the odd part, (sin h - h cos h), by its series where it cancels.
    let odd = if half < 0.1 {
        let h2 = half * half;
        half * h2 * (1.0 / 3.0 - h2 * (1.0 / 30.0 - h2 * (1.0 / 840.0 - h2 / 45_360.0)))
    } else {
        sin(half) - half * cos(half)
    };
    (all, 0.5 * all + cos(middle) * 2.0 * odd / w)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_their_closed_forms() {
        for (p, w) in [(0.0, 0.5), (0.3, 0.19), (0.3, 0.21), (1.2, 1.9), (3.0, 0.14)] {
            let (all, far) = sine_moments(p, w);
            let exact = (sin(p + w) - sin(p)) / w - cos(p + w);
            assert!((all - (cos(p) - cos(p + w))).abs() < 1e-15, "{p} {w}");
            assert!((far - exact).abs() < 1e-14, "{p} {w}: {far} {exact}");
        }
        // Narrow: all is w sin p, far half of it, to a relative 1e-9.
        let (all, far) = sine_moments(1.0, 1e-9);
        assert!((all / (1e-9 * sin(1.0)) - 1.0).abs() < 1e-8 && (far / all - 0.5).abs() < 1e-8);
    }
}
