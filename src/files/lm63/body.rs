//! The numbers: the record of ten, the record of three, angles and candela.

use super::tokens::Tokens;
use super::turned::turned;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::candela::Said;
use crate::files::candela::angles::snap;
use crate::files::candela::checks::{Candela, MAX_ANGLES, MAX_FACTOR, poles, seam};
use crate::files::candela::number::{Number, values};
use crate::photometry::axes::{Axis, AxisNote, check_axes};
use crate::photometry::opening::sign;
use crate::photometry::{Format, LuminousOpening, PhotometricType, Photometry, Revision, Tilt, Web};

/// The stream and what is wrong in it and tolerated.
pub(crate) struct Reader<'a> {
    pub tokens: Tokens<'a>,
    pub warnings: Vec<Diagnostic>,
}

impl<'a> Reader<'a> {
    pub fn new(text: &'a str, offset: usize) -> Self {
        Self { tokens: Tokens::new(text, offset), warnings: Vec::new() }
    }

    /// Keeps a warning at this byte.
    pub fn warn(&mut self, offset: usize, kind: Kind, found: &str, required: &str, hint: &str) {
        let mut d = Diagnostic::new(kind, found, required);
        if !hint.is_empty() {
            d = d.hint(hint);
        }
        self.warnings.push(self.tokens.place(offset, d));
    }

    fn tell(&mut self, said: Said) {
        self.warn(said.offset, Kind::Range, &said.found, &said.required, &said.hint);
    }

    /// Keeps a warning about a number that is out of its range.
    fn doubt(&mut self, number: &Number, what: &str, required: &str, hint: &str) {
        self.warn(number.offset, Kind::Range, &format!("{what} {}", number.text), required, hint);
    }

    pub fn refuse<T>(&self, number: &Number, kind: Kind, what: &str, required: &str) -> Result<T> {
        let found = format!("{what} {}", number.text);
        Err(self.tokens.place(number.offset, Diagnostic::new(kind, found, required)))
    }

    /// A number that must be one of these integers; `1.0` is one.
    pub fn code(&mut self, what: &str, allowed: &[u32], required: &str) -> Result<u32> {
        let number = self.tokens.number(what)?;
        match allowed.iter().find(|&&code| f64::from(code) == number.value) {
            Some(&code) => Ok(code),
            None => self.refuse(&number, Kind::Range, what, required),
        }
    }

    /// A count: a positive integer within the cap, also written `19.0`.
    pub fn count(&mut self, what: &str) -> Result<usize> {
        let number = self.tokens.number(what)?;
        if !(number.value >= 1.0 && number.value.fract() == 0.0) {
            return self.refuse(&number, Kind::Range, what, "a whole number, 1 or more");
        }
        if number.value > MAX_ANGLES as f64 {
            return self.refuse(&number, Kind::Limit, what, &format!("at most {MAX_ANGLES}"));
        }
        Ok(number.value as usize)
    }

    /// A factor: 0 or more, and 0 gives a warning, since it makes the luminaire dark.
    fn factor(&mut self, what: &str) -> Result<Number<'a>> {
        let number = self.tokens.number(what)?;
        if !(number.value >= 0.0 && number.value <= MAX_FACTOR) {
            return self.refuse(&number, Kind::Range, what, &format!("a factor between 0 and {MAX_FACTOR}"));
        }
        if number.value == 0.0 {
            self.doubt(&number, what, "a factor above 0", "the flux is 0");
        }
        Ok(number)
    }

    /// A number; one that does not fit gives a warning.
    fn tolerated(&mut self, what: &str, fits: fn(f64) -> bool, required: &str, hint: &str) -> Result<f64> {
        let number = self.tokens.number(what)?;
        if !fits(number.value) {
            self.doubt(&number, what, required, hint);
        }
        Ok(number.value)
    }

    /// Everything from the number of lamps on: a luminaire without labels and tilt.
    pub fn luminaire(&mut self, revision: Revision) -> Result<Photometry> {
        let whole = |x: f64| x >= 1.0 && x.fract() == 0.0;
        let required = "a whole number, 1 or more";
        let lamps = self.tolerated("number of lamps", whole, required, "it scales nothing")?;
        let absolute = |x: f64| x >= 0.0 || x == -1.0;
        let required = "0 or more, or -1 (absolute)";
        let lumens_per_lamp = self.tolerated("lumens per lamp", absolute, required, "read as -1")?;
        let multiplier = self.factor("candela multiplier")?.value;
        let n_v = self.count("number of vertical angles")?;
        let n_h = self.count("number of horizontal angles")?;
        let photometric_type =
            match self.code("photometric type", &[1, 2, 3], "1 (type C), 2 (B) or 3 (A)")? {
                1 => PhotometricType::C,
                2 => PhotometricType::B,
                _ => PhotometricType::A,
            };
        let feet = self.code("units", &[1, 2], "1 (feet) or 2 (metres)")? == 1;
        let sides = [
            self.tokens.number("width of the luminous opening")?,
            self.tokens.number("length of the luminous opening")?,
            self.tokens.number("height of the luminous opening")?,
        ];
        self.require_table(n_v, n_h)?;
        let ballast_factor = self.factor("ballast factor")?.value;
        let field12 = self.field12(revision)?;
        let input_watts = self.tolerated("input watts", |x| x >= 0.0, "0 or more", "read as 0")?.max(0.0);
        let mut vertical = self.tokens.numbers(n_v, "vertical angle")?;
        let mut horizontal = self.tokens.numbers(n_h, "horizontal angle")?;
        let snapped = [snap("vertical", &mut vertical), snap("horizontal", &mut horizontal)];
        let (turned, said) = turned(photometric_type, &horizontal).unzip();
        snapped.into_iter().flatten().chain(said).for_each(|said| self.tell(said));
        let stored = horizontal.clone();
        if let Some(order) = &turned {
            horizontal = order.iter().map(|&(i, value)| Number { value, ..stored[i] }).collect();
        }
        self.check_angles(revision, photometric_type, &vertical, &horizontal)?;
        let mut candela = self.candela(n_v * n_h, multiplier)?;
        seam(photometric_type, &candela, &stored).into_iter().for_each(|said| self.tell(said));
        if let Some(order) = &turned {
            candela = order.iter().flat_map(|&(i, _)| &candela[i * n_v..(i + 1) * n_v]).copied().collect();
        }
        let web = Web {
            photometric_type,
            vertical_deg: values(&vertical),
            horizontal_deg: values(&horizontal),
            candela,
        };
        poles(&web, [&vertical, &horizontal]).into_iter().for_each(|said| self.tell(said));
        Ok(Photometry {
            file: String::new(),
            format: Format::Lm63(revision),
            labels: Vec::new(),
            tilt: Tilt::None,
            lamps,
            lumens_per_lamp: (lumens_per_lamp >= 0.0).then_some(lumens_per_lamp),
            lamp_sets: Vec::new(),
            lamp_set: 0,
            eulumdat: None,
            multiplier,
            ballast_factor,
            field12: field12.value,
            field12_text: field12.text.to_owned(),
            input_watts,
            opening: self.opening(sides, feet, revision),
            web,
            flux_declared_lm: None,
            warnings: Vec::new(),
        })
    }

    fn opening(&mut self, sides: [Number; 3], feet: bool, revision: Revision) -> LuminousOpening {
        let fields = sides.map(|n| n.value);
        let (opening, defined) = LuminousOpening::from_fields(fields, feet, revision);
        if !defined {
            let signs: String = fields.map(sign).iter().collect();
            let found = format!("signs {signs} of width, length and height of the luminous opening");
            let hint = format!("read as {}", opening.shape);
            self.warn(sides[0].offset, Kind::Unknown, &found, "a combination of this edition", &hint);
        }
        opening
    }

    /// Whether the file holds what its counts promise, before memory is asked for. Three numbers short is the mark
    /// of a whole family of generated files: they leave out the record of three.
    fn require_table(&self, n_v: usize, n_h: usize) -> Result<()> {
        let (n_v, n_h) = (n_v as u64, n_h as u64);
        let needed = 3 + n_v + n_h + n_v * n_h;
        let name = |i: u64| match i {
            0 => "the ballast factor".to_owned(),
            1 => "field 12".to_owned(),
            2 => "the input watts".to_owned(),
            _ if i < 3 + n_v => format!("vertical angle {} of {n_v}", i - 2),
            _ if i < 3 + n_v + n_h => format!("horizontal angle {} of {n_h}", i - 2 - n_v),
            _ => format!("candela {} of {n_h} x {n_v}", i - 2 - n_v - n_h),
        };
        self.tokens.require(needed, name).map_err(|d| {
            if d.kind() == Kind::Missing && self.tokens.count() + 3 == needed {
                d.hint("just three are missing: is the record of ballast factor, field 12 and input watts there?")
            } else {
                d
            }
        })
    }

    fn field12(&mut self, revision: Revision) -> Result<Number<'a>> {
        if revision.field12_is_factor() {
            return self.factor("ballast-lamp photometric factor (field 12)");
        }
        let number = self.tokens.number("field 12")?;
        if revision == Revision::Y2019 {
            if generation_type(number.text).is_none() {
                let found = format!("field 12 {}", number.text);
                let required = "a file generation type such as 1.10000";
                self.warn(number.offset, Kind::Unknown, &found, required, "it is never used as a factor");
            }
        } else if number.value != 1.0 {
            let hint = "it is a factor in 1986 and 1991 only, and is ignored here";
            self.doubt(&number, "field 12", "1 in this edition", hint);
        }
        Ok(number)
    }

    fn check_angles(
        &mut self,
        revision: Revision,
        photometric_type: PhotometricType,
        vertical: &[Number],
        horizontal: &[Number],
    ) -> Result<()> {
        let offset = |note: &AxisNote| {
            let list = if note.axis == Axis::Vertical { vertical } else { horizontal };
            list.get(note.index).map_or(0, |n| n.offset)
        };
        let h = values(horizontal);
        let notes = check_axes(photometric_type, &values(vertical), &h).map_err(|note| {
            let d = Diagnostic::new(Kind::Range, note.found.clone(), note.required);
            self.tokens.place(offset(&note), d)
        })?;
        for note in notes {
            self.warn(offset(&note), Kind::Range, &note.found, note.required, note.hint);
        }
        let half =
            photometric_type == PhotometricType::C && h.first() == Some(&90.0) && h.last() == Some(&270.0);
        if half && revision >= Revision::Y2002 {
            let found = "horizontal angles over 90..270";
            let hint = "read as mirrored in the 90-270 plane, as before 2002";
            self.warn(horizontal[0].offset, Kind::Range, found, "0, 0..90, 0..180 or 0..360", hint);
        }
        Ok(())
    }

    /// The intensities times the multiplier; slightly negative ones become 0.
    fn candela(&mut self, n: usize, multiplier: f64) -> Result<Vec<f64>> {
        let mut candela = Candela::new(n, multiplier);
        for _ in 0..n {
            let number = self.tokens.number("candela")?;
            candela.push(number).map_err(|said| self.refusal(Kind::Limit, said))?;
        }
        let (candela, said) = candela.finish().map_err(|said| self.refusal(Kind::Range, said))?;
        said.into_iter().for_each(|said| self.tell(said));
        Ok(candela)
    }

    fn refusal(&self, kind: Kind, said: Said) -> Diagnostic {
        self.tokens.place(said.offset, Diagnostic::new(kind, said.found, said.required))
    }
}

/// Meaning of field 12 in LM-63-2019 (its section 5.13, Table 2). The code is text: trailing zeros may be missing.
pub fn generation_type(text: &str) -> Option<&'static str> {
    Some(match format!("{:0<7}", if text == "1" { "1." } else { text }).as_str() {
        "1.00001" => "undefined or older file",
        "1.00010" => "computer simulation",
        "1.00000" => "test at an unaccredited laboratory",
        "1.00100" => "test at an unaccredited laboratory, lumens scaled",
        "1.01000" => "test at an unaccredited laboratory, angles interpolated",
        "1.01100" => "test at an unaccredited laboratory, lumens scaled, angles interpolated",
        "1.10000" => "test at an accredited laboratory",
        "1.10100" => "test at an accredited laboratory, lumens scaled",
        "1.11000" => "test at an accredited laboratory, angles interpolated",
        "1.11100" => "test at an accredited laboratory, lumens scaled, angles interpolated",
        _ => return None,
    })
}
