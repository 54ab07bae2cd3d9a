//! Light tracing to a pinhole: every photon that arrives on a scattering surface is joined to the pinhole where it sees it.
//!
//! The luminance of pixel j is the mean of L over the picture plane weighted by the pixel's filter h_j (its integral over
//! pixel units is 1). A photon of flux F that arrives at x with the weight w adds
//!
//!   F w f(wi, wo) cos(theta_x) / d^2   h_j(p)   (focal length in pixels)^2 / cos^3(theta_camera),
//!
//! d the distance of the pinhole, p the point of the picture where x is seen; the last factor is the picture's area, in
//! pixels, per solid angle at the pinhole. There is no density estimate and so no bias. Light that is scattered last and seen by
//! mirror or through glass is not found: no ray joins such a point to the pinhole.
//!
//! Sums are fixed-point integers of 128 bits, added in any order with the same result.

use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec3};

use crate::bsdf::Bsdf;
use crate::bsdf::reflectance::luminance;
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::{Hit, Side, Whereabouts};
use crate::scene::Scene;
use crate::scene::camera::{CameraSpec, Filter};
use crate::tally::ReceiverSink;
use crate::tally::photon_map::Channels;
use crate::tally::photon_map::sink::scattering_surfaces;
use crate::tally::wide_sum::WideSum;
use crate::transport::{Arrival, Sink};

/// Most bytes of a splatted picture's sums.
pub const MOST_SPLAT_BYTES: u64 = 1 << 30;

/// Bits after the point of a contribution, which is about 1 where the pinhole is as far as the scene is large.
const FRACTION_BITS: i32 = 48;
/// Contributions are cut at 2^60 of that: the pinhole nearer to a surface than a thousand-millionth of the scene.
const MOST_CONTRIBUTION: f64 = (1u64 << 60) as f64;

/// The pinhole and the picture behind it.
#[derive(Debug, Clone, Copy)]
struct Pinhole {
    position: DVec3,
    /// Columns to the right and rows down, unit.
    right: DVec3,
    down: DVec3,
    forward: DVec3,
    /// Distance of the picture plane, in pixels.
    focal_pixels: f64,
    middle: DVec2,
}

impl Pinhole {
    fn new(spec: &CameraSpec) -> Self {
        let middle = DVec2::new(0.5 * f64::from(spec.pixels[0]), 0.5 * f64::from(spec.pixels[1]));
        Self {
            position: spec.position,
            right: spec.forward.cross(spec.up),
            down: -spec.up,
            forward: spec.forward,
            focal_pixels: middle.x / libm::tan(0.5 * spec.fov_deg.to_radians()),
            middle,
        }
    }

    /// Where in the picture (pixels from its top left corner) the pinhole sees a point in this unit direction from it, and the
    /// cosine to the axis; `None` behind it.
    #[inline]
    fn project(&self, direction: DVec3) -> Option<(DVec2, f64)> {
        let cos = direction.dot(self.forward);
        let seen =
            DVec2::new(direction.dot(self.right), direction.dot(self.down)) * (self.focal_pixels / cos);
        (cos > 0.0 && seen.is_finite()).then_some((self.middle + seen, cos))
    }
}

/// Farthest from a pixel's centre that its filter reaches, pixels.
fn reach(filter: Filter) -> f64 {
    match filter {
        Filter::Box => 0.5,
        Filter::Tent => 1.0,
        Filter::Gaussian => 2.0,
    }
}

/// The filter at this offset from the centre, pixels; its integral is 1.
#[inline]
fn filter_value(filter: Filter, x: f64, y: f64) -> f64 {
    let tent = |x: f64| (1.0 - x.abs()).max(0.0);
    match filter {
        // Half open, so that every point of the picture is in one pixel.
        Filter::Box => f64::from(u8::from([x, y].iter().all(|x| (-0.5..0.5).contains(x)))),
        Filter::Tent => tent(x) * tent(y),
        // Standard deviation 1/2, cut at a distance of 4 of them: what is left has the part 1 - e^-8.
        Filter::Gaussian if x * x + y * y < 4.0 => GAUSSIAN_PEAK * libm::exp(-2.0 * (x * x + y * y)),
        Filter::Gaussian => 0.0,
    }
}

/// 2 / (pi (1 - e^-8)).
const GAUSSIAN_PEAK: f64 = 0.636_833_406_175_553_2;

/// The sums of a splatted picture, for one replicate.
#[derive(Debug)]
pub struct Splat<'s, const C: usize> {
    scene: &'s Scene,
    pinhole: Pinhole,
    pixels: [u32; 2],
    filter: Filter,
    scatters: Vec<bool>,
    sums: Vec<[WideSum; C]>,
    /// Luminance in cd/m2 of a photon of 1 lm that contributes 1.
    unit: f64,
    /// 1 / unit in the contributions' own terms.
    per_unit: f64,
    joined: AtomicU64,
    cut: AtomicU64,
}

/// Sums over replicates, pixel by pixel, in cd/m2 a lumen of photon.
#[derive(Debug, Clone, PartialEq)]
pub struct SplatMoments<const C: usize> {
    /// Sum by channel.
    pub sum: Vec<[f64; C]>,
    /// Sum of squares of the luminance.
    pub square: Vec<f64>,
}

impl<const C: usize> SplatMoments<C> {
    /// Zeros.
    pub fn new(pixels: usize) -> Self {
        Self { sum: vec![[0.0; C]; pixels], square: vec![0.0; pixels] }
    }

    /// Zeros again.
    pub fn restart(&mut self) {
        self.sum.fill([0.0; C]);
        self.square.fill(0.0);
    }
}

impl<'s, const C: usize> Splat<'s, C> {
    /// Sums at zero for a camera.
    ///
    /// # Errors
    /// A picture whose sums need more than [`MOST_SPLAT_BYTES`].
    pub fn new(scene: &'s Scene, spec: &CameraSpec) -> Result<Self> {
        let pixels = u64::from(spec.pixels[0]) * u64::from(spec.pixels[1]);
        let bytes = pixels * (size_of::<[WideSum; C]>() + size_of::<[f64; C]>() + size_of::<f64>()) as u64;
        if bytes > MOST_SPLAT_BYTES {
            return Err(Diagnostic::new(
                Kind::Limit,
                format!("{} x {} pixels: {} MiB", spec.pixels[0], spec.pixels[1], bytes >> 20),
                format!("a splatted picture of at most {} MiB", MOST_SPLAT_BYTES >> 20),
            ));
        }
        let pinhole = Pinhole::new(spec);
        // A power of two near the scene's size, so that a scene and the same scene times a power of two agree bit for bit.
        let (low, high) = scene.geometry.bounds();
        let size = (high - low).length().max((spec.position - low).length());
        let size = if size > 0.0 { libm::scalbn(1.0, libm::ilogb(size)) } else { 1.0 };
        let unit = pinhole.focal_pixels * pinhole.focal_pixels / (size * size);
        Ok(Self {
            scene,
            pinhole,
            pixels: spec.pixels,
            filter: spec.filter,
            scatters: scattering_surfaces(scene),
            sums: (0..pixels).map(|_| std::array::from_fn(|_| WideSum::default())).collect(),
            unit,
            per_unit: size * size,
            joined: AtomicU64::new(0),
            cut: AtomicU64::new(0),
        })
    }

    /// A handle for one batch of photons, which counts them on receivers as well.
    pub fn sink<'r>(&'r self, receivers: ReceiverSink<'r, 's>) -> SplatSink<'r, 's, C> {
        SplatSink { receivers, splat: self, joined: 0 }
    }

    /// Arrivals that reached a pixel so far.
    pub fn joined(&self) -> u64 {
        self.joined.load(Ordering::Relaxed)
    }

    /// Contributions that were cut because the pinhole all but touches a surface.
    pub fn cut(&self) -> u64 {
        self.cut.load(Ordering::Relaxed)
    }

    /// Adds what there is to the sums over replicates. With `clear` the next replicate starts at zero.
    pub fn close(&mut self, into: &mut SplatMoments<C>, clear: bool) {
        let quantum = libm::scalbn(self.unit, -FRACTION_BITS);
        for (pixel, sums) in self.sums.iter_mut().enumerate() {
            let value = sums.each_mut().map(|s| (if clear { s.take() } else { s.get() }) as f64 * quantum);
            for (sum, value) in into.sum[pixel].iter_mut().zip(value) {
                *sum += value;
            }
            let y = luminance_of(value);
            into.square[pixel] += y * y;
        }
    }

    /// Joins an arrival to the pinhole; whether it reached the picture.
    #[inline]
    fn join<T: Channels<C>>(&self, arrival: &Arrival<'_, T>) -> bool {
        let hit = arrival.hit;
        let away = self.pinhole.position - hit.position;
        let distance = away.length();
        let wo = away / distance;
        let Some((p, cos_camera)) = self.pinhole.project(-wo) else { return false };
        let reach = reach(self.filter);
        // Centres of pixels lie at halves.
        let first = |p: f64| libm::ceil(p - 0.5 - reach).max(0.0);
        let last = |p: f64, n: u32| libm::floor(p - 0.5 + reach).min(f64::from(n) - 1.0);
        let (left, right) = (first(p.x), last(p.x, self.pixels[0]));
        let (top, bottom) = (first(p.y), last(p.y, self.pixels[1]));
        if left > right || top > bottom {
            return false;
        }
        let f = value::<C>(self.scene.bsdf(hit.surface), hit, -arrival.direction, wo);
        if f.iter().all(|f| *f <= 0.0) || self.is_hidden(hit, arrival.whereabouts, wo, distance) {
            return false;
        }
        let weight = arrival.carried.channels();
        // d^2 first: either may be far from 1, their product is not.
        let factor = self.per_unit / (distance * distance) * wo.dot(hit.normal).abs()
            / (cos_camera * cos_camera * cos_camera);
        for row in top as u32..=bottom as u32 {
            let y = p.y - 0.5 - f64::from(row);
            for column in left as u32..=right as u32 {
                let h = filter_value(self.filter, p.x - 0.5 - f64::from(column), y);
                let sums = &self.sums[row as usize * self.pixels[0] as usize + column as usize];
                for c in 0..C {
                    self.add(&sums[c], factor * h * f[c] * weight[c]);
                }
            }
        }
        true
    }

    #[inline]
    fn add(&self, sum: &WideSum, contribution: f64) {
        if contribution > MOST_CONTRIBUTION {
            self.cut.fetch_add(1, Ordering::Relaxed);
        }
        // Rounded to the nearest quantum. (A NaN becomes 0.)
        sum.add((libm::scalbn(contribution.min(MOST_CONTRIBUTION), FRACTION_BITS) + 0.5) as u128);
    }

    /// Whether any surface, glass included, lies between a point of a surface and the pinhole.
    #[inline]
    fn is_hidden(&self, hit: &Hit, arrived: &Whereabouts, wo: DVec3, distance: f64) -> bool {
        let along = wo.dot(hit.normal);
        if along == 0.0 {
            return true;
        }
        let mut whereabouts = *arrived;
        whereabouts.leave(hit, if along > 0.0 { Side::Front } else { Side::Back });
        let first = self.scene.geometry.nearest(hit.position, wo, &whereabouts, &mut 0);
        first.is_some_and(|first| first.t < distance)
    }
}

/// f(wi, wo) by channel, 1/sr; one channel sees white light's luminance.
#[inline]
fn value<const C: usize>(bsdf: &Bsdf, hit: &Hit, wi: DVec3, wo: DVec3) -> [f64; C] {
    let rgb = match bsdf {
        Bsdf::Lambertian { reflectance } if (wo.dot(hit.normal) > 0.0) == hit.front => {
            reflectance.by_channel().map(|part| part * std::f64::consts::FRAC_1_PI)
        }
        _ => [0.0; 3],
    };
    let _ = wi;
    if C == 1 { [luminance(rgb); C] } else { std::array::from_fn(|c| rgb[c]) }
}

fn luminance_of<const C: usize>(value: [f64; C]) -> f64 {
    match value.as_slice() {
        [r, g, b] => luminance([*r, *g, *b]),
        _ => value[0],
    }
}

/// Joins the arrivals of one batch to the pinhole, direct light included, and adds them to a scene's receivers.
#[derive(Debug)]
pub struct SplatSink<'r, 's, const C: usize> {
    receivers: ReceiverSink<'r, 's>,
    splat: &'r Splat<'s, C>,
    joined: u64,
}

impl<T: Channels<C>, const C: usize> Sink<T> for SplatSink<'_, '_, C> {
    #[inline]
    fn arrive(&mut self, arrival: &Arrival<'_, T>) {
        self.receivers.arrive(arrival);
        if self.splat.scatters[arrival.hit.surface.0 as usize] {
            self.joined += u64::from(self.splat.join(arrival));
        }
    }
}

impl<const C: usize> Drop for SplatSink<'_, '_, C> {
    fn drop(&mut self) {
        self.splat.joined.fetch_add(self.joined, Ordering::Relaxed);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn filters_have_integral_one_and_their_shape() {
        for filter in [Filter::Box, Filter::Tent, Filter::Gaussian] {
            // The midpoint rule with an even number of intervals a pixel meets the kinks at their edges.
            let n = 2000;
            let step = 6.0 / f64::from(n);
            let at = |k: i32| -3.0 + (f64::from(k) + 0.5) * step;
            let mut integral = 0.0;
            for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
                let value = filter_value(filter, at(i), at(j));
                assert!(value == 0.0 || at(i).abs().max(at(j).abs()) <= reach(filter));
                integral += value * step * step;
            }
            assert!((integral - 1.0).abs() < 1e-6, "{filter:?}: {integral}");
        }
        let ratio = filter_value(Filter::Gaussian, 0.3, 0.4) / filter_value(Filter::Gaussian, 0.0, 0.0);
        assert!((ratio - libm::exp(-0.5)).abs() < 1e-15, "half a pixel is a standard deviation");
    }

    #[test]
    fn a_projected_point_lies_where_a_ruler_puts_it() {
        // 90 degrees across 200 pixels: the picture plane is 100 pixels away.
        let spec = CameraSpec::pinhole(DVec3::ZERO, DVec3::Y, DVec3::Z, 90.0, [200, 100]);
        let pinhole = Pinhole::new(&spec);
        let (p, cos) = pinhole.project(DVec3::new(0.5, 1.0, 0.25).normalize()).unwrap();
        assert!((p - DVec2::new(150.0, 25.0)).length() < 1e-12, "right is +x, up is +z: {p}");
        assert!((cos - 1.0 / 1.3125f64.sqrt()).abs() < 1e-15);
        assert!(pinhole.project(DVec3::new(0.5, -1.0, 0.25).normalize()).is_none());
        assert!(pinhole.project(DVec3::X).is_none());
    }
}
