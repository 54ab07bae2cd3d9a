//! `type = "heightfield"`: waves, noise or an image over a rectangle.

use glam::DVec2;

use super::loader::{Loader, Make};
use super::table::{Placed, Table, shown};
use crate::error::words::limit;
use crate::error::{Diagnostic, Kind};
use crate::files::height_image;
use crate::files::kinds::{Use, instead};
use crate::geometry::{
    ANGLE, CELLS_REQUIRED, COORDINATE, Facing, Formula, HEIGHT, Heightfield, LENGTH, MOST_CELLS,
    MOST_OCTAVES, Noise, Octave, PEAK, RELATIVE, Shape, Wave,
};
use crate::scene::steps::Steps;

/// Most cells of all heightfields of a scene: 2^24, about eight gigabytes of triangles and search structure.
const MOST_CELLS_TOGETHER: u64 = 1 << 24;
const MOST_WAVES: usize = 256;

const FACING: [(&str, Facing); 2] = [("up", Facing::Up), ("down", Facing::Down)];

const RELIEFS: [&str; 3] = ["waves", "noise", "image"];

/// The heightfield. Its cells are added to `all`, those of the scene, which have a cap. An image without cells counts as none: its
/// file has a cap of its own.
pub(super) fn read(table: &mut Table<'_, '_>, name: &str, all: &mut u64) -> Option<Make<Shape>> {
    table.call("a heightfield");
    let origin = table.needed_vector("origin", &COORDINATE, "[x, y, z] of its corner in metres");
    let extents = "[extent along x, extent along y] in metres";
    let size = table.needed("size", extents, |t, key| t.numbers(key, &LENGTH));
    let facing = table.needed("facing", "\"up\" or \"down\"", |t, key| t.word(key, &FACING));
    let smooth = table.truth("smooth").unwrap_or(true);
    let cells = table.cells("cells", MOST_CELLS, CELLS_REQUIRED);
    let formula = read_waves(table).map(Formula::Waves);
    let noise = read_noise(table).map(Formula::Noise);
    let image = read_image(table);
    let given: Vec<&str> = RELIEFS.into_iter().filter(|key| table.place_of(key).is_some()).collect();
    let (origin, size, facing) = (origin?, DVec2::from_array(size?), facing?);
    match given[..] {
        [] => {
            table.error("waves", Kind::Missing, "[{ ... }], or noise = { ... }, or image = \"file.png\"");
            None
        }
        ["image"] => {
            let (file, heights) = image?;
            let [nx, ny] = cells.unwrap_or([0; 2]).map(u64::from);
            count(table, name, nx * ny, all);
            Some(Box::new(move |loader: &mut Loader| {
                let bytes = loader.bytes(&file)?;
                let image = height_image::parse(&bytes, heights).map_err(|e| {
                    let name = loader.path(&file).display().to_string();
                    let other = instead(&bytes, Use::Image, "a PNG of 8 or 16 bits", &name);
                    other.unwrap_or(e).in_file(name)
                })?;
                let [columns, rows] = image.size();
                let cells = cells.unwrap_or([columns as u32 - 1, rows as u32 - 1]);
                // A picture of one grey packs a thousandfold: a small file must not ask for gigabytes of triangles.
                if u64::from(cells[0]) * u64::from(cells[1]) > MOST_CELLS {
                    let found = format!("a heightfield with a vertex for each of {columns} x {rows} pixels");
                    return Err(Diagnostic::new(
                        Kind::Limit,
                        found,
                        format!("at most {} cells", limit(MOST_CELLS)),
                    )
                    .hint("give cells = [along x, along y]: heights between pixels are interpolated"));
                }
                let field = Heightfield::new(origin, size, cells, Formula::Image(image))?;
                let between =
                    |k: usize, pixels: usize| size[k] / f64::from(cells[k]).min(pixels as f64 - 1.0);
                loader.steps = height_image::has_8_bits(&bytes).then(|| Steps {
                    height_m: (heights[1] - heights[0]).abs() / 255.0,
                    distance_m: between(0, columns).min(between(1, rows)),
                });
                Ok(field.facing(facing).smooth(smooth).mesh()?.into())
            }))
        }
        [one] => {
            let cells = table.needed("cells", CELLS_REQUIRED, |_, _| cells)?;
            let formula = if one == "waves" { formula } else { noise };
            let field = table.accept(Heightfield::new(origin, size, cells, formula?))?;
            let field = field.facing(facing).smooth(smooth);
            count(table, name, field.cell_count(), all);
            Some(Box::new(move |_: &mut Loader| Ok(field.mesh()?.into())))
        }
        [_, second, ..] => {
            table.error(second, Kind::Range, "one of waves, noise and image, not several");
            None
        }
    }
}

/// Refuses heightfields that are each small enough but not together: an error at the first that is too much.
fn count(table: &Table<'_, '_>, name: &str, cells: u64, all: &mut u64) {
    let before = *all;
    *all += cells;
    if before <= MOST_CELLS_TOGETHER && *all > MOST_CELLS_TOGETHER {
        let found = format!("the heightfield `{}`, with which there are {all} cells", shown(name));
        let required = "at most 2^24 cells in all heightfields of a scene";
        table.document().error_at(table.place(), Kind::Limit, found, required);
    }
}

fn read_waves(table: &mut Table<'_, '_>) -> Option<Vec<Wave>> {
    let required =
        format!("a list of 1 to {MOST_WAVES} waves {{ amplitude, wavelength, direction_deg, phase_deg }}");
    let waves = table.tables("waves", "a wave", MOST_WAVES, &required)?;
    let read: Vec<_> = waves.into_iter().map(read_wave).collect();
    read.into_iter().collect()
}

fn read_wave(mut table: Table<'_, '_>) -> Option<Wave> {
    let amplitude_m = table.needed_number("amplitude", &HEIGHT);
    let wavelength_m = table.needed_number("wavelength", &LENGTH);
    let direction_deg = table.angle("direction_deg", &ANGLE).unwrap_or(0.0);
    let phase_deg = table.angle("phase_deg", &ANGLE).unwrap_or(0.0);
    table.finish();
    Some(Wave { amplitude_m: amplitude_m?, wavelength_m: wavelength_m?, direction_deg, phase_deg })
}

fn read_noise(table: &mut Table<'_, '_>) -> Option<Noise> {
    let mut noise = table.table("noise", "noise")?;
    let seed = noise.integer("seed", 0, u64::MAX, "a whole number from 0 to 2^64 - 1");
    let amplitude = noise.needed_number("amplitude", &PEAK);
    let required = format!("a list of 1 to {MOST_OCTAVES} octaves {{ amplitude, wavelength }}");
    let octaves =
        noise.needed("octaves", &required, |t, key| t.tables(key, "an octave", MOST_OCTAVES, &required));
    let octaves = octaves.map(|tables| tables.into_iter().map(read_octave).collect::<Vec<_>>());
    let octaves = octaves.and_then(|all| all.into_iter().collect());
    let made = amplitude
        .zip(octaves)
        .and_then(|(amplitude, octaves)| noise.accept(Noise::new(seed.unwrap_or(0), octaves, amplitude)));
    noise.finish();
    made
}

fn read_octave(mut table: Table<'_, '_>) -> Option<Octave> {
    let amplitude = table.needed_number("amplitude", &RELATIVE);
    let wavelength_m = table.needed_number("wavelength", &LENGTH);
    table.finish();
    Some(Octave { amplitude: amplitude?, wavelength_m: wavelength_m? })
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
    let height = table.needed("height", "[height of black, height of white] in metres", |_, _| height);
    Some((file?, height?))
}
