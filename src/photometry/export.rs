//! What a photometric file is written from: a table of type C with all factors in it, and what stands beside
//! it.
//!
//! The writers ([`crate::files::lm63`], EULUMDAT) take this and nothing else: a photometric file that is
//! converted and a far field that was traced come the same way.

use super::opening::OpeningShape;
use super::{Format, LuminousOpening, PhotometricType, Photometry, Revision, Tilt, Web, flux};
use crate::error::{Diagnostic, Kind, Result};

/// Labels that state the flux of the luminaire: wrong once its table is scaled.
const TOTALS: [&str; 2] = ["_TOTALLUMINAIRELUMENS", "TOTALLUMINAIRELUMENS"];

/// A luminaire to be written. [`Export::new`] checks the table; the other fields may be set to anything, and
/// writers say what their format cannot hold.
#[derive(Debug, Clone, PartialEq)]
pub struct Export {
    /// Keyword of LM-63 without brackets (empty for a free line) and text, in the order of the file. EULUMDAT
    /// has places for
    /// `MANUFAC`, `TEST`, `LUMINAIRE`, `LUMCAT` and `ISSUEDATE`. A date is the caller's: no writer looks at a
    /// clock.
    pub labels: Vec<(String, String)>,
    /// Where the numbers come from.
    pub origin: DataOrigin,
    /// The table: type C, cd as emitted, every factor in it.
    web: Web,
    /// Number of lamps.
    pub lamps: f64,
    /// Lumens of all lamps together; `None` for absolute photometry.
    pub lamps_lm: Option<f64>,
    /// Kind of lamps, colour appearance and colour rendering, as text, for EULUMDAT.
    pub lamp_words: [String; 3],
    /// Luminous opening.
    pub opening: LuminousOpening,
    /// The luminaire itself, for EULUMDAT: length (along C90-C270) or diameter, width (0 where it is round) and height, m;
    /// `None`: as the opening.
    pub luminaire_size_m: Option<[f64; 3]>,
    /// Input power, W; 0 where it is not known.
    pub input_watts: f64,
    /// What was changed on the way here, in words.
    pub notes: Vec<String>,
}

/// Where the intensities of a file come from: the file generation type of LM-63-2019 (its section 5.13, Table
/// 2).
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum DataOrigin {
    /// A computer simulation: `1.00010`.
    Simulation,
    /// Not stated, or a file of an older edition: `1.00001`.
    Undefined,
    /// The code that a file of 2019 has.
    Code(String),
}

impl DataOrigin {
    /// The code of LM-63-2019.
    pub fn code(&self) -> &str {
        match self {
            Self::Simulation => "1.00010",
            Self::Undefined => "1.00001",
            Self::Code(code) => code,
        }
    }
}

/// What a writer gives.
#[derive(Debug, Clone, PartialEq)]
pub struct PhotometricFile {
    /// The file.
    pub bytes: Vec<u8>,
    /// The table as the file has it, over H = 0..360: rounded to its digits.
    pub table: Web,
    /// What the format could not hold as it was, in words.
    pub notes: Vec<String>,
}

impl Export {
    /// A luminaire of this name with this table: absolute photometry, one lamp, a point, no power, no further
    /// labels.
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
        Ok(Self {
            labels: vec![("LUMINAIRE".to_owned(), name.to_owned())],
            origin: DataOrigin::Undefined,
            web: Web::new(web.photometric_type, web.vertical_deg, web.horizontal_deg, web.candela)?,
            lamps: 1.0,
            lamps_lm: None,
            lamp_words: Default::default(),
            opening: LuminousOpening { shape: OpeningShape::Point, size_m: [0.0; 3], heights_m: None },
            luminaire_size_m: None,
            input_watts: 0.0,
            notes: Vec::new(),
        })
    }

    /// The luminaire of a file, with the factors that its intensities have not.
    ///
    /// # Errors
    /// Those of [`Export::new`].
    pub fn of(photometry: &Photometry) -> Result<Self> {
        let mut export = Self::new("", photometry.web.clone()).map_err(|d| d.in_file(&photometry.file))?;
        export.labels.clone_from(&photometry.labels);
        let code = || DataOrigin::Code(photometry.field12_text.clone());
        export.origin = match photometry.format {
            Format::Lm63(Revision::Y2019) => code(),
            _ => DataOrigin::Undefined,
        };
        export.lamps = photometry.lamps;
        export.lamps_lm = photometry.lamps_lm();
        if photometry.lumens_per_lamp.is_some() && export.lamps_lm.is_none() {
            export.notes.push("the lumens of the lamps are 0: written as absolute photometry".to_owned());
        }
        let kind = photometry.label("LAMP").unwrap_or_default().to_owned();
        export.lamp_words = match photometry.lamp_sets.get(photometry.lamp_set) {
            Some(set) => [set.kind.clone(), set.colour.clone(), set.cri.clone()],
            None => [kind, String::new(), String::new()],
        };
        export.opening = photometry.opening;
        export.luminaire_size_m = photometry.eulumdat.map(|head| head.luminaire_size_m);
        export.input_watts = photometry.input_watts;
        if photometry.factor() != 1.0 {
            export.multiply(photometry.factor());
            export.notes.push(format!("the factor {} is in the intensities", photometry.factor()));
        }
        if photometry.tilt != Tilt::None {
            export.notes.push("the table of lamp tilt is not written: TILT=NONE".to_owned());
        }
        Ok(export)
    }

    /// The table.
    pub fn web(&self) -> &Web {
        &self.web
    }

    /// Flux of the table by the industry's trapezoid, lm.
    pub fn flux_lm(&self) -> f64 {
        flux::trapezoid_lm(&self.web.full_grid())
    }

    /// Text of the first label with this keyword (case ignored) that is not blank.
    pub fn label(&self, keyword: &str) -> Option<&str> {
        let labels = self.labels.iter().filter(|(key, _)| key.eq_ignore_ascii_case(keyword));
        labels.map(|(_, text)| text.trim()).find(|text| !text.is_empty())
    }

    /// Scales table and lamps so that the flux (by the trapezoid) is this one, lm. The watts stay.
    ///
    /// # Errors
    /// [`Kind::Range`] for a flux that is not above 0 and at most 1e12 lm, and for a dark table.
    pub fn scale_to(&mut self, flux_lm: f64) -> Result<()> {
        let is_fit = flux_lm > 0.0 && flux_lm <= 1e12;
        if !is_fit {
            return Err(Diagnostic::new(
                Kind::Range,
                format!("{flux_lm} lm"),
                "a flux above 0, at most 1e12 lm",
            ));
        }
        let now_lm = self.flux_lm();
        if now_lm == 0.0 {
            return Err(Diagnostic::new(
                Kind::Range,
                "a table without light",
                "a flux above 0, to be scaled",
            ));
        }
        self.multiply(flux_lm / now_lm);
        self.lamps_lm = self.lamps_lm.map(|lm| lm * (flux_lm / now_lm));
        self.notes.push(format!("scaled from {now_lm:.1} to {flux_lm} lm; the watts are as they were"));
        Ok(())
    }

    fn multiply(&mut self, factor: f64) {
        self.web.candela.iter_mut().for_each(|c| *c *= factor);
        let is_total = |key: &str| TOTALS.iter().any(|total| key.eq_ignore_ascii_case(total));
        let (dropped, kept) =
            std::mem::take(&mut self.labels).into_iter().partition(|(key, _)| is_total(key));
        self.labels = kept;
        for (key, text) in Vec::<(String, String)>::from_iter(dropped) {
            self.notes.push(format!("[{key}] {text} is left out: it held for the table before"));
        }
    }

    /// Turns the table about its axis: what was at H comes to H + `by_deg`. The opening turns with it by
    /// multiples of 90 degrees.
    ///
    /// # Errors
    /// [`Kind::Range`] for an angle beyond +-360 degrees.
    pub fn turn(&mut self, by_deg: f64) -> Result<()> {
        let is_fit = by_deg.abs() <= 360.0;
        if !is_fit {
            return Err(Diagnostic::new(
                Kind::Range,
                format!("{by_deg} degrees"),
                "an angle within +-360 degrees",
            ));
        }
        if by_deg % 360.0 == 0.0 {
            return Ok(());
        }
        self.web = self.web.turned(by_deg);
        if let Some([length, width, height]) = self.luminaire_size_m
            && width > 0.0
            && by_deg.rem_euclid(180.0) == 90.0
        {
            self.luminaire_size_m = Some([width, length, height]);
        }
        match self.opening.turned(by_deg) {
            Some(opening) => self.opening = opening,
            None => self.notes.push(format!(
                "the luminous opening ({}) is not turned: neither format can say how it lies then",
                self.opening.shape
            )),
        }
        self.notes.push(format!("turned by {by_deg} degrees about the axis"));
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn web(h: &[f64], candela: &[f64]) -> Web {
        Web::new(PhotometricType::C, vec![0.0, 60.0, 90.0], h.to_vec(), candela.to_vec()).unwrap()
    }

    #[test]
    fn scaling_keeps_the_share_of_the_lamps() {
        let mut export = Export::new("a", web(&[0.0], &[100.0, 50.0, 0.0])).unwrap();
        export.lamps_lm = Some(400.0);
        export.labels.push(("_TotalLuminaireLumens".to_owned(), "1".to_owned()));
        let ratio = export.flux_lm() / 400.0;
        export.scale_to(1234.5).unwrap();
        assert!((export.flux_lm() - 1234.5).abs() < 1e-9);
        assert!((export.flux_lm() / export.lamps_lm.unwrap() - ratio).abs() < 1e-14);
        assert_eq!(export.labels.len(), 1);
        assert_eq!(export.notes.len(), 2, "{:?}", export.notes);
        assert!(export.scale_to(0.0).is_err() && export.scale_to(f64::NAN).is_err());
        let mut dark = Export::new("a", web(&[0.0], &[0.0; 3])).unwrap();
        assert!(dark.scale_to(1.0).is_err());
        let flood = Web { photometric_type: PhotometricType::B, ..web(&[0.0, 90.0], &[1.0; 6]) };
        assert!(Export::new("a", flood).is_err());
    }

    #[test]
    fn a_turned_luminaire_shines_where_it_was_turned_to() {
        let h = [0.0, 50.0, 90.0, 200.0, 360.0];
        let candela: Vec<f64> = (0..15).map(|i| f64::from((i * 7919 + 13) % 101)).collect();
        let mut skew = web(&h, &candela);
        skew.candela.copy_within(0..3, 12);
        for by_deg in [-360.0, -133.7, -90.0, 0.0, 0.1, 90.0, 180.0, 270.0] {
            let mut export = Export::new("a", skew.clone()).unwrap();
            export.turn(by_deg).unwrap();
            for at in [0.0, 17.0, 49.9, 90.0, 133.0, 199.0, 355.0] {
                let (was, is) = (skew.intensity_cd(40.0, at), export.web().intensity_cd(40.0, at + by_deg));
                assert!((was - is).abs() <= 1e-9 * was, "{by_deg} {at}: {was} {is}");
            }
            let flux_lm = Export::new("a", skew.clone()).unwrap().flux_lm();
            assert!((export.flux_lm() / flux_lm - 1.0).abs() < 1e-12, "{by_deg}");
        }
        let mut export = Export::new("a", skew).unwrap();
        assert!(export.turn(361.0).is_err() && export.turn(f64::NAN).is_err());
    }
}
