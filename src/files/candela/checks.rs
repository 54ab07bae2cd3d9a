//! What must hold of a table of intensities, and what of it is worth a warning.

use super::Said;
use super::number::Number;
use crate::error::{Diagnostic, Kind};
use crate::photometry::{PhotometricType, Web};

/// Angles on one axis, and pairs of a tilt table, that are read at most. The finest real table has 721.
pub(crate) const MAX_ANGLES: usize = 100_000;

/// Intensities above this are refused: no sum over a sphere can overflow then. The sun has 3e27 cd.
const MAX_CANDELA: f64 = 1e30;

/// Factors (ballast, field 12, conversion, tilt) above this are refused, for the same reason.
pub(crate) const MAX_FACTOR: f64 = 1e6;

/// Share of the maximum that passes for measurement noise: negative intensities, planes that should be equal.
const NOISE: f64 = 1e-3;

/// Distance of the two integrals of one table that is worth a warning: of 8 187 real files 14 exceed it, by
/// up to 6.2 %.
const TWO_INTEGRALS: f64 = 1e-2;

/// Intensities as they are read: times the multiplier, slightly negative ones 0.
pub(crate) struct Candela<'a> {
    multiplier: f64,
    values: Vec<f64>,
    lowest: Option<Number<'a>>,
}

impl<'a> Candela<'a> {
    /// For `n` values, which the caller knows to be there.
    pub fn new(n: usize, multiplier: f64) -> Self {
        Self { multiplier, values: Vec::with_capacity(n), lowest: None }
    }

    /// Takes the next value.
    ///
    /// # Errors
    /// One beyond `MAX_CANDELA`.
    pub fn push(&mut self, number: Number<'a>) -> Result<(), Said> {
        let value = number.value * self.multiplier;
        if value.abs() > MAX_CANDELA {
            let (found, required) = (format!("candela {}", number.text), format!("at most {MAX_CANDELA:e}"));
            return Err(Said { offset: number.offset, found, required, hint: String::new() });
        }
        if number.value < self.lowest.map_or(0.0, |n| n.value) {
            self.lowest = Some(number);
        }
        self.values.push(value);
        Ok(())
    }

    /// All of them, and what to say of negative ones.
    ///
    /// # Errors
    /// Negative ones that are no noise.
    pub fn finish(mut self) -> Result<(Vec<f64>, Option<Said>), Said> {
        let Some(number) = self.lowest else { return Ok((self.values, None)) };
        let max = self.values.iter().copied().fold(0.0, f64::max);
        let said = |required: &str, hint: &str| Said {
            offset: number.offset,
            found: format!("candela {}", number.text),
            required: required.to_owned(),
            hint: hint.to_owned(),
        };
        if number.value * self.multiplier < -NOISE * max || max == 0.0 {
            return Err(said("0 or more (noise down to -0.1 % of the maximum is taken as 0)", ""));
        }
        for c in &mut self.values {
            *c = c.max(0.0);
        }
        Ok((self.values, Some(said("0 or more", "negative intensities are taken as 0"))))
    }
}

/// H = 0 and H = 360 are one plane. Where a file gives two, both are kept, and the web has a step there. (Of
/// H = -180 and H = 180 the latter is kept.)
pub(crate) fn seam(
    photometric_type: PhotometricType,
    candela: &[f64],
    stored: &[Number<'_>],
) -> Option<Said> {
    let (first, last) = (stored.first()?, stored.last()?);
    if photometric_type != PhotometricType::C || last.value - first.value != 360.0 {
        return None;
    }
    let n_v = candela.len() / stored.len();
    let planes = candela[..n_v].iter().zip(&candela[candela.len() - n_v..]);
    let step = planes.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    (step > NOISE * candela.iter().copied().fold(0.0, f64::max)).then(|| Said {
        offset: last.offset,
        found: format!("planes H = {} and H = {} that differ by up to {step} cd", first.value, last.value),
        required: "one plane, twice".to_owned(),
        hint: if first.value == 0.0 { "both are kept" } else { "the last is kept" }.to_owned(),
    })
}

/// At a pole all planes have one direction, and one intensity. Where a file gives several, the web has all of
/// them there.
pub(crate) fn poles(web: &Web, [vertical, horizontal]: [&[Number<'_>]; 2]) -> Vec<Said> {
    let n_v = vertical.len();
    let is_b = web.photometric_type == PhotometricType::B;
    let (name, across) = if is_b { ("horizontal", horizontal) } else { ("vertical", vertical) };
    let poles = if web.photometric_type == PhotometricType::C { [0.0, 180.0] } else { [-90.0, 90.0] };
    let most = web.max_intensity().intensity_cd;
    let doubt = |(i, angle): (usize, &Number<'_>)| {
        let of_pole = |place: usize| if is_b { place / n_v == i } else { place % n_v == i };
        let values = web.candela.iter().enumerate().filter(|&(place, _)| of_pole(place)).map(|(_, &c)| c);
        // A plane that is 0 up to the pole is a shield's shadow, which no measurement blurs.
        let lit = values.filter(|&c| c > 0.0);
        let (low, high) = lit.fold((f64::MAX, 0.0f64), |(l, h), c| (l.min(c), h.max(c)));
        (high - low > NOISE * most).then(|| Said {
            offset: angle.offset,
            found: format!("{low} to {high} cd at {name} angle {}, which is one direction", angle.value),
            required: "one intensity in all planes".to_owned(),
            hint: "all are kept: light near it depends on the plane".to_owned(),
        })
    };
    across.iter().enumerate().filter(|(_, angle)| poles.contains(&angle.value)).filter_map(doubt).collect()
}

/// What to say where the two integrals of one table (trapezoid, bilinear; lm) are far apart.
pub(crate) fn two_integrals(flux_lm: f64, emitted_lm: f64) -> Option<Diagnostic> {
    let relative = emitted_lm / flux_lm - 1.0;
    (relative.abs() > TWO_INTEGRALS).then(|| {
        let side = if relative < 0.0 { "below" } else { "above" };
        let percent = 100.0 * relative.abs();
        let found = format!(
            "{emitted_lm:.1} lm of the bilinear table, {percent:.1} % {side} the {flux_lm:.1} lm of the trapezoid"
        );
        Diagnostic::new(Kind::Range, found, "a distance within 1 %").hint(
            "the angles are coarse for this beam; the bilinear table is what render emits: \
             state flux_lm of the emitter to have another flux",
        )
    })
}
