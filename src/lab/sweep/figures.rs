//! What is taken of each scene of a sweep.

use serde::{Deserialize, Serialize};

use crate::estimate::extremes::{Extremes, Interval};
use crate::run::outcome::ReplicateTotals;
use crate::run::{Estimate, Outcome, warnings};
use crate::scene::Scene;

/// One number of a scene.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Figure {
    /// Its name, such as `floor.flux_lm`.
    pub name: String,
    /// The number; `None` where it is not known, as the extremes of noisy cells are not.
    pub value: Option<f64>,
    /// Its standard error; `None` for one replicate.
    pub standard_error: Option<f64>,
    /// What it is a count of, if it is one.
    pub counted: Option<Counted>,
}

/// Photons of each replicate, and what one of them is worth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Counted {
    /// The number's unit for one photon.
    pub photon: f64,
    /// Photons, by replicate.
    pub by_replicate: Vec<u64>,
}

/// What a scene gave: a part that is kept.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PointFigures {
    /// Photons that were traced.
    pub photons: u64,
    /// Replicates.
    pub replicates: u32,
    /// Every figure there is.
    pub figures: Vec<Figure>,
    /// Warnings of the run: a word for programs, and the text.
    pub warnings: Vec<(String, String)>,
}

/// Relative standard error up to which the brightest cell is given where others are too noisy for a minimum.
const WIDEST_PEAK: f64 = 0.1;

/// What can be taken of a scene.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    /// Flux on a receiver.
    Flux(usize),
    /// Its mean illuminance.
    Mean(usize),
    /// Illuminance of its darkest cell.
    Min(usize),
    /// Of its brightest.
    Max(usize),
    /// Its uniformity.
    U0(usize),
    /// Mean illuminance of its evaluation grid.
    GridMean(usize),
    /// Uniformity of that.
    GridU0(usize),
    /// Flux that a far field saw.
    Seen(usize),
    /// Flux that left the scene.
    Escaped,
    /// Flux that a surface absorbed.
    Absorbed(usize),
}

impl What {
    /// Whether it is taken where nobody says what is.
    fn is_default(self) -> bool {
        !matches!(self, Self::Min(_) | Self::Absorbed(_))
    }
}

/// All that can be taken of a scene, with their names.
fn all(scene: &Scene) -> Vec<(String, What)> {
    let mut all = Vec::new();
    for (i, receiver) in scene.receivers.iter().enumerate() {
        let named = |(ending, what): (&str, What)| (format!("{}.{ending}", receiver.name), what);
        let of_cells = [
            ("flux_lm", What::Flux(i)),
            ("mean_lx", What::Mean(i)),
            ("min_lx", What::Min(i)),
            ("max_lx", What::Max(i)),
            ("u0", What::U0(i)),
        ];
        let of_grid = [("grid_mean_lx", What::GridMean(i)), ("grid_u0", What::GridU0(i))];
        all.extend(of_cells.map(named));
        all.extend(of_grid.map(named).into_iter().filter(|_| receiver.grid.is_some()));
    }
    for (i, field) in scene.far_fields.iter().enumerate() {
        all.push((format!("{}.flux_lm", field.name), What::Seen(i)));
    }
    all.push(("escaped_lm".to_string(), What::Escaped));
    for (i, surface) in scene.geometry.surfaces().iter().enumerate() {
        all.push((format!("absorbed.{}_lm", surface.name), What::Absorbed(i)));
    }
    all
}

/// Names of all figures of a scene, and whether each is taken by default.
pub fn names(scene: &Scene) -> Vec<(String, bool)> {
    all(scene).into_iter().map(|(name, what)| (name, what.is_default())).collect()
}

impl PointFigures {
    /// Of a run that is over.
    pub fn new(scene: &Scene, outcome: &Outcome) -> Self {
        let figures = all(scene).into_iter().map(|(name, what)| figure(scene, outcome, name, what));
        let warnings = warnings(scene, outcome);
        let told = warnings.iter().filter(|warning| warning.code != "scene");
        Self {
            photons: outcome.photons,
            replicates: outcome.replicates,
            figures: figures.collect(),
            // What is odd about the text is known before.
            warnings: told.map(|w| (w.code.to_string(), w.to_string())).collect(),
        }
    }

    /// The figure of this name.
    pub fn figure(&self, name: &str) -> Option<&Figure> {
        self.figures.iter().find(|figure| figure.name == name)
    }
}

fn figure(scene: &Scene, outcome: &Outcome, name: String, what: What) -> Figure {
    let photon = outcome.photon_lm;
    let counts = |count: &dyn Fn(&ReplicateTotals) -> u64| {
        outcome.by_replicate().iter().map(count).collect::<Vec<_>>()
    };
    let counted = |estimate: Estimate, photon: f64, by_replicate: Vec<u64>| Figure {
        name: name.clone(),
        value: Some(estimate.value),
        standard_error: estimate.standard_error,
        counted: Some(Counted { photon, by_replicate }),
    };
    let of_cells = |known: Option<Interval>| Figure {
        name: name.clone(),
        value: known.map(|known| known.value),
        standard_error: known.map(|known| known.standard_error),
        counted: None,
    };
    let extremes = |i: usize| outcome.extremes(i, scene.receivers[i].areas_m2()).ok();
    let lux = |interval: Interval| interval.times(photon);
    let absorbed = scene.geometry.surfaces().len();
    match what {
        What::Flux(i) => counted(outcome.receiver_flux_lm(i), photon, counts(&|r| r.receivers[i])),
        What::Mean(i) => {
            let area = scene.receivers[i].total_area_m2();
            let flux = outcome.receiver_flux_lm(i);
            let lx =
                Estimate { value: flux.value / area, standard_error: flux.standard_error.map(|e| e / area) };
            counted(lx, photon / area, counts(&|r| r.receivers[i]))
        }
        What::Min(i) => of_cells(extremes(i).map(|e| lux(e.minimum))),
        What::Max(i) => {
            let peak = || {
                let peak = outcome.peak_lx(i, scene.receivers[i].areas_m2());
                peak.filter(|peak| peak.standard_error <= WIDEST_PEAK * peak.value)
            };
            of_cells(extremes(i).map(|e| lux(e.maximum)).or_else(peak))
        }
        What::U0(i) => of_cells(extremes(i).map(|e| e.u0)),
        What::GridMean(i) | What::GridU0(i) => {
            let grid = scene.receivers[i].grid.map(|grid| outcome.grid(i, grid.area_m2));
            let Some((mean, extremes)) = grid else { return of_cells(None) };
            match what {
                What::GridU0(_) => of_cells(extremes.ok().map(|e: Extremes| e.u0)),
                _ => Figure {
                    name: name.clone(),
                    value: Some(mean.value * photon),
                    standard_error: mean.standard_error.map(|error| error * photon),
                    counted: None,
                },
            }
        }
        What::Seen(i) => counted(outcome.far_field_lm(i)[0], photon, outcome.far_field_seen(i).to_vec()),
        What::Escaped => counted(outcome.escaped_lm(), photon, counts(&|r| r.accounts[absorbed])),
        What::Absorbed(i) => counted(outcome.absorbed_lm(i), photon, counts(&|r| r.accounts[i])),
    }
}
