//! Luminaires to the bytes of a photometric file, which are read back before anybody is told that they are
//! written.

use crate::error::{Diagnostic, Kind, Result};
use crate::files::eulumdat::write as eulumdat;
use crate::files::lm63::write::{self, Edition};
use crate::files::photometric::parse;
use crate::photometry::Web;
use crate::photometry::export::{Export, PhotometricFile};

/// Half a unit of nine digits of 360 degrees, twice: mirrored angles are rounded apart from those that they
/// mirror.
const ANGLES_DEG: f64 = 1e-6;

/// What can be written.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ExportFormat {
    /// IES LM-63-2002.
    Ies2002,
    /// IES LM-63-2019.
    Ies2019,
    /// EULUMDAT.
    Ldt,
}

impl ExportFormat {
    /// By the name that `--to` takes.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "ies" | "ies2002" => Some(Self::Ies2002),
            "ies2019" => Some(Self::Ies2019),
            "ldt" => Some(Self::Ldt),
            _ => None,
        }
    }

    /// Its name in messages.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ies2002 => "IES LM-63-2002",
            Self::Ies2019 => "IES LM-63-2019",
            Self::Ldt => "EULUMDAT",
        }
    }
}

/// The file of a luminaire. It was read back to the table that it says it has, to 1e-12 of each intensity.
///
/// # Errors Those of the writers; [`Kind::Range`] where what was written is read as something else, which is
/// then not to be used.
pub fn photometric_file(export: &Export, target: ExportFormat) -> Result<PhotometricFile> {
    let written = match target {
        ExportFormat::Ies2002 => write::write(export, Edition::Y2002),
        ExportFormat::Ies2019 => write::write(export, Edition::Y2019),
        ExportFormat::Ldt => eulumdat::write(export)?,
    };
    read_back(&written, target)?;
    Ok(written)
}

fn read_back(written: &PhotometricFile, target: ExportFormat) -> Result<()> {
    let other = |found: String| {
        let required = "the table that was to be written";
        Diagnostic::new(
            Kind::Range,
            format!("a file of {} that reads back as {found}", target.name()),
            required,
        )
        .hint("nothing is written; angles closer to one another than 1e-6 degrees may be the reason")
    };
    let read = parse(&written.bytes, target.name()).map_err(|d| other(format!("an error: {d}")))?;
    let (is, told) = (read.web.over_circle(), &written.table);
    let same = |is: &[f64], told: &[f64]| {
        is.len() == told.len() && is.iter().zip(told).all(|(a, b)| (a - b).abs() <= ANGLES_DEG)
    };
    let angles = same(&is.vertical_deg, &told.vertical_deg) && same(&is.horizontal_deg, &told.horizontal_deg);
    if read.factor() != 1.0 || !angles {
        return Err(other("other angles".to_owned()));
    }
    match (0..is.candela.len()).find(|&i| (is.candela[i] - told.candela[i]).abs() > 1e-12 * told.candela[i]) {
        Some(i) => Err(other(format!("{} for {} cd {}", is.candela[i], told.candela[i], place(told, i)))),
        None => Ok(()),
    }
}

fn place(web: &Web, index: usize) -> String {
    let n_v = web.vertical_deg.len();
    format!("at V {}, H {}", web.vertical_deg[index % n_v], web.horizontal_deg[index / n_v])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::photometry::PhotometricType;

    #[test]
    fn a_file_that_reads_back_otherwise_is_told() {
        let web =
            Web::new(PhotometricType::C, vec![0.0, 30.0, 90.0], vec![0.0], vec![3.0, 2.0, 1.0]).unwrap();
        let export = Export::new("a", web).unwrap();
        for target in [ExportFormat::Ies2002, ExportFormat::Ies2019] {
            let written = photometric_file(&export, target).unwrap();
            for (from, to) in
                [("3 2 1", "3 2.1 1"), ("0 30 90", "0 31 90"), ("1 1.0", "2 1.0"), ("1 1 0", "1.1 1 0")]
            {
                let text = String::from_utf8(written.bytes.clone()).unwrap();
                if !text.contains(from) {
                    continue;
                }
                let bytes = text.replace(from, to).into_bytes();
                assert!(
                    read_back(&PhotometricFile { bytes, ..written.clone() }, target).is_err(),
                    "{from} {to}"
                );
            }
        }
    }
}
