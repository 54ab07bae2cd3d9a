//! Reader of the Zemax/Radiant tabular `.bsdf`.
//!
//! ```text
//! # comment
//! Source          Measured
//! Symmetry        PlaneSymmetrical | Asymmetrical | Asymmetrical4D
//! SpectralContent Monochrome | XYZ
//! ScatterType     BRDF | BTDF
//! SampleRotation  n   and n angles
//! AngleOfIncidence n  and n angles
//! ScatterAzimuth  n   and n angles
//! ScatterRadial   n   and n angles
//! Monochrome | TristimulusX | TristimulusY | TristimulusZ
//! DataBegin
//! TIS x           once for each sample rotation and, within it, angle of incidence,
//! values          then a row for each azimuth, a column for each radial angle
//! DataEnd
//! ```
//!
//! Radial angle and azimuth are those of the specular frame of [`crate::scattering::table`]: about the mirrored (straight-through)
//! direction, azimuth 0 towards the normal. PlaneSymmetrical files hold azimuths 0 to 180. The angle "of incidence" is that of
//! the mirrored or straight-through direction; the reader takes it as the incident angle. A sample turned by S degrees, counter-
//! clockwise, is lit from azimuth -S of its own reference direction, so phi_i = 360 - S. XYZ values become linear sRGB with
//! Y kept (they are taken as D65 tristimulus values, 1 for Y of a full reflection).

use crate::error::{Diagnostic, Kind, Result};
use crate::files::bsdf::unfold::{MAX_ANGLES, Turn, closed, mirrored, rises, rotational, unfold};
use crate::files::bsdf::words::{Word, Words, number};
use crate::files::bsdf::xyz::linear_srgb;
use crate::scattering::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};

/// Reads the bytes of a table; `name` is the table's name.
///
/// # Errors
/// [`Kind::Syntax`], [`Kind::Missing`], [`Kind::Unknown`], [`Kind::Range`] or [`Kind::Limit`] with a place.
pub fn parse(bytes: &[u8], name: &str) -> Result<ScatterTable> {
    let text = String::from_utf8_lossy(bytes);
    let words = &mut Words::new(&text);
    let mut header = Header::default();
    // What the header gives is known, and judged, from the first block on.
    let mut known: Option<Layout> = None;
    let mut spectra: [Option<Block>; 3] = [None, None, None];
    while let Some(word) = words.next() {
        if let Some(channel) = spectral(&word) {
            words.keyword("DataBegin", "DataBegin")?;
            let layout = match known.take() {
                Some(layout) => layout,
                None => header.layout(&word)?,
            };
            let is_grey = word.is("Monochrome");
            if layout.counts[0] == 1 && (!is_grey || spectra[0].is_some()) {
                return Err(word.refuse(Kind::Syntax, "one block, headed Monochrome, in a monochrome file"));
            }
            if layout.counts[0] == 3 && (is_grey || spectra[channel].is_some()) {
                let required = "TristimulusX, TristimulusY and TristimulusZ once each in an XYZ file";
                return Err(word.refuse(Kind::Syntax, required));
            }
            spectra[channel] = Some(block(words, &layout)?);
            known = Some(layout);
        } else if known.is_some() {
            return Err(word.refuse(Kind::Syntax, "nothing after DataEnd but another tristimulus block"));
        } else {
            header.entry(word, words)?;
        }
    }
    let mut warnings = Vec::new();
    let lobe = known.and_then(|layout| layout.lobe(spectra, &mut warnings));
    let lobe = lobe.ok_or_else(|| words.missing("the end of the file", "DataBegin and a table"))?;
    // What the angles are together is judged at the end.
    ScatterTable::new(name, vec![lobe], warnings).map_err(|d| words.place(d))
}

fn spectral(word: &Word) -> Option<usize> {
    let names = ["Monochrome", "TristimulusX", "TristimulusY", "TristimulusZ"];
    names.iter().position(|n| word.is(n)).map(|i| i.saturating_sub(1))
}

/// What stands before the data, as far as it was read.
#[derive(Default)]
struct Header {
    /// What [`CHOICES`] name: an index into the values of each.
    choices: [Option<usize>; 4],
    /// The angles of [`LISTS`].
    lists: [Option<Vec<f64>>; 4],
}

/// Keywords with their values; any where none are listed.
const CHOICES: [(&str, &[&str]); 4] = [
    ("Source", &[]),
    ("Symmetry", &["PlaneSymmetrical", "Asymmetrical", "Asymmetrical4D"]),
    ("SpectralContent", &["Monochrome", "XYZ"]),
    ("ScatterType", &["BRDF", "BTDF"]),
];

const LISTS: [&str; 4] = ["SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"];

impl Header {
    fn entry(&mut self, keyword: Word, words: &mut Words) -> Result<()> {
        if let Some(which) = LISTS.iter().position(|n| keyword.is(n)) {
            let list = angles(words, LISTS[which])?;
            if self.lists[which].replace(list).is_some() {
                return Err(keyword.refuse(Kind::Syntax, format!("{} once", LISTS[which])));
            }
            return Ok(());
        }
        let Some(which) = CHOICES.iter().position(|(n, _)| keyword.is(n)) else {
            return Err(keyword
                .refuse(Kind::Unknown, "a keyword of a tabular BSDF: Symmetry, AngleOfIncidence, ...")
                .hint("LightTools files of the same ending have other keywords and are not read"));
        };
        let values = CHOICES[which].1;
        let word = words.expect(&format!("a value of {}", keyword.text))?;
        self.choices[which] = values.iter().position(|value| word.is(value));
        if self.choices[which].is_none() && !values.is_empty() {
            return Err(word.refuse(Kind::Unknown, format!("one of {}", values.join(", "))));
        }
        Ok(())
    }

    /// The layout that the header gives, which is used up.
    fn layout(&mut self, at: &Word) -> Result<Layout> {
        let missing = |what: &str| {
            let (found, required) = (format!("no {what} before the data"), format!("{what} in the header"));
            at.place(Diagnostic::new(Kind::Missing, found, required))
        };
        let refuse = |what: &str, required: &str| at.place(Diagnostic::new(Kind::Range, what, required));
        let [_, symmetry, spectral_content, scatter_type] = self.choices;
        let plane = symmetry.ok_or_else(|| missing("Symmetry"))? == 0;
        let quantity = scatter_type.ok_or_else(|| missing("ScatterType"))?;
        let [rotations, incidences, azimuths, radials] = std::mem::take(&mut self.lists);
        let rotations = rotations.unwrap_or_else(|| vec![0.0]);
        let incidences = incidences.ok_or_else(|| missing(LISTS[1]))?;
        let azimuths = azimuths.ok_or_else(|| missing(LISTS[2]))?;
        let radials = radials.ok_or_else(|| missing(LISTS[3]))?;
        const FULL_TURN: &str = "azimuths rising over at most a full turn";
        let (turn, what, required) = match plane {
            true => (mirrored(&azimuths), "a PlaneSymmetrical", "azimuths rising from 0 to 180"),
            false => (closed(&azimuths), "an asymmetrical", FULL_TURN),
        };
        let turn = match azimuths.len() {
            1 => rotational(Frame::Specular),
            _ => turn.ok_or_else(|| refuse(&format!("ScatterAzimuth of {what} table"), required))?,
        };
        let samples = sample_turn(&rotations).ok_or_else(|| {
            refuse("SampleRotation", "one angle, or angles rising over at most a full turn")
        })?;
        if !rises(&incidences) || !rises(&radials) {
            return Err(refuse("AngleOfIncidence or ScatterRadial", "strictly rising angles"));
        }
        let channels = if spectral_content == Some(1) { 3 } else { 1 };
        let in_file = [1, rotations.len(), incidences.len(), radials.len(), azimuths.len()];
        let counts = [channels, samples.source.len(), incidences.len(), radials.len(), turn.source.len()];
        for counts in [in_file, counts] {
            Lobe::value_count(counts).map_err(|d| at.place(d))?;
        }
        let quantity = [Quantity::Reflection, Quantity::Transmission][quantity];
        Ok(Layout { quantity, in_file, counts, incidences, radials, turn, samples })
    }
}

/// A count and so many angles.
fn angles(words: &mut Words, what: &str) -> Result<Vec<f64>> {
    let word = words.expect(&format!("the number of angles of {what}"))?;
    let count = number(&word, &format!("how many angles {what} has"))?;
    if !(count >= 1.0 && count <= MAX_ANGLES as f64 && count.fract() == 0.0) {
        return Err(word.refuse(Kind::Limit, format!("a whole number of angles, 1 to {MAX_ANGLES}")));
    }
    let mut list = Vec::new();
    for _ in 0..count as usize {
        let word = words.expect(&format!("an angle of {what}"))?;
        list.push(number(&word, &format!("an angle of {what}, degrees"))?);
    }
    Ok(list)
}

/// Azimuths of incidence of sample rotations, with the rotation that each takes: phi_i = 360 - S, over a full turn.
fn sample_turn(rotations: &[f64]) -> Option<Turn> {
    if rotations.len() == 1 {
        return Some(Turn { azimuth_deg: vec![0.0], source: vec![0] });
    }
    let last = *rotations.last()?;
    if !rises(rotations) || last > 360.0 || rotations[0] < 0.0 {
        return None;
    }
    let phi: Vec<f64> = rotations.iter().rev().map(|s| 360.0 - s).collect();
    let mut turn = closed(&phi)?;
    for source in &mut turn.source {
        *source = rotations.len() - 1 - *source;
    }
    Some(turn)
}

/// Counts and angles of the data, and how they unfold.
struct Layout {
    quantity: Quantity,
    /// Of a block of the file, and of the unfolded table.
    in_file: [usize; 5],
    counts: [usize; 5],
    incidences: Vec<f64>,
    radials: Vec<f64>,
    turn: Turn,
    samples: Turn,
}

/// The numbers between DataBegin and DataEnd, as they stand: values [rotation][incidence][azimuth][radial], and totals.
type Block = (Vec<f32>, Vec<f64>);

fn block(words: &mut Words, layout: &Layout) -> Result<Block> {
    let [_, rotations, incidences, radials, azimuths] = layout.in_file;
    let blocks = rotations * incidences;
    let mut values = words.table_of(blocks * azimuths * radials, "its header announces")?;
    let mut totals = Vec::with_capacity(blocks);
    for _ in 0..blocks {
        let word = words.expect("TIS and the values of one incidence")?;
        if !word.is("TIS") {
            return Err(word.refuse(Kind::Syntax, "TIS before the values of each incidence"));
        }
        totals.push(words.number("a total integrated scatter")?);
        words.values(azimuths * radials, &mut values)?;
    }
    words.keyword("DataEnd", "DataEnd after the last value")?;
    Ok((values, totals))
}

impl Layout {
    /// The lobe of the blocks; `None` where one is missing.
    fn lobe(self, spectra: [Option<Block>; 3], warnings: &mut Vec<Diagnostic>) -> Option<LobeData> {
        let (totals, channels) = match (self.counts[0], spectra) {
            (1, [Some((grey, totals)), None, None]) => (totals, vec![grey]),
            (3, [Some((x, _)), Some((y, totals)), Some((z, _))]) => {
                let (rgb, outside) = to_rgb([&x, &y, &z]);
                if outside > 0 {
                    let found = format!("{outside} tristimulus values outside the gamut of sRGB");
                    let outside = Diagnostic::new(Kind::Range, found, "colours within it");
                    warnings.push(outside.hint("their negative channels are set to zero; Y is kept"));
                }
                (totals, rgb)
            }
            _ => return None,
        };
        let [_, _, incidences, radials, azimuths] = self.in_file;
        let rotations = self.samples.source.iter();
        let phi_i = rotations.clone().map(|rotation| (*rotation, false));
        let values = unfold(self.counts, phi_i, &self.turn, |channel, rotation, incidence| {
            let of_block = azimuths * radials;
            &channels[channel][(rotation * incidences + incidence) * of_block..][..of_block]
        });
        let declared = rotations.flat_map(|r| &totals[r * incidences..(r + 1) * incidences]);
        Some(LobeData {
            quantity: self.quantity,
            side: LobeSide::Both,
            frame: Frame::Specular,
            declared_tis: declared.copied().collect(),
            theta_i_deg: self.incidences,
            phi_i_deg: self.samples.azimuth_deg,
            polar_deg: self.radials,
            azimuth_deg: self.turn.azimuth_deg,
            channels: self.counts[0],
            values,
        })
    }
}

/// Linear sRGB of three blocks, and how many values lay outside its gamut.
fn to_rgb(xyz: [&[f32]; 3]) -> (Vec<Vec<f32>>, usize) {
    let mut rgb: Vec<Vec<f32>> = (0..3).map(|_| Vec::with_capacity(xyz[0].len())).collect();
    let mut outside = 0;
    for i in 0..xyz[0].len() {
        let (colour, clipped) = linear_srgb(xyz.map(|channel| f64::from(channel[i])));
        outside += usize::from(clipped);
        for (channel, c) in rgb.iter_mut().zip(colour) {
            channel.push(c as f32);
        }
    }
    (rgb, outside)
}
