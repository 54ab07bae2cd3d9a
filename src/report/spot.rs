//! The spot of a receiver in numbers: centroid, radii, encircled flux, peak and sections, each with its error; their tables.

use std::fmt::Write as _;
use std::io::Write as _;
use std::path::Path;

use glam::DVec3;
use serde::Serialize;

use crate::error::Result;
use crate::error::warning::{Severity, Warning};
use crate::estimate::extremes::{Interval, student};
use crate::estimate::far_field::jackknife_error;
use crate::estimate::spot::{self, Diameter, Encircled, FEWEST_PHOTONS, Figure, Figures};
use crate::files::atomic::write_atomically;
use crate::run::Outcome;
use crate::scene::evaluation::middle;
use crate::scene::spot::Spot;

use super::numbers::{bare, digits, rounded, with_error, written};

/// A spot with more of its light than this in the strip along the edges is cut.
const CUT: f64 = 0.01;

/// Fine cells that leave more of a diameter open than this are too wide for it.
const COARSE: f64 = 0.1;

/// The cells of a receiver's map, row by row from the top left.
pub(super) struct MapCells<'a> {
    pub counts: [u32; 2],
    pub lx: &'a [f64],
    /// NaN where one replicate leaves them unknown.
    pub errors: &'a [f64],
    pub hits: &'a [u64],
    /// The brightest of them, lx, where it is known.
    pub maximum: Option<Interval>,
}

/// The figures of a spot, or why there are none. Names are those of report.json: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct SpotStatistics {
    /// Photons that they come of.
    pub photons: u64,
    /// Fine cells along u and v, of which encircled flux comes.
    pub fine_cells: [u32; 2],
    /// The figures.
    #[serde(flatten)]
    pub figures: Option<SpotFigures>,
    /// Why they are not given.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
}

/// The figures of a spot. Lengths along u and v are from the corner of the rectangle.
#[derive(Debug, Clone, Serialize)]
pub struct SpotFigures {
    /// Centroid along u and v, m.
    pub centroid_m: [Figure; 2],
    /// The same in the coordinates of the scene, m.
    pub centroid_xyz_m: [Figure; 3],
    /// RMS radius about it, m.
    pub rms_radius_m: Figure,
    /// RMS along u and along v, m.
    pub rms_m: [Figure; 2],
    /// Diameter about it with half of the receiver's flux, m.
    pub d50_m: Diameter,
    /// With 1 - 1/e^2 = 86.5 % of it, m.
    pub d86_m: Diameter,
    /// The brightest cell of the map.
    pub peak: Peak,
    /// The middles of the map's cells that the sections go through, u and v in m.
    pub sections_at_m: [f64; 2],
    /// Share of the flux in the strip along the edges, a sixty-fourth of each side wide.
    pub edge_share: f64,
    /// Share of the flux within a radius, by radius.
    #[serde(skip)]
    pub encircled: Vec<Encircled>,
    /// Along u and along v.
    #[serde(skip)]
    pub sections: [Vec<SectionCell>; 2],
    /// Student's t of 95 %; `None` for one replicate.
    #[serde(skip)]
    pub student: Option<f64>,
}

/// The brightest cell of a map.
#[derive(Debug, Clone, Serialize)]
pub struct Peak {
    /// Mean illuminance in it, lx: half of the replicates choose the cell and the others value it (METHOD 7). `None` for one
    /// replicate, and where it has fewer than ten photons.
    pub illuminance_lx: Option<Interval>,
    /// Its middle, u and v in m.
    pub at_m: [f64; 2],
    /// The same in the coordinates of the scene, m.
    pub at_xyz_m: [f64; 3],
    /// From where to where along u and v cells lie that may be the brightest as well, m; `None` for one replicate.
    pub among_m: Option<[[f64; 2]; 2]>,
}

/// A cell that a section goes through.
#[derive(Debug, Clone)]
pub struct SectionCell {
    /// Its middle along the section, m.
    pub along_m: f64,
    /// In the coordinates of the scene.
    pub place: DVec3,
    /// Mean illuminance in it, lx.
    pub lx: f64,
    /// Its standard error, lx; `None` for one replicate.
    pub standard_error_lx: Option<f64>,
    /// Photons.
    pub hits: u64,
}

impl SpotStatistics {
    /// The numbers of the spot of receiver number `index`.
    pub(super) fn new(spot: &Spot, outcome: &Outcome, index: usize, map: &MapCells<'_>) -> Self {
        let fine_cells = [spot.nu, spot.nv];
        match spot::figures(spot, outcome.spot(index)) {
            Ok(figures) => {
                let photons = figures.photons;
                let figures = Some(SpotFigures::new(spot, figures, map, outcome.replicates));
                Self { photons, fine_cells, figures, reason: None }
            }
            Err(few) => {
                let reason = match few.photons {
                    0 => "no light arrives".to_owned(),
                    n => format!("{n} photons arrive, and fewer than {FEWEST_PHOTONS} say nothing of a spot"),
                };
                Self { photons: few.photons, fine_cells, figures: None, reason: Some(reason) }
            }
        }
    }

    /// What must be known beside the numbers of this receiver.
    pub fn warnings(&self, receiver: &str) -> Vec<Warning> {
        let tell = |severity, code, message: String, share, remedy: &str| Warning {
            severity,
            code,
            message: format!("spot of receiver \"{receiver}\": {message}"),
            surfaces: Vec::new(),
            share,
            remedy: remedy.into(),
        };
        let Some(figures) = &self.figures else {
            let reason = self.reason.clone().unwrap_or_default();
            let message = format!("{reason}, so that there are no figures of it and no files");
            let remedy = "light on the side that the receiver counts, and more photons";
            return vec![tell(Severity::Note, "spot-absent", message, None, remedy)];
        };
        let mut all = Vec::new();
        if figures.edge_share > CUT {
            let share = figures.edge_share;
            let percent = rounded(100.0 * share, 2);
            let message = format!(
                "{percent} % of its light is in a strip of a sixty-fourth along the edges: the spot may be cut, and the \
                 figures are of what is left"
            );
            let remedy = "a rectangle wide enough for all of the light";
            all.push(tell(Severity::Doubtful, "spot-cut", message, Some(share), remedy));
        }
        let open = |d: &Diameter| d.by_cells[1] - d.by_cells[0] > COARSE * d.value;
        let names = [("D50", &figures.d50_m), ("D86.5", &figures.d86_m)];
        if let Some((name, d)) = names.into_iter().find(|(_, d)| open(d)) {
            let (unit, name_of_unit) = unit_of(figures.d86_m.by_cells[1]);
            let [low, high] = d.by_cells.map(|x| digits(unit * x));
            let [nu, nv] = self.fine_cells;
            let message = format!(
                "{nu} x {nv} fine cells leave {name} open from {low} to {high} {name_of_unit}, noise apart"
            );
            let remedy = "a smaller rectangle about the spot; centroid and RMS radius are not concerned";
            all.push(tell(Severity::Note, "spot-coarse", message, None, remedy));
        }
        all
    }

    /// What the summary says.
    pub fn text(&self) -> String {
        written(|out| match (&self.figures, &self.reason) {
            (Some(figures), _) => figures.write(out),
            (None, reason) => writeln!(out, "  spot         none: {}", reason.as_deref().unwrap_or_default()),
        })
    }
}

impl SpotFigures {
    fn new(spot: &Spot, figures: Figures, map: &MapCells<'_>, replicates: u32) -> Self {
        let peak = Peak::new(spot, map, replicates);
        let [counts, size] = [map.counts.map(f64::from), spot.size_m];
        // The middle of the cell that a point lies in.
        let cell = [0, 1].map(|i| {
            let at = spot.at_m.unwrap_or(peak.at_m)[i];
            (at / size[i] * counts[i]).floor().min(counts[i] - 1.0)
        });
        let section = |along: usize| {
            (0..map.counts[along])
                .map(|i| {
                    let mut at = cell;
                    at[along] = f64::from(i);
                    section_cell(spot, map, at, along)
                })
                .collect()
        };
        let xyz = |[u, v]: [f64; 2]| spot.place([u, v]).to_array();
        let centre = xyz(figures.centroid_m.map(|figure| figure.value));
        let without: Vec<[f64; 3]> = figures.centroids_without.iter().map(|at| xyz(*at)).collect();
        let error = |axis: usize| {
            let each: Vec<f64> = without.iter().map(|at| at[axis]).collect();
            (!each.is_empty()).then(|| jackknife_error(&each))
        };
        let [d50_m, d86_m] = figures.diameters_m;
        Self {
            centroid_m: figures.centroid_m,
            centroid_xyz_m: [0, 1, 2].map(|i| Figure { value: centre[i], standard_error: error(i) }),
            rms_radius_m: figures.rms_radius_m,
            rms_m: figures.rms_m,
            d50_m,
            d86_m,
            peak,
            sections_at_m: [0, 1].map(|i| size[i] * (cell[i] + 0.5) / counts[i]),
            edge_share: figures.edge_share,
            encircled: figures.encircled,
            sections: [section(0), section(1)],
            student: (replicates > 1).then(|| student(replicates - 1)),
        }
    }

    fn write(&self, out: &mut String) -> std::fmt::Result {
        let (unit, name) = unit_of(self.d86_m.by_cells[1]);
        let number = |figure: &Figure, unit: f64, name: &str| {
            let text = with_error(unit * figure.value, figure.standard_error.map(|e| unit * e), name);
            text.rsplit_once(" (").map_or(text.clone(), |(text, _)| text.to_owned())
        };
        let length = |figure: &Figure| number(figure, unit, name);
        let [u, v] = self.centroid_m.each_ref().map(|figure| number(figure, 1.0, "m"));
        let [x, y, z] = self.centroid_xyz_m.map(|figure| digits(figure.value));
        writeln!(out, "  spot         centroid u {u}, v {v}; at [{x}, {y}, {z}]")?;
        let [along_u, along_v] = self.rms_m.each_ref().map(length);
        let radius = length(&self.rms_radius_m);
        writeln!(out, "               RMS radius {radius}, along u {along_u}, along v {along_v}")?;
        let [d50, d86] = [&self.d50_m, &self.d86_m].map(|d| diameter_text(d, (unit, name)));
        writeln!(out, "               D50 {d50}, D86.5 {d86}; 95 %, cells included")?;
        let [u, v] = self.peak.at_m.map(digits);
        let peak = self.peak.illuminance_lx.map_or("not known".into(), |lx| {
            format!("{} lx ({} to {})", digits(lx.value), digits(lx.low), digits(lx.high))
        });
        writeln!(out, "               peak {peak}, in the cell about u {u} m, v {v} m")
    }

    /// Writes the curve of encircled flux: a row a radius.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_encircled_csv(&self, path: &Path) -> Result<()> {
        write_atomically(path, |out| {
            writeln!(out, "radius_m,share,standard_error,share_low_by_cells,share_high_by_cells")?;
            for point in &self.encircled {
                let error = bare(point.share.standard_error);
                let ([low, high], share) = (point.by_cells, point.share.value);
                writeln!(out, "{},{share},{error},{low},{high}", point.radius_m)?;
            }
            Ok(())
        })
    }

    /// Writes the cells that the sections go through: first along u, then along v.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub fn write_sections_csv(&self, path: &Path) -> Result<()> {
        write_atomically(path, |out| {
            writeln!(out, "section,along_m,x,y,z,illuminance_lx,standard_error_lx,hits")?;
            for (name, cells) in ["u", "v"].into_iter().zip(&self.sections) {
                for cell in cells {
                    let (DVec3 { x, y, z }, error) = (cell.place, bare(cell.standard_error_lx));
                    let SectionCell { along_m, lx, hits, .. } = cell;
                    writeln!(out, "{name},{along_m},{x},{y},{z},{lx},{error},{hits}")?;
                }
            }
            Ok(())
        })
    }
}

/// A cell of the map by its column and row, the row of v = 0 first.
fn section_cell(spot: &Spot, map: &MapCells<'_>, cell: [f64; 2], along: usize) -> SectionCell {
    let [nu, nv] = map.counts.map(|n| n as usize);
    let at = [0, 1].map(|i| spot.size_m[i] * (cell[i] + 0.5) / f64::from(map.counts[i]));
    let number = (nv - 1 - cell[1] as usize) * nu + cell[0] as usize;
    SectionCell {
        along_m: at[along],
        place: spot.place(at),
        lx: map.lx[number],
        standard_error_lx: Some(map.errors[number]).filter(|error| error.is_finite()),
        hits: map.hits[number],
    }
}

impl Peak {
    fn new(spot: &Spot, map: &MapCells<'_>, replicates: u32) -> Self {
        let most = (0..map.lx.len()).fold(0, |best, i| if map.lx[i] > map.lx[best] { i } else { best });
        let at = |cell: usize| {
            let (u, v) = middle(map.counts, cell);
            [spot.size_m[0] * u, spot.size_m[1] * v]
        };
        let among_m = (replicates > 1).then(|| {
            let t = student(replicates - 1);
            let least = map.lx[most] - t * map.errors[most];
            let may_be =
                (0..map.lx.len()).filter(|&cell| map.lx[cell] + t * map.errors[cell] >= least).map(at);
            let none = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
            let box_of_middles = may_be
                .fold(none, |sides, at| [0, 1].map(|i| [sides[i][0].min(at[i]), sides[i][1].max(at[i])]));
            [0, 1].map(|i| {
                let half = 0.5 * spot.size_m[i] / f64::from(map.counts[i]);
                [box_of_middles[i][0] - half, box_of_middles[i][1] + half]
            })
        });
        let at_m = at(most);
        Self { illuminance_lx: map.maximum, at_m, at_xyz_m: spot.place(at_m).to_array(), among_m }
    }
}

/// A diameter with its interval, in a unit.
pub fn diameter_text(d: &Diameter, (unit, name): (f64, &str)) -> String {
    let text = with_error(unit * d.value, d.standard_error.map(|e| unit * e), name);
    let text = text.rsplit_once(" (").map_or(text.as_str(), |(text, _)| text);
    match (d.low, d.high) {
        (Some(low), Some(high)) => format!("{text} ({} to {})", digits(unit * low), digits(unit * high)),
        _ => {
            format!("{text} ({} to {} by cells)", digits(unit * d.by_cells[0]), digits(unit * d.by_cells[1]))
        }
    }
}

/// The unit in which lengths up to this are told: how many of it are a metre, and its name.
pub fn unit_of(length_m: f64) -> (f64, &'static str) {
    match length_m {
        l if l >= 1.0 => (1.0, "m"),
        l if l >= 1e-3 => (1e3, "mm"),
        _ => (1e6, "um"),
    }
}
