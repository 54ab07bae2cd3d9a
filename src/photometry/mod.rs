//! Photometric files: reading, symmetry, flux, summary.
//!
//! A file is read once and checked once (`files::photometric`); what comes out is plain data, the same for IES LM-63
//! and EULUMDAT. Intensities in [`Web`] are the file's values times its candela multiplier; [`Photometry::factor`]
//! holds what stands beside them (ballast factor, and field 12 where it is a factor). Degrees live here and in no
//! later module: [`Web::full_grid`] hands out radians.

pub mod axes;
pub mod beam;
pub mod eulumdat;
pub mod export;
pub mod flux;
pub mod luminance;
pub mod nema;
pub mod opening;
mod opening_written;
pub mod sheet;
pub mod summary;
pub mod tilt;
pub mod turn;
pub mod unfold;
pub mod web;
pub mod zones;

pub use eulumdat::{EulumdatHead, LampSet};
pub use opening::LuminousOpening;
pub use sheet::DataSheet;
pub use summary::Summary;
pub use tilt::{Tilt, TiltTable};
pub use unfold::FullGrid;
pub use web::{PhotometricType, Web};

use crate::error::{Diagnostic, Invalid};

/// The format of a photometric file, and its edition where it has editions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Format {
    /// IES LM-63, by the rules of this edition.
    Lm63(Revision),
    /// EULUMDAT (.ldt), which has no editions.
    Eulumdat,
}

impl Format {
    /// Name without the edition.
    pub fn name(self) -> &'static str {
        match self {
            Self::Lm63(_) => "IES LM-63",
            Self::Eulumdat => "EULUMDAT",
        }
    }

    /// The edition of LM-63; `None` for EULUMDAT.
    pub fn revision(self) -> Option<Revision> {
        match self {
            Self::Lm63(revision) => Some(revision),
            Self::Eulumdat => None,
        }
    }
}

/// The edition of LM-63 whose rules a file was read by.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Revision {
    /// LM-63-1986: no version line.
    Y1986,
    /// LM-63-1991: `IESNA91`.
    Y1991,
    /// LM-63-1995.
    Y1995,
    /// LM-63-2002.
    Y2002,
    /// LM-63-2019, and any later or unknown `IES` version line.
    Y2019,
}

impl Revision {
    /// The year, as text.
    pub fn name(self) -> &'static str {
        ["1986", "1991", "1995", "2002", "2019"][self as usize]
    }

    /// Whether field 12 (second number of the three-number record) is the ballast-lamp photometric factor. Later
    /// editions reserve it (1995, 2002) or store the file generation type in it (2019).
    pub fn field12_is_factor(self) -> bool {
        matches!(self, Self::Y1986 | Self::Y1991)
    }
}

/// A photometric file as it was read: plain data, lengths in metres, powers in watts.
#[derive(Debug, Clone, PartialEq)]
pub struct Photometry {
    /// The file, as the caller named it.
    pub file: String,
    /// The format, with the edition whose rules were applied.
    pub format: Format,
    /// Keyword (without brackets; empty for a free label line) and text, in file order; `[MORE]` lines are joined
    /// to the keyword they continue, with a line feed. EULUMDAT's lines have the keywords of LM-63 that mean the same
    /// (docs/PHOTOMETRY.md); blank ones are left out.
    pub labels: Vec<(String, String)>,
    /// How the output depends on the mounting tilt; none in EULUMDAT. Never multiplied into the intensities.
    pub tilt: Tilt,
    /// Number of lamps; of EULUMDAT in the lamp set taken, without its sign.
    pub lamps: f64,
    /// Lumens per lamp; `None` for absolute photometry (LM-63: -1 lumens; EULUMDAT: a negative number of lamps).
    /// It never scales the intensities of LM-63.
    pub lumens_per_lamp: Option<f64>,
    /// The lamp sets of EULUMDAT, which are alternatives; none in LM-63.
    pub lamp_sets: Vec<LampSet>,
    /// Which of them was taken, from 0; 0 where there are none.
    pub lamp_set: usize,
    /// What only EULUMDAT says.
    pub eulumdat: Option<EulumdatHead>,
    /// Candela multiplier, already in [`Web::candela`]; of EULUMDAT the conversion factor times the lumens of the lamp set
    /// taken / 1000.
    pub multiplier: f64,
    /// Ballast factor, not in [`Web::candela`]; 1 in EULUMDAT.
    pub ballast_factor: f64,
    /// Field 12: ballast-lamp photometric factor (1986, 1991), reserved (1995, 2002), file generation type (2019). 1 in
    /// EULUMDAT, which has no such field.
    pub field12: f64,
    /// Field 12 as written: the 2019 code is text, not a quantity. Empty in EULUMDAT.
    pub field12_text: String,
    /// Input power, watts; 0 where the file does not know it. Of EULUMDAT that of the lamp set taken.
    pub input_watts: f64,
    /// Luminous opening.
    pub opening: LuminousOpening,
    /// The intensities.
    pub web: Web,
    /// The maker's own number, lm, if the file declares it and it can be read: `[_TOTALLUMINAIRELUMENS]`, without ballast
    /// factor; of EULUMDAT lumens of the lamp set x light output ratio.
    pub flux_declared_lm: Option<f64>,
    /// What is wrong with the file and was tolerated.
    pub warnings: Vec<Diagnostic>,
}

impl Photometry {
    /// Factor from [`Web::candela`] to what the luminaire emits where it is not tilted: ballast factor, times field 12 in 1986 and
    /// 1991, times the tilt table's factor at 0 degrees (1 where there is no table, or it does not reach 0).
    pub fn factor(&self) -> f64 {
        self.gear_factor() * self.untilted_factor().unwrap_or(1.0)
    }

    /// The same where the luminaire is mounted at this tilt, degrees.
    ///
    /// # Errors
    /// A file without a tilt table; a tilt outside it.
    pub fn factor_at_tilt(&self, tilt_deg: f64) -> Result<f64, Invalid> {
        let refused = |found: &str, required: String| Invalid::Content {
            what: "tilt_deg",
            found: format!("tilt_deg = {tilt_deg} {found}"),
            required,
        };
        let Some(table) = self.tilt_table() else {
            return Err(match &self.tilt {
                Tilt::File { name, .. } => refused(
                    &format!("for a file with TILT={name}, which was not read"),
                    "that file beside the photometric file".to_owned(),
                ),
                _ => refused(
                    "for a file without a tilt table",
                    "no tilt_deg, unless the file has TILT=INCLUDE or TILT=file; `aim` turns the lamp"
                        .to_owned(),
                ),
            });
        };
        let outside = || refused("outside the file's tilt table", format!("{} degrees", table.range()));
        table.factor_at(tilt_deg).map(|factor| self.gear_factor() * factor).ok_or_else(outside)
    }

    /// The tilt table, if the file has one that was read.
    pub fn tilt_table(&self) -> Option<&TiltTable> {
        match &self.tilt {
            Tilt::Include(table) | Tilt::File { table: Some(table), .. } => Some(table),
            Tilt::None | Tilt::File { table: None, .. } => None,
        }
    }

    /// The tilt table's factor at 0 degrees, if it reaches there.
    pub fn untilted_factor(&self) -> Option<f64> {
        self.tilt_table()?.factor_at(0.0)
    }

    /// Ballast factor, times field 12 in 1986 and 1991.
    fn gear_factor(&self) -> f64 {
        match self.format {
            Format::Lm63(revision) if revision.field12_is_factor() => self.ballast_factor * self.field12,
            _ => self.ballast_factor,
        }
    }

    /// Lumens of all lamps together, as the file declares them; `None` for absolute photometry, and where they are 0.
    pub fn lamps_lm(&self) -> Option<f64> {
        let of_set = self.lamp_sets.get(self.lamp_set).map(|set| set.flux_lm);
        self.lumens_per_lamp.map(|each| of_set.unwrap_or(self.lamps * each)).filter(|&lm| lm > 0.0)
    }

    /// Text of the first label with this keyword (case ignored, no brackets).
    pub fn label(&self, keyword: &str) -> Option<&str> {
        self.labels.iter().find(|(key, _)| key.eq_ignore_ascii_case(keyword)).map(|(_, text)| text.as_str())
    }
}
