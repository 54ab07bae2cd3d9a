//! How a picture was made and what it cost.

use std::collections::BTreeMap;

use serde::{Serialize, Serializer};

use crate::geometry::SurfaceId;
use crate::picture::camera::Film;
use crate::scene::camera::Method;
use crate::surface::luminance_of;

/// A bandwidth that was chosen, as report.json tells it.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Chosen {
    /// Radius, m; of nearest neighbours their mean distance, where it is known.
    pub radius_m: Option<f64>,
    /// Mean number of photons within it, where it is known.
    pub neighbours: Option<f64>,
}

/// How good a picture is: medians over the pixels that are not black.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize)]
pub struct Cost {
    /// Estimated bias over the pixel, percent.
    pub median_bias_percent: Option<f64>,
    /// Standard error over the pixel, percent.
    pub median_standard_error_percent: Option<f64>,
}

/// How a picture was made, and how good it is. Names are those of report.json: they are only added to.
#[derive(Debug, Clone, PartialEq, Default, Serialize)]
pub struct PictureSummary {
    /// How light got from photons into pixels.
    #[serde(serialize_with = "word")]
    pub method: Method,
    /// Of light that no surface scattered before it arrived, and of all other.
    #[serde(skip_serializing_if = "Option::is_none", serialize_with = "by_density")]
    pub bandwidth: Option<[Chosen; 2]>,
    /// How good it is.
    #[serde(flatten)]
    pub cost: Cost,
    /// Photons that it stands for.
    pub photons: u64,
    /// Replicates they belong to.
    #[serde(skip)]
    pub replicates: u32,
    /// Photons that were kept on surfaces, all passes together; for a splat the arrivals that reached a
    /// pixel.
    pub photons_kept: u64,
    /// Passes that memory made necessary.
    pub passes: u32,
    /// Eye paths that were ended because they did not end by themselves.
    pub eye_paths_killed: u64,
    /// Eye paths, one a sample.
    #[serde(skip)]
    pub eye_paths: u64,
    /// Those that reached a surface in another medium than the scene says is there; report.json has a warning of it.
    #[serde(skip)]
    pub eye_paths_contradicted: BTreeMap<SurfaceId, u64>,
    /// Splats of a photon that were cut to the largest that is added: the pinhole all but touches a surface.
    pub splats_cut: u64,
    /// Pixels that an interrupt left unseen: black, with an unknown error.
    pub pixels_unseen: u64,
    /// Time of the maps and the camera, s. (What a splat takes is part of the tracing.)
    pub time_s: f64,
}

fn word<S: Serializer>(method: &Method, to: S) -> Result<S::Ok, S::Error> {
    to.serialize_str(method.word())
}

fn by_density<S: Serializer>(bandwidth: &Option<[Chosen; 2]>, to: S) -> Result<S::Ok, S::Error> {
    to.collect_map(["caustic", "diffuse"].into_iter().zip(bandwidth.iter().flatten()))
}

impl Cost {
    /// Of a film.
    pub fn of<const C: usize>(film: &Film<C>) -> Self {
        let median_of = |errors: &[f64]| {
            let mut parts: Vec<f64> = film
                .value
                .iter()
                .zip(errors)
                .map(|(value, error)| 100.0 * error.abs() / luminance_of(value))
                .filter(|percent| percent.is_finite())
                .collect();
            median(&mut parts)
        };
        Self {
            median_bias_percent: median_of(&film.bias),
            median_standard_error_percent: median_of(&film.standard_error),
        }
    }
}

/// The lower median; `None` of nothing.
fn median(values: &mut [f64]) -> Option<f64> {
    if values.is_empty() {
        return None;
    }
    let middle = (values.len() - 1) / 2;
    Some(*values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn medians_are_over_lit_pixels_with_a_known_error() {
        let film = Film::<1> {
            pixels: [5, 1],
            value: vec![[0.0], [10.0], [20.0], [40.0], [50.0]],
            standard_error: vec![1.0, 1.0, 1.0, 1.0, f64::NAN],
            bias: vec![0.0; 5],
        };
        let cost = Cost::of(&film);
        assert_eq!(cost.median_standard_error_percent, Some(5.0));
        assert_eq!(cost.median_bias_percent, Some(0.0));
        let dark = Film::<1> { value: vec![[0.0]; 5], ..film };
        assert_eq!(Cost::of(&dark).median_bias_percent, None);
    }
}
