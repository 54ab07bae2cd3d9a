//! `type = "heightfield"`: waves, noise or an image over a rectangle.

use crate::error::Kind;
use crate::files::scene_toml::description::{
    Facing, HeightfieldDescription, OctaveDescription, Placed, ReliefDescription, ShapeDescription,
    SurfaceDescription, WaveDescription,
};
use crate::files::scene_toml::document::Document;
use crate::files::scene_toml::toml_table::{Interval, Table, shown};
use crate::files::scene_toml::{ANGLE, COORDINATE, LENGTH};

/// Most cells of one heightfield: 2^22, eight million triangles.
pub const MOST_CELLS: u64 = 1 << 22;
/// Most cells of all heightfields of a scene: 2^24, about eight gigabytes of triangles and search structure.
const MOST_CELLS_TOGETHER: u64 = 1 << 24;
const MOST_WAVES: usize = 256;
const MOST_OCTAVES: usize = 32;

const HEIGHT: Interval = Interval { low: -1e9, high: 1e9, words: "a height from -1e9 to 1e9 m" };
const PEAK: Interval = Interval { low: 0.0, high: 1e9, words: "a height from 0 to 1e9 m" };
const RELATIVE: Interval = Interval { low: 0.0, high: 1e9, words: "a relative amplitude from 0 to 1e9" };

const FACING: [(&str, Facing); 2] = [("up", Facing::Up), ("down", Facing::Down)];

const RELIEFS: [&str; 3] = ["waves", "noise", "image"];

pub(crate) fn read(table: &mut Table<'_, '_>) -> Option<HeightfieldDescription> {
    table.call("a heightfield");
    let origin = table.vector("origin", &COORDINATE);
    let origin = table.require("origin", origin, "[x, y, z] of its corner in metres");
    let size = table.numbers::<2>("size", &LENGTH);
    let size = table.require("size", size, "[extent along x, extent along y] in metres");
    let facing = table.word("facing", &FACING);
    let facing = table.require("facing", facing, "\"up\" or \"down\"");
    let smooth = table.truth("smooth").unwrap_or(true);
    let relief = read_relief(table);
    Some(HeightfieldDescription {
        origin: origin?.value,
        size: size?,
        facing: facing?,
        smooth,
        relief: relief?,
    })
}

/// Refuses heightfields that are each small enough but not together: an error at the first that is too much. An image
/// without cells counts by its file, which has a cap of its own.
pub(crate) fn check_total(document: &Document<'_>, surfaces: &[Option<SurfaceDescription>]) {
    let mut total = 0u64;
    for surface in surfaces.iter().flatten() {
        let ShapeDescription::Heightfield(field) = &surface.shape else { continue };
        let cells = match &field.relief {
            ReliefDescription::Waves { cells, .. } | ReliefDescription::Noise { cells, .. } => Some(*cells),
            ReliefDescription::Image { cells, .. } => *cells,
        };
        total += cells.map_or(0, |[nx, ny]| u64::from(nx) * u64::from(ny));
        if total > MOST_CELLS_TOGETHER {
            let found =
                format!("the heightfield `{}`, with which there are {total} cells", shown(&surface.name));
            let required = "at most 2^24 cells in all heightfields of a scene";
            document.error_at(surface.place, Kind::Limit, found, required);
            return;
        }
    }
}

fn read_relief(table: &mut Table<'_, '_>) -> Option<ReliefDescription> {
    const CELLS: &str = "[cells along x, cells along y], each at least 1, at most 2^22 in all";
    let cells = table.cells("cells", MOST_CELLS, CELLS);
    let waves = read_waves(table);
    let noise = read_noise(table);
    let image = read_image(table);
    let given: Vec<&str> = RELIEFS.into_iter().filter(|key| table.place_of(key).is_some()).collect();
    match given[..] {
        [] => {
            table.error("waves", Kind::Missing, "[{ ... }], or noise = { ... }, or image = \"file.png\"");
            None
        }
        ["image"] => image.map(|(file, height)| ReliefDescription::Image { cells, file, height }),
        [one] => {
            let cells = table.require("cells", cells, CELLS)?;
            if one == "waves" {
                return waves.map(|waves| ReliefDescription::Waves { cells, waves });
            }
            noise.map(|(seed, amplitude, octaves)| ReliefDescription::Noise {
                cells,
                seed,
                amplitude,
                octaves,
            })
        }
        [_, second, ..] => {
            table.error(second, Kind::Range, "one of waves, noise and image, not several");
            None
        }
    }
}

fn read_waves(table: &mut Table<'_, '_>) -> Option<Vec<WaveDescription>> {
    let required =
        format!("a list of 1 to {MOST_WAVES} waves {{ amplitude, wavelength, direction_deg, phase_deg }}");
    let waves = table.tables("waves", "a wave", MOST_WAVES, &required)?;
    let read: Vec<_> = waves.into_iter().map(read_wave).collect();
    read.into_iter().collect()
}

fn read_wave(mut table: Table<'_, '_>) -> Option<WaveDescription> {
    let amplitude = table.number("amplitude", &HEIGHT);
    let amplitude = table.require("amplitude", amplitude, HEIGHT.words);
    let wavelength = table.number("wavelength", &LENGTH);
    let wavelength = table.require("wavelength", wavelength, LENGTH.words);
    let direction_deg = table.number("direction_deg", &ANGLE).unwrap_or(0.0);
    let phase_deg = table.number("phase_deg", &ANGLE).unwrap_or(0.0);
    table.finish();
    Some(WaveDescription { amplitude: amplitude?, wavelength: wavelength?, direction_deg, phase_deg })
}

fn read_noise(table: &mut Table<'_, '_>) -> Option<(u64, f64, Vec<OctaveDescription>)> {
    let mut noise = table.table("noise", "noise")?;
    let seed = noise.integer("seed", 0, u64::MAX, "a whole number from 0 to 2^64 - 1");
    let amplitude = noise.number("amplitude", &PEAK);
    let amplitude = noise.require("amplitude", amplitude, PEAK.words);
    let required = format!("a list of 1 to {MOST_OCTAVES} octaves {{ amplitude, wavelength }}");
    let octaves = noise.tables("octaves", "an octave", MOST_OCTAVES, &required);
    let octaves = noise.require("octaves", octaves, &required);
    let octaves: Option<Vec<Option<OctaveDescription>>> =
        octaves.map(|tables| tables.into_iter().map(read_octave).collect());
    let octaves: Option<Vec<OctaveDescription>> = octaves.and_then(|all| all.into_iter().collect());
    if octaves.as_ref().is_some_and(|all| all.iter().all(|o| o.amplitude == 0.0)) {
        noise.error("octaves", Kind::Range, "at least one octave of an amplitude above 0");
        return None;
    }
    noise.finish();
    Some((seed.map_or(0, |s| s.value), amplitude?, octaves?))
}

fn read_octave(mut table: Table<'_, '_>) -> Option<OctaveDescription> {
    let amplitude = table.number("amplitude", &RELATIVE);
    let amplitude = table.require("amplitude", amplitude, RELATIVE.words);
    let wavelength = table.number("wavelength", &LENGTH);
    let wavelength = table.require("wavelength", wavelength, LENGTH.words);
    table.finish();
    Some(OctaveDescription { amplitude: amplitude?, wavelength: wavelength? })
}

/// `image` and `height`, which belong together.
fn read_image(table: &mut Table<'_, '_>) -> Option<(Placed<String>, [f64; 2])> {
    let height = table.numbers::<2>("height", &HEIGHT);
    if table.place_of("image").is_none() {
        // Known as a key, so that a scene without one is not told of an unknown key, but of no use alone.
        let image = table.text("image");
        if table.place_of("height").is_some() {
            table.error("height", Kind::Range, "no height: it belongs to an image");
        }
        return image.and(None);
    }
    let file = table.path("image");
    let height = table.require("height", height, "[height of black, height of white] in metres");
    Some((file?, height?))
}
