//! `[camera]`: the picture that is made of a scene.

use glam::DVec3;

use crate::error::Kind;
use crate::files::scene_toml::description::CameraDescription;
use crate::files::scene_toml::toml_table::{Interval, Table};
use crate::files::scene_toml::{COORDINATE, DIRECTION, LENGTH, unit};
use crate::math::frame::orthogonal_part;
use crate::scene::camera::{Bandwidth, CameraSpec, Exposure, Filter, Kernel, Method};

/// Most pixels: 2^26, an image of 8192 x 8192.
pub const MOST_PIXELS: u64 = 1 << 26;
/// Most eye paths a pixel.
const MOST_SAMPLES: u64 = 1 << 16;
/// Most neighbours of a density estimate.
const MOST_NEAREST: u64 = 1 << 20;

const FOV: Interval = Interval { low: 1e-3, high: 179.0, words: "an angle from 0.001 to 179 degrees" };
const LENS: Interval = Interval { low: 0.0, high: 1e9, words: "a radius from 0 (a pinhole) to 1e9 m" };
const LUMINANCE: Interval = Interval { low: 0.0, high: 1e15, words: "a luminance from 0 to 1e15 cd/m2" };
const WHITE: Interval =
    Interval { low: 1e-9, high: 1e15, words: "\"auto\", or the luminance of white, 1e-9 to 1e15 cd/m2" };
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

pub(crate) fn read(mut table: Table<'_, '_>) -> Option<CameraDescription> {
    let place = table.place();
    let view = read_view(&mut table);
    let fov_deg = table.number("fov_deg", &FOV);
    let fov_deg = table.require("fov_deg", fov_deg, FOV.words);
    let pixels = read_pixels(&mut table);
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
        check_splat(&table, lens_radius_m);
    }
    table.finish();

    let (position, look_at, up) = view?;
    let default = CameraSpec::pinhole(position, look_at, up, fov_deg?, pixels?);
    let spec = CameraSpec {
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
    };
    Some(CameraDescription { spec, place })
}

/// Position, the point looked at, and a direction that is up and not along the view.
fn read_view(table: &mut Table<'_, '_>) -> Option<(DVec3, DVec3, DVec3)> {
    const UP: &str = "a direction [x, y, z] that is not zero and not along the view";
    let position = table.vector("position", &COORDINATE);
    let position = table.require("position", position, "[x, y, z] in metres");
    let look_at = table.vector("look_at", &COORDINATE);
    let look_at = table.require("look_at", look_at, "[x, y, z] in metres, what is in the middle");
    let given = table.vector("up", &DIRECTION);
    let (position, look_at) = (position?.value, look_at?.value);
    let Some(forward) = unit(look_at - position) else {
        table.error("look_at", Kind::Range, "a point away from position");
        return None;
    };
    let across = |up| orthogonal_part(up, forward);
    if table.place_of("up").is_none() {
        return Some((position, look_at, across(DVec3::Z).or_else(|| across(DVec3::Y))?));
    }
    let up = unit(given?.value).and_then(across);
    if up.is_none() {
        table.error("up", Kind::Range, UP);
    }
    Some((position, look_at, up?))
}

fn read_pixels(table: &mut Table<'_, '_>) -> Option<[u32; 2]> {
    const REQUIRED: &str = "[columns, rows], each at least 1, at most 2^26 in all";
    let pixels = table.cells("pixels", MOST_PIXELS, REQUIRED);
    table.require("pixels", pixels, REQUIRED)
}

/// Samples come in four sets, whose spread is part of the error.
fn read_samples(table: &mut Table<'_, '_>) -> Option<u32> {
    const REQUIRED: &str = "a multiple of 4 from 4 to 65536";
    let samples = table.integer("samples", 4, MOST_SAMPLES, REQUIRED)?.value;
    if !samples.is_multiple_of(4) {
        table.error("samples", Kind::Range, REQUIRED);
    }
    Some(samples as u32)
}

/// One of `radius`, `nearest` and `progressive_radius`, or none.
fn read_bandwidth(table: &mut Table<'_, '_>) -> Bandwidth {
    let radius = table.number("radius", &LENGTH);
    let words = "a whole number of photons from 2 to 2^20";
    let nearest = table.integer("nearest", 2, MOST_NEAREST, words);
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
        .or(nearest.map(|k| Bandwidth::Nearest(k.value as u32)))
        .or(progressive.map(Bandwidth::Progressive))
        .unwrap_or_default()
}

/// What a picture by splatting cannot have, and what it does not look at.
fn check_splat(table: &Table<'_, '_>, lens_radius_m: Option<f64>) {
    if lens_radius_m.is_some_and(|r| r > 0.0) {
        table.error("lens_radius", Kind::Range, "0 with method = \"splat\": photons are joined to one point");
    }
    for key in OF_THE_MAP {
        if let Some(place) = table.place_of(key) {
            let found = format!("{key} with method = \"splat\"");
            let required = "method = \"map\" for it to matter: splatting estimates no density";
            table.document().warn_at(place, Kind::Unknown, found, required);
        }
    }
}
