//! The bias of the photon map's pictures, measured: caustics by the map against the same light joined to the pinhole.
//!
//! Only light of L S+ D E is compared: what reached a scattering surface through mirrors and glass alone and is seen there directly.
//! Direct light, emitters and light that was scattered before are in neither picture, so that no pixel's error is divided by
//! light that the density estimate has no part in. The splat has no density bias; its standard error is known and is taken
//! into account. Pixels through which the camera sees anything but scattering surfaces are left out: the splat does not see
//! L S+ D S E.
//!
//! The map's error of one run is noise and bias. The mean over several seeds less the splat is its bias, with noise less by the root
//! of their number.
//!
//! Shared by `bias.rs` and `examples/picture_bias.rs`.
#![allow(dead_code)]

use std::sync::Arc;
use std::sync::atomic::AtomicBool;

use glam::DVec2;

use caustix::error::Result;
use caustix::picture::camera::splat;
use caustix::picture::camera::splat::{Splat, SplatMoments, SplatSink};
use caustix::picture::camera::{Film, Pass, Sums, View, render};
use caustix::picture::gather::footprint::Footprints;
use caustix::picture::gather::{Choice, Density, bandwidth};
use caustix::picture::photon_map::sink::scattering_surfaces;
use caustix::picture::photon_map::{PhotonMap, PhotonStore};
use caustix::run::Plan;
use caustix::run::tracer::Tracer;
use caustix::scene::Scene;
use caustix::scene::camera::{Bandwidth, Camera};
use caustix::surface::Rgb;
use caustix::surface::reflectance::luminance;
use caustix::tally::Receivers;
use caustix::transport::{Arrival, Sink};

/// Rays a pixel, along each side, that tell what it sees.
const PROBES: u32 = 8;

/// Relative standard error of the reference beyond which a pixel has no relative error: there is hardly any light.
pub const MOST_REFERENCE_ERROR: f64 = 0.05;

/// A picture without density bias.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    /// Luminance, cd/m2, row by row.
    pub value: Vec<f64>,
    /// Its standard error, cd/m2.
    pub standard_error: Vec<f64>,
    /// Whether nothing but scattering surfaces is seen through the pixel, and directly.
    pub seen: Vec<bool>,
}

impl Reference {
    /// Pixels that are compared.
    pub fn compared(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.value.len()).filter(|p| self.seen[*p])
    }

    /// Those among them that have a relative error.
    pub fn lit(&self) -> impl Iterator<Item = usize> + '_ {
        self.compared().filter(|&p| self.standard_error[p] < MOST_REFERENCE_ERROR * self.value[p])
    }
}

/// A picture by the map.
#[derive(Debug, Clone, PartialEq)]
pub struct Mapped {
    /// Luminance, cd/m2, row by row.
    pub value: Vec<f64>,
    /// Its standard error, cd/m2.
    pub standard_error: Vec<f64>,
    /// Its bias figure, cd/m2.
    pub bias: Vec<f64>,
    /// Radius, m; 0 where the bandwidth has none.
    pub radius_m: f64,
}

/// Passes on the arrivals of light that went through at least one event, none of them on a surface that scatters.
struct CausticOnly<'r, 's> {
    splat: SplatSink<'r, 's, 3>,
    scatters: &'r [bool],
    scattered: bool,
}

impl Sink<Rgb> for CausticOnly<'_, '_> {
    fn arrive(&mut self, arrival: &Arrival<'_, Rgb>) {
        if arrival.events == 0 {
            self.scattered = false;
        }
        if arrival.events > 0 && !self.scattered {
            self.splat.arrive(arrival);
        }
        self.scattered |= self.scatters[arrival.hit.surface.0 as usize];
    }
}

/// The pixels through whose own squares nothing but scattering surfaces is seen, and directly; row by row.
///
/// # Errors
/// A camera that sees nothing.
pub fn seen_directly(scene: &Scene, spec: &Camera) -> Result<Vec<bool>> {
    let view = View::new(scene, spec, 0)?;
    let scatters = scattering_surfaces(scene);
    let at_once = |place: DVec2| {
        let ray = view.pinhole.ray(place);
        let hit = scene.geometry.nearest(ray.origin, ray.direction, &view.start, &mut 0);
        hit.is_some_and(|hit| scatters[hit.surface.0 as usize])
    };
    let [columns, rows] = spec.pixels;
    // From edge to edge, both included.
    let step = 1.0 / f64::from(PROBES - 1);
    let pixel = |column: u32, row: u32| {
        (0..PROBES * PROBES).all(|k| {
            let [dx, dy] = [k % PROBES, k / PROBES].map(|i| step * f64::from(i));
            at_once(DVec2::new(f64::from(column) + dx, f64::from(row) + dy))
        })
    };
    Ok((0..rows)
        .flat_map(|row| (0..columns).map(move |column| (column, row)))
        .map(|(c, r)| pixel(c, r))
        .collect())
}

/// The caustics by splatting.
///
/// # Errors
/// Those of tracing; a camera that sees nothing or is too large.
pub fn splatted(scene: &Scene, spec: &Camera, plan: &Plan) -> Result<Reference> {
    let mut splat = Splat::<3>::new(scene, spec)?;
    let mut moments = SplatMoments::<3>::new(spec.pixels[0] as usize * spec.pixels[1] as usize);
    let nobody = Receivers::new(&scene.geometry, &[]);
    let scatters = scattering_surfaces(scene);
    for replicate in 0..plan.replicates() {
        let n = plan.photons_per_replicate();
        let mut tracer = Tracer::new(scene, plan.algorithm(), plan.seed(), replicate, n);
        let sink = || CausticOnly { splat: splat.sink(nobody.sink()), scatters: &scatters, scattered: false };
        tracer.trace_into(n, Rgb::WHITE, sink, &AtomicBool::new(false), &|_| {})?;
        splat.close(&mut moments, true);
    }
    let photon_lm = scene.emitters.flux_lm() / plan.photons() as f64;
    let error = |pixel| moments.variance(pixel, plan.replicates()).sqrt() * photon_lm;
    let mut reference = Reference {
        standard_error: (0..moments.sum.len()).map(error).collect(),
        value: moments.sum.iter().map(|sum| luminance(*sum) * photon_lm).collect(),
        seen: seen_directly(scene, spec)?,
    };
    let view = View::new(scene, spec, 0)?;
    for pixel in 0..reference.value.len() {
        let owed = splat::owed(&view, pixel, photon_lm, reference.value[pixel]);
        reference.standard_error[pixel] = reference.standard_error[pixel].hypot(owed);
    }
    Ok(reference)
}

/// The caustics by the photon map, as `method = "map"` makes them of the same photons.
///
/// # Errors
/// Those of tracing; a camera that sees nothing or is too large.
pub fn mapped(scene: &Scene, spec: &Camera, plan: &Plan) -> Result<Mapped> {
    let mut store = PhotonStore::<3>::new(scene);
    let nobody = Receivers::new(&scene.geometry, &[]);
    for replicate in 0..plan.replicates() {
        let n = plan.photons_per_replicate();
        let mut tracer = Tracer::new(scene, plan.algorithm(), plan.seed(), replicate, n);
        let sink = || store.sink(nobody.sink(), replicate);
        tracer.trace_into(n, Rgb::WHITE, sink, &AtomicBool::new(false), &|_| {})?;
    }
    let frame = store.frame();
    let [caustic, _] = store.take().unwrap_or_default();
    let map = PhotonMap::build(caustic.concat(), frame, 0.0);
    let photon_lm = scene.emitters.flux_lm() / plan.photons() as f64;
    let footprints = Arc::new(Footprints::new(&scene.geometry));
    let bandwidth = match spec.bandwidth {
        Bandwidth::Automatic if !map.photons().is_empty() => {
            bandwidth::choose(&footprints, &map, spec.kernel, plan.replicates(), 1.0).bandwidth()
        }
        named => named,
    };
    let radius_m = match bandwidth {
        Bandwidth::AtLeast { radius_m, .. }
        | Bandwidth::Radius(radius_m)
        | Bandwidth::Progressive(radius_m) => radius_m,
        Bandwidth::Automatic | Bandwidth::Nearest(_) => 0.0,
    };
    let map = map.rebuilt(radius_m);
    let choice = Choice { bandwidth, kernel: spec.kernel, replicates: plan.replicates() };
    let densities = [Density::new(footprints, &map, photon_lm, choice)];
    let mut sums = Sums::new(spec.pixels)?;
    let view = View::new(scene, spec, plan.seed())?;
    let replicates = 0..plan.replicates();
    let pass = Pass { densities: &densities, replicates, finishes: true, emission: false, direct: false };
    render(&view, &pass, &mut sums, &AtomicBool::new(false), &|_| {})?;
    let Film { value, standard_error, bias, .. } = sums.finish();
    Ok(Mapped { value: value.into_iter().map(luminance).collect(), standard_error, bias, radius_m })
}

/// What pictures of several seeds say at one number of photons. Parts and medians are over pixels and seeds; relative numbers
/// are fractions of the reference, over its lit pixels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Row {
    /// Photons of a picture.
    pub photons: u64,
    /// Mean radius, m.
    pub radius_m: f64,
    /// Median size of map - splat.
    pub error: f64,
    /// Median standard error of the map.
    pub standard_error: f64,
    /// Median bias figure.
    pub figure: f64,
    /// Median size of the bias: that of the mean over the seeds less the splat, noise of both included.
    pub bias: f64,
    /// Median standard error of that bias.
    pub bias_error: f64,
    /// Part of the pixels where the bias figure is at least map - splat.
    pub figure_covers_error: f64,
    /// Part of the pixels where the bias figure is at least the bias.
    pub figure_covers_bias: f64,
    /// The same over the pixels alone whose bias is beyond three of its own standard errors, where it is not mostly noise. NaN
    /// where there are none.
    pub figure_covers_clear_bias: f64,
    /// Part of the pixels that are compared, lit or not, where map - splat is within the bias figure and three standard errors
    /// of both.
    pub agree: f64,
}

impl Row {
    /// Of pictures of so many photons, one a seed.
    pub fn new(reference: &Reference, photons: u64, pictures: &[Mapped]) -> Self {
        let lit: Vec<usize> = reference.lit().collect();
        let truth = |p: usize| reference.value[p];
        let of_all = |of: &dyn Fn(&Mapped, usize) -> f64| -> Vec<f64> {
            pictures.iter().flat_map(|m| lit.iter().map(move |&p| of(m, p))).collect()
        };
        let biases: Vec<[f64; 2]> =
            (0..reference.value.len()).map(|p| mean_bias(reference, pictures, p)).collect();
        let bias = |p: usize| biases[p];
        let within = |m: &Mapped, p: usize| {
            let error = m.standard_error[p].hypot(reference.standard_error[p]);
            (m.value[p] - truth(p)).abs() <= m.bias[p] + 3.0 * error
        };
        let agreeing = |m: &Mapped| {
            mean(&reference.compared().map(|p| f64::from(u8::from(within(m, p)))).collect::<Vec<_>>())
        };
        let clear = |p: usize| bias(p)[0].abs() > 3.0 * bias(p)[1];
        let pairs_covered = |which: &dyn Fn(usize) -> bool| {
            let covered = |m: &Mapped, p: usize| f64::from(u8::from(bias(p)[0].abs() <= m.bias[p]));
            let covered = &covered;
            let some: Vec<usize> = lit.iter().copied().filter(|&p| which(p)).collect();
            mean(&pictures.iter().flat_map(|m| some.iter().map(move |&p| covered(m, p))).collect::<Vec<_>>())
        };
        Self {
            photons,
            radius_m: mean(&pictures.iter().map(|m| m.radius_m).collect::<Vec<_>>()),
            error: median(of_all(&|m, p| (m.value[p] - truth(p)).abs() / truth(p))),
            standard_error: median(of_all(&|m, p| m.standard_error[p] / truth(p))),
            figure: median(of_all(&|m, p| m.bias[p] / truth(p))),
            bias: median(lit.iter().map(|&p| bias(p)[0].abs() / truth(p)).collect()),
            bias_error: median(lit.iter().map(|&p| bias(p)[1] / truth(p)).collect()),
            figure_covers_error: mean(&of_all(&|m, p| {
                f64::from(u8::from((m.value[p] - truth(p)).abs() <= m.bias[p]))
            })),
            figure_covers_bias: pairs_covered(&|_| true),
            figure_covers_clear_bias: pairs_covered(&clear),
            agree: mean(&pictures.iter().map(agreeing).collect::<Vec<_>>()),
        }
    }
}

impl Row {
    /// [`Self::bias`] with the noise taken out in squares, as it is for biases and noise that are normally distributed over the
    /// pixels, the median of whose size is 0.674 of their standard deviation; 0 where noise leaves nothing.
    pub fn bias_without_noise(&self) -> f64 {
        let noise = MEDIAN_OF_NORMAL * self.bias_error;
        (self.bias * self.bias - noise * noise).max(0.0).sqrt()
    }
}

/// Median size of a number of the standard normal distribution.
const MEDIAN_OF_NORMAL: f64 = 0.674_489_750_196_081_7;

/// Mean over the seeds of map - splat in a pixel, and its standard error.
fn mean_bias(reference: &Reference, pictures: &[Mapped], pixel: usize) -> [f64; 2] {
    let n = pictures.len() as f64;
    let centre = pictures.iter().map(|m| m.value[pixel]).sum::<f64>() / n;
    let squares: f64 = pictures.iter().map(|m| (m.value[pixel] - centre).powi(2)).sum();
    let error = (squares / (n * (n - 1.0))).sqrt().hypot(reference.standard_error[pixel]);
    [centre - reference.value[pixel], error]
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// The lower median; NaN of nothing.
fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return f64::NAN;
    }
    let middle = (values.len() - 1) / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Exponent of N with which a value of the rows falls: the slope of its logarithm by least squares.
pub fn rate(rows: &[Row], value: impl Fn(&Row) -> f64) -> f64 {
    let points: Vec<[f64; 2]> =
        rows.iter().map(|r| [libm::log(r.photons as f64), libm::log(value(r))]).collect();
    let centre = [0, 1].map(|k| mean(&points.iter().map(|p| p[k]).collect::<Vec<_>>()));
    let moment = |k: usize| points.iter().map(|p| (p[0] - centre[0]) * (p[k] - centre[k])).sum::<f64>();
    moment(1) / moment(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Pictures of 1000 pixels of 10 cd/m2 with this bias, this noise (rectangular) and this bias figure.
    fn pictures(bias: f64, noise: f64, figure: f64, seeds: u64) -> (Reference, Vec<Mapped>) {
        let n = 1000;
        let reference =
            Reference { value: vec![10.0; n], standard_error: vec![1e-6; n], seen: vec![true; n] };
        let picture = |seed: u64| {
            let u = |p: usize| (((p as u64 * 8 + seed) * 40_503) % 65_536) as f64 / 65_536.0 - 0.5;
            Mapped {
                value: (0..n).map(|p| 10.0 + bias + noise * 12f64.sqrt() * u(p)).collect(),
                standard_error: vec![noise; n],
                bias: vec![figure; n],
                radius_m: 0.5,
            }
        };
        (reference, (0..seeds).map(picture).collect())
    }

    #[test]
    fn bias_is_told_from_noise() {
        let (reference, all) = pictures(0.2, 0.4, 0.1, 8);
        let row = Row::new(&reference, 64, &all);
        assert!(row.bias > 0.0 && row.bias_error > 0.01, "{row:?}");
        assert!((row.standard_error - 0.04).abs() < 1e-12 && (row.figure - 0.01).abs() < 1e-12);
        assert!(row.figure_covers_bias < 0.4 && row.agree > 0.99, "{row:?}");
        let (reference, all) = pictures(0.2, 1e-9, 0.199, 2);
        let row = Row::new(&reference, 64, &all);
        assert_eq!([row.figure_covers_error, row.figure_covers_bias, row.figure_covers_clear_bias], [0.0; 3]);
        let (reference, all) = pictures(-0.2, 1e-9, 0.201, 2);
        let row = Row::new(&reference, 64, &all);
        assert_eq!([row.figure_covers_error, row.figure_covers_bias, row.agree], [1.0; 3]);
    }

    #[test]
    fn noise_alone_is_no_bias_and_clear_bias_stays() {
        // Biases in normal quantiles, 2 % wide, with noise of 1 %: their sum is wider by sqrt(1.25).
        let (reference, all) = pictures(0.2, 1e-9, 0.1, 2);
        let row = Row::new(&reference, 64, &all);
        let noisy = Row { bias: MEDIAN_OF_NORMAL * 0.02 * 1.25f64.sqrt(), bias_error: 0.01, ..row };
        assert!((noisy.bias_without_noise() - MEDIAN_OF_NORMAL * 0.02).abs() < 1e-12);
        assert_eq!(Row { bias: 0.006, bias_error: 0.01, ..row }.bias_without_noise(), 0.0);
        assert!((row.bias_without_noise() - 0.02).abs() < 1e-6, "{row:?}");
    }

    #[test]
    fn what_is_not_seen_or_hardly_lit_does_not_count() {
        let (mut reference, mut all) = pictures(0.0, 1e-9, 0.1, 2);
        reference.seen[0] = false;
        reference.standard_error[1] = 1.0;
        for picture in &mut all {
            picture.value[0] = 1e3;
            picture.value[1] = 11.0;
            picture.bias[1] = 0.0;
        }
        assert_eq!((reference.compared().count(), reference.lit().count()), (999, 998));
        let row = Row::new(&reference, 64, &all);
        assert_eq!([row.agree, row.figure_covers_error], [1.0; 2]);
    }

    #[test]
    fn a_power_law_has_its_rate() {
        let (reference, all) = pictures(0.2, 0.4, 0.1, 2);
        let row =
            |photons: u64| Row { figure: (photons as f64).powf(-0.3), ..Row::new(&reference, photons, &all) };
        let rows = [row(100), row(1000), row(50_000)];
        assert!((rate(&rows, |r| r.figure) + 0.3).abs() < 1e-12);
    }
}
