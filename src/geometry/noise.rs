//! Seeded gradient noise in the plane, with its exact slope.

use glam::DVec2;

use super::LENGTH;
use crate::error::Invalid;
use crate::error::invalid::Interval;

/// One octave: its share of the amplitude and the pitch of its lattice (m).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Octave {
    /// Relative amplitude; the sum over octaves is scaled to the noise's peak.
    pub amplitude: f64,
    /// Lattice pitch (m).
    pub wavelength_m: f64,
}

/// A sum of octaves of gradient noise: twice continuously differentiable, zero at lattice points, |h| <= amplitude.
///
/// K. Perlin, Improving Noise, 2002 (the fade 6 t^5 - 15 t^4 + 10 t^3), with unit gradients of uniform direction
/// hashed from (seed, octave, lattice point); one octave's range is [-1, 1], reached only in the middle of a cell.
#[derive(Debug, Clone, PartialEq)]
pub struct Noise {
    seed: u64,
    octaves: Vec<Octave>,
    scale_m: f64,
}

/// Peaks of noise, m.
pub const PEAK: Interval = Interval { low: 0.0, high: 1e9, words: "a height from 0 to 1e9 m" };
/// Amplitudes of octaves relative to each other.
pub const RELATIVE: Interval = Interval { low: 0.0, high: 1e9, words: "a relative amplitude from 0 to 1e9" };
/// Most octaves.
pub const MOST_OCTAVES: usize = 32;

impl Noise {
    /// Number of octaves.
    pub fn octaves(&self) -> usize {
        self.octaves.len()
    }

    /// A noise of these octaves whose amplitudes sum to `amplitude_m` (m).
    ///
    /// # Errors
    /// No octave of an amplitude above 0, more than `MOST_OCTAVES`, numbers out of range.
    pub fn new(seed: u64, octaves: Vec<Octave>, amplitude_m: f64) -> Result<Self, Invalid> {
        PEAK.check("amplitude", amplitude_m)?;
        for octave in &octaves {
            RELATIVE.check("amplitude", octave.amplitude)?;
            LENGTH.check("wavelength", octave.wavelength_m)?;
        }
        let total: f64 = octaves.iter().map(|o| o.amplitude).sum();
        if octaves.len() > MOST_OCTAVES || !(total > 0.0) {
            let found = format!("{} octaves of amplitudes that sum to {total}", octaves.len());
            return Err(Invalid::Content {
                what: "octaves",
                found,
                required: "at least one octave of an amplitude above 0".into(),
            });
        }
        Ok(Self { seed, octaves, scale_m: amplitude_m / total })
    }

    /// Shortest wavelength (m).
    pub(crate) fn shortest_wavelength_m(&self) -> f64 {
        self.octaves.iter().fold(f64::INFINITY, |m, o| m.min(o.wavelength_m))
    }

    /// Height (m) and its slope at a point (m).
    pub fn height_and_slope(&self, at: DVec2) -> (f64, DVec2) {
        let mut height = 0.0;
        let mut slope = DVec2::ZERO;
        for (i, octave) in self.octaves.iter().enumerate() {
            let seed = mix(self.seed ^ mix(i as u64));
            let (n, d) = gradient_noise(seed, at / octave.wavelength_m);
            height += octave.amplitude * n;
            slope += d * (octave.amplitude / octave.wavelength_m);
        }
        (height * self.scale_m, slope * self.scale_m)
    }
}

/// One octave on the unit lattice, in [-1, 1], and its gradient.
fn gradient_noise(seed: u64, p: DVec2) -> (f64, DVec2) {
    let cell = p.floor();
    let f = p - cell;
    let (ix, iy) = (cell.x as i64, cell.y as i64);
    let corner = |dx: i64, dy: i64| {
        let g = gradient(seed, ix.wrapping_add(dx), iy.wrapping_add(dy));
        (g, g.dot(f - DVec2::new(dx as f64, dy as f64)))
    };
    let [(g00, n00), (g10, n10), (g01, n01), (g11, n11)] =
        [corner(0, 0), corner(1, 0), corner(0, 1), corner(1, 1)];
    let (u, v) = (fade(f.x), fade(f.y));
    let (du, dv) = (fade_slope(f.x), fade_slope(f.y));
    let bottom = n00 + u * (n10 - n00);
    let top = n01 + u * (n11 - n01);
    let g_bottom = g00 + (g10 - g00) * u;
    let g_top = g01 + (g11 - g01) * u;
    let across = (n10 - n00) + v * ((n11 - n01) - (n10 - n00));
    let slope = g_bottom + (g_top - g_bottom) * v + DVec2::new(du * across, dv * (top - bottom));
    // Unit gradients reach sqrt(1/2) in the middle of a cell.
    let range = std::f64::consts::SQRT_2;
    ((bottom + v * (top - bottom)) * range, slope * range)
}

fn fade(t: f64) -> f64 {
    t * t * t * (t * (t * 6.0 - 15.0) + 10.0)
}

fn fade_slope(t: f64) -> f64 {
    30.0 * t * t * (t - 1.0) * (t - 1.0)
}

/// The unit gradient of a lattice point.
fn gradient(seed: u64, ix: i64, iy: i64) -> DVec2 {
    let hash = mix(mix(seed ^ ix as u64).wrapping_add(iy as u64));
    let angle = (hash >> 11) as f64 * (std::f64::consts::TAU / (1u64 << 53) as f64);
    DVec2::new(libm::cos(angle), libm::sin(angle))
}

/// The output function of SplitMix64 (Steele, Lea, Flood 2014), a bijection of good avalanche.
fn mix(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three_octaves(seed: u64) -> Noise {
        let octaves = [(1.0, 0.30), (0.45, 0.148), (0.12, 0.073)];
        let octaves = octaves.map(|(amplitude, wavelength_m)| Octave { amplitude, wavelength_m });
        Noise::new(seed, octaves.to_vec(), 0.010).unwrap()
    }

    #[test]
    fn range_is_kept_and_used() {
        let noise = three_octaves(1);
        let (mut lo, mut hi, mut sum) = (0.0f64, 0.0f64, 0.0);
        for i in 0..300 {
            for j in 0..300 {
                let (h, _) =
                    noise.height_and_slope(DVec2::new(f64::from(i) * 0.0137, f64::from(j) * 0.0171 - 2.0));
                lo = lo.min(h);
                hi = hi.max(h);
                sum += h;
            }
        }
        assert!(lo >= -0.010 && hi <= 0.010, "{lo} {hi}");
        assert!(lo < -0.005 && hi > 0.005, "{lo} {hi}");
        assert!((sum / 9e4).abs() < 5e-4, "{}", sum / 9e4);
    }

    #[test]
    fn slope_is_the_derivative_also_across_lattice_lines() {
        let noise = three_octaves(7);
        let h = 1e-6;
        for k in 0..400 {
            let x = if k % 2 == 0 { 0.3 * f64::from(k % 5 - 2) } else { f64::from(k) * 0.0173 };
            let at = DVec2::new(x, f64::from(k) * 0.00731 - 1.3);
            let f = |p: DVec2| noise.height_and_slope(p).0;
            let numeric = DVec2::new(
                (f(at + DVec2::X * h) - f(at - DVec2::X * h)) / (2.0 * h),
                (f(at + DVec2::Y * h) - f(at - DVec2::Y * h)) / (2.0 * h),
            );
            let (_, slope) = noise.height_and_slope(at);
            assert!((numeric - slope).length() < 1e-8, "{at}: {numeric} {slope}");
            // The second derivative exists: slopes either side of a lattice line differ by O(h), not O(1).
            let (_, left) = noise.height_and_slope(at - DVec2::X * 1e-9);
            assert!((left - slope).length() < 1e-6);
        }
    }

    #[test]
    fn seeds_differ_and_octaves_do_not_share_gradients() {
        let (a, b) = (three_octaves(1), three_octaves(2));
        let mut dot = [0.0; 3];
        for k in 0..5000 {
            let p = DVec2::new(f64::from(k) * 0.317, f64::from(k % 71) * 0.211);
            let (x, y) = (a.height_and_slope(p).0, b.height_and_slope(p).0);
            dot[0] += x * x;
            dot[1] += y * y;
            dot[2] += x * y;
        }
        let correlation = dot[2] / f64::sqrt(dot[0] * dot[1]);
        assert!(correlation.abs() < 0.1, "{correlation}");
        assert_ne!(gradient(mix(1 ^ mix(0)), 3, 4), gradient(mix(1 ^ mix(1)), 3, 4));
    }

    #[test]
    fn nonsense_is_refused() {
        for (amplitude, wavelength_m) in [(0.0, 1.0), (1.0, 0.0), (f64::NAN, 1.0), (1.0, f64::INFINITY)] {
            assert!(Noise::new(0, vec![Octave { amplitude, wavelength_m }], 1.0).is_err());
        }
        assert!(Noise::new(0, vec![], 1.0).is_err());
        assert!(Noise::new(0, vec![Octave { amplitude: 1.0, wavelength_m: 1.0 }], f64::NAN).is_err());
    }
}
