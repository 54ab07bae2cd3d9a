//! Lines 1 to 25, and the direct ratios.

use super::fields::{Fields, is_blank, value};
use crate::error::{Kind, Result};
use crate::files::candela::checks::{MAX_ANGLES, MAX_FACTOR};
use crate::files::candela::number::Number;
use crate::files::excerpt::quoted;
use crate::photometry::LuminousOpening;

/// Larger sizes, mm, are none: 10 km.
const MAX_SIZE_MM: f64 = 1e7;

/// Metres in a millimetre.
const M_PER_MM: f64 = 1e-3;

/// What stands before the lamps.
pub(super) struct Head<'a> {
    pub labels: Vec<(String, String)>,
    pub ityp: u32,
    pub isym: Number<'a>,
    pub c: Declared<'a>,
    pub gamma: Declared<'a>,
    pub luminaire_size_m: [f64; 3],
    pub opening: LuminousOpening,
    pub downward_fraction_percent: f64,
    pub light_output_ratio_percent: f64,
    pub conversion: f64,
    pub measured_tilt_deg: f64,
}

/// What is declared of a list of angles.
pub(super) struct Declared<'a> {
    pub count: usize,
    /// The count as it is written.
    pub written: Number<'a>,
    /// The distance of neighbours, degrees; 0: uneven.
    pub step_deg: f64,
    /// Where it stands.
    pub step_offset: usize,
}

pub(super) fn read<'a>(fields: &mut Fields<'a>) -> Result<Head<'a>> {
    let mut labels = Vec::new();
    label(fields, &mut labels, "MANUFAC", "the company")?;
    let is_type = |x: f64| (0.0..=3.0).contains(&x) && x.fract() == 0.0;
    let ityp = fields.tolerated("type Ityp", is_type, "0, 1, 2 or 3 (it decides nothing)", 3.0)? as u32;
    let isym = fields.number("symmetry Isym")?;
    if !((0.0..=4.0).contains(&isym.value) && isym.value.fract() == 0.0) {
        return fields.refuse(&isym, Kind::Range, "symmetry Isym", "0, 1, 2, 3 or 4");
    }
    let c = declared(fields, "C planes Mc", "distance Dc of C planes")?;
    let gamma = declared(fields, "gamma angles Ng", "distance Dg of gamma angles")?;
    for (keyword, what) in [
        ("TEST", "the number of the report"),
        ("LUMINAIRE", "the name of the luminaire"),
        ("LUMCAT", "the number of the luminaire"),
        ("_FILENAME", "the name of the file"),
        ("ISSUEDATE", "date and user"),
    ] {
        label(fields, &mut labels, keyword, what)?;
    }
    let luminaire_size_m = [
        size(fields, "length of the luminaire")?,
        size(fields, "width of the luminaire")?,
        size(fields, "height of the luminaire")?,
    ];
    let [length, width] =
        [size(fields, "length of the luminous area")?, size(fields, "width of the luminous area")?];
    let mut heights_m = [0.0; 4];
    for (height, plane) in heights_m.iter_mut().zip(["C0", "C90", "C180", "C270"]) {
        *height = size(fields, &format!("luminous height at {plane}"))?;
    }
    let is_percent = |x: f64| (0.0..=101.0).contains(&x);
    let downward_fraction_percent = fields.tolerated("downward fraction", is_percent, "0 to 100 %", 0.0)?;
    let is_ratio = |x: f64| (0.0..=1e6).contains(&x);
    let light_output_ratio_percent =
        fields.tolerated("light output ratio (LORL)", is_ratio, "per cent, 0 or more", 0.0)?;
    let conversion = conversion(fields)?;
    let measured_tilt_deg =
        fields.tolerated("tilt", |x| x.abs() <= 360.0, "degrees within -360..360", 0.0)?;
    Ok(Head {
        labels,
        ityp,
        isym,
        c,
        gamma,
        luminaire_size_m,
        opening: LuminousOpening::from_eulumdat([length, width], heights_m),
        downward_fraction_percent,
        light_output_ratio_percent,
        conversion,
        measured_tilt_deg,
    })
}

/// A line of text, as the label of LM-63 that means the same; a blank one is none.
fn label(
    fields: &mut Fields<'_>,
    labels: &mut Vec<(String, String)>,
    keyword: &str,
    what: &str,
) -> Result<()> {
    let text = fields.field(what)?.text;
    if !text.is_empty() {
        labels.push((keyword.to_owned(), text.to_owned()));
    }
    Ok(())
}

/// A count of angles and their distance.
fn declared<'a>(fields: &mut Fields<'a>, what: &str, step: &str) -> Result<Declared<'a>> {
    let what = format!("number of {what}");
    let written = fields.number(&what)?;
    if !(written.value >= 1.0 && written.value.fract() == 0.0) {
        return fields.refuse(&written, Kind::Range, &what, "a whole number, 1 or more");
    }
    if written.value > MAX_ANGLES as f64 {
        return fields.refuse(&written, Kind::Limit, &what, &format!("at most {MAX_ANGLES}"));
    }
    let step_offset = fields.lines.offset();
    let step_deg = fields.tolerated(step, |x| (0.0..=360.0).contains(&x), "0 to 360 degrees", 0.0)?;
    Ok(Declared { count: written.value as usize, written, step_deg, step_offset })
}

/// A size in metres.
fn size(fields: &mut Fields<'_>, what: &str) -> Result<f64> {
    let fits = |x: f64| (0.0..=MAX_SIZE_MM).contains(&x);
    Ok(fields.tolerated(what, fits, "millimetres, 0 or more", 0.0)? * M_PER_MM)
}

/// The factor of all intensities; 1 where the line is blank.
fn conversion(fields: &mut Fields<'_>) -> Result<f64> {
    let what = "conversion factor of the intensities";
    let field = fields.field(what)?;
    if field.text.is_empty() {
        fields.warn(field.offset, Kind::Missing, "a blank line", &format!("a number: {what}"), "read as 1");
        return Ok(1.0);
    }
    let number = fields.number_of(field, what)?;
    if !(number.value > 0.0 && number.value <= MAX_FACTOR) {
        return fields.refuse(
            &number,
            Kind::Range,
            what,
            &format!("a factor above 0 and up to {MAX_FACTOR}; usually 1"),
        );
    }
    Ok(number.value)
}

/// Ten direct ratios, which decide nothing: blank lines are 0, and several may stand on a line.
pub(super) fn direct_ratios(fields: &mut Fields<'_>) -> Result<[f64; 10]> {
    let mut ratios = Vec::with_capacity(10);
    while ratios.len() < 10 {
        let what = format!("direct ratio {} of 10", ratios.len() + 1);
        let field = fields.field(&what)?;
        let words = field.text.split(is_blank).filter(|word| !word.is_empty());
        let numbers: Vec<f64> = words.map_while(value).take(11).collect();
        if numbers.is_empty() && !field.text.is_empty() {
            let found = format!("{what} {}", quoted(field.text));
            fields.warn(field.offset, Kind::Range, &found, "a number", "read as 0");
        }
        if ratios.len() + numbers.len() > 10 {
            let number = Number { value: 0.0, text: "with numbers of the next list", offset: field.offset };
            return fields.refuse(&number, Kind::Syntax, &what, "a line that ends with direct ratio 10");
        }
        if numbers.is_empty() {
            ratios.push(0.0);
        }
        ratios.extend(numbers);
    }
    let mut ten = [0.0; 10];
    ten.copy_from_slice(&ratios);
    Ok(ten)
}
