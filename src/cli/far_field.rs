//! The files of a far field.

use std::path::Path;

use crate::error::warning::{Severity, Warning};
use crate::files::atomic::write_bytes;
use crate::files::converted::{ExportFormat, photometric_file};
use crate::files::set::Set;
use crate::plot;
use crate::report::far_field::{FarFieldStatistics, export, write_csv, write_exr};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::scene::far_field::FarField;

/// What is written of a far field, by the endings of the files.
const ENDINGS: [&str; 6] = ["ies", "2019.ies", "ldt", "csv", "exr", "svg"];

/// The names of its files.
pub(super) fn files(field: &FarField) -> Vec<String> {
    ENDINGS.map(|ending| format!("{}.{ending}", field.name)).to_vec()
}

/// Makes them; the names of those that could be, and what is to be said of them.
pub(super) fn write(
    set: &mut Set<'_>,
    scene: &Scene,
    outcome: &Outcome,
    field: &FarField,
    s: &FarFieldStatistics,
) -> (Vec<String>, Vec<Warning>) {
    let (mut made, mut notes) = (Vec::new(), Vec::new());
    let luminaire = export(scene, outcome, field, s);
    for ending in ENDINGS {
        let name = format!("{}.{ending}", field.name);
        let mut photometric = |path: &Path, format| {
            // EULUMDAT has candela per 1000 lm: of no light there is no such file (`far-field-dark` tells).
            if format == ExportFormat::Ldt && s.flux_lm == 0.0 {
                return Ok(false);
            }
            let written = photometric_file(luminaire.as_ref().map_err(Clone::clone)?, format)?;
            notes.extend(written.notes.into_iter().map(|note| format!("{name}: {note}")));
            write_bytes(path, &written.bytes).map(|()| true)
        };
        let is_made = set.add(&name, |path| match ending {
            "ies" => photometric(path, ExportFormat::Ies2002),
            "2019.ies" => photometric(path, ExportFormat::Ies2019),
            "ldt" => photometric(path, ExportFormat::Ldt),
            "csv" => write_csv(path, s).map(|()| true),
            "exr" => write_exr(path, scene, outcome, field, s).map(|()| true),
            _ => plot::far_field::drawing(field, s).write(path).map(|()| true),
        });
        made.extend(is_made.then_some(name));
    }
    (made, notes.into_iter().map(told).collect())
}

/// What a format could not hold as it was.
fn told(message: String) -> Warning {
    Warning {
        severity: Severity::Note,
        code: "photometric-file",
        message,
        surfaces: Vec::new(),
        share: None,
        remedy: "the CSV has the table as it is; a `name` of Latin letters".into(),
    }
}
