//! Angles as programs write them: noise about multiples of 90.

use super::Said;
use super::number::Number;

/// Angles nearer than this to a multiple of 90 degrees are taken for it: the ranges of the standard begin and
/// end there, and what a range stands for hangs on its ends. (A little more than 0.001, since 180.001 - 180
/// is.)
const NOISE_DEG: f64 = 1.000_001e-3;

/// Puts angles within 1e-3 degrees of a multiple of 90 on it, unless the list has that multiple too; what to
/// say of the first.
pub(crate) fn snap(name: &str, list: &mut [Number<'_>]) -> Option<Said> {
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
