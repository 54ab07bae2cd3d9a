//! Reader of caustix's own text format: simple enough to save from a spreadsheet as text.
//!
//! ```text
//! caustix-scattering 1
//! name      Brushed aluminium     # anything to the end of the line
//! lobe      reflection both       # or transmission; front, back: the side the light comes from
//! frame     specular              # or surface
//! symmetry  plane                 # rotational | plane | none | orthotropic
//! channels  1                     # or 3: linear sRGB
//! theta_i   0 30 60               # degrees, rising, 0 to 90
//! phi_i     0 45 90               # only for tables that are not isotropic
//! polar     0 5 10 20 40 90       # degrees, rising, 0 to 180
//! azimuth   0 60 120 180          # none for rotational tables
//! incidence 0                     # theta_i, and phi_i if there is a list of them
//! tis       0.84                  # optional: the total scatter this incidence is meant to have
//! 3.1 2.9 2.2 0.8 0.1 0.0         # f in 1/sr without cosine: a row for each azimuth, a column for each polar angle
//! ...
//! ```
//!
//! Frames, angles and the value are those of [`crate::scattering::table`]. Words are separated by blanks, tabs, commas or semicolons;
//! `#` begins a comment. A list ends with its line, rows may wrap. The blocks of all incidences follow, theta_i running
//! faster than phi_i; with three channels a block holds all rows of red, then of green, then of blue. `lobe` begins the next lobe,
//! which keeps the lists above it unless it has its own.
//!
//! | symmetry | azimuth holds | phi_i holds |
//! |---|---|---|
//! | rotational | no list: values depend on the polar angle only | none, or a full turn |
//! | plane | 0 to 180, mirrored in the plane of incidence | none, or a full turn |
//! | none | a full turn, 0 to 360 or one step less | none, or a full turn |
//! | orthotropic | a full turn | 0 to 90: the surface has two planes of symmetry, through its reference direction and across it |

use crate::error::{Diagnostic, Kind, Result};
use crate::files::bsdf::unfold::{Turn, closed, mirrored, rises, rotational};
use crate::files::bsdf::words::{Word, Words, decode, number, value};
use crate::scattering::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};

/// The first word of a file.
pub(crate) const MAGIC: &str = "caustix-scattering";

/// Angles a list may have.
const MAX_ANGLES: usize = 100_000;

/// Reads the bytes of a table; `name` stands in messages, and for a table that does not name itself.
///
/// # Errors
/// [`Kind::Syntax`], [`Kind::Missing`], [`Kind::Unknown`], [`Kind::Range`] or [`Kind::Limit`] with file and place.
pub fn parse(bytes: &[u8], name: &str) -> Result<ScatterTable> {
    let text = decode(bytes);
    read(&mut Words::new(&text), name).map_err(|d| d.in_file(name))
}

fn read(words: &mut Words, file: &str) -> Result<ScatterTable> {
    let magic = words.expect(MAGIC)?;
    if !magic.is(MAGIC) {
        return Err(magic.refuse(Kind::Syntax, MAGIC));
    }
    let version = words.expect("the version of the format, 1")?;
    if version.text != "1" {
        return Err(version.refuse(Kind::Unavailable, "version 1"));
    }
    let mut name = None;
    let mut lists = Lists::default();
    let mut lobes: Vec<LobeData> = Vec::new();
    while let Some(word) = words.next() {
        if word.is("name") {
            name = Some(words.rest_of_line().to_owned());
        } else if word.is("lobe") {
            // Two quantities from two sides are all there can be.
            if lobes.len() == 4 {
                return Err(word.refuse(Kind::Limit, "at most four lobes"));
            }
            lobes.push(lobe(words, &word, &mut lists)?);
        } else {
            lists.entry(&word, words)?;
        }
    }
    if lobes.is_empty() {
        let d = Diagnostic::new(Kind::Missing, "the end of the file", "lobe and a table");
        return Err(words.place(d));
    }
    let name = name.filter(|n| !n.is_empty()).unwrap_or_else(|| file.to_owned());
    // What the parts are together can only be judged at the end.
    ScatterTable::new(name, lobes, Vec::new())
        .map_err(|d| if d.line().is_none() { words.place(d) } else { d })
}

#[derive(Debug, Clone, Copy, PartialEq)]
enum Symmetry {
    Rotational,
    Plane,
    None,
    Orthotropic,
}

/// What a lobe is made by: kept from one lobe to the next.
#[derive(Default)]
struct Lists {
    frame: Option<Frame>,
    symmetry: Option<Symmetry>,
    channels: Option<usize>,
    theta_i: Vec<f64>,
    phi_i: Vec<f64>,
    polar: Vec<f64>,
    azimuth: Vec<f64>,
}

impl Lists {
    /// One key of the header and its values.
    fn entry(&mut self, key: &Word, words: &mut Words) -> Result<()> {
        if key.is("frame") {
            self.frame = Some(choice(words, &[("surface", Frame::Surface), ("specular", Frame::Specular)])?);
        } else if key.is("symmetry") {
            let all = [
                ("rotational", Symmetry::Rotational),
                ("plane", Symmetry::Plane),
                ("none", Symmetry::None),
                ("orthotropic", Symmetry::Orthotropic),
            ];
            self.symmetry = Some(choice(words, &all)?);
        } else if key.is("channels") {
            self.channels = Some(choice(words, &[("1", 1), ("3", 3)])?);
        } else if key.is("theta_i") {
            self.theta_i = list(words, key)?;
        } else if key.is("phi_i") {
            self.phi_i = list(words, key)?;
        } else if key.is("polar") {
            self.polar = list(words, key)?;
        } else if key.is("azimuth") {
            self.azimuth = list(words, key)?;
        } else {
            let keys = "name, lobe, frame, symmetry, channels, theta_i, phi_i, polar, azimuth or incidence";
            return Err(key.refuse(Kind::Unknown, keys));
        }
        Ok(())
    }

    /// How the lists unfold.
    fn layout(&self, at: &Word) -> Result<Layout> {
        let missing = |what: &str| {
            at.place(Diagnostic::new(Kind::Missing, format!("no {what} before the values"), what))
        };
        let refuse = |found: &str, required: &str| at.place(Diagnostic::new(Kind::Range, found, required));
        let frame = self.frame.ok_or_else(|| missing("frame"))?;
        let symmetry = self.symmetry.ok_or_else(|| missing("symmetry"))?;
        for (angles, what) in [(&self.theta_i, "theta_i"), (&self.polar, "polar")] {
            if angles.is_empty() {
                return Err(missing(what));
            }
            if !rises(angles) {
                return Err(refuse(what, "strictly rising angles"));
            }
        }
        let azimuth = match symmetry {
            Symmetry::Rotational if self.azimuth.is_empty() => rotational(frame),
            Symmetry::Rotational => {
                return Err(refuse("azimuth with rotational symmetry", "no list of azimuths"));
            }
            _ if self.azimuth.is_empty() => return Err(missing("azimuth")),
            Symmetry::Plane => mirrored(&self.azimuth)
                .ok_or_else(|| refuse("azimuth with plane symmetry", "azimuths rising from 0 to 180"))?,
            Symmetry::None | Symmetry::Orthotropic => closed(&self.azimuth)
                .ok_or_else(|| refuse("azimuth", "azimuths rising over at most a full turn"))?,
        };
        let phi_i = match symmetry {
            Symmetry::Orthotropic => quarters(&self.phi_i, &azimuth)
                .ok_or_else(|| refuse("phi_i or azimuth with orthotropic symmetry", ORTHOTROPIC))?,
            _ if self.phi_i.is_empty() => vec![Azimuth { phi_deg: 0.0, source: 0, mirrored: false }],
            _ => {
                let turn = closed(&self.phi_i)
                    .ok_or_else(|| refuse("phi_i", "azimuths rising over at most a full turn"))?;
                let angles = turn.azimuth_deg.iter().zip(&turn.source);
                angles
                    .map(|(phi_deg, &source)| Azimuth { phi_deg: *phi_deg, source, mirrored: false })
                    .collect()
            }
        };
        let channels = self.channels.unwrap_or(1);
        let counts = [channels, phi_i.len(), self.theta_i.len(), self.polar.len(), azimuth.source.len()];
        Lobe::value_count(counts).map_err(|d| at.place(d))?;
        Ok(Layout {
            frame,
            channels,
            azimuth,
            phi_i,
            counts,
            phis: self.phi_i.len().max(1),
            azimuths: self.azimuth.len().max(1),
        })
    }
}

const ORTHOTROPIC: &str = "phi_i rising from 0 to 90, and azimuths from 0 to 360 that mirror about 180";

/// An azimuth of incidence, the file's one it takes, and whether its values are mirrored in azimuth.
#[derive(Clone, Copy)]
struct Azimuth {
    phi_deg: f64,
    source: usize,
    mirrored: bool,
}

/// The full turn of a quarter: f(phi, a) = f(-phi, -a) by the plane through the reference direction, f(180 - phi, -a) by
/// the one across. `None` where the lists do not allow it.
fn quarters(quarter: &[f64], azimuth: &Turn) -> Option<Vec<Azimuth>> {
    let n = quarter.len();
    let spans = n >= 2 && quarter[0] == 0.0 && quarter[n - 1] == 90.0 && rises(quarter);
    let a = &azimuth.azimuth_deg;
    let mirrors = a[0] == 0.0 && (0..a.len()).all(|i| a[i] == 360.0 - a[a.len() - 1 - i]);
    if !spans || !mirrors {
        return None;
    }
    let up = (0..n).map(|i| (i, 0.0, 1.0));
    let down = (0..n - 1).rev().map(|i| (i, 180.0, -1.0));
    let up_again = (1..n).map(|i| (i, 180.0, 1.0));
    let down_again = (0..n - 1).rev().map(|i| (i, 360.0, -1.0));
    let all = up.chain(down).chain(up_again).chain(down_again);
    let turn = |(source, base, sign): (usize, f64, f64)| Azimuth {
        phi_deg: base + sign * quarter[source],
        source,
        mirrored: sign < 0.0,
    };
    Some(all.map(turn).collect())
}

struct Layout {
    frame: Frame,
    channels: usize,
    azimuth: Turn,
    phi_i: Vec<Azimuth>,
    /// Of the unfolded table.
    counts: [usize; 5],
    /// Of the file.
    phis: usize,
    azimuths: usize,
}

/// A lobe: quantity and side, what it changes of the header, and the values.
fn lobe(words: &mut Words, at: &Word, lists: &mut Lists) -> Result<LobeData> {
    let quantity =
        choice(words, &[("reflection", Quantity::Reflection), ("transmission", Quantity::Transmission)])?;
    let side =
        choice(words, &[("front", LobeSide::Front), ("back", LobeSide::Back), ("both", LobeSide::Both)])?;
    loop {
        match words.peek() {
            Some(key) if key.is("incidence") => break,
            Some(key) if !key.is("lobe") && !key.is("name") => {
                let _key = words.next();
                lists.entry(&key, words)?;
            }
            _ => {
                return Err(at.place(Diagnostic::new(
                    Kind::Missing,
                    "a lobe without values",
                    "incidence and a table",
                )));
            }
        }
    }
    let layout = lists.layout(at)?;
    let (values, declared_tis) = blocks(words, lists, &layout)?;
    Ok(LobeData {
        quantity,
        side,
        frame: layout.frame,
        theta_i_deg: lists.theta_i.clone(),
        phi_i_deg: layout.phi_i.iter().map(|p| p.phi_deg).collect(),
        polar_deg: lists.polar.clone(),
        azimuth_deg: layout.azimuth.azimuth_deg.clone(),
        channels: layout.channels,
        values: unfold(&values, &layout),
        declared_tis: unfold_declared(&declared_tis, &layout),
    })
}

/// The values as they stand, [phi_i][theta_i][channel][azimuth][polar], and the declared totals, none or all.
fn blocks(words: &mut Words, lists: &Lists, layout: &Layout) -> Result<(Vec<f32>, Vec<f64>)> {
    let of_block = layout.channels * layout.azimuths * lists.polar.len();
    let incidences = layout.phis * lists.theta_i.len();
    let required = incidences * of_block;
    if required > words.room() {
        let found = format!("a file too short for the {required} values that its lists announce");
        return Err(words.place(Diagnostic::new(Kind::Missing, found, "all values")));
    }
    let (mut values, mut declared) = (Vec::with_capacity(required), Vec::new());
    for i in 0..incidences {
        let key = words.expect("incidence")?;
        if !key.is("incidence") {
            return Err(key.refuse(Kind::Syntax, format!("incidence {} of {incidences}", i + 1)));
        }
        expect_angle(words, "theta_i", lists.theta_i[i % lists.theta_i.len()])?;
        if !lists.phi_i.is_empty() {
            expect_angle(words, "phi_i", lists.phi_i[i / lists.theta_i.len()])?;
        }
        if words.peek().is_some_and(|w| w.is("tis")) {
            let key = words.expect("tis")?;
            if declared.len() != i {
                return Err(key.refuse(Kind::Syntax, "tis at every incidence of a lobe, or at none"));
            }
            declared.push(number(&words.expect("a total scatter")?, "a total scatter")?);
        } else if !declared.is_empty() {
            return Err(words.place(Diagnostic::new(
                Kind::Missing,
                "an incidence without tis",
                "tis at every incidence of a lobe, or at none",
            )));
        }
        for _ in 0..of_block {
            values.push(value(&words.expect("a value of the table")?)?);
        }
    }
    Ok((values, declared))
}

/// The incidence's own angle again: a block in the wrong place must not go unnoticed.
fn expect_angle(words: &mut Words, what: &str, angle_deg: f64) -> Result<()> {
    let word = words.expect(what)?;
    if number(&word, what)? == angle_deg {
        Ok(())
    } else {
        Err(word.refuse(Kind::Range, format!("{what} {angle_deg}")))
    }
}

fn unfold(values: &[f32], layout: &Layout) -> Vec<f32> {
    let [channels, _, thetas, polars, azimuths] = layout.counts;
    let mut out = Vec::with_capacity(layout.counts.iter().product());
    for channel in 0..channels {
        for phi in &layout.phi_i {
            for theta in 0..thetas {
                let block = ((phi.source * thetas + theta) * channels + channel) * layout.azimuths;
                for polar in 0..polars {
                    for azimuth in 0..azimuths {
                        let azimuth = if phi.mirrored { azimuths - 1 - azimuth } else { azimuth };
                        out.push(values[(block + layout.azimuth.source[azimuth]) * polars + polar]);
                    }
                }
            }
        }
    }
    out
}

fn unfold_declared(declared: &[f64], layout: &Layout) -> Vec<f64> {
    if declared.is_empty() {
        return Vec::new();
    }
    let thetas = layout.counts[2];
    layout.phi_i.iter().flat_map(|p| &declared[p.source * thetas..(p.source + 1) * thetas]).copied().collect()
}

/// The value that the next word names.
fn choice<T: Copy>(words: &mut Words, choices: &[(&str, T)]) -> Result<T> {
    let names = choices.iter().map(|(n, _)| *n).collect::<Vec<_>>().join(" or ");
    let word = words.expect(&names)?;
    let found = choices.iter().find(|(n, _)| word.is(n)).map(|(_, value)| *value);
    found.ok_or_else(|| word.refuse(Kind::Unknown, names))
}

/// The numbers to the end of the line, at least one.
fn list(words: &mut Words, key: &Word) -> Result<Vec<f64>> {
    let mut angles = Vec::new();
    while let Some(word) = words.next_in_line() {
        if angles.len() == MAX_ANGLES {
            return Err(word.refuse(Kind::Limit, format!("at most {MAX_ANGLES} angles")));
        }
        angles.push(number(&word, &format!("an angle of {}, degrees", key.text))?);
    }
    if angles.is_empty() {
        return Err(key.refuse(Kind::Missing, "angles in degrees after it, in the same line"));
    }
    Ok(angles)
}
