//! `[[receiver]]`: what is measured.

use super::names::Names;
use super::part::SurfacePart;
use super::table::{Placed, Table};
use crate::error::invalid::Interval;
use crate::error::{Kind, Place};
use crate::geometry::LENGTH;
use crate::scene::evaluation::{GRID_REQUIRED, MOST_GRID_CELLS};
use crate::scene::receiver::{CELLS_REQUIRED, MOST_CELLS, ReceiverEvents, ReceiverSide, ReceiverSpec};

const SIDES: [(&str, ReceiverSide); 3] =
    [("front", ReceiverSide::Front), ("back", ReceiverSide::Back), ("both", ReceiverSide::Both)];

const EVENTS: [(&str, ReceiverEvents); 3] = [
    ("all", ReceiverEvents::All),
    ("direct", ReceiverEvents::Direct),
    ("indirect", ReceiverEvents::Indirect),
];

pub(super) fn read(
    mut table: Table<'_, '_>,
    index: usize,
    names: &mut Names,
    surface_names: &Names,
    surfaces: &[Option<(SurfacePart, Place)>],
) -> Option<ReceiverSpec> {
    let given = table.text("name");
    let surface = surface_names.refer(&mut table, "surface");
    let name = match (given, &surface) {
        (Some(given), _) => Some(given),
        (None, Some((surface, _))) if table.place_of("name").is_none() => {
            Some(Placed { value: surface.clone(), place: table.place_of("surface")? })
        }
        _ => None,
    };
    if let Some(name) = &name {
        // Cases are not told apart: some file systems don't, and the names become file names. Upper case takes a sharp
        // s for ss and a final sigma for any other, as those systems do.
        names.insert(table.document(), name, &name.value.to_uppercase(), index);
    }
    let cells = table.cells("cells", MOST_CELLS, CELLS_REQUIRED);
    let part = surface.as_ref().and_then(|(_, index)| surfaces.get(*index)?.as_ref());
    let of_faces = part.and_then(|(part, _)| part.of_faces);
    if let Some(word) = of_faces.filter(|_| table.place_of("cells").is_some()) {
        table.error("cells", Kind::Range, &format!("no cells: a {word} has one value a triangle"));
    }
    let side = table.word("side", &SIDES).unwrap_or_default();
    let events = table.word("events", &EVENTS).unwrap_or_default();
    let grid = grid(&mut table);
    let spot = spot(&mut table);
    let spec = name.and_then(|name| {
        let (surface, _) = surface.unwrap_or_default();
        let spec = table.accept(ReceiverSpec::new(name.value, surface))?.on_side(side).of_events(events);
        let spec = match cells {
            Some(cells) => table.accept(spec.with_cells(cells))?,
            None => spec,
        };
        let spec = match grid {
            Some((counts, border_m)) => table.accept(spec.with_grid(counts, border_m))?,
            None => spec,
        };
        Some(match spot {
            Some(at_m) => spec.with_spot(at_m),
            None => spec,
        })
    });
    table.finish();
    spec
}

/// Counts of an evaluation grid, none for the standard's, and the border.
fn grid(table: &mut Table<'_, '_>) -> Option<(Option<[u32; 2]>, f64)> {
    let is_given = table.place_of("grid").is_some();
    if !is_given && table.place_of("border_m").is_some() {
        table.error("border_m", Kind::Missing, "`grid`, whose border this is, too");
    }
    let border_m = table.number("border_m", &LENGTH).unwrap_or(0.0);
    let counts = if table.is_list("grid") {
        Some(table.cells("grid", MOST_GRID_CELLS, GRID_REQUIRED)?)
    } else if table.word_of("grid").is_some() {
        table.word("grid", &[("EN 12464", ())])?;
        None
    } else {
        table.cells("grid", MOST_GRID_CELLS, GRID_REQUIRED)?;
        None
    };
    Some((counts, border_m))
}

/// A place along an edge.
const ALONG: Interval = Interval { low: 0.0, high: 1e9, words: "0 to the length of its edge, in m" };

/// Whether the spot is measured, and the point of the sections.
fn spot(table: &mut Table<'_, '_>) -> Option<Option<[f64; 2]>> {
    let is_asked = table.truth("spot") == Some(true);
    let at_m = table.numbers::<2>("spot_at", &ALONG);
    if !is_asked && table.place_of("spot_at").is_some() {
        table.error("spot_at", Kind::Missing, "`spot = true`, whose sections go through this point, too");
    }
    is_asked.then_some(at_m)
}
