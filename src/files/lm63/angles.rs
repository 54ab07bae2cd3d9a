//! Angles as programs write them: noise about multiples of 90, H of type C counted from -180.

use super::tokens::Number;
use crate::photometry::PhotometricType;

/// Angles nearer than this to a multiple of 90 degrees are taken for it: the ranges of the standard begin and end there,
/// and what a range stands for hangs on its ends. (A little more than 0.001, since 180.001 - 180 is.)
const NOISE_DEG: f64 = 1.000_001e-3;

/// Something to say about a list of angles, at a byte.
pub(super) struct Said {
    pub offset: usize,
    pub found: String,
    pub required: String,
    pub hint: String,
}

/// Puts angles within 1e-3 degrees of a multiple of 90 on it, unless the list has that multiple too; what to say of the first.
pub(super) fn snap(name: &str, list: &mut [Number]) -> Option<Said> {
    let mut said = None;
    for i in 0..list.len() {
        let number = list[i];
        // Plus zero: of noise below 0 there is no -0 left.
        let whole = (number.value / 90.0).round() * 90.0 + 0.0;
        let off = (number.value - whole).abs();
        if off == 0.0 || off > NOISE_DEG || list.iter().any(|n| n.value == whole) {
            continue;
        }
        list[i].value = whole;
        said = said.or(Some(Said {
            offset: number.offset,
            found: format!("{name} angle {}", number.text),
            required: whole.to_string(),
            hint: format!("taken for {whole} (angles within 0.001 degrees of a multiple of 90 are)"),
        }));
    }
    said
}

/// Planes of type C that are counted from -180 to 180, in the order of 0..360: for each, the place in the file that it
/// had, and its angle. Of -180 and 180, which are one plane, the latter; 0 closes the circle. `None` where no angle is
/// negative, or they don't go round.
pub(super) fn turned(
    photometric_type: PhotometricType,
    list: &[Number],
) -> Option<(Vec<(usize, f64)>, Said)> {
    let increases = list.windows(2).all(|pair| pair[0].value < pair[1].value);
    let (first, last) = (list.first()?, list.last()?);
    let goes_round = first.value >= -180.0 && last.value <= 180.0 && last.value - first.value > 180.0;
    if photometric_type != PhotometricType::C || first.value >= 0.0 || !increases || !goes_round {
        return None;
    }
    let said = Said {
        offset: first.offset,
        found: format!("horizontal angles over {}..{}", first.text, last.text),
        required: "horizontal angles of type C over 0..360".to_owned(),
        hint: "read as 0..360: negative ones plus 360".to_owned(),
    };
    let split = list.iter().position(|n| n.value >= 0.0)?;
    let both_ends = first.value == -180.0 && last.value == 180.0;
    let closes = list[split].value == 0.0;
    let at = |i: usize| (i, list[i].value);
    let negative = (usize::from(both_ends)..split).map(|i| (i, list[i].value + 360.0));
    let closing = closes.then_some((split, 360.0));
    Some(((split..list.len()).map(at).chain(negative).chain(closing).collect(), said))
}
