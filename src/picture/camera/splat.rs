//! Light tracing to a pinhole: every photon that arrives on a scattering surface is joined to the pinhole
//! where it sees it.
//!
//! The luminance of pixel j is the mean of L over the picture plane weighted by the pixel's filter h_j (its
//! integral over pixel units is 1). A photon of flux F that arrives at x with the weight w adds
//!
//!   F w f(wi, wo) cos(theta_x) / d^2   h_j(p)   (focal length in pixels)^2 / cos^3(theta_camera),
//!
//! d the distance of the pinhole, p the point of the picture where x is seen; the last factor is the
//! picture's area, in pixels, per solid angle at the pinhole. There is no density estimate and so no bias.
//! Light that is scattered last and seen by mirror or through glass is not found: no ray joins such a point
//! to the pinhole.
//!
//! Sums are fixed-point integers of 128 bits, added in any order with the same result.

use std::io::{self, Read, Write};
use std::sync::atomic::{AtomicU64, Ordering};

use glam::{DVec2, DVec3};

use crate::error::Result;
use crate::estimate::replicates::FEWEST_HITS;
use crate::geometry::{Hit, Side, SurfaceId, Whereabouts};
use crate::math::varint::{expect, put, put_reals, take_real};
use crate::picture::photon_map::Channels;
use crate::picture::photon_map::sink::scattering_surfaces;
use crate::scene::Scene;
use crate::scene::camera::{Camera, Filter};
use crate::surface::{Leg, Material, luminance, luminance_of};
use crate::tally::{ReceiverSink, WideSum};
use crate::transport::{Arrival, Sink};

use super::film::{self, Film};
use super::filter;
use super::pinhole::Pinhole;
use super::view::View;

/// Bits after the point of a contribution, which is about 1 where the pinhole is as far as the scene is
/// large.
const FRACTION_BITS: i32 = 48;
/// Larger contributions are cut to this: only where the pinhole is nearer to a surface than 1e-9 of the scene's size.
const MOST_CONTRIBUTION: f64 = (1u64 << 60) as f64;

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
    /// The scene's size squared, m2: what a contribution, by the squared distance, is counted in.
    size_squared: f64,
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

    /// R s^2 of the R partial sums of a pixel's luminance; NaN for one replicate.
    pub fn variance(&self, pixel: usize, replicates: u32) -> f64 {
        let (r, y) = (f64::from(replicates), luminance_of(&self.sum[pixel]));
        let spread = r / (r - 1.0) * (self.square[pixel] - y * y / r).max(0.0);
        if replicates < 2 { f64::NAN } else { spread }
    }

    /// Writes the sums, to the bit.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        put(out, [self.sum.len() as u64])?;
        put_reals(out, self.sum.iter().flatten().chain(&self.square).copied())
    }

    /// Takes sums that were written in the place of these.
    ///
    /// # Errors
    /// Those of the reader; sums of another picture.
    pub fn read(&mut self, from: &mut dyn Read) -> io::Result<()> {
        expect(from, self.sum.len() as u64, "pixels")?;
        let mut all = self.sum.iter_mut().flatten().chain(&mut self.square);
        all.try_for_each(|sum| take_real(from).map(|x| *sum = x))
    }

    /// Zeros again.
    pub fn restart(&mut self) {
        self.sum.fill([0.0; C]);
        self.square.fill(0.0);
    }
}

impl<'s, const C: usize> Splat<'s, C> {
    /// Bytes that a picture of so many columns and rows takes while it is splatted: [`Film`] and these sums.
    pub fn memory_bytes(pixels: [u32; 2]) -> u64 {
        let of_pixel = size_of::<[WideSum; C]>() + size_of::<[f64; C]>() + size_of::<f64>();
        let number = u128::from(pixels[0]) * u128::from(pixels[1]);
        let sums = u64::try_from(number * of_pixel as u128).unwrap_or(u64::MAX);
        Film::<C>::memory_bytes(pixels).saturating_add(sums)
    }

    /// Sums at zero for a camera.
    ///
    /// # Errors
    /// A picture that takes more than [`film::MOST_PICTURE_BYTES`].
    pub fn new(scene: &'s Scene, spec: &Camera) -> Result<Self> {
        film::check_memory(spec.pixels, Self::memory_bytes(spec.pixels))?;
        let pixels = u64::from(spec.pixels[0]) * u64::from(spec.pixels[1]);
        let pinhole = Pinhole::new(spec);
        // A power of two near the scene's size, so that a scene and the same scene times a power of two agree
        // bit for bit.
        let (low, high) = scene.geometry.bounds();
        let size = (high - low).length().max((spec.position - low).length());
        let size = if size > 0.0 { libm::scalbn(1.0, libm::ilogb(size)) } else { 1.0 };
        let unit = pinhole.focal_px() * pinhole.focal_px() / (size * size);
        Ok(Self {
            scene,
            pinhole,
            pixels: spec.pixels,
            filter: spec.filter,
            scatters: scattering_surfaces(scene),
            sums: (0..pixels).map(|_| std::array::from_fn(|_| WideSum::default())).collect(),
            unit,
            size_squared: size * size,
            joined: AtomicU64::new(0),
            cut: AtomicU64::new(0),
        })
    }

    /// Goes on from so many arrivals that reached a pixel and so many contributions that were cut.
    pub fn after(&mut self, joined: u64, cut: u64) {
        (*self.joined.get_mut(), *self.cut.get_mut()) = (joined, cut);
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
            let y = luminance_of(&value);
            into.square[pixel] += y * y;
        }
    }

    /// Joins an arrival to the pinhole; whether it reached the picture.
    #[inline]
    fn join<T: Channels<C>>(&self, arrival: &Arrival<'_, T>) -> bool {
        let hit = arrival.hit;
        let Some(seen) = self.pinhole.project(hit.position) else { return false };
        let (p, wo, distance) = (seen.place_px, -seen.direction, seen.distance_m);
        let reach = filter::reach(self.filter);
        // Centres of pixels lie at halves.
        let first = |p: f64| libm::ceil(p - 0.5 - reach).max(0.0);
        let last = |p: f64, n: u32| libm::floor(p - 0.5 + reach).min(f64::from(n) - 1.0);
        let (left, right) = (first(p.x), last(p.x, self.pixels[0]));
        let (top, bottom) = (first(p.y), last(p.y, self.pixels[1]));
        if left > right || top > bottom {
            return false;
        }
        let f = value::<C>(self.scene.material(hit.surface), hit, -arrival.direction, wo);
        if f.iter().all(|f| *f <= 0.0) || self.is_hidden(hit, arrival.whereabouts, wo, distance) {
            return false;
        }
        let weight = arrival.carried.channels();
        // In terms of the unit; d^2 first: either may be far from 1, their product is not.
        let focal_px = self.pinhole.focal_px();
        let magnified = seen.pixels_per_sr / (focal_px * focal_px);
        let factor = self.size_squared / (distance * distance) * wo.dot(hit.normal).abs() * magnified;
        for row in top as u32..=bottom as u32 {
            let y = p.y - 0.5 - f64::from(row);
            for column in left as u32..=right as u32 {
                let h = filter::density(self.filter, [p.x - 0.5 - f64::from(column), y]);
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
        let mut whereabouts = arrived.clone();
        self.scene.media.leave(&mut whereabouts, hit, if along > 0.0 { Side::Front } else { Side::Back });
        self.scene.is_hidden(hit.position, wo, distance, &whereabouts)
    }
}

/// Standard error (cd/m2) of a pixel whose luminance is that of n photons, n below [`FEWEST_HITS`], so that their spread says
/// nothing: sqrt(n + 1) times the luminance of one photon that arrives where the pixel's middle looks. 0 from there on.
pub fn owed(view: &View<'_>, pixel: usize, photon_lm: f64, luminance_cd_m2: f64) -> f64 {
    let one = photon_lm * of_one_lumen(view, pixel);
    let photons = luminance_cd_m2 / one;
    // NaN or infinite where a pixel sees nothing that photons could be joined from: the comparison fails.
    if photons < FEWEST_HITS as f64 { one * (photons + 1.0).sqrt() } else { 0.0 }
}

/// Luminance (cd/m2) that a photon of 1 lm, arriving along the normal, brings to a pixel if it arrives where
/// the pixel's middle looks; 0 if nothing is there.
fn of_one_lumen(view: &View<'_>, pixel: usize) -> f64 {
    let columns = view.camera.pixels[0] as usize;
    let place = DVec2::new((pixel % columns) as f64 + 0.5, (pixel / columns) as f64 + 0.5);
    let ray = view.pinhole.ray(place);
    let Some(hit) = view.scene.geometry.nearest(ray.origin, ray.direction, &view.start, &mut 0) else {
        return 0.0;
    };
    let Some(seen) = view.pinhole.project(hit.position) else { return 0.0 };
    let to_eye = -seen.direction;
    let towards = if to_eye.dot(hit.normal) > 0.0 { hit.normal } else { -hit.normal };
    let bsdf = view.scene.material(hit.surface);
    let f = bsdf.eval(hit.normal, Leg::new(towards, hit.normal), Leg::new(to_eye, hit.normal));
    let h = filter::density(view.camera.filter, [0.0; 2]);
    let per_area = to_eye.dot(hit.normal).abs() / (seen.distance_m * seen.distance_m);
    luminance(f) * per_area * seen.pixels_per_sr * h
}

/// f(wi, wo) by channel, 1/sr; one channel sees white light's luminance.
#[inline]
fn value<const C: usize>(bsdf: &Material, hit: &Hit, wi: DVec3, wo: DVec3) -> [f64; C] {
    let arrived = Leg { direction: wi, front: hit.front };
    let rgb = bsdf.eval(hit.normal, arrived, Leg::new(wo, hit.normal));
    if C == 1 { [luminance(rgb); C] } else { std::array::from_fn(|c| rgb[c]) }
}

/// Joins the arrivals of one batch to the pinhole, direct light included, and adds them to a scene's
/// receivers.
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

    #[inline]
    fn emerge(&mut self, surface: SurfaceId, direction: DVec3) {
        <ReceiverSink<'_, '_> as Sink<T>>::emerge(&mut self.receivers, surface, direction);
    }

    #[inline]
    fn escape(&mut self, direction: DVec3) {
        <ReceiverSink<'_, '_> as Sink<T>>::escape(&mut self.receivers, direction);
    }
}

impl<const C: usize> Drop for SplatSink<'_, '_, C> {
    fn drop(&mut self) {
        self.splat.joined.fetch_add(self.joined, Ordering::Relaxed);
    }
}
