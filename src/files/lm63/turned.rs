//! H of type C counted from -180, as some programs write it.

use crate::files::candela::Said;
use crate::files::candela::number::Number;
use crate::photometry::PhotometricType;

/// Planes of type C that are counted from -180 to 180, in the order of 0..360: for each, the place in the
/// file that it had, and its angle. Of -180 and 180, which are one plane, the latter; 0 closes the circle.
/// `None` where no angle is negative, or they don't go round.
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
