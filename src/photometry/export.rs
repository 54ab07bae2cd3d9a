//! What a photometric file is written from: a table of type C with all factors in it, and what stands beside it.
//!
//! The writers ([`crate::files::lm63`], EULUMDAT) take this and nothing else: a photometric file that is converted and a
//! far field that was traced come the same way.

use super::{LuminousOpening, PhotometricType, Web, flux};
use crate::error::{Diagnostic, Kind, Result};

/// A luminaire to be written. [`Export::new`] checks the table; the other fields may be set to anything, and writers say
/// what their format cannot hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// Keyword of LM-63 without brackets and text, in the order of the file. EULUMDAT has places for `MANUFAC`, `TEST`,
    /// `LUMINAIRE`, `LUMCAT`, `ISSUEDATE` and `LAMP`. A date is the caller's: no writer looks at a clock.
    pub labels: Vec<(String, String)>,
    /// Where the numbers come from.
    pub origin: Origin,
    /// The table: type C, cd as emitted, every factor in it.
    web: Web,
    /// Number of lamps.
    pub lamps: f64,
    /// Lumens of all lamps together; `None` for absolute photometry.
    pub lamps_lm: Option<f64>,
    /// Luminous opening.
    pub opening: LuminousOpening,
    /// Input power, W; 0 where it is not known.
    pub input_watts: f64,
}

/// Where the intensities of a file come from: the file generation type of LM-63-2019 (its section 5.13, Table 2).
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Origin {
    /// A computer simulation: `1.00010`.
    Simulation,
    /// Not stated, or a file of an older edition: `1.00001`.
    Undefined,
    /// The code that a file of 2019 has.
    Code(String),
}

impl Origin {
    /// The code of LM-63-2019.
    pub fn code(&self) -> &str {
        match self {
            Self::Simulation => "1.00010",
            Self::Undefined => "1.00001",
            Self::Code(code) => code,
        }
    }
}

/// What a writer gives: the bytes of a file, and what is to be said about them.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Written {
    /// The file.
    pub bytes: Vec<u8>,
    /// What the format could not hold as it was, in words.
    pub notes: Vec<String>,
}

impl Export {
    /// A luminaire of this name with this table: absolute photometry, one lamp, a point, no power, no further labels.
    ///
    /// # Errors
    /// [`Kind::Range`] for a table that is not of type C, or that [`Web::new`] refuses.
    pub fn new(name: &str, web: Web) -> Result<Self> {
        if web.photometric_type != PhotometricType::C {
            let found = format!("a table of type {}", web.photometric_type.name());
            let required = "type C: intensities over angles from the axis (V) and around it (H)";
            return Err(Diagnostic::new(Kind::Range, found, required)
                .hint("types A and B have other poles: a table of them is not turned into type C here"));
        }
        let web = Web::new(web.photometric_type, web.vertical_deg, web.horizontal_deg, web.candela)?;
        Ok(Self {
            labels: vec![("LUMINAIRE".to_owned(), name.to_owned())],
            origin: Origin::Undefined,
            web,
            lamps: 1.0,
            lamps_lm: None,
            opening: LuminousOpening { shape: super::opening::OpeningShape::Point, size_m: [0.0; 3] },
            input_watts: 0.0,
        })
    }

    /// The table.
    pub fn web(&self) -> &Web {
        &self.web
    }

    /// Flux of the table by the industry's trapezoid, lm.
    pub fn flux_lm(&self) -> f64 {
        flux::trapezoid_lm(&self.web.full_grid())
    }

    /// Text of the first label with this keyword (case ignored); `None` where it is blank.
    pub fn label(&self, keyword: &str) -> Option<&str> {
        let label = self.labels.iter().find(|(key, _)| key.eq_ignore_ascii_case(keyword));
        label.map(|(_, text)| text.trim()).filter(|text| !text.is_empty())
    }
}
