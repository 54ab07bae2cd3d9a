//! Angles and values, and the web that they make.

use super::fields::Fields;
use super::head::{Declared, Head};
use super::stream::{Next, Stream};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::candela::Said;
use crate::files::candela::angles::snap;
use crate::files::candela::checks::{Candela, poles, seam};
use crate::files::candela::number::{Number, values};
use crate::files::excerpt::quoted;
use crate::photometry::axes::{Axis, AxisNote, check_axes};
use crate::photometry::{PhotometricType, Web};

/// Angles off an even list by more than this share of its distance contradict it.
const UNEVEN: f64 = 0.01;

/// The web, and the Isym by which it was read.
pub(super) fn read<'a>(fields: &mut Fields<'a>, head: &Head<'a>, multiplier: f64) -> Result<(Web, u32)> {
    let (mc, ng) = (head.c.count, head.gamma.count);
    let mut stream = Stream::new(fields.lines);
    let mut isym = head.isym.value as u32;
    let mut stored = stored_planes(fields, head, isym)?;
    let before = (mc + ng) as u64;
    let (few, all) = ((stored * ng) as u64, (mc * ng) as u64);
    // Of symmetric files some have all planes: their count tells.
    if stored < mc && stream.skipped(before).count(all + 1) == all {
        let found = format!("{mc} x {ng} values where Isym = {isym} has {stored} x {ng}");
        let hint = "all planes are there: read as Isym = 0";
        fields.warn(head.isym.offset, Kind::Range, &found, "the values of the stored planes", hint);
        (isym, stored) = (0, mc);
    }
    require(fields, stream, head, before + if isym == 0 { all } else { few })?;
    let mut c = numbers(fields, &mut stream, mc, "C angle")?;
    let mut gamma = numbers(fields, &mut stream, ng, "gamma angle")?;
    for said in [snap("C", &mut c), snap("gamma", &mut gamma)].into_iter().flatten() {
        tell(fields, said);
    }
    rising(fields, &c)?;
    even(fields, "C", &c, &head.c);
    even(fields, "gamma", &gamma, &head.gamma);
    let planes = planes(fields, isym, &c)?;
    let horizontal: Vec<Number<'_>> = planes.iter().map(|&(_, angle)| angle).collect();
    check(fields, &gamma, &horizontal)?;
    let candela = candela(fields, &mut stream, stored * ng, multiplier)?;
    surplus(fields, stream);
    let candela = planes.iter().flat_map(|&(i, _)| &candela[i * ng..(i + 1) * ng]).copied().collect();
    let web = Web {
        photometric_type: PhotometricType::C,
        vertical_deg: values(&gamma),
        horizontal_deg: values(&horizontal),
        candela,
    };
    let twice = seam(PhotometricType::C, &web.candela, &horizontal);
    for said in twice.into_iter().chain(poles(&web, [&gamma, &horizontal])) {
        tell(fields, said);
    }
    Ok((web, isym))
}

/// The words of LM-63 for angles, in those of EULUMDAT.
fn renamed(words: &str) -> String {
    let words = words.replace("vertical", "gamma").replace("horizontal", "C").replace(" of type C", "");
    words.replace("H = ", "C = ")
}

fn tell(fields: &mut Fields<'_>, said: Said) {
    fields.warn(said.offset, Kind::Range, &renamed(&said.found), &said.required, &said.hint);
}

/// How many planes have values.
fn stored_planes(fields: &Fields<'_>, head: &Head<'_>, isym: u32) -> Result<usize> {
    let mc = head.c.count;
    let (stored, parts) = match isym {
        0 => return Ok(mc),
        1 => return Ok(1),
        2 => (mc / 2 + 1, 2),
        3 => (mc / 2 + 1, 4),
        _ => (mc / 4 + 1, 4),
    };
    if mc.is_multiple_of(parts) {
        return Ok(stored);
    }
    let required = format!("a multiple of {parts}, for Isym = {isym}");
    fields.refuse(&head.c.written, Kind::Range, "number of C planes Mc", &required)
}

/// Whether the numbers are there that the counts promise, before memory is asked for.
fn require(fields: &Fields<'_>, stream: Stream<'_>, head: &Head<'_>, needed: u64) -> Result<()> {
    let (mc, ng) = (head.c.count as u64, head.gamma.count as u64);
    let name = |i: u64| match i {
        _ if i < mc => format!("C angle {} of {mc}", i + 1),
        _ if i < mc + ng => format!("gamma angle {} of {ng}", i - mc + 1),
        _ => format!("value {} of {}", i - mc - ng + 1, needed - mc - ng),
    };
    let have = stream.count(needed);
    if have == needed {
        return Ok(());
    }
    let required = format!("a number: {}", name(have));
    match stream.skipped(have).next() {
        Next::Word(word, offset) => Err(fields.no_number(word, offset, &required)),
        _ => {
            let found = format!("the end of the file after {have} of {needed} angles and values");
            Err(fields.at_end(Diagnostic::new(Kind::Missing, found, required)))
        }
    }
}

fn numbers<'a>(
    fields: &mut Fields<'a>,
    stream: &mut Stream<'a>,
    n: usize,
    what: &str,
) -> Result<Vec<Number<'a>>> {
    (0..n).map(|i| stream.number(fields, || format!("{what} {} of {n}", i + 1))).collect()
}

/// All C angles must rise within the circle, also where their planes have no values: a line too many or too
/// few shows here.
fn rising(fields: &Fields<'_>, c: &[Number<'_>]) -> Result<()> {
    if let Some(bad) = c.iter().find(|n| !(0.0..=360.0).contains(&n.value)) {
        return fields.refuse(bad, Kind::Range, "C angle", "0 to 360 degrees");
    }
    match c.windows(2).find(|pair| pair[1].value <= pair[0].value) {
        Some(pair) => {
            let found = format!("C angle {} after {}", pair[1].text, pair[0].text);
            let d = Diagnostic::new(Kind::Range, found, "angles in strictly increasing order");
            Err(fields.place(pair[1].offset, d.hint("is a line before them missing, or one too many?")))
        }
        None => Ok(()),
    }
}

/// Warns where the distance that is declared is not that of the list.
fn even(fields: &mut Fields<'_>, name: &str, list: &[Number<'_>], declared: &Declared<'_>) {
    let step = declared.step_deg;
    let is_off = |pair: &[Number<'_>]| (pair[1].value - pair[0].value - step).abs() > UNEVEN * step;
    if let Some(pair) = list.windows(2).find(|pair| step > 0.0 && is_off(pair)) {
        let found =
            format!("a distance of {step} degrees, and {name} angles {} and {}", pair[0].text, pair[1].text);
        let required = "the distance of the list, or 0 where it is uneven";
        fields.warn(declared.step_offset, Kind::Range, &found, required, "the list is used");
    }
}

/// The planes of the web: for each the place among the stored ones, and its angle.
fn planes<'a>(fields: &Fields<'_>, isym: u32, c: &[Number<'a>]) -> Result<Vec<(usize, Number<'a>)>> {
    let mc = c.len();
    let must = |i: usize, angle: f64| match c.get(i) {
        Some(number) if number.value == angle => Ok(()),
        Some(number) => {
            let required = format!("{angle}: Isym = {isym} begins and ends there");
            fields.refuse(number, Kind::Range, &format!("C angle {} of {mc},", i + 1), &required)
        }
        None => Ok(()),
    };
    let from_0 = |n: usize| c.iter().take(n).copied().enumerate().collect();
    Ok(match isym {
        0 => {
            whole_circle(fields, c)?;
            from_0(mc)
        }
        1 => vec![(0, Number { value: 0.0, ..c[0] })],
        3 => {
            // Stored from C270 over C0 to C90; the web has the other half, which is its mirror image.
            must(3 * mc / 4, 270.0)?;
            must(mc / 4, 90.0)?;
            let stored = c[3 * mc / 4..].iter().chain(&c[..=mc / 4]).enumerate();
            let turn = |angle: f64| if angle > 180.0 { 540.0 - angle } else { 180.0 - angle };
            let mut planes: Vec<_> =
                stored.map(|(i, n)| (i, Number { value: turn(n.value), ..*n })).collect();
            planes.reverse();
            planes
        }
        _ => {
            let (parts, last) = if isym == 2 { (2, 180.0) } else { (4, 90.0) };
            must(0, 0.0)?;
            must(mc / parts, last)?;
            from_0(mc / parts + 1)
        }
    })
}

/// Without symmetry the planes go round: a list that ends at 90 or 180 would be taken for a mirrored one.
fn whole_circle(fields: &Fields<'_>, c: &[Number<'_>]) -> Result<()> {
    let (first, last) = (c[0], c[c.len() - 1]);
    let are_opposite = c.len() == 2 && last.value - first.value == 180.0;
    if c.len() == 1 || are_opposite || last.value - first.value > 180.0 {
        return Ok(());
    }
    let found = format!("C angles from {} to {} where Isym = 0", first.text, last.text);
    let d = Diagnostic::new(Kind::Range, found, "C angles round the whole circle");
    Err(fields.place(last.offset, d.hint("of a symmetric luminaire Isym is 2, 3 or 4")))
}

fn check(fields: &mut Fields<'_>, gamma: &[Number<'_>], horizontal: &[Number<'_>]) -> Result<()> {
    let offset = |note: &AxisNote| {
        let list = if note.axis == Axis::Vertical { gamma } else { horizontal };
        list.get(note.index).map_or(0, |n| n.offset)
    };
    let notes = check_axes(PhotometricType::C, &values(gamma), &values(horizontal));
    let notes = notes.map_err(|note| {
        let d = Diagnostic::new(Kind::Range, renamed(&note.found), renamed(note.required));
        fields.place(offset(&note), d)
    })?;
    for note in notes {
        fields.warn(offset(&note), Kind::Range, &renamed(&note.found), &renamed(note.required), note.hint);
    }
    Ok(())
}

fn candela<'a>(
    fields: &mut Fields<'a>,
    stream: &mut Stream<'a>,
    n: usize,
    multiplier: f64,
) -> Result<Vec<f64>> {
    let mut candela = Candela::new(n, multiplier);
    let refusal = |fields: &Fields<'_>, kind, said: Said| {
        fields.place(said.offset, Diagnostic::new(kind, said.found, said.required))
    };
    for i in 0..n {
        let number = stream.number(fields, || format!("value {} of {n}", i + 1))?;
        candela.push(number).map_err(|said| refusal(fields, Kind::Limit, said))?;
    }
    let (candela, said) = candela.finish().map_err(|said| refusal(fields, Kind::Range, said))?;
    said.into_iter().for_each(|said| tell(fields, said));
    Ok(candela)
}

/// Warns of what stands behind the last value.
fn surplus(fields: &mut Fields<'_>, stream: Stream<'_>) {
    let mut next = stream;
    let (found, offset) = match next.next() {
        Next::End => return,
        Next::Word(word, offset) => (format!("text {}", quoted(word)), offset),
        Next::Number(number) => match stream.count(u64::MAX) {
            1 => ("1 surplus number".to_owned(), number.offset),
            n => (format!("{n} surplus numbers"), number.offset),
        },
    };
    fields.warn(offset, Kind::Syntax, &found, "nothing after the last value", "it is ignored");
}
