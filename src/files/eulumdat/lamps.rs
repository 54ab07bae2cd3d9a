//! Line 26 and the lamp sets.

use super::fields::{Field, Fields, value};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::quoted;
use crate::photometry::LampSet;

/// Lamp sets that are read at most: the format has 20.
pub const MAX_LAMP_SETS: usize = 1000;

/// Lines of a set.
const LINES: usize = 6;

/// Places among them of what must be a number: lamps, lumens, watts.
const NUMBERS: [usize; 3] = [0, LUMENS, 5];
const LUMENS: usize = 2;

/// The lamp sets, and which of them is taken.
pub(super) struct Lamps {
    pub sets: Vec<LampSet>,
    pub chosen: usize,
}

impl Lamps {
    /// The set that is taken; `None` where there are none.
    pub fn taken(&self) -> Option<&LampSet> {
        self.sets.get(self.chosen)
    }
}

/// Reads them; `lamp_set` is the one to take, from 1.
pub(super) fn read(fields: &mut Fields<'_>, lamp_set: Option<usize>) -> Result<Lamps> {
    let what = "number of lamp sets";
    let written = fields.number(what)?;
    if !(written.value >= 0.0 && written.value.fract() == 0.0) {
        return fields.refuse(&written, Kind::Range, what, "a whole number, 0 or more");
    }
    if written.value > MAX_LAMP_SETS as f64 {
        return fields.refuse(&written, Kind::Limit, what, &format!("at most {MAX_LAMP_SETS}"));
    }
    let count = written.value as usize;
    let mut lines = Vec::new();
    for i in 0..count * LINES {
        lines.push(fields.field(&format!(
            "line {} of {LINES} of lamp set {}",
            i % LINES + 1,
            i / LINES + 1
        ))?);
    }
    let by_set = |set: usize, line: usize| lines[set * LINES + line];
    let by_field = |set: usize, line: usize| lines[line * count + set];
    let is_by_field = !fits(count, by_set) && fits(count, by_field);
    if is_by_field {
        let required = "lamp sets one after the other";
        fields.warn(written.offset, Kind::Syntax, "lamp sets field by field", required, "read so");
    }
    let at = |set, line| if is_by_field { by_field(set, line) } else { by_set(set, line) };
    let sets =
        (0..count).map(|set| one(fields, set + 1, |line| at(set, line))).collect::<Result<Vec<_>>>()?;
    let chosen = lamp_set.map_or(0, |number| number.saturating_sub(1)).min(count.saturating_sub(1));
    let lamps = Lamps { sets, chosen };
    match lamps.taken() {
        None => {
            let hint = "the intensities are taken for 1000 lm";
            fields.warn(written.offset, Kind::Missing, "0 lamp sets", "1 or more", hint);
        }
        Some(set) if set.flux_lm == 0.0 => {
            let found = format!("0 lm of lamp set {}, of which the intensities are a share", chosen + 1);
            let d = Diagnostic::new(Kind::Range, found, "lumens above 0");
            let d = d.hint("in absolute photometry it is the flux of the luminaire");
            return Err(fields.place(at(chosen, LUMENS).offset, d));
        }
        Some(_) if count > 1 && lamp_set.is_none() => {
            let d = Diagnostic::new(
                Kind::Missing,
                told(&lamps.sets),
                "one of them chosen, by `lamp_set` of the emitter or --lamp-set",
            );
            fields
                .warnings
                .push(fields.place(written.offset, d.hint("they are alternatives: lamp set 1 is used")));
        }
        Some(_) => {}
    }
    Ok(lamps)
}

/// `3 lamp sets (1: LED, 1000 lm; 2: ...)`.
pub(crate) fn told(sets: &[LampSet]) -> String {
    const MOST: usize = 5;
    let one = |(i, set): (usize, &LampSet)| {
        let kind: String = set.kind.chars().filter(|c| !c.is_control()).take(40).collect();
        let watts = if set.watts > 0.0 { format!(", {} W", set.watts) } else { String::new() };
        format!("{}: {kind}{}{} lm{watts}", i + 1, if kind.is_empty() { "" } else { ", " }, set.flux_lm)
    };
    let list: Vec<String> = sets.iter().enumerate().take(MOST).map(one).collect();
    let more = if sets.len() > MOST { "; ..." } else { "" };
    format!("{} lamp sets ({}{more})", sets.len(), list.join("; "))
}

/// Whether numbers stand where they must when the lines are taken in this way.
fn fits<'a>(count: usize, at: impl Fn(usize, usize) -> Field<'a>) -> bool {
    let number = |field: Field<'_>| field.text.split_whitespace().next().and_then(value).is_some();
    (0..count).all(|set| NUMBERS.iter().all(|&line| number(at(set, line))))
}

fn one<'a>(fields: &mut Fields<'a>, set: usize, at: impl Fn(usize) -> Field<'a>) -> Result<LampSet> {
    let what = |quantity: &str| format!("{quantity} of lamp set {set}");
    let count = fields.number_of(at(0), &what("number of lamps"))?;
    if count.value == 0.0 || count.value.fract() != 0.0 {
        let found = format!("{} {}", what("number of lamps"), count.text);
        let hint = "it scales nothing";
        fields.warn(
            count.offset,
            Kind::Range,
            &found,
            "a whole number: 1 or more, negative in absolute photometry",
            hint,
        );
    }
    let flux = fields.number_of(at(LUMENS), &what("lumens"))?;
    if flux.value < 0.0 {
        return fields.refuse(&flux, Kind::Range, &what("lumens"), "0 or more");
    }
    Ok(LampSet {
        count: count.value,
        kind: at(1).text.to_owned(),
        flux_lm: flux.value,
        colour: at(3).text.to_owned(),
        cri: at(4).text.to_owned(),
        watts: watts(fields, at(5), &what("watts")),
    })
}

/// The watts, which decide nothing.
fn watts(fields: &mut Fields<'_>, field: Field<'_>, what: &str) -> f64 {
    let word = field.text.split_whitespace().next().unwrap_or_default();
    let watts = value(word).filter(|&watts| watts >= 0.0);
    if watts.is_none() && !word.is_empty() {
        let found = format!("{what} {}", quoted(field.text));
        fields.warn(field.offset, Kind::Range, &found, "0 or more", "read as 0");
    }
    watts.unwrap_or(0.0)
}
