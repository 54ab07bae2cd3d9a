//! Reader of WINDOW/Radiance BSDF files in XML with a matrix on a Klems basis (Full, Half, Quarter, or one the file defines).
//!
//! A basis divides the hemisphere into rings of polar angle and each ring into equal patches, the first centred on
//! azimuth 0. The matrix holds one value, 1/sr, for each pair of incident and scattered patch; `IncidentDataStructure` says
//! whether columns or rows are incident. Azimuths follow Radiance (`bsdf_m.c`): an incident and a scattered patch of one
//! number are mirror images (reflection) or straight through (transmission), so the azimuth of the surface frame is the
//! difference of the two patches' azimuths. `Front` and `Back` are the file's own words; its azimuths are counter-clockwise seen
//! from the back (the room), so they run the other way about the front's normal.
//!
//! Only data for visible light (`Wavelength` Visible, detector Y) are read; directions that a file lacks scatter nothing
//! and are named in a warning. Tensor trees are refused.
//!
//! A matrix becomes a table of steps: the value of a patch holds over the patch, and borders are ramps of 0.2 degrees.
//! Scattered azimuths are taken in as many sectors as the fullest ring has; a ring with fewer or unaligned patches gives each
//! sector its mean over it, so that the flux of every ring stays. Incidence is linear between the rings' middles and between as many
//! azimuths as the fullest ring has.

use roxmltree::{Document, Node, ParsingOptions};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::bsdf::words::{self, Word, Words, value};
use crate::files::excerpt::quoted;
use crate::scattering::{Frame, Lobe, LobeData, LobeSide, Quantity, ScatterTable};

/// XML nodes a file may have; a file with four directions has below 500.
const MAX_NODES: u32 = 1 << 20;

/// Patches a basis may have; Klems Full has 145.
const MAX_PATCHES: usize = 4096;

/// Half the width of the ramp between two patches.
const RAMP_DEG: f64 = 0.1;

/// Steps of polar angle within a ring: f is constant there, and g = f cos(theta) nearly linear.
const STEP_DEG: f64 = 5.0;

/// A ring of a basis: from, to (degrees), patches.
type Ring = (f64, f64, usize);

#[derive(Debug, Clone, PartialEq)]
struct Basis {
    name: String,
    rings: Vec<Ring>,
}

/// The directions that a file may have, by its own words for them.
const DIRECTIONS: [(&str, Quantity, LobeSide); 4] = [
    ("Transmission Front", Quantity::Transmission, LobeSide::Front),
    ("Transmission Back", Quantity::Transmission, LobeSide::Back),
    ("Reflection Front", Quantity::Reflection, LobeSide::Front),
    ("Reflection Back", Quantity::Reflection, LobeSide::Back),
];

/// Reads the bytes of a file; `name` is the table's name unless the file has one.
///
/// # Errors
/// [`Kind::Syntax`], [`Kind::Missing`], [`Kind::Unknown`], [`Kind::Unavailable`], [`Kind::Range`] or [`Kind::Limit`] with a place.
pub fn parse(bytes: &[u8], name: &str) -> Result<ScatterTable> {
    let text = String::from_utf8_lossy(bytes);
    let options = ParsingOptions { nodes_limit: MAX_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(&text, options).map_err(|e| {
        let at = e.pos();
        let d = Diagnostic::new(Kind::Syntax, quoted(&e.to_string()), "well-formed XML");
        d.at(at.row as usize, at.col as usize)
    })?;
    let root = document.root_element();
    if root.tag_name().name() != "WindowElement" {
        return Err(refuse(&root, Kind::Unknown, root.tag_name().name(), "WindowElement"));
    }
    let layer =
        root.descendants().find(|n| n.tag_name().name() == "Layer" && child(n, "WavelengthData").is_ok());
    let layer = layer.ok_or_else(|| missing(&root, "a Layer with WavelengthData"))?;
    let definition = child(&layer, "DataDefinition")?;
    let structure = child(&definition, "IncidentDataStructure")?;
    let columns = match text_of(&structure) {
        t if t.eq_ignore_ascii_case("Columns") => true,
        t if t.eq_ignore_ascii_case("Rows") => false,
        t if t.to_ascii_lowercase().starts_with("tensortree") => {
            let d = refuse(&structure, Kind::Unavailable, t, "Columns or Rows");
            return Err(d.hint("tensor trees are not read; export the material on a Klems basis"));
        }
        t => return Err(refuse(&structure, Kind::Unknown, t, "Columns or Rows")),
    };
    let bases = bases(&definition)?;
    let mut warnings = Vec::new();
    let mut lobes: Vec<LobeData> = Vec::new();
    for data in children(&layer, "WavelengthData") {
        if !is_luminous(&data, &mut warnings) {
            continue;
        }
        for block in children(&data, "WavelengthDataBlock") {
            if lobes.len() == DIRECTIONS.len() {
                return Err(refuse(&block, Kind::Limit, "a fifth direction", "four of them, each once"));
            }
            lobes.push(direction(&text, &block, &bases, columns)?);
        }
    }
    if lobes.is_empty() {
        return Err(missing(&layer, "WavelengthData of visible light"));
    }
    let mut absent = DIRECTIONS.to_vec();
    absent.retain(|(_, quantity, side)| !lobes.iter().any(|l| (l.quantity, l.side) == (*quantity, *side)));
    if !absent.is_empty() {
        let names = absent.iter().map(|(name, ..)| *name).collect::<Vec<_>>().join(", ");
        let d = Diagnostic::new(Kind::Missing, format!("no {names}"), "all four directions");
        warnings.push(place(&layer, d.hint("light that would take one of them is absorbed")));
    }
    let material = layer.descendants().find(|n| n.tag_name().name() == "Name").map(|n| text_of(&n));
    let title = material.filter(|n| !n.is_empty()).unwrap_or(name);
    let title: String = title.chars().take(200).collect();
    ScatterTable::new(title, lobes, warnings).map_err(|d| place(&layer, d))
}

fn place(node: &Node, diagnostic: Diagnostic) -> Diagnostic {
    let at = node.document().text_pos_at(node.range().start);
    diagnostic.at(at.row as usize, at.col as usize)
}

fn refuse(node: &Node, kind: Kind, found: &str, required: &str) -> Diagnostic {
    place(node, Diagnostic::new(kind, quoted(found), required))
}

fn missing(node: &Node, what: &str) -> Diagnostic {
    let found = format!("a {} without it", node.tag_name().name());
    place(node, Diagnostic::new(Kind::Missing, found, what))
}

fn children<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> impl Iterator<Item = Node<'a, 'i>> {
    node.children().filter(move |n| n.tag_name().name() == name)
}

fn child<'a, 'i>(node: &Node<'a, 'i>, name: &str) -> Result<Node<'a, 'i>> {
    children(node, name).next().ok_or_else(|| missing(node, name))
}

fn text_of<'a>(node: &Node<'a, '_>) -> &'a str {
    node.text().unwrap_or("").trim()
}

/// Whether these are values for visible light as the eye weights it.
fn is_luminous(data: &Node, warnings: &mut Vec<Diagnostic>) -> bool {
    let of = |name| child(data, name).map_or("", |n| text_of(&n));
    let visible = of("Wavelength").eq_ignore_ascii_case("Visible");
    let colour = [" X.dsp", " Z.dsp", "CIE-X", "CIE-Z"].iter().any(|c| of("DetectorSpectrum").contains(c));
    if visible && colour {
        let d = Diagnostic::new(Kind::Unavailable, "tristimulus X or Z values", "Y values");
        warnings.push(place(data, d.hint("colour of XML files is not read; Y is")));
    }
    visible && !colour
}

/// The bases that the file defines, and the three of LBNL.
fn bases(definition: &Node) -> Result<Vec<Basis>> {
    let mut list = Vec::new();
    for node in children(definition, "AngleBasis") {
        let name = child(&node, "AngleBasisName")?;
        let (mut rings, mut patches) = (Vec::<Ring>::new(), 0);
        for block in children(&node, "AngleBasisBlock") {
            let bounds = child(&block, "ThetaBounds")?;
            let (from, to) = (number(&bounds, "LowerTheta")?, number(&bounds, "UpperTheta")?);
            let count = number(&block, "nPhis")?;
            let whole = count >= 1.0 && count <= MAX_PATCHES as f64 && count.fract() == 0.0;
            patches += if whole { count as usize } else { 0 };
            if !whole || patches > MAX_PATCHES {
                let found = format!("{count} patches, {patches} so far");
                return Err(refuse(&block, Kind::Limit, &found, "at least one a ring, 4096 in all"));
            }
            if from != rings.last().map_or(0.0, |r| r.1) || to - from < 4.0 * RAMP_DEG || to > 90.0 {
                let found = format!("a ring from {from} to {to} degrees");
                return Err(refuse(&block, Kind::Range, &found, "rings that follow each other from 0 to 90"));
            }
            rings.push((from, to, count as usize));
        }
        if rings.last().map(|r| r.1) != Some(90.0) {
            return Err(missing(&node, "rings of an angle basis up to 90 degrees"));
        }
        list.push(Basis { name: text_of(&name).to_owned(), rings });
    }
    list.extend(LBNL.map(|(name, edges, counts)| Basis {
        name: name.to_owned(),
        rings: edges.windows(2).zip(counts).map(|(e, n)| (e[0], e[1], *n)).collect(),
    }));
    Ok(list)
}

/// J. H. Klems' bases as LBNL uses them: name, edges of the rings, patches of each.
const LBNL: [(&str, &[f64], &[usize]); 3] = [
    (
        "LBNL/Klems Full",
        &[0.0, 5.0, 15.0, 25.0, 35.0, 45.0, 55.0, 65.0, 75.0, 90.0],
        &[1, 8, 16, 20, 24, 24, 24, 16, 12],
    ),
    ("LBNL/Klems Half", &[0.0, 6.5, 19.5, 32.5, 46.5, 61.5, 76.5, 90.0], &[1, 8, 12, 16, 20, 12, 4]),
    ("LBNL/Klems Quarter", &[0.0, 9.0, 27.0, 46.0, 66.0, 90.0], &[1, 8, 12, 12, 8]),
];

fn number(parent: &Node, name: &str) -> Result<f64> {
    let node = child(parent, name)?;
    let text = text_of(&node);
    words::number(&Word { text, within: text, byte: 0 }, name).map_err(|d| place(&node, d))
}

/// One WavelengthDataBlock as a lobe.
fn direction(text: &str, block: &Node, bases: &[Basis], columns: bool) -> Result<LobeData> {
    let named = child(block, "WavelengthDataDirection")?;
    let words = text_of(&named).split_whitespace().collect::<Vec<_>>().join(" ");
    let known = DIRECTIONS.iter().find(|(name, ..)| words.eq_ignore_ascii_case(name));
    let Some(&(_, quantity, side)) = known else {
        let required = "Transmission or Reflection, and Front or Back";
        return Err(refuse(&named, Kind::Unknown, text_of(&named), required));
    };
    let basis = |name: &str| -> Result<&Basis> {
        let node = child(block, name)?;
        let found = bases.iter().find(|b| b.name.eq_ignore_ascii_case(text_of(&node)));
        found.ok_or_else(|| {
            refuse(&node, Kind::Unknown, text_of(&node), "an angle basis that the file defines")
        })
    };
    let (across, down) = (basis("ColumnAngleBasis")?, basis("RowAngleBasis")?);
    let (incident, scattered) = if columns { (across, down) } else { (down, across) };
    let data = child(block, "ScatteringData")?;
    let values = matrix(text, &data, incident.patches() * scattered.patches())?;
    let matrix = Matrix { incident, scattered, columns, values };
    matrix.lobe(quantity, side).map_err(|d| place(&data, d))
}

/// The numbers of a matrix; places are those of the file.
fn matrix(text: &str, data: &Node, count: usize) -> Result<Vec<f32>> {
    let content = data.children().find(|n| n.is_text()).ok_or_else(|| missing(data, "numbers"))?;
    let mut words = Words::between(text, content.range());
    if !words.have_room_for(count) {
        let found = format!("a matrix too short for the {count} values of its bases");
        return Err(place(data, Diagnostic::new(Kind::Missing, found, "all values")));
    }
    let mut values = Vec::with_capacity(count);
    while let Some(word) = words.next() {
        if values.len() == count {
            return Err(word.refuse(Kind::Range, format!("nothing after the {count} values of the bases")));
        }
        values.push(value(&word)?);
    }
    if values.len() < count {
        return Err(words.missing(format!("{} values", values.len()), format!("{count} values")));
    }
    Ok(values)
}

impl Basis {
    fn patches(&self) -> usize {
        self.rings.iter().map(|r| r.2).sum()
    }

    fn fullest(&self) -> usize {
        self.rings.iter().map(|r| r.2).max().unwrap_or(1)
    }

    /// Rings with the number of their first patch.
    fn numbered(&self) -> impl Iterator<Item = (Ring, usize)> + '_ {
        self.rings.iter().scan(0, |first, ring| {
            let at = *first;
            *first += ring.2;
            Some((*ring, at))
        })
    }
}

struct Matrix<'a> {
    incident: &'a Basis,
    scattered: &'a Basis,
    columns: bool,
    values: Vec<f32>,
}

impl Matrix<'_> {
    fn value(&self, incident: usize, scattered: usize) -> f64 {
        let at = if self.columns {
            scattered * self.incident.patches() + incident
        } else {
            incident * self.scattered.patches() + scattered
        };
        f64::from(self.values[at])
    }

    /// Mean of a ring's patches over azimuths `middle` +- `half`, degrees.
    fn mean(&self, incident: usize, ((_, _, count), first): (Ring, usize), middle: f64, half: f64) -> f64 {
        let width = 360.0 / count as f64;
        // Patch j covers (j - 1/2, j + 1/2) in units of its width.
        let (from, to) = ((middle - half) / width + 0.5, (middle + half) / width + 0.5);
        let (mut sum, mut at) = (0.0, from);
        while at < to {
            let end = (at.floor() + 1.0).min(to);
            let patch = (at.floor() as i64).rem_euclid(count as i64) as usize;
            sum += (end - at) * self.value(incident, first + patch);
            at = end;
        }
        sum / (to - from)
    }

    fn lobe(&self, quantity: Quantity, side: LobeSide) -> Result<LobeData> {
        let sectors = self.scattered.fullest();
        let half = 180.0 / sectors as f64;
        let azimuth_deg = stairs(sectors, half);
        let (polar_deg, ring_of) = polar_nodes(&self.scattered.rings);
        let theta_i_deg: Vec<f64> =
            self.incident.rings.iter().map(|r| if r.0 == 0.0 { 0.0 } else { 0.5 * (r.0 + r.1) }).collect();
        let incidences = match self.incident.fullest() {
            1 => vec![0.0],
            n => (0..=n).map(|i| 360.0 * i as f64 / n as f64).collect(),
        };
        let counts = [1, incidences.len(), theta_i_deg.len(), polar_deg.len(), azimuth_deg.len()];
        let mut values = Vec::with_capacity(Lobe::value_count(counts)?);
        let rings: Vec<(Ring, usize)> = self.scattered.numbered().collect();
        // About the front's normal the file's azimuths run clockwise.
        let sign = if side == LobeSide::Front { -1.0 } else { 1.0 };
        for phi_i in &incidences {
            // The file's azimuth of an incident patch is that of the direction in which the light goes on.
            let azimuth = sign * phi_i - 180.0;
            for ((_, _, count), first) in self.incident.numbered() {
                let patch = ((azimuth / 360.0 * count as f64).round() as i64).rem_euclid(count as i64);
                let incident = first + patch as usize;
                let means: Vec<Vec<f32>> = rings
                    .iter()
                    .map(|ring| {
                        let sector = |k: usize| azimuth + sign * 2.0 * half * k as f64;
                        (0..sectors).map(|k| self.mean(incident, *ring, sector(k), half) as f32).collect()
                    })
                    .collect();
                for ring in &ring_of {
                    // Two nodes a sector, and the first again at the end of the turn.
                    values.extend((0..=2 * sectors).map(|node| means[*ring][node / 2 % sectors]));
                }
            }
        }
        Ok(LobeData {
            quantity,
            side,
            frame: Frame::Surface,
            theta_i_deg,
            phi_i_deg: incidences,
            polar_deg,
            azimuth_deg,
            channels: 1,
            values,
            declared_tis: vec![],
        })
    }
}

/// Azimuths of `sectors` steps, the first centred on 0, with ramps between them: one turn with both ends.
fn stairs(sectors: usize, half: f64) -> Vec<f64> {
    let middle = |k: usize| 2.0 * half * k as f64;
    let ramp = RAMP_DEG.min(0.25 * half);
    let mut list: Vec<f64> =
        (0..sectors).flat_map(|k| [middle(k) - half + ramp, middle(k) + half - ramp]).collect();
    list.push(360.0 - half + ramp);
    list
}

/// Polar angles of the rings' steps, and the ring of each.
fn polar_nodes(rings: &[Ring]) -> (Vec<f64>, Vec<usize>) {
    let (mut nodes, mut ring_of) = (Vec::new(), Vec::new());
    for (ring, (from, to, _)) in rings.iter().enumerate() {
        let first = if ring == 0 { *from } else { from + RAMP_DEG };
        let last = if ring + 1 == rings.len() { *to } else { to - RAMP_DEG };
        let steps = ((last - first) / STEP_DEG).ceil().max(1.0) as usize;
        for i in 0..=steps {
            nodes.push(if i == steps { last } else { first + (last - first) * i as f64 / steps as f64 });
            ring_of.push(ring);
        }
    }
    (nodes, ring_of)
}
