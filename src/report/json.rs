//! report.json: the run in numbers, for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::run::{Outcome, StoppedBy};
use crate::sample::coordinates::Purpose;
use crate::scene::Scene;

use super::camera::CameraReport;
use super::statistics::ReceiverStatistics;

/// Everything report.json says. Names are a contract: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct Report {
    /// Version of the program.
    pub caustix: &'static str,
    /// The scene.
    pub scene: SceneReport,
    /// Algorithm variant.
    pub variant: &'static str,
    /// Point sequence.
    pub sequence: &'static str,
    /// Solver of the cell equation of a variant that inverts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub solver: Option<&'static str>,
    /// How a variant that rejects does it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rejection: Option<&'static str>,
    /// Seed.
    pub seed: u64,
    /// Photons that the results stand for.
    pub photons: u64,
    /// Photons that were asked for.
    pub photons_planned: u64,
    /// Replicates that the results stand for.
    pub replicates: u32,
    /// Why there is no standard error, where there is none.
    pub standard_error_absent: Option<&'static str>,
    /// Times.
    pub time: TimeReport,
    /// Where the flux went.
    pub ledger_lm: LedgerReport,
    /// The same in photons: integers that balance exactly.
    pub ledger_photons: LedgerPhotons,
    /// Coordinates a photon.
    pub dimension: DimensionReport,
    /// Things that geometry and smooth normals made necessary.
    pub exceptions: ExceptionsReport,
    /// Receivers in the order of the scene.
    pub receivers: Vec<ReceiverReport>,
    /// The camera, where the scene has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraReport>,
    /// "photons" or "interrupt".
    pub stopped_by: &'static str,
    /// Warnings about the scene and its files.
    pub warnings: Vec<String>,
}

/// The scene of a report.
#[derive(Debug, Clone, Serialize)]
pub struct SceneReport {
    /// As given.
    pub path: String,
    /// SHA-256 of the scene file.
    pub sha256: String,
    /// SHA-256 of the files it names, by the path written there.
    pub files: BTreeMap<String, String>,
}

impl SceneReport {
    /// Of a scene.
    pub fn new(scene: &Scene) -> Self {
        Self {
            path: scene.identity.name.clone(),
            sha256: scene.identity.sha256.clone(),
            files: scene.identity.files.iter().cloned().collect(),
        }
    }
}

/// Times of a report.
#[derive(Debug, Clone, Serialize)]
pub struct TimeReport {
    /// Tracing, s.
    pub trace_s: f64,
    /// Everything from reading the scene on, s.
    pub total_s: f64,
    /// Photons over tracing time, 1/s.
    pub photons_per_s: f64,
}

/// Flux by account, lm.
#[derive(Debug, Clone, Serialize)]
pub struct LedgerReport {
    /// Emitted.
    pub emitted: f64,
    /// Absorbed by each surface.
    pub absorbed: BTreeMap<String, f64>,
    /// Left the scene.
    pub escaped: f64,
    /// Ended by the guard against endless walks.
    pub killed: f64,
    /// Standard errors of the accounts: surfaces by name, `escaped`, `killed`; absent for one replicate.
    pub standard_error: Option<LedgerErrors>,
}

/// Standard errors by account, lm.
#[derive(Debug, Clone, Serialize)]
pub struct LedgerErrors {
    /// Absorbed by each surface.
    pub absorbed: BTreeMap<String, f64>,
    /// Left the scene.
    pub escaped: f64,
    /// Ended by the guard.
    pub killed: f64,
}

/// Photons by account.
#[derive(Debug, Clone, Serialize)]
pub struct LedgerPhotons {
    /// Emitted, by emitter.
    pub emitted: BTreeMap<String, u64>,
    /// Absorbed, by surface.
    pub absorbed: BTreeMap<String, u64>,
    /// Left the scene.
    pub escaped: u64,
    /// Ended by the guard.
    pub killed: u64,
}

/// Constructive dimension.
#[derive(Debug, Clone, Serialize)]
pub struct DimensionReport {
    /// Mean coordinates a photon.
    pub mean: f64,
    /// Most coordinates of one photon.
    pub max: u32,
    /// Photons by number of coordinates, 0 to 64 and more.
    pub histogram: Vec<u64>,
    /// Mean coordinates a photon by what they were drawn for.
    pub mean_by_purpose: BTreeMap<&'static str, f64>,
}

/// Counted exceptions.
#[derive(Debug, Clone, Serialize)]
pub struct ExceptionsReport {
    /// Crossings seen twice through rounding and skipped.
    pub skipped_crossings: u64,
    /// Directions that smooth normals sent to the wrong side of a facet and that were mirrored back.
    pub corrected_directions: u64,
    /// Photons that scattering tables sent below the horizon, absorbed there.
    pub below_horizon: u64,
}

/// One receiver.
#[derive(Debug, Clone, Serialize)]
pub struct ReceiverReport {
    /// Name.
    pub name: String,
    /// Flux that arrived, lm.
    pub flux_lm: f64,
    /// Its standard error, lm.
    pub flux_standard_error_lm: Option<f64>,
    /// Least illuminance of a cell, lx.
    pub min_lx: f64,
    /// Mean illuminance, lx.
    pub mean_lx: f64,
    /// Greatest illuminance of a cell, lx.
    pub max_lx: f64,
    /// min / mean.
    pub uniformity_u0: Option<f64>,
    /// Area, m2.
    pub area_m2: f64,
    /// Number of cells.
    pub cells: usize,
    /// Expected root-mean-square error of a cell over the mean illuminance, from the replicates.
    pub expected_nrms: Option<f64>,
    /// Files written for it.
    pub files: Vec<String>,
}

impl Report {
    /// The report of a run. `files` names what was written for each receiver.
    pub fn new(
        scene: &Scene,
        outcome: &Outcome,
        statistics: &[ReceiverStatistics],
        files: &[Vec<String>],
        total_s: f64,
    ) -> Self {
        let surfaces = scene.geometry.surfaces();
        let by_surface = |f: &dyn Fn(usize) -> f64| -> BTreeMap<String, f64> {
            surfaces.iter().enumerate().map(|(i, s)| (s.name.clone(), f(i))).collect()
        };
        let error = |e: crate::run::Estimate| e.standard_error.unwrap_or(0.0);
        let photons = outcome.photons as f64;
        let rejects = outcome.plan.algorithm().variant.rejects();
        Self {
            caustix: env!("CARGO_PKG_VERSION"),
            scene: SceneReport::new(scene),
            variant: outcome.plan.algorithm().variant.name(),
            sequence: outcome.plan.algorithm().sequence.name(),
            solver: (!rejects).then(|| outcome.plan.algorithm().solver.name()),
            rejection: rejects.then(|| outcome.plan.algorithm().rejection.name()),
            seed: outcome.plan.seed(),
            photons: outcome.photons,
            photons_planned: outcome.plan.photons(),
            replicates: outcome.replicates,
            standard_error_absent: why_no_error(outcome),
            time: TimeReport {
                trace_s: outcome.trace_s,
                total_s,
                photons_per_s: if outcome.trace_s > 0.0 { photons / outcome.trace_s } else { 0.0 },
            },
            ledger_lm: LedgerReport {
                emitted: outcome.ledger.total_emitted() as f64 * outcome.photon_lm,
                absorbed: by_surface(&|i| outcome.absorbed_lm(i).value),
                escaped: outcome.escaped_lm().value,
                killed: outcome.killed_lm().value,
                standard_error: (outcome.replicates > 1).then(|| LedgerErrors {
                    absorbed: by_surface(&|i| error(outcome.absorbed_lm(i))),
                    escaped: error(outcome.escaped_lm()),
                    killed: error(outcome.killed_lm()),
                }),
            },
            ledger_photons: LedgerPhotons {
                emitted: scene
                    .emitter_names
                    .iter()
                    .cloned()
                    .zip(outcome.ledger.emitted.iter().copied())
                    .collect(),
                absorbed: surfaces
                    .iter()
                    .map(|s| s.name.clone())
                    .zip(outcome.ledger.absorbed.iter().copied())
                    .collect(),
                escaped: outcome.ledger.escaped,
                killed: outcome.ledger.killed,
            },
            dimension: DimensionReport {
                mean: outcome.census.dimension_mean(),
                max: outcome.census.dimension_max,
                histogram: outcome.census.dimension_histogram.clone(),
                mean_by_purpose: Purpose::ALL
                    .iter()
                    .map(|p| (p.label(), outcome.census.drawn_for[*p as usize] as f64 / photons))
                    .collect(),
            },
            exceptions: ExceptionsReport {
                skipped_crossings: outcome.census.exceptions.skipped_crossings,
                corrected_directions: outcome.census.exceptions.corrected_directions,
                below_horizon: outcome.census.exceptions.below_horizon,
            },
            receivers: scene
                .receivers
                .iter()
                .zip(statistics)
                .zip(files)
                .map(|((receiver, s), files)| ReceiverReport {
                    name: receiver.name.clone(),
                    flux_lm: s.flux_lm.value,
                    flux_standard_error_lm: s.flux_lm.standard_error,
                    min_lx: s.min_lx,
                    mean_lx: s.mean_lx,
                    max_lx: s.max_lx,
                    uniformity_u0: s.uniformity_u0,
                    area_m2: s.area_m2,
                    cells: receiver.cells.len(),
                    expected_nrms: s.expected_nrms,
                    files: files.clone(),
                })
                .collect(),
            camera: None,
            stopped_by: match outcome.stopped_by {
                StoppedBy::Photons => "photons",
                StoppedBy::Interrupt => "interrupt",
            },
            warnings: scene.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

/// Why a run has no standard error, where it has none.
pub fn why_no_error(outcome: &Outcome) -> Option<&'static str> {
    match (outcome.replicates, outcome.plan.algorithm().sequence.is_randomised()) {
        (2.., _) => None,
        (_, false) => {
            Some("this sequence has no seed: there is one replicate, and one set of points has no spread")
        }
        (_, true) => Some("one replicate: the points of one set are not independent of each other"),
    }
}
