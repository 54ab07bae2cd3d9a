//! The files of a far field.

use crate::files::set::Set;
use crate::plot;
use crate::report::far_field::{FarFieldStatistics, write_csv, write_exr};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::far_field::FarField;

/// What is written of a far field, by the endings of the files.
const ENDINGS: [&str; 3] = ["csv", "exr", "svg"];

/// The names of its files.
pub(super) fn files(field: &FarField) -> Vec<String> {
    ENDINGS.map(|ending| format!("{}.{ending}", field.name)).to_vec()
}

/// Makes them; the names of those that could be.
pub(super) fn write(
    set: &mut Set<'_>,
    scene: &Scene,
    outcome: &Outcome,
    field: &FarField,
    s: &FarFieldStatistics,
) -> Vec<String> {
    let mut made = Vec::new();
    for ending in ENDINGS {
        let name = format!("{}.{ending}", field.name);
        let is_made = set.add(&name, |path| {
            match ending {
                "csv" => write_csv(path, s),
                "exr" => write_exr(path, scene, outcome, field, s),
                _ => plot::far_field::drawing(field, s).write(path),
            }
            .map(|()| true)
        });
        made.extend(is_made.then_some(name));
    }
    made
}
