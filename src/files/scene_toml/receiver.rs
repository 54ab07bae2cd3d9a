//! `[[receiver]]`: what is measured.

use super::names::{Names, Reference};
use super::part::SurfacePart;
use super::table::{Placed, Table};
use crate::error::Kind;
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
    surfaces: &[Option<SurfacePart>],
) -> Option<ReceiverSpec> {
    let given = table.text("name");
    let surface = surface_names.refer(&mut table, "surface");
    let name = match (given, &surface) {
        (Some(given), _) => Some(given),
        (None, Some(surface)) if table.place_of("name").is_none() => {
            Some(Placed { value: surface.name.clone(), place: table.place_of("surface")? })
        }
        _ => None,
    };
    if let Some(name) = &name {
        // Cases are not told apart: some file systems don't, and the names become file names.
        names.insert_as(table.document(), &name.value, &name.value.to_lowercase(), name.place, index);
    }
    let cells = table.cells("cells", MOST_CELLS, CELLS_REQUIRED);
    check_cells(&table, surface.as_ref(), surfaces);
    let side = table.word("side", &SIDES).unwrap_or_default();
    let events = table.word("events", &EVENTS).unwrap_or_default();
    let spec = name.and_then(|name| {
        let surface = surface.map_or_else(String::new, |s| s.name);
        let spec = table.accept(ReceiverSpec::new(name.value, surface))?.on_side(side).of_events(events);
        match cells {
            Some(cells) => table.accept(spec.with_cells(cells)),
            None => Some(spec),
        }
    });
    table.finish();
    spec
}

/// That no cells are asked for where there is a value a triangle.
fn check_cells(table: &Table<'_, '_>, surface: Option<&Reference>, surfaces: &[Option<SurfacePart>]) {
    let Some(Some(part)) = surface.and_then(|s| surfaces.get(s.index)) else { return };
    if let Some(word) = part.of_faces.filter(|_| table.place_of("cells").is_some()) {
        let required = format!("no cells: a {word} has one value a triangle");
        table.error("cells", Kind::Range, required);
    }
}
