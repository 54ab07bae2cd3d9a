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
    let fov_deg = table.needed_number("fov_deg", &FOV);
    let pixels = table.cells("pixels", MOST_PIXELS, PIXELS_REQUIRED);
    let pixels = table.require("pixels", pixels, PIXELS_REQUIRED);
    let samples = read_samples(&mut table);
    let lens_radius_m = table.number("lens_radius", &LENS);
    let focus_m = table.number("focus", &LENGTH);
    let filter = table.word("filter", &FILTERS);
    let method = table.word("method", &METHODS);
    let bandwidth = read_bandwidth(&mut table);
    let kernel = table.word("kernel", &KERNELS);
    let background = table.number_or_vector("background", &LUMINANCE);
    let exposure = if table.is_text("exposure") {
        table.word("exposure", &EXPOSURES)
    } else {
        table.number("exposure", &WHITE).map(Exposure::White)
    };
    let filmic = table.truth("filmic");
    let false_colour = table.truth("false_colour");
    let memory_mb = table.number("photon_memory_mb", &MEMORY_MB);
    if method == Some(Method::Splat) {
        warn_of_the_map(&table);
    }
    let camera = view.zip(fov_deg).zip(pixels).and_then(|(((position, look_at, up), fov_deg), pixels)| {
        let default = CameraSpec::pinhole(position, look_at, up, fov_deg, pixels);
        table.accept(Camera::new(CameraSpec {
            samples: samples.unwrap_or(default.samples),
            lens_radius_m: lens_radius_m.unwrap_or(default.lens_radius_m),
            focus_m: focus_m.unwrap_or(default.focus_m),
            filter: filter.unwrap_or_default(),
            method: method.unwrap_or_default(),
            bandwidth,
            kernel: kernel.unwrap_or_default(),
            background_cd_m2: background.map_or([0.0; 3], |b| b.to_array()),
            exposure: exposure.unwrap_or_default(),
            filmic: filmic.unwrap_or(false),
            false_colour: false_colour.unwrap_or(false),
            photon_memory_bytes: memory_mb.map_or(default.photon_memory_bytes, |mb| (mb * 1e6) as u64),
            ..default
        }))
    });
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
        table.error(
            second,
            Kind::Range,
            "one of radius, nearest and progressive_radius, or none of them, not several",
        );
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
