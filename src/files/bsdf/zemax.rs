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
use crate::files::bsdf::unfold::{Turn, closed, mirrored, rises, rotational};
use crate::files::bsdf::words::{Word, Words, decode, number, value};
use crate::files::bsdf::xyz::linear_srgb;
use crate::scattering::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};

/// Angles a list may have.
const MAX_ANGLES: usize = 100_000;

/// Reads the bytes of a table; `name` stands in messages and is the table's name.
///
/// # Errors
/// [`Kind::Syntax`], [`Kind::Missing`], [`Kind::Unknown`], [`Kind::Range`] or [`Kind::Limit`] with file and place.
pub fn parse(bytes: &[u8], name: &str) -> Result<ScatterTable> {
    let text = decode(bytes);
    let mut words = Words::new(&text);
    read(&mut words, name).map_err(|d| d.in_file(name))
}

fn read(words: &mut Words, name: &str) -> Result<ScatterTable> {
    let mut header = Header::default();
    let mut spectra: [Option<Block>; 3] = [None, None, None];
    let mut warnings = Vec::new();
    while let Some(word) = words.next() {
        if let Some(channel) = spectral(&word) {
            let begin = words.expect("DataBegin")?;
            if !begin.is("DataBegin") {
                return Err(begin.refuse(Kind::Syntax, "DataBegin"));
            }
            let layout = header.layout(&word)?;
            if layout.channels == 1 && (!word.is("Monochrome") || spectra[0].is_some()) {
                return Err(word.refuse(Kind::Syntax, "one block, headed Monochrome, in a monochrome file"));
            }
            if layout.channels == 3 && (word.is("Monochrome") || spectra[channel].is_some()) {
                let required = "TristimulusX, TristimulusY and TristimulusZ once each in an XYZ file";
                return Err(word.refuse(Kind::Syntax, required));
            }
            spectra[channel] = Some(block(words, &layout)?);
        } else {
            header.entry(word, words)?;
        }
    }
    let end = words.place(Diagnostic::new(Kind::Missing, "the end of the file", "DataBegin and a table"));
    let Some(layout) = header.read.take() else { return Err(end) };
    let data = layout.lobe(spectra, &mut warnings).ok_or(end)?;
    // What the angles are together is judged at the end.
    ScatterTable::new(name, vec![data], warnings).map_err(|d| words.place(d))
}

fn spectral(word: &Word) -> Option<usize> {
    let names = ["Monochrome", "TristimulusX", "TristimulusY", "TristimulusZ"];
    names.iter().position(|n| word.is(n)).map(|i| i.saturating_sub(1))
}

/// What stands before the data, as far as it was read.
#[derive(Default)]
struct Header {
    plane_symmetric: Option<bool>,
    xyz: Option<bool>,
    quantity: Option<Quantity>,
    /// Sample rotations, angles of incidence, azimuths, radial angles.
    lists: [Option<Vec<f64>>; 4],
    read: Option<Layout>,
}

const LISTS: [&str; 4] = ["SampleRotation", "AngleOfIncidence", "ScatterAzimuth", "ScatterRadial"];

impl Header {
    fn entry(&mut self, keyword: Word, words: &mut Words) -> Result<()> {
        if self.read.is_some() {
            return Err(keyword.refuse(Kind::Syntax, "nothing after DataEnd but another tristimulus block"));
        }
        if let Some(which) = LISTS.iter().position(|n| keyword.is(n)) {
            let list = angles(words, LISTS[which])?;
            if self.lists[which].replace(list).is_some() {
                return Err(keyword.refuse(Kind::Syntax, format!("{} once", LISTS[which])));
            }
            return Ok(());
        }
        let choices: &[&str] = if keyword.is("Source") {
            &[]
        } else if keyword.is("Symmetry") {
            &["PlaneSymmetrical", "Asymmetrical", "Asymmetrical4D"]
        } else if keyword.is("SpectralContent") {
            &["Monochrome", "XYZ"]
        } else if keyword.is("ScatterType") {
            &["BRDF", "BTDF"]
        } else {
            return Err(keyword
                .refuse(Kind::Unknown, "a keyword of a tabular BSDF: Symmetry, AngleOfIncidence, ...")
                .hint("LightTools files of the same ending have other keywords and are not read"));
        };
        let word = words.expect(&format!("a value of {}", keyword.text))?;
        let choice = choices.iter().position(|c| word.is(c));
        match choice {
            _ if choices.is_empty() => {}
            None => return Err(word.refuse(Kind::Unknown, format!("one of {}", choices.join(", ")))),
            Some(i) if keyword.is("Symmetry") => self.plane_symmetric = Some(i == 0),
            Some(i) if keyword.is("SpectralContent") => self.xyz = Some(i == 1),
            Some(i) => self.quantity = Some([Quantity::Reflection, Quantity::Transmission][i]),
        }
        Ok(())
    }

    /// The layout that the header gives; checked once, at the first block.
    fn layout(&mut self, at: &Word) -> Result<Layout> {
        if let Some(layout) = &self.read {
            return Ok(layout.clone());
        }
        let missing = |what: &str| {
            at.place(Diagnostic::new(
                Kind::Missing,
                format!("no {what} before the data"),
                format!("{what} in the header"),
            ))
        };
        let plane = self.plane_symmetric.ok_or_else(|| missing("Symmetry"))?;
        let quantity = self.quantity.ok_or_else(|| missing("ScatterType"))?;
        let [rotations, incidences, azimuths, radials] = &mut self.lists;
        let rotations = rotations.take().unwrap_or_else(|| vec![0.0]);
        let incidences = incidences.take().ok_or_else(|| missing(LISTS[1]))?;
        let azimuths = azimuths.take().ok_or_else(|| missing(LISTS[2]))?;
        let radials = radials.take().ok_or_else(|| missing(LISTS[3]))?;
        let refuse = |what: &str, required: &str| at.place(Diagnostic::new(Kind::Range, what, required));
        let turn = match (azimuths.len(), plane) {
            (1, _) => Some(rotational(Frame::Specular)),
            (_, true) => mirrored(&azimuths),
            (_, false) => closed(&azimuths),
        };
        let turn = turn.ok_or_else(|| match plane {
            true => refuse("ScatterAzimuth of a PlaneSymmetrical table", "azimuths rising from 0 to 180"),
            false => {
                refuse("ScatterAzimuth of an asymmetrical table", "azimuths rising over at most a full turn")
            }
        })?;
        let samples = sample_turn(&rotations).ok_or_else(|| {
            refuse("SampleRotation", "one angle, or angles rising over at most a full turn")
        })?;
        if !rises(&incidences) || !rises(&radials) {
            return Err(refuse("AngleOfIncidence or ScatterRadial", "strictly rising angles"));
        }
        let channels = if self.xyz == Some(true) { 3 } else { 1 };
        let in_file = [1, rotations.len(), incidences.len(), radials.len(), azimuths.len()];
        Lobe::value_count(in_file).map_err(|d| at.place(d))?;
        let unfolded = [channels, samples.source.len(), incidences.len(), radials.len(), turn.source.len()];
        Lobe::value_count(unfolded).map_err(|d| at.place(d))?;
        let layout = Layout {
            quantity,
            channels,
            rotations: rotations.len(),
            azimuths: azimuths.len(),
            incidences,
            radials,
            turn,
            samples,
        };
        self.read = Some(layout.clone());
        Ok(layout)
    }
}

/// A count and so many angles.
fn angles(words: &mut Words, what: &str) -> Result<Vec<f64>> {
    let word = words.expect(&format!("the number of angles of {what}"))?;
    let count = number(&word, &format!("how many angles {what} has"))?;
    if !(count >= 1.0 && count <= MAX_ANGLES as f64 && count.fract() == 0.0) {
        return Err(word.refuse(Kind::Limit, format!("a whole number of angles, 1 to {MAX_ANGLES}")));
    }
    let mut list = Vec::with_capacity((count as usize).min(words.room()));
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
#[derive(Clone)]
struct Layout {
    quantity: Quantity,
    channels: usize,
    rotations: usize,
    azimuths: usize,
    incidences: Vec<f64>,
    radials: Vec<f64>,
    turn: Turn,
    samples: Turn,
}

/// The numbers between DataBegin and DataEnd, as they stand: [rotation][incidence][azimuth][radial].
struct Block {
    values: Vec<f32>,
    tis: Vec<f64>,
}

fn block(words: &mut Words, layout: &Layout) -> Result<Block> {
    let blocks = layout.rotations * layout.incidences.len();
    let of_block = layout.azimuths * layout.radials.len();
    let required = blocks * of_block;
    if required > words.room() {
        let found = format!("a file too short for the {required} values that its header announces");
        return Err(words.place(Diagnostic::new(Kind::Missing, found, "all values")));
    }
    let mut data = Block { values: Vec::with_capacity(required), tis: Vec::with_capacity(blocks) };
    for _ in 0..blocks {
        let word = words.expect("TIS and the values of one incidence")?;
        if !word.is("TIS") {
            return Err(word.refuse(Kind::Syntax, "TIS before the values of each incidence"));
        }
        let word = words.expect("a total integrated scatter")?;
        data.tis.push(number(&word, "a total integrated scatter")?);
        for _ in 0..of_block {
            data.values.push(value(&words.expect("a value of the table")?)?);
        }
    }
    let end = words.expect("DataEnd")?;
    if end.is("DataEnd") { Ok(data) } else { Err(end.refuse(Kind::Syntax, "DataEnd after the last value")) }
}

impl Layout {
    /// The lobe of the blocks; `None` where one is missing.
    fn lobe(self, spectra: [Option<Block>; 3], warnings: &mut Vec<Diagnostic>) -> Option<LobeData> {
        let [first, second, third] = spectra;
        let (tis, channels) = match (self.channels, first, second, third) {
            (1, Some(grey), None, None) => (grey.tis, vec![grey.values]),
            (3, Some(x), Some(y), Some(z)) => {
                let (rgb, outside) = to_rgb([&x.values, &y.values, &z.values]);
                if outside > 0 {
                    let found = format!("{outside} tristimulus values outside the gamut of sRGB");
                    warnings.push(
                        Diagnostic::new(Kind::Range, found, "colours within it")
                            .hint("their negative channels are set to zero; Y is kept"),
                    );
                }
                (y.tis, rgb)
            }
            _ => return None,
        };
        let (incidences, radials) = (self.incidences.len(), self.radials.len());
        let count = [self.channels, self.samples.source.len(), incidences, radials, self.turn.source.len()];
        let mut values = Vec::with_capacity(count.iter().product());
        for channel in &channels {
            for &rotation in &self.samples.source {
                for incidence in 0..incidences {
                    let start = (rotation * incidences + incidence) * self.azimuths;
                    for radial in 0..radials {
                        values
                            .extend(self.turn.source.iter().map(|a| channel[(start + a) * radials + radial]));
                    }
                }
            }
        }
        let declared_tis =
            self.samples.source.iter().flat_map(|r| &tis[r * incidences..(r + 1) * incidences]);
        Some(LobeData {
            quantity: self.quantity,
            side: LobeSide::Both,
            frame: Frame::Specular,
            declared_tis: declared_tis.copied().collect(),
            theta_i_deg: self.incidences,
            phi_i_deg: self.samples.azimuth_deg,
            polar_deg: self.radials,
            azimuth_deg: self.turn.azimuth_deg,
            channels: self.channels,
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
