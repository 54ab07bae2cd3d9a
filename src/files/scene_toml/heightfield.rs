//! `type = "heightfield"`: waves, noise or an image over a rectangle.

use std::path::PathBuf;

use glam::DVec2;

use super::asked::{Asked, What};
use super::loader::{Loader, Make};
use super::table::{Placed, Table};
use crate::error::words::limit;
use crate::error::{Diagnostic, Kind};
use crate::files::height_image;
use crate::files::kinds::{Use, instead};
use crate::geometry::{
    ANGLE, CELLS_REQUIRED, COORDINATE, Facing, Formula, HEIGHT, Heightfield, LENGTH, MOST_CELLS,
    MOST_OCTAVES, Noise, Octave, PEAK, RELATIVE, Shape, Wave,
};
use crate::scene::steps::Steps;

const MOST_WAVES: usize = 256;

const FACING: [(&str, Facing); 2] = [("up", Facing::Up), ("down", Facing::Down)];

const RELIEFS: [&str; 3] = ["waves", "noise", "image"];

/// The heightfield, and what counts the pixels of its image, and its cells where that says how many. Other cells are counted here.
pub(super) fn read(
    table: &mut Table<'_, '_>,
    name: &str,
    asked: &mut Asked,
) -> Option<(Make<Shape>, Option<Make<()>>)> {
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
            if let Some([nx, ny]) = cells {
                count(table, name, u64::from(nx) * u64::from(ny), 0, asked);
            }
            let ask = count_image(name.to_owned(), file.clone(), cells.is_some());
            let make: Make<Shape> = Box::new(move |loader: &mut Loader| {
                let bytes = loader.bytes(&file)?;
                let image = height_image::parse(&bytes, heights)
                    .map_err(|e| no_image(e, &bytes, loader.path(&file)))?;
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
            });
            Some((make, Some(ask)))
        }
        [one] => {
            let cells = table.needed("cells", CELLS_REQUIRED, |_, _| cells)?;
            let formula = if one == "waves" { formula } else { noise }?;
            let terms = formula.terms();
            let field = table.accept(Heightfield::new(origin, size, cells, formula))?;
            let field = field.facing(facing).smooth(smooth);
            count(table, name, field.cell_count(), terms, asked);
            Some((Box::new(move |_: &mut Loader| Ok(field.mesh()?.into())), None))
        }
        [_, second, ..] => {
            table.error(second, Kind::Range, "one of waves, noise and image, not several");
            None
        }
    }
}

/// Counts cells of so many terms each: an error where it is too much, and none of what follows it.
fn count(table: &Table<'_, '_>, name: &str, cells: u64, terms: u64, asked: &mut Asked) {
    let was_over = asked.is_over();
    let counted = [(What::Cells, cells), (What::Triangles, 2 * cells), (What::Terms, cells * terms)]
        .into_iter()
        .try_for_each(|(what, number)| asked.count(what, name, number));
    if let Some(error) = counted.err().filter(|_| !was_over) {
        table.document().error(|| error.placed(Some(table.place())));
    }
}

/// What is wrong with a file of heights, or what else it is.
fn no_image(e: Diagnostic, bytes: &[u8], path: PathBuf) -> Diagnostic {
    let name = path.display().to_string();
    instead(bytes, Use::Image, "a PNG of 8 or 16 bits", &name).unwrap_or(e).in_file(name)
}

/// What looks at the size of an image, before anything is made of it.
fn count_image(name: String, file: Placed<String>, has_cells: bool) -> Make<()> {
    Box::new(move |loader: &mut Loader| {
        let (_, bytes) = loader.look(&file)?;
        let [columns, rows] =
            height_image::size(&bytes).map_err(|e| no_image(e, &bytes, loader.path(&file)))?;
        loader.asked.count(What::Pixels, &name, columns * rows)?;
        let cells = columns.saturating_sub(1) * rows.saturating_sub(1);
        // One that is too large by itself is told so when it is made.
        if !has_cells && cells <= MOST_CELLS {
            loader.asked.count(What::Cells, &name, cells)?;
            loader.asked.count(What::Triangles, &name, 2 * cells)?;
        }
        Ok(())
    })
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
