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
use crate::files::bsdf::unfold::{MAX_ANGLES, Turn, closed, mirrored, rises, rotational, unfold};
use crate::files::bsdf::words::{Word, Words, number};
use crate::scattering::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};

/// The first word of a file.
pub(crate) use crate::files::kinds::SCATTERING as MAGIC;

/// Reads the bytes of a table; `file` stands for the name of a table that does not name itself.
///
/// # Errors
/// [`Kind::Syntax`], [`Kind::Missing`], [`Kind::Unknown`], [`Kind::Range`] or [`Kind::Limit`] with a place.
pub fn parse(bytes: &[u8], file: &str) -> Result<ScatterTable> {
    let text = String::from_utf8_lossy(bytes);
    let words = &mut Words::new(&text);
    words.keyword(MAGIC, MAGIC)?;
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
        return Err(words.missing("the end of the file", "lobe and a table"));
    }
    let name = name.filter(|n| !n.is_empty()).unwrap_or_else(|| file.to_owned());
    // What the parts are together can only be judged at the end.
    ScatterTable::new(name, lobes, Vec::new())
        .map_err(|d| if d.line().is_none() { words.place(d) } else { d })
}

const SYMMETRIES: [&str; 4] = ["rotational", "plane", "none", "orthotropic"];

const ANGLES: [&str; 4] = ["theta_i", "phi_i", "polar", "azimuth"];

/// What a lobe is made by: kept from one lobe to the next.
#[derive(Default)]
struct Lists {
    frame: Option<Frame>,
    /// One of [`SYMMETRIES`].
    symmetry: Option<&'static str>,
    channels: Option<usize>,
    /// Those of [`ANGLES`], in degrees.
    angles: [Vec<f64>; 4],
}

impl Lists {
    /// One key of the header and its values.
    fn entry(&mut self, key: &Word, words: &mut Words) -> Result<()> {
        if let Some(which) = ANGLES.iter().position(|name| key.is(name)) {
            self.angles[which] = list(words, key)?;
        } else if key.is("frame") {
            self.frame = Some(choice(words, &[("surface", Frame::Surface), ("specular", Frame::Specular)])?);
        } else if key.is("symmetry") {
            self.symmetry = Some(choice(words, &SYMMETRIES.map(|word| (word, word)))?);
        } else if key.is("channels") {
            self.channels = Some(choice(words, &[("1", 1), ("3", 3)])?);
        } else {
            let keys = "name, lobe, frame, symmetry, channels, theta_i, phi_i, polar, azimuth or incidence";
            return Err(key.refuse(Kind::Unknown, keys));
        }
        Ok(())
    }

    /// How the lists unfold.
    fn layout(&self, at: &Word) -> Result<Layout> {
        const FULL_TURN: &str = "azimuths rising over at most a full turn";
        let missing = |what: &str| {
            at.place(Diagnostic::new(Kind::Missing, format!("no {what} before the values"), what))
        };
        let refuse = |found: &str, required: &str| at.place(Diagnostic::new(Kind::Range, found, required));
        let frame = self.frame.ok_or_else(|| missing("frame"))?;
        let symmetry = self.symmetry.ok_or_else(|| missing("symmetry"))?;
        let [theta_i, phi_i, polar, azimuth] = &self.angles;
        for (angles, what) in [(theta_i, "theta_i"), (polar, "polar")] {
            if angles.is_empty() {
                return Err(missing(what));
            }
            if !rises(angles) {
                return Err(refuse(what, "strictly rising angles"));
            }
        }
        let turn = match symmetry {
            "rotational" if azimuth.is_empty() => rotational(frame),
            "rotational" => {
                return Err(refuse("azimuth with rotational symmetry", "no list of azimuths"));
            }
            _ if azimuth.is_empty() => return Err(missing("azimuth")),
            "plane" => mirrored(azimuth)
                .ok_or_else(|| refuse("azimuth with plane symmetry", "azimuths rising from 0 to 180"))?,
            _ => closed(azimuth).ok_or_else(|| refuse("azimuth", FULL_TURN))?,
        };
        let incidences = match symmetry {
            "orthotropic" => quarters(phi_i, &turn)
                .ok_or_else(|| refuse("phi_i or azimuth with orthotropic symmetry", ORTHOTROPIC))?,
            _ if phi_i.is_empty() => vec![Incidence { phi_deg: 0.0, source: 0, mirrored: false }],
            _ => {
                let turn = closed(phi_i).ok_or_else(|| refuse("phi_i", FULL_TURN))?;
                let angles = turn.azimuth_deg.into_iter().zip(turn.source);
                angles.map(|(phi_deg, source)| Incidence { phi_deg, source, mirrored: false }).collect()
            }
        };
        let channels = self.channels.unwrap_or(1);
        let counts = [channels, incidences.len(), theta_i.len(), polar.len(), turn.source.len()];
        Lobe::value_count(counts).map_err(|d| at.place(d))?;
        Ok(Layout { frame, turn, incidences, counts })
    }
}

const ORTHOTROPIC: &str = "phi_i rising from 0 to 90, and azimuths from 0 to 360 that mirror about 180";

/// An azimuth of incidence, the file's one it takes, and whether its values are mirrored in azimuth.
struct Incidence {
    phi_deg: f64,
    source: usize,
    mirrored: bool,
}

/// The full turn of a quarter: f(phi, a) = f(-phi, -a) by the plane through the reference direction, f(180 - phi, -a) by
/// the one across. `None` where the lists do not allow it.
fn quarters(quarter: &[f64], azimuth: &Turn) -> Option<Vec<Incidence>> {
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
    let turn = |(source, base, sign): (usize, f64, f64)| Incidence {
        phi_deg: base + sign * quarter[source],
        source,
        mirrored: sign < 0.0,
    };
    Some(all.map(turn).collect())
}

struct Layout {
    frame: Frame,
    turn: Turn,
    incidences: Vec<Incidence>,
    /// Of the unfolded table.
    counts: [usize; 5],
}

/// A lobe: quantity and side, what it changes of the header, and the values.
fn lobe(words: &mut Words, at: &Word, lists: &mut Lists) -> Result<LobeData> {
    let quantity =
        choice(words, &[("reflection", Quantity::Reflection), ("transmission", Quantity::Transmission)])?;
    let side =
        choice(words, &[("front", LobeSide::Front), ("back", LobeSide::Back), ("both", LobeSide::Both)])?;
    while !words.peek().is_some_and(|key| key.is("incidence")) {
        match words.next() {
            Some(key) if !key.is("lobe") && !key.is("name") => lists.entry(&key, words)?,
            _ => {
                let required = "incidence and a table";
                return Err(at.place(Diagnostic::new(Kind::Missing, "a lobe without values", required)));
            }
        }
    }
    let Layout { frame, turn, incidences, counts } = lists.layout(at)?;
    let [channels, _, thetas, _, _] = counts;
    let [theta_i_deg, phi_i_deg, polar_deg, azimuth_deg] = &lists.angles;
    let of_channel = azimuth_deg.len().max(1) * polar_deg.len();
    let (values, tis) = blocks(words, &[theta_i_deg, phi_i_deg], channels * of_channel)?;
    let phi_i = incidences.iter().map(|phi| (phi.source, phi.mirrored));
    let values = unfold(counts, phi_i, &turn, |channel, phi, theta| {
        &values[((phi * thetas + theta) * channels + channel) * of_channel..][..of_channel]
    });
    let declared = |phi: &Incidence| tis.iter().skip(phi.source * thetas).take(thetas);
    Ok(LobeData {
        quantity,
        side,
        frame,
        declared_tis: incidences.iter().flat_map(declared).copied().collect(),
        theta_i_deg: theta_i_deg.clone(),
        phi_i_deg: incidences.iter().map(|phi| phi.phi_deg).collect(),
        polar_deg: polar_deg.clone(),
        azimuth_deg: turn.azimuth_deg,
        channels,
        values,
    })
}

/// The values as they stand, [phi_i][theta_i] and so many each, and the declared totals, none or all.
fn blocks(
    words: &mut Words,
    [theta_i, phi_i]: &[&[f64]; 2],
    of_block: usize,
) -> Result<(Vec<f32>, Vec<f64>)> {
    const ALL_OR_NONE: &str = "tis at every incidence of a lobe, or at none";
    let incidences = phi_i.len().max(1) * theta_i.len();
    let mut values = words.table_of(incidences * of_block, "its lists announce")?;
    let mut declared = Vec::new();
    for i in 0..incidences {
        words.keyword("incidence", &format!("incidence {} of {incidences}", i + 1))?;
        expect_angle(words, "theta_i", theta_i[i % theta_i.len()])?;
        if !phi_i.is_empty() {
            expect_angle(words, "phi_i", phi_i[i / theta_i.len()])?;
        }
        if words.peek().is_some_and(|w| w.is("tis")) {
            let key = words.expect("tis")?;
            if declared.len() != i {
                return Err(key.refuse(Kind::Syntax, ALL_OR_NONE));
            }
            declared.push(words.number("a total scatter")?);
        } else if !declared.is_empty() {
            return Err(words.missing("an incidence without tis", ALL_OR_NONE));
        }
        words.values(of_block, &mut values)?;
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
