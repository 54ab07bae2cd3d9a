//! Reader of EULUMDAT files (.ldt).
//!
//! One field a line, no keywords, no version: what a line means hangs on its number, and on the counts before
//! it. So a line that is missing or too many shifts all that follow, and is found by what they must hold:
//! counts against lists, angles that rise, the end of the file. docs/PHOTOMETRY.md lists what is read,
//! tolerated and refused.
//!
//! ```text
//!  1      company
//!  2      Ityp, a label
//!  3      Isym: which planes are stored
//!  4, 5   Mc, Dc: number of C planes of the whole circle, their distance (0: uneven)
//!  6, 7   Ng, Dg: number of gamma angles, their distance
//!  8..12  report, luminaire, number, file, date
//! 13..21  sizes of the luminaire and of its luminous area, mm
//! 22..25  downward fraction, light output ratio (LORL), conversion factor, tilt
//! 26      n lamp sets, and six lines for each: lamps, kind, lumens, colour, colour rendering, watts
//!         10 direct ratios;  Mc C angles;  Ng gamma angles;  Ng values for each stored plane, cd per 1000 lm
//! ```

mod doubts;
mod fields;
mod head;
mod lamps;
mod stream;
mod table;
pub mod write;

use crate::error::{Kind, Result};
use crate::files::excerpt::quoted;
use crate::photometry::{EulumdatHead, Format, Photometry, Tilt};
use fields::Fields;
pub use lamps::MAX_LAMP_SETS;
pub(super) use lamps::told;

/// Lumens for which a file states its intensities.
const PER_LM: f64 = 1000.0;

/// Reads the text of a file; messages have line and column, and no file. Of several lamp sets the one of this
/// number, from 1, is taken; the first where there is no such set, which the caller refuses.
pub(super) fn parse_text(text: &str, lamp_set: Option<usize>) -> Result<Photometry> {
    let mut fields = Fields::new(text);
    let head = head::read(&mut fields)?;
    let lamps = lamps::read(&mut fields, lamp_set)?;
    let direct_ratios = head::direct_ratios(&mut fields)?;
    // Without a lamp set the intensities stand for 1000 lm.
    let multiplier = head.conversion * lamps.taken().map_or(1.0, |set| set.flux_lm / PER_LM);
    let (web, isym) = table::read(&mut fields, &head, multiplier)?;
    warn_about_signs(&mut fields);
    let mut labels = head.labels;
    let kind = lamps.taken().map(|set| set.kind.clone()).filter(|kind| !kind.is_empty());
    labels.extend(kind.map(|kind| ("LAMP".to_owned(), kind)));
    let set = lamps.taken();
    let count = set.map_or(0.0, |set| set.count.abs());
    let each = set.filter(|set| !set.is_absolute()).map(|set| set.flux_lm / count.max(1.0));
    let mut photometry = Photometry {
        file: String::new(),
        format: Format::Eulumdat,
        labels,
        tilt: Tilt::None,
        lamps: count,
        lumens_per_lamp: each,
        multiplier,
        ballast_factor: 1.0,
        field12: 1.0,
        field12_text: String::new(),
        input_watts: set.map_or(0.0, |set| set.watts),
        lamp_set: lamps.chosen,
        lamp_sets: lamps.sets,
        eulumdat: Some(EulumdatHead {
            ityp: head.ityp,
            isym,
            c_planes: head.c.count,
            luminaire_size_m: head.luminaire_size_m,
            downward_fraction_percent: head.downward_fraction_percent,
            light_output_ratio_percent: head.light_output_ratio_percent,
            conversion: head.conversion,
            measured_tilt_deg: head.measured_tilt_deg,
            direct_ratios,
        }),
        opening: head.opening,
        web,
        flux_declared_lm: None,
        warnings: fields.warnings,
    };
    doubts::compare(&mut photometry);
    Ok(photometry)
}

/// A comma is a decimal sign here. Where the same file has points, too, it may have been meant to part
/// thousands.
fn warn_about_signs(fields: &mut Fields<'_>) {
    if let [Some(_), Some(comma)] = fields.signs {
        let found = format!("{} in a file that has decimal points, too", quoted(comma.text));
        let hint = "read as a decimal comma";
        fields.warn(comma.offset, Kind::Syntax, &found, "decimal points, or commas, in the whole file", hint);
    }
}
