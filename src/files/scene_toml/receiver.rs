//! `[[receiver]]`: what is measured.

use crate::error::Kind;
use crate::files::scene_toml::description::{
    ReceiverDescription, ReceiverEvents, ReceiverSide, Reference, ShapeDescription, SurfaceDescription,
};
use crate::files::scene_toml::document::Document;
use crate::files::scene_toml::names::Names;
use crate::files::scene_toml::toml_table::{Table, shown};

/// Most cells of one receiver, and of all with cells of their own together: 2^26, two gigabytes of sums.
const MOST_CELLS: u64 = 1 << 26;

const DEFAULT_CELLS: [u32; 2] = [256, 256];

const SIDES: [(&str, ReceiverSide); 3] =
    [("front", ReceiverSide::Front), ("back", ReceiverSide::Back), ("both", ReceiverSide::Both)];

const EVENTS: [(&str, ReceiverEvents); 3] = [
    ("all", ReceiverEvents::All),
    ("direct", ReceiverEvents::Direct),
    ("indirect", ReceiverEvents::Indirect),
];

/// Longest receiver name in bytes: file systems take 255, of which endings and temporary names need some.
const LONGEST_NAME_BYTES: usize = 200;

/// Base names of files that a run writes besides the receivers', and names Windows does not let a file have.
const RESERVED: [&str; 6] = ["camera", "report", "con", "prn", "aux", "nul"];

pub(crate) fn read(
    mut table: Table<'_, '_>,
    index: usize,
    names: &mut Names,
    surface_names: &Names,
    surfaces: &[Option<SurfaceDescription>],
) -> Option<ReceiverDescription> {
    let place = table.place();
    let given = table.text("name");
    let surface = surface_names.refer(&mut table, "surface");
    let name = match (given, &surface) {
        (Some(given), _) => Some((given.value, given.place)),
        (None, Some(surface)) if table.place_of("name").is_none() => {
            Some((surface.name.clone(), surface.place))
        }
        _ => None,
    };
    if let Some((name, name_place)) = &name {
        // Cases are not told apart: some file systems don't, and the names become file names.
        names.insert_as(table.document(), name, &name.to_lowercase(), *name_place, index);
        if !is_file_name(name) {
            let found = format!("the receiver name `{}`", shown(name));
            let required = "letters, digits, spaces, `_`, `-` and `.`, not beginning or ending with a dot or a space, \
                            at most 200 bytes of UTF-8 (it becomes a file name), and none of the words camera, report, con, prn, aux, nul";
            table.document().error_at(*name_place, Kind::Range, found, required);
        }
    }
    let cells = read_cells(&mut table, surface.as_ref(), surfaces);
    let side = table.word("side", &SIDES).unwrap_or(ReceiverSide::Front);
    let events = table.word("events", &EVENTS).unwrap_or(ReceiverEvents::All);
    table.finish();
    Some(ReceiverDescription { name: name?.0, surface: surface?, cells, side, events, place })
}

/// Refuses receivers that are each small enough but not together: an error at the first that is too much.
pub(crate) fn check_total(document: &Document<'_>, receivers: &[Option<ReceiverDescription>]) {
    let mut total = 0u64;
    for receiver in receivers.iter().flatten() {
        let Some([nu, nv]) = receiver.cells else { continue };
        total += u64::from(nu) * u64::from(nv);
        if total > MOST_CELLS {
            let found =
                format!("the receiver `{}`, with which there are {total} cells", shown(&receiver.name));
            let required = "at most 2^26 cells in all receivers of a scene";
            document.error_at(receiver.place, Kind::Limit, found, required);
            return;
        }
    }
}

fn read_cells(
    table: &mut Table<'_, '_>,
    surface: Option<&Reference>,
    surfaces: &[Option<SurfaceDescription>],
) -> Option<[u32; 2]> {
    const REQUIRED: &str = "[cells along u, cells along v], each at least 1, at most 2^26 in all";
    let cells = table.cells("cells", MOST_CELLS, REQUIRED);
    let Some(Some(surface)) = surface.and_then(|s| surfaces.get(s.index)) else { return cells };
    match &surface.shape {
        ShapeDescription::Rectangle { .. }
        | ShapeDescription::Sphere { .. }
        | ShapeDescription::Paraboloid { .. } => Some(cells.unwrap_or(DEFAULT_CELLS)),
        triangles @ (ShapeDescription::Mesh { .. }
        | ShapeDescription::Box { .. }
        | ShapeDescription::Heightfield(_)) => {
            if table.place_of("cells").is_some() {
                let required = format!("no cells: a {} has one value a triangle", triangles.word());
                table.error("cells", Kind::Range, required);
            }
            None
        }
    }
}

/// Whether this can be the base name of a file on every common system, and only that.
fn is_file_name(name: &str) -> bool {
    let allowed = |c: char| c.is_alphanumeric() || matches!(c, ' ' | '_' | '-' | '.');
    let edge = |c: char| matches!(c, ' ' | '.');
    name.len() <= LONGEST_NAME_BYTES
        && name.chars().all(allowed)
        && !name.starts_with(edge)
        && !name.ends_with(edge)
        && !RESERVED.contains(&name.to_lowercase().as_str())
}
