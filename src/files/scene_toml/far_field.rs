//! `[[far_field]]`: intensity by direction.

use super::names::Names;
use super::numbers::DIRECTION;
use super::table::Table;
use crate::emitter::AimFrame;
use crate::error::Kind;
use crate::scene::far_field::{C_REQUIRED, FarFieldSpec, GAMMA_REQUIRED, Symmetry};

/// Those of type C.
const SYMMETRIES: [Symmetry; 5] = [
    Symmetry::None,
    Symmetry::Rotational,
    Symmetry::Quadrants,
    Symmetry::Bilateral0To180,
    Symmetry::Bilateral90To270,
];

pub(super) fn read(
    mut table: Table<'_, '_>,
    index: usize,
    names: &mut Names,
    surface_names: &Names,
) -> Option<FarFieldSpec> {
    let name = table.needed("name", "a name, which becomes that of its files", Table::text);
    if let Some(name) = &name {
        names.insert(table.document(), name, &name.value.to_uppercase(), index);
    }
    let axis = table.needed_vector("axis", &DIRECTION, "a direction [x, y, z]: that of gamma = 0");
    let up = table.vector("up", &DIRECTION);
    let is_up_good = up.is_some() == table.place_of("up").is_some();
    let gamma_deg = table.step_or_list("gamma_deg", GAMMA_REQUIRED);
    let c_deg = table.step_or_list("c_deg", C_REQUIRED);
    let surface = match table.place_of("surface") {
        Some(_) => Some(surface_names.refer(&mut table, "surface").map(|(name, _)| name)),
        // Known, for keys that are misspelt.
        None => table.text("surface").map(|_| None),
    };
    let symmetry = table
        .word("symmetry", &SYMMETRIES.map(|symmetry| (symmetry.name(), symmetry)))
        .unwrap_or(Symmetry::None);
    let frame = axis.filter(|_| is_up_good).and_then(|axis| {
        let frame = AimFrame::new(axis, up);
        // The frame speaks of `aim`, which is `axis` here.
        frame
            .map_err(|e| {
                let key = if e.what() == "up" { "up" } else { "axis" };
                table.error(key, Kind::Range, &e.required().replace("aim", "axis"));
            })
            .ok()
    });
    let spec = name.zip(frame).and_then(|(name, frame)| {
        let mut spec = table.accept(FarFieldSpec::new(name.value, frame))?.with_symmetry(symmetry);
        if let Some(gamma_deg) = gamma_deg {
            spec = table.accept(spec.with_gamma_deg(&gamma_deg))?;
        }
        if let Some(c_deg) = c_deg {
            spec = table.accept(spec.with_c_deg(&c_deg))?;
        }
        Some(match surface {
            Some(surface) => spec.of_surface(surface?),
            None => spec,
        })
    });
    table.finish();
    spec
}
