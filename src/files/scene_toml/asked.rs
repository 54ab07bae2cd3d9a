//! What the parts of a scene ask for together: each may be small enough, and all of them too much.

use crate::error::{Diagnostic, Kind, Result};
use crate::geometry;

/// Something that is counted over all parts of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum What {
    /// Cells of heightfields.
    Cells,
    /// Waves and octaves, once for each cell that they are summed up in.
    Terms,
    /// Pixels of height images, once for each surface that names one.
    Pixels,
    /// Triangles of meshes and heightfields.
    Triangles,
    /// Vertices and normals in the files of meshes, once for each surface that names one.
    Vertices,
    /// Candela values of photometric files, once for each lamp.
    Candela,
    /// Values of scattering tables, once for each material.
    Scattering,
}

/// Most cells of all heightfields of a scene: 2^24, about eight gigabytes of triangles and search structure.
pub const MOST_CELLS: u64 = 1 << 24;
/// Most waves and octaves times cells: half a minute of sines.
pub const MOST_TERMS: u64 = 1 << 30;
/// Most pixels of all height images: four of the largest.
pub const MOST_PIXELS: u64 = 1 << 28;
/// Most triangles: twice the cells.
pub const MOST_TRIANGLES: u64 = 2 * MOST_CELLS;
/// Most vertices and normals of meshes.
pub const MOST_VERTICES: u64 = 1 << 27;
/// Most candela values of all lamps: four of the largest tables.
pub const MOST_CANDELA: u64 = 1 << 24;
/// Most values of all scattering tables: the largest one.
pub const MOST_SCATTERING: u64 = crate::scattering::table::MAX_VALUES as u64;

impl What {
    const ALL: [(Self, u64, &str, &str); 7] = [
        (Self::Cells, MOST_CELLS, "heightfield", "cells in all heightfields"),
        (Self::Terms, MOST_TERMS, "heightfield", "waves and octaves times cells in all heightfields"),
        (Self::Pixels, MOST_PIXELS, "heightfield", "pixels in all height images"),
        (Self::Triangles, MOST_TRIANGLES, "surface", "triangles in all surfaces"),
        (Self::Vertices, MOST_VERTICES, "mesh", "vertices and normals in all meshes"),
        (Self::Candela, MOST_CANDELA, "emitter", "candela values in all emitters"),
        (Self::Scattering, MOST_SCATTERING, "material", "values in all scattering tables"),
    ];
}

/// The counts so far.
#[derive(Debug, Clone, Default)]
pub(super) struct Asked {
    counts: [u64; What::ALL.len()],
    is_over: bool,
}

impl Asked {
    /// Counts what a part asks for; `name` is the part's.
    ///
    /// # Errors
    /// [`Kind::Limit`] where it is too much together with what was counted before.
    pub fn count(&mut self, what: What, name: &str, number: u64) -> Result<()> {
        let i = What::ALL.iter().position(|(known, ..)| *known == what).unwrap_or_default();
        let (_, most, part, words) = What::ALL[i];
        self.counts[i] = self.counts[i].saturating_add(number);
        if self.counts[i] <= most {
            return Ok(());
        }
        self.is_over = true;
        let (thing, _) = words.split_once(" in all ").unwrap_or((words, ""));
        let found = format!(
            "the {part} `{}`, with which there are {} {thing}",
            super::table::shown(name),
            self.counts[i]
        );
        Err(Diagnostic::new(Kind::Limit, found, format!("at most {} {words} of a scene", power(most))))
    }

    /// Whether more was asked for than there may be. What comes after it, is not even looked at.
    pub fn is_over(&self) -> bool {
        self.is_over
    }
}

/// A power of two in words.
fn power(number: u64) -> String {
    if number.is_power_of_two() { format!("2^{}", number.trailing_zeros()) } else { number.to_string() }
}

const _: () = assert!(MOST_CELLS >= geometry::MOST_CELLS);
