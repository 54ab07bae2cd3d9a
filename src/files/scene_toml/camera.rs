//! `[camera]`: the picture that is made of a scene.

use glam::DVec3;

use super::numbers::DIRECTION;
use super::table::Table;
use crate::error::Kind;
use crate::error::invalid::Interval;
use crate::geometry::{COORDINATE, LENGTH};
use crate::math::frame::{orthogonal_part, unit};
use crate::scene::camera::{
    Bandwidth, Camera, CameraSpec, Exposure, FOV, Filter, Kernel, LENS, LUMINANCE, MOST_NEAREST, MOST_PIXELS,
    MOST_SAMPLES, Method, NEAREST_REQUIRED, PIXELS_REQUIRED, WHITE,
};

const MEMORY_MB: Interval = Interval { low: 1.0, high: 1e9, words: "a number of megabytes from 1 to 1e9" };

/// Meanings with their words.
macro_rules! worded {
    ($($meaning:expr),+) => { [$(($meaning.word(), $meaning)),+] };
}
const FILTERS: [(&str, Filter); 3] = worded!(Filter::Box, Filter::Tent, Filter::Gaussian);
const METHODS: [(&str, Method); 2] = worded!(Method::Map, Method::Splat);
const KERNELS: [(&str, Kernel); 2] = worded!(Kernel::Flat, Kernel::Epanechnikov);
const EXPOSURES: [(&str, Exposure); 1] = [("auto", Exposure::Auto)];

/// The keys that only a density estimate looks at.
const OF_THE_MAP: [&str; 4] = ["radius", "nearest", "progressive_radius", "kernel"];

pub(super) fn read(mut table: Table<'_, '_>) -> Option<Camera> {
    let view = read_view(&mut table);
    let fov_deg = table.needed("fov_deg", FOV.words, |t, key| t.angle(key, &FOV));
    let pixels = table.needed("pixels", PIXELS_REQUIRED, |t, key| t.cells(key, MOST_PIXELS, PIXELS_REQUIRED));
    let needed = view.zip(fov_deg).zip(pixels);
    // Where one of them is missing, the rest is read all the same, so that all its errors are told.
    let ((view, fov_deg), pixels) = needed.unwrap_or_default();
    let mut spec = CameraSpec::pinhole(view.0, view.1, view.2, fov_deg, pixels);
    spec.samples = read_samples(&mut table).unwrap_or(spec.samples);
    spec.lens_radius_m = table.number("lens_radius", &LENS).unwrap_or(spec.lens_radius_m);
    spec.focus_m = table.number("focus", &LENGTH).unwrap_or(spec.focus_m);
    spec.filter = table.word("filter", &FILTERS).unwrap_or_default();
    spec.method = table.word("method", &METHODS).unwrap_or_default();
    spec.bandwidth = read_bandwidth(&mut table);
    spec.kernel = table.word("kernel", &KERNELS).unwrap_or_default();
    spec.background_cd_m2 = table.number_or_vector("background", &LUMINANCE).unwrap_or_default().to_array();
    let exposure = if table.word_of("exposure").is_some() {
        table.word("exposure", &EXPOSURES)
    } else {
        table.number("exposure", &WHITE).map(Exposure::White)
    };
    spec.exposure = exposure.unwrap_or_default();
    spec.filmic = table.truth("filmic").unwrap_or(false);
    spec.false_colour = table.truth("false_colour").unwrap_or(false);
    if let Some(mb) = table.number("photon_memory_mb", &MEMORY_MB) {
        spec.photon_memory_bytes = (mb * 1e6) as u64;
    }
    if spec.method == Method::Splat {
        warn_of_the_map(&table);
    }
    let camera = needed.and_then(|_| table.accept(Camera::new(spec)));
    table.finish();
    camera
}

/// Position, the point looked at, and a direction that is up and not along the view.
fn read_view(table: &mut Table<'_, '_>) -> Option<(DVec3, DVec3, DVec3)> {
    const UP: &str = "a direction [x, y, z] that is not zero and not along the view";
    let position = table.needed_vector("position", &COORDINATE, "[x, y, z] in metres");
    let look_at = table.needed_vector("look_at", &COORDINATE, "[x, y, z] in metres, what is in the middle");
    let given = table.vector("up", &DIRECTION);
    let (position, look_at) = (position?, look_at?);
    let Some(forward) = unit(look_at - position) else {
        table.error("look_at", Kind::Range, "a point away from position");
        return None;
    };
    let across = |up| orthogonal_part(up, forward);
    if table.place_of("up").is_none() {
        return Some((position, look_at, across(DVec3::Z).or_else(|| across(DVec3::Y))?));
    }
    let up = unit(given?).and_then(across);
    if up.is_none() {
        table.error("up", Kind::Range, UP);
    }
    Some((position, look_at, up?))
}

/// Samples come in four sets, whose spread is part of the error.
fn read_samples(table: &mut Table<'_, '_>) -> Option<u32> {
    const REQUIRED: &str = "a multiple of 4 from 4 to 65536";
    let samples = table.integer("samples", 4, MOST_SAMPLES.into(), REQUIRED)?;
    if !samples.is_multiple_of(4) {
        table.error("samples", Kind::Range, REQUIRED);
    }
    Some(samples as u32)
}

/// One of `radius`, `nearest` and `progressive_radius`, or none.
fn read_bandwidth(table: &mut Table<'_, '_>) -> Bandwidth {
    let radius = table.number("radius", &LENGTH);
    let nearest = table.integer("nearest", 2, MOST_NEAREST.into(), NEAREST_REQUIRED);
    let progressive = table.number("progressive_radius", &LENGTH);
    let mut given =
        ["radius", "nearest", "progressive_radius"].map(|key| (table.place_of(key), key)).to_vec();
    given.retain(|(place, _)| place.is_some());
    given.sort_unstable();
    if let [_, (_, second), ..] = given[..] {
        let required = "one of radius, nearest and progressive_radius, or none of them, not several";
        table.error(second, Kind::Range, required);
    }
    radius
        .map(Bandwidth::Radius)
        .or(nearest.map(|k| Bandwidth::Nearest(k as u32)))
        .or(progressive.map(Bandwidth::Progressive))
        .unwrap_or_default()
}

/// Warns of keys that a picture by splatting does not look at.
fn warn_of_the_map(table: &Table<'_, '_>) {
    for key in OF_THE_MAP {
        if let Some(place) = table.place_of(key) {
            let found = format!("{key} with method = \"splat\"");
            let required = "method = \"map\" for it to matter: splatting estimates no density";
            table.document().warn_at(place, Kind::Unknown, found, required);
        }
    }
}
