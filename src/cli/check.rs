//! `caustix check SCENE.toml`: everything that can be known without tracing, and what a few thousand photons find.

use std::cmp::Reverse;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use serde::Serialize;

use crate::emitter::Emits;
use crate::error::warning::{Severity, Warning};
use crate::error::{Diagnostic, Kind, Result};
use crate::geometry::Shape;
use crate::picture;
use crate::report::json::json;
use crate::report::numbers::{digits, duration, grouped};
use crate::run::dark::is_long;
use crate::run::kept::memory_bytes;
use crate::run::{Plan, Settings, trace, warnings};
use crate::scene::camera::Method;
use crate::scene::receiver::DividedBy;
use crate::scene::{Scene, requires::requirements};

use super::deadline::{flagged, or_end};
use super::forecast::{ForecastCheck, foretold};
use super::progress::Progress;
use super::written::{say_found, strictly};
use super::{CheckArgs, Done, exit, fail, print, say, start, warn};

#[derive(Debug, Default, Serialize)]
struct Check {
    ok: bool,
    requires: Vec<&'static str>,
    surfaces: Vec<SurfaceCheck>,
    emitters: Vec<EmitterCheck>,
    receivers: Vec<ReceiverCheck>,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    far_fields: Vec<FarFieldCheck>,
    #[serde(skip_serializing_if = "Option::is_none")]
    camera: Option<CameraCheck>,
    memory_mb: f64,
    warnings: Vec<String>,
    errors: Vec<ErrorCheck>,
    #[serde(skip_serializing_if = "Option::is_none")]
    probe: Option<Probe>,
    /// What errors will take.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    forecast: Vec<ForecastCheck>,
}

/// What a run of few photons says: absent where it says nothing.
#[derive(Debug, Serialize)]
struct Probe {
    photons: u64,
    warnings: Vec<Warning>,
}

/// Photons of the probe.
const PHOTONS: u64 = 4096;

/// Photons where each takes long.
const FEWER: u64 = 256;

/// The longest that a probe lasts, and a check, by the clock: the rays of a scene that means harm cost as much as it likes.
const LONGEST_PROBE: Duration = Duration::from_secs(60);
const LONGEST: Duration = Duration::from_secs(300);

/// What a run of this scene would say of itself, to a few photons and eye paths; what was found without them, too.
/// How many photons that were, and the time that a million takes, s.
struct Probed {
    photons: u64,
    million_s: f64,
    said: Vec<Warning>,
}

fn probe(scene: &Scene) -> Result<Probed> {
    let is_over = AtomicBool::new(false);
    let of = |photons| {
        let settings = Settings { photons: Some(photons), replicates: Some(1), ..Settings::default() };
        match trace(scene, &Plan::new(&settings)?, &is_over, &|_| {}) {
            Err(e) if e.kind() == Kind::Interrupted => Ok(None),
            outcome => outcome.map(Some),
        }
    };
    let (outcome, seen) = flagged(LONGEST_PROBE, &is_over, || {
        let mut outcome = of(FEWER)?;
        if outcome.as_ref().is_some_and(|few| !is_long(few)) {
            outcome = of(PHOTONS)?.or(outcome);
        }
        Ok::<_, Diagnostic>((outcome, picture::probe(scene, &is_over)?))
    })?;
    let (mut photons, mut million_s, mut said) = (0, 0.0, Vec::new());
    match &outcome {
        None => said.extend(scene.found.iter().cloned()),
        Some(outcome) => {
            said = warnings(scene, outcome);
            photons = outcome.photons;
            if is_long(outcome) {
                million_s = 1e6 * outcome.trace_s / photons as f64;
            }
        }
    }
    said.extend(seen);
    if is_over.load(Ordering::Relaxed) {
        said.push(probe_ended(photons));
    }
    said.sort_by_key(|warning| Reverse(warning.severity));
    Ok(Probed { photons, million_s, said })
}

/// What errors will take, where a probe told that photons are quick.
fn forecasts(scene: &mut Scene, probed: &Probed) -> Result<Vec<ForecastCheck>> {
    if probed.million_s > 0.0 || probed.photons < PHOTONS { Ok(Vec::new()) } else { foretold(scene) }
}

/// That the photons, or eye paths, of a scene take too long to be probed.
fn probe_ended(photons: u64) -> Warning {
    Warning {
        severity: Severity::Doubtful,
        code: "probe-ended",
        message: format!(
            "the probe was ended after {} s, at {} photons: what more of them would find is not known",
            LONGEST_PROBE.as_secs(),
            grouped(photons)
        ),
        surfaces: Vec::new(),
        share: None,
        remedy: "surfaces without thousands of large faces in one place, and that absorb; `render` would take long, too".into(),
    }
}

#[derive(Debug, Serialize)]
struct SurfaceCheck {
    name: String,
    triangles: usize,
    open_edges: usize,
    closed: bool,
    area_m2: f64,
}

#[derive(Debug, Serialize)]
struct EmitterCheck {
    name: String,
    flux_emitted_lm: f64,
}

#[derive(Debug, Serialize)]
struct ReceiverCheck {
    name: String,
    cells: usize,
    /// Whether a run's pilot will choose others.
    #[serde(skip_serializing_if = "is_not")]
    cells_by_pilot: bool,
    area_m2: f64,
}

#[derive(Debug, Serialize)]
struct FarFieldCheck {
    name: String,
    /// Nodes that a run counts, half steps included.
    nodes: usize,
}

fn is_not(flag: &bool) -> bool {
    !flag
}

#[derive(Debug, Serialize)]
struct CameraCheck {
    pixels: [u32; 2],
    samples: u32,
    method: &'static str,
    photon_memory_mb: f64,
}

#[derive(Debug, Serialize)]
struct ErrorCheck {
    file: Option<String>,
    line: Option<usize>,
    column: Option<usize>,
    found: String,
    required: String,
}

impl Check {
    fn of_scene(scene: &Scene, Probed { photons, said, .. }: &Probed) -> Self {
        let surfaces = scene.geometry.surfaces().iter().map(|s| {
            let (triangles, open_edges) = match &s.shape {
                Shape::Mesh(mesh) => (mesh.triangles().len(), mesh.topology().open_edges),
                // A rectangle is two triangles with four free edges; exact shapes have no triangles.
                Shape::Rectangle(_) => (2, 4),
                Shape::Sphere(_) => (0, 0),
                Shape::Paraboloid(_) => (0, 1),
            };
            SurfaceCheck {
                name: s.name.clone(),
                triangles,
                open_edges,
                closed: s.shape.is_closed(),
                area_m2: s.shape.area(),
            }
        });
        let emitters = scene.emitter_names.iter().zip(scene.emitters.as_slice());
        let emitters =
            emitters.map(|(name, e)| EmitterCheck { name: name.clone(), flux_emitted_lm: e.flux_lm() });
        let receivers = scene.receivers.iter().map(|r| ReceiverCheck {
            name: r.name.clone(),
            cells: r.cells.len(),
            cells_by_pilot: r.divided_by == DividedBy::Default,
            area_m2: r.total_area_m2(),
        });
        let far_fields: Vec<_> = scene
            .far_fields
            .iter()
            .map(|f| FarFieldCheck { name: f.name.clone(), nodes: f.nodes.count() })
            .collect();
        let camera = scene.camera.as_ref().map(|c| CameraCheck {
            pixels: c.pixels,
            samples: c.samples,
            method: c.method.word(),
            photon_memory_mb: if c.method == Method::Map { c.photon_memory_bytes as f64 / 1e6 } else { 0.0 },
        });
        let of_camera = scene.camera.as_ref().map_or(0, |c| picture::memory_bytes(c, scene.is_coloured()));
        let memory_bytes = (scene.memory_bytes() as u64).saturating_add(memory_bytes(scene)) + of_camera;
        Self {
            ok: true,
            requires: requirements(scene),
            surfaces: surfaces.collect(),
            emitters: emitters.collect(),
            receivers: receivers.collect(),
            far_fields,
            camera,
            memory_mb: memory_bytes as f64 / 1e6,
            warnings: scene.warnings.iter().map(ToString::to_string).collect(),
            errors: Vec::new(),
            probe: (!said.is_empty()).then(|| Probe { photons: *photons, warnings: said.clone() }),
            forecast: Vec::new(),
        }
    }

    fn of_errors(errors: &[Diagnostic]) -> Self {
        let place = |e: &Diagnostic| ErrorCheck {
            file: e.file().map(str::to_string),
            line: e.line(),
            column: e.column(),
            found: e.found().to_string(),
            required: e.required().to_string(),
        };
        Self { errors: errors.iter().map(place).collect(), ..Self::default() }
    }

    fn text(&self, name: &str) -> String {
        let mut out = format!("{name}: ready to trace\n\nrequires   {}\n", self.requires.join(", "));
        for e in &self.emitters {
            out += &format!("emitter    {}: {} lm\n", e.name, digits(e.flux_emitted_lm));
        }
        for s in &self.surfaces {
            let edges = match (s.triangles, s.open_edges) {
                (0, _) => "exact".to_string(),
                (n, 0) => format!("{} triangles, closed", grouped(n as u64)),
                (n, open) => format!("{} triangles, {} open edges", grouped(n as u64), grouped(open as u64)),
            };
            out += &format!("surface    {}: {edges}, {} m2\n", s.name, digits(s.area_m2));
        }
        for r in &self.receivers {
            let cells = match r.cells_by_pilot {
                true => "cells by a pilot run".into(),
                false => format!("{} cells", grouped(r.cells as u64)),
            };
            out += &format!("receiver   {}: {cells}, {} m2\n", r.name, digits(r.area_m2));
        }
        for f in &self.far_fields {
            out +=
                &format!("far field  {}: {} nodes, half steps included\n", f.name, grouped(f.nodes as u64));
        }
        if let Some(c) = &self.camera {
            let ([columns, rows], samples, method) = (c.pixels, c.samples, c.method);
            let photons = match c.photon_memory_mb {
                0.0 => String::new(),
                mb => format!(", at most {} MB of photons at a time", grouped(mb.round() as u64)),
            };
            out += &format!(
                "camera     {columns} x {rows} pixels of {} samples, {method}{photons}\n",
                grouped(samples.into())
            );
        }
        out + &format!("memory     {:.1} MB\n", self.memory_mb)
    }
}

/// Says that a check took too long.
fn told_late(is_json: bool) {
    let found = format!("a scene that is not checked after {} s", LONGEST.as_secs());
    let required = "a scene of fewer faces and emitters, or of fewer bodies in one another";
    let error = [Diagnostic::new(Kind::Limit, found, required)];
    match json(&Check::of_errors(&error)) {
        Ok(text) if is_json => print(&text),
        _ => _ = fail(None, &error),
    }
}

/// Runs the subcommand; the exit code.
pub fn run(args: &CheckArgs) -> Done {
    let is_json = args.json;
    let _until_done = or_end(LONGEST, exit::WRONG, move || told_late(is_json));
    let ready = start::load(args.scene.as_deref(), args.confine, args.json).and_then(|(scene, _)| {
        // What `render` refuses is not ready.
        picture::check(&scene)?;
        Ok(scene)
    });
    let progress = Progress::new(args.json, "probing", 0);
    let mut ready = ready.and_then(|scene| Ok((probe(&scene)?, scene)));
    progress.clear();
    if args.json {
        let check = match &mut ready {
            Err(errors) => Check::of_errors(errors),
            Ok((probed, scene)) => {
                let check = Check::of_scene(scene, probed);
                Check { forecast: forecasts(scene, probed)?, ..check }
            }
        };
        print(&json(&check)?);
        let said = ready.iter().flat_map(|(probed, _)| &probed.said);
        return Ok(if check.ok { strictly(args.strict, exit::DONE, said) } else { exit::WRONG });
    }
    let (probed, mut scene) = ready?;
    warn(&scene.warnings);
    let Probed { photons, million_s, said } = &probed;
    let photons = grouped(*photons);
    for warning in said {
        if scene.found.contains(warning) {
            say_found(warning);
        } else {
            say(&format!("warning (found by a probe of {photons} photons): {warning}"));
        }
    }
    let worst = match said.iter().map(|warning| warning.severity).max() {
        None => "nothing to warn of",
        Some(Severity::Note) => "notes only",
        Some(Severity::Doubtful) => "numbers would be doubtful (see the warnings)",
        Some(Severity::Untrusted) => "numbers would be wrong (see the warnings)",
    };
    print(&Check::of_scene(&scene, &probed).text(&scene.identity.name));
    print(&format!("probe      {photons} photons: {worst}\n"));
    if *million_s > 0.0 {
        print(&format!("time       about {} for a million photons\n", duration(*million_s)));
    }
    let forecasts = forecasts(&mut scene, &probed)?;
    forecasts.iter().for_each(|forecast| print(&forecast.text()));
    Ok(strictly(args.strict, exit::DONE, &probed.said))
}
