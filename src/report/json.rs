//! report.json: the run in numbers, for programs.

use std::collections::BTreeMap;

use serde::Serialize;

use crate::error::warning::{Severity, Warning};
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::SurfaceId;
use crate::run::warnings::TRAPPED;
use crate::run::{Estimate, Outcome, Plan, Reached, StoppedBy, warnings};
use crate::sample::coordinates::Purpose;
use crate::scene::Scene;
use crate::scene::far_field::FarField;
use crate::scene::receiver::Receiver;
use crate::transport::census::Exceptions;

use super::camera::CameraReport;
use super::diagnosis::{self, DiagnosisReport};
use super::far_field::{self, FarFieldStatistics};
use super::numbers::grouped;
use super::statistics::ReceiverStatistics;
use super::unknown::why_no_error;

/// Everything report.json says. Names are a contract: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct Report<'a> {
    /// What was run.
    #[serde(flatten)]
    pub run: RunReport,
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
    pub exceptions: Exceptions,
    /// Receivers in the order of the scene.
    pub receivers: Vec<ReceiverReport<'a>>,
    /// Far fields in the order of the scene; absent where it has none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub far_fields: Vec<FarFieldReport<'a>>,
    /// The camera, where the scene has one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub camera: Option<CameraReport>,
    /// "photons", "interrupt", "error" or "time".
    pub stopped_by: &'static str,
    /// The error that the run was to reach; absent where none was asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stopping: Option<StoppingReport>,
    /// What must be known beside the numbers: about the run, the gravest first, then about the scene and its files.
    pub warnings: Vec<Warning>,
}

/// An error that a run was to reach.
#[derive(Debug, Clone, Serialize)]
pub struct StoppingReport {
    /// What it is of: "flux", "mean", "cells" or "max".
    pub error_of: &'static str,
    /// The relative standard error that was asked for, as a fraction.
    pub asked: f64,
    /// What it is, of the receiver where it is largest; `null` where it is not known.
    pub reached: Option<f64>,
    /// Whether it is as small as was asked for.
    pub met: bool,
}

impl From<&Reached> for StoppingReport {
    fn from(of: &Reached) -> Self {
        Self { error_of: of.of.name(), asked: of.asked, reached: of.error, met: of.is_met() }
    }
}

/// What stands at the head of every report.json.
#[derive(Debug, Clone, Serialize)]
pub struct RunReport {
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
}

impl RunReport {
    /// Of a run by this plan, with the number of photons that its results stand for.
    pub fn new(scene: &Scene, plan: &Plan, photons: u64) -> Self {
        let algorithm = plan.algorithm();
        let rejects = algorithm.variant.rejects();
        Self {
            caustix: env!("CARGO_PKG_VERSION"),
            scene: SceneReport::new(scene),
            variant: algorithm.variant.name(),
            sequence: algorithm.sequence.name(),
            solver: (!rejects).then(|| algorithm.solver.name()),
            rejection: rejects.then(|| algorithm.rejection.name()),
            seed: plan.seed(),
            photons,
        }
    }
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
    /// Of this scene.
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
    /// Figure of merit of each receiver's flux, 1 / (relative standard error^2 x tracing time), 1/s; absent where none is known.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub merit_per_s: BTreeMap<String, f64>,
}

/// Where photons ended.
#[derive(Debug, Clone, Serialize)]
pub struct Accounts<T> {
    /// Absorbed by each surface.
    pub absorbed: BTreeMap<String, T>,
    /// Left the scene.
    pub escaped: T,
    /// Ended by the guard against endless walks.
    pub killed: T,
    /// Kept for ever by total reflection, by body; absent where there is none.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub trapped: BTreeMap<String, T>,
}

impl<T> Accounts<T> {
    fn new(scene: &Scene, absorbed: impl Fn(usize) -> T, escaped: T, killed: T) -> Self {
        let surfaces = scene.geometry.surfaces().iter().enumerate();
        Self {
            absorbed: surfaces.map(|(i, s)| (s.name.clone(), absorbed(i))).collect(),
            escaped,
            killed,
            trapped: BTreeMap::new(),
        }
    }
}

/// Flux by account, lm.
#[derive(Debug, Clone, Serialize)]
pub struct LedgerReport {
    /// Emitted.
    pub emitted: f64,
    /// Where it ended.
    #[serde(flatten)]
    pub ended: Accounts<f64>,
    /// Standard errors of the accounts: surfaces by name, `escaped`, `killed`; absent for one replicate.
    pub standard_error: Option<Accounts<f64>>,
}

/// Photons by account.
#[derive(Debug, Clone, Serialize)]
pub struct LedgerPhotons {
    /// Emitted, by emitter.
    pub emitted: BTreeMap<String, u64>,
    /// Where they ended.
    #[serde(flatten)]
    pub ended: Accounts<u64>,
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

/// One receiver.
#[derive(Debug, Clone, Serialize)]
pub struct ReceiverReport<'a> {
    /// Name.
    pub name: &'a str,
    /// Its numbers.
    #[serde(flatten)]
    pub numbers: &'a ReceiverStatistics,
    /// Files written for it.
    pub files: &'a [String],
    /// What replicates and doublings say of it; absent for one replicate.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub diagnosis: Option<DiagnosisReport>,
    /// Codes of warnings for which its numbers are not to be trusted; absent where there is none.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub untrusted: Vec<&'static str>,
}

/// One far field.
#[derive(Debug, Clone, Serialize)]
pub struct FarFieldReport<'a> {
    /// Name.
    pub name: &'a str,
    /// Its numbers.
    #[serde(flatten)]
    pub numbers: &'a FarFieldStatistics,
    /// Files written for it.
    pub files: &'a [String],
}

impl FarFieldReport<'_> {
    /// What the summary says of it.
    pub fn text(&self, field: &FarField) -> String {
        far_field::text(field, self.numbers, self.files)
    }
}

/// The code of what was found before the run.
const SCENE: &str = "scene";

/// The code of numbers of photons that an EXR does not hold to the last digit.
const HITS_ROUNDED: &str = "hits-rounded";

fn rounded_hits((receiver, numbers): (&Receiver, &ReceiverStatistics)) -> Option<Warning> {
    let (name, most) = (&receiver.name, grouped(numbers.rounded_hits()?));
    Some(Warning {
        severity: Severity::Note,
        code: HITS_ROUNDED,
        message: format!("{name}.exr: {most} photons in a cell, of which a float holds 24 binary digits"),
        surfaces: Vec::new(),
        share: None,
        remedy: format!("{name}.csv has the whole numbers; illuminance and its error are not concerned"),
    })
}

/// What was found before the run, as notes.
fn of_scene(found: &[Diagnostic]) -> impl Iterator<Item = Warning> {
    found.iter().map(|found| Warning {
        severity: Severity::Note,
        code: SCENE,
        message: found.to_string(),
        surfaces: Vec::new(),
        share: None,
        remedy: found.required().to_owned(),
    })
}

impl<'a> Report<'a> {
    /// The report of a run. `files` names what was written for each receiver.
    pub fn new(
        scene: &'a Scene,
        outcome: &Outcome,
        statistics: &'a [ReceiverStatistics],
        files: &'a [Vec<String>],
        total_s: f64,
    ) -> Self {
        let ledger = &outcome.ledger;
        let lumens = |of: &dyn Fn(Estimate) -> f64| {
            let absorbed = |i| of(outcome.absorbed_lm(i));
            Accounts::new(scene, absorbed, of(outcome.escaped_lm()), of(outcome.killed_lm()))
        };
        let name = |body: &SurfaceId| scene.geometry.name(*body).to_owned();
        let trapped: BTreeMap<_, _> = ledger.trapped.iter().map(|(body, n)| (name(body), *n)).collect();
        let trapped_lm =
            trapped.iter().map(|(n, count)| (n.clone(), *count as f64 * outcome.photon_lm)).collect();
        let photons = outcome.photons as f64;
        let diagnoses = diagnosis::of_receivers(scene, outcome);
        let merit_per_s = diagnosis::merits_per_s(scene, outcome, &diagnoses);
        let receivers = scene.receivers.iter().zip(statistics).zip(files).zip(diagnoses);
        let rounded = scene.receivers.iter().zip(statistics).filter_map(rounded_hits);
        let spots = scene.receivers.iter().zip(statistics);
        let spots =
            spots.filter_map(|(receiver, of)| Some(of.spot.as_ref()?.warnings(&receiver.name))).flatten();
        let of_run = warnings(scene, outcome).into_iter().chain(rounded).chain(spots);
        let warnings: Vec<Warning> = of_run.chain(of_scene(&scene.warnings)).collect();
        let untrusted = |receiver: &Receiver| {
            let surface = scene.geometry.name(receiver.surface);
            let spoils = |w: &&Warning| {
                w.code == TRAPPED
                    && w.severity == Severity::Untrusted
                    && w.surfaces.iter().any(|s| s == surface)
            };
            warnings.iter().filter(spoils).map(|w| w.code).collect()
        };
        Self {
            run: RunReport::new(scene, &outcome.plan, outcome.photons),
            photons_planned: outcome.plan.photons(),
            replicates: outcome.replicates,
            standard_error_absent: why_no_error(outcome),
            time: TimeReport {
                trace_s: outcome.trace_s,
                total_s,
                photons_per_s: if outcome.trace_s > 0.0 { photons / outcome.trace_s } else { 0.0 },
                merit_per_s,
            },
            ledger_lm: LedgerReport {
                emitted: ledger.total_emitted() as f64 * outcome.photon_lm,
                ended: Accounts { trapped: trapped_lm, ..lumens(&|e| e.value) },
                standard_error: (outcome.replicates > 1)
                    .then(|| lumens(&|e| e.standard_error.unwrap_or(0.0))),
            },
            ledger_photons: LedgerPhotons {
                emitted: scene.emitter_names.iter().cloned().zip(ledger.emitted.iter().copied()).collect(),
                ended: Accounts {
                    trapped,
                    ..Accounts::new(scene, |i| ledger.absorbed[i], ledger.escaped, ledger.killed)
                },
            },
            dimension: DimensionReport {
                mean: outcome.census.dimension_mean(),
                max: outcome.census.dimension_max,
                histogram: outcome.census.dimension_histogram.clone(),
                mean_by_purpose: Purpose::LABELS
                    .into_iter()
                    .zip(outcome.census.drawn_for.map(|drawn| drawn as f64 / photons))
                    .collect(),
            },
            exceptions: outcome.census.exceptions.clone(),
            receivers: receivers
                .map(|(((r, numbers), files), diagnosis)| ReceiverReport {
                    name: &r.name,
                    numbers,
                    files,
                    diagnosis,
                    untrusted: untrusted(r),
                })
                .collect(),
            far_fields: Vec::new(),
            camera: None,
            stopped_by: match outcome.stopped_by {
                StoppedBy::Photons => "photons",
                StoppedBy::Interrupt => "interrupt",
                StoppedBy::Error => "error",
                StoppedBy::Time => "time",
            },
            stopping: outcome.reached.as_ref().map(StoppingReport::from),
            warnings,
        }
    }

    /// Adds the scene's far fields and what they and their files say of themselves. `files` names what was written for each.
    pub fn add_far_fields(
        &mut self,
        scene: &'a Scene,
        numbers: &'a [FarFieldStatistics],
        files: &'a [Vec<String>],
        of_files: Vec<Warning>,
    ) {
        let all = || scene.far_fields.iter().zip(numbers);
        let report = |((field, numbers), files): ((&'a FarField, _), &'a Vec<String>)| FarFieldReport {
            name: &field.name,
            numbers,
            files,
        };
        self.far_fields = all().zip(files).map(report).collect();
        self.tell(all().flat_map(|(field, numbers)| numbers.warnings(field)).chain(of_files).collect());
    }

    /// What replicates and doublings say of the receivers, as it is printed.
    pub fn diagnosis_text(&self) -> String {
        let text = |receiver: &ReceiverReport<'_>| {
            let merit = self.time.merit_per_s.get(receiver.name).copied();
            Some(receiver.diagnosis.as_ref()?.text(receiver.name, merit))
        };
        match (self.standard_error_absent, self.receivers.is_empty()) {
            (Some(why), _) => format!("\ndiagnosis  none: {why}\n"),
            (None, true) => "\ndiagnosis  none: the scene has no receivers\n".to_owned(),
            (None, false) => self.receivers.iter().filter_map(text).collect(),
        }
    }

    /// Adds the camera and what its picture says of itself.
    pub fn see(&mut self, camera: Option<CameraReport>, said: Vec<Warning>) {
        self.camera = camera;
        self.tell(said);
    }

    fn tell(&mut self, said: Vec<Warning>) {
        let of_run = self.warnings.iter().take_while(|warning| warning.code != SCENE).count();
        self.warnings.splice(of_run..of_run, said);
        self.warnings[..].sort_by_key(|warning| (warning.code == SCENE, std::cmp::Reverse(warning.severity)));
    }
}

/// A value as JSON text, indented, with a line break at its end.
///
/// # Errors
/// [`Kind::Io`] where JSON cannot hold it.
pub fn json(value: &impl Serialize) -> Result<String> {
    let text = serde_json::to_string_pretty(value).map_err(|e| {
        Diagnostic::new(Kind::Io, format!("\"{e}\" while writing JSON"), "numbers that JSON can hold")
    })?;
    Ok(text + "\n")
}
