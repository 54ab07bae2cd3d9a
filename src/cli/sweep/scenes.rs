//! The scenes of a sweep: one text with other values at each point.

use std::path::PathBuf;

use crate::cli::kept::{command_line, scene_key};
use crate::cli::misuse::a_folder;
use crate::cli::progress::{INTERRUPTED, Progress};
use crate::cli::written::say_found;
use crate::cli::{algorithm, count, results, say, warn};
use crate::error::{Diagnostic, Kind, Place, Result};
use crate::files::scene_toml::RunDefaults;
use crate::files::scene_toml::edit::with_value;
use crate::files::scene_toml::source::Source;
use crate::lab::sweep::figures::{PointFigures, names};
use crate::lab::sweep::grid::Grid;
use crate::lab::sweep::results::Sweep;
use crate::report::numbers::grouped;
use crate::run::{Plan, Settings, Variant, choose_cells};
use crate::scene::Scene;
use crate::scene::receiver::DividedBy;

use super::SweepArgs;

/// What can be wrong with a scene, all of it.
type Built<T> = std::result::Result<T, Vec<Diagnostic>>;

/// The scenes of a sweep.
pub struct Scenes<'a> {
    args: &'a SweepArgs,
    grid: &'a Grid,
    source: Source,
    /// The scene without the sweep's values.
    pub original: Scene,
    /// Cells that a pilot chose at the first point, by receiver.
    cells: Vec<(String, [u32; 2])>,
}

/// A point whose scene can be traced.
pub struct Checked {
    /// All that its figures depend on.
    pub key: String,
    /// How it is traced.
    pub plan: Plan,
    /// Files that its scene names.
    files: Vec<String>,
}

impl<'a> Scenes<'a> {
    /// Reads the scene, and says what is odd about it.
    pub fn open(args: &'a SweepArgs, grid: &'a Grid) -> Built<Self> {
        let source = match args.scene.as_deref() {
            Some(path) if path.is_dir() => return Err(a_folder(path, "a scene file (TOML)").into()),
            Some(path) => Source::open(path, args.confine)?,
            None => Source::built_in(),
        };
        let original = source.read(&source.text)?.build()?;
        warn(&original.warnings);
        original.found.iter().for_each(say_found);
        Ok(Self { args, grid, source, original, cells: Vec::new() })
    }

    /// The scene of the first point.
    pub fn first(&self) -> Built<(Scene, RunDefaults)> {
        self.scene(0)
    }

    /// The scene of a point, of the cells that were chosen once for all.
    pub fn scene(&self, point: usize) -> Built<(Scene, RunDefaults)> {
        let mut text = self.source.text.clone();
        for (key, value) in self.grid.values(point) {
            text = with_value(&text, key, &value.toml)
                .map_err(|e| vec![self.at_point(&format!("--set {key}={}", value.shown), &e)])?;
        }
        let told = self.grid.told(point);
        let named =
            |errors: Vec<Diagnostic>| errors.iter().map(|e| self.at_point(&told, e)).collect::<Vec<_>>();
        let file = self.source.read(&text).map_err(named)?;
        let run = file.run;
        let mut scene = file.build().map_err(named)?;
        for receiver in &mut scene.receivers {
            if let Some((_, cells)) = self.cells.iter().find(|(name, _)| *name == receiver.name) {
                receiver.take_cells_of_pilot(*cells);
            }
        }
        Ok((scene, run))
    }

    /// An error of a scene, where it names the values that made it. Its place in the scene's text would be one in a text that
    /// nobody has; one in another file is kept.
    fn at_point(&self, told: &str, error: &Diagnostic) -> Diagnostic {
        let named = Diagnostic::new(error.kind(), format!("{told}: {}", error.found()), error.required());
        let named = match error.advice() {
            Some(hint) => named.hint(hint),
            None => named,
        };
        match error.file().filter(|file| *file != self.source.name) {
            Some(file) => {
                let place = error.line().zip(error.column()).map(|(line, column)| Place { line, column });
                named.placed(place).in_file(file)
            }
            None => named,
        }
    }

    /// Chooses the cells of receivers that the scene leaves undivided, at the first point: maps of other cells would have other
    /// extremes.
    pub fn fix_cells(&mut self) -> Built<()> {
        let (mut scene, run) = self.first()?;
        let is_open = |scene: &Scene| scene.receivers.iter().any(|r| r.divided_by == DividedBy::Default);
        if !is_open(&scene) {
            return Ok(());
        }
        let progress = Progress::new(self.args.quiet, "choosing cells", 0);
        choose_cells(&mut scene, &self.plan(&run)?, &INTERRUPTED)?;
        progress.clear();
        let chosen = scene.receivers.iter().filter_map(|r| Some((r.name.clone(), r.cells_by_pilot()?)));
        self.cells = chosen.collect();
        Ok(())
    }

    /// Builds every scene, so that a wrong value is told before anything is traced.
    pub fn check(&self, shown: &[String]) -> Built<Vec<Checked>> {
        let points = self.grid.points();
        let progress = Progress::new(self.args.quiet, "reading", 0);
        let mut odd: Vec<String> = self.original.warnings.iter().map(|w| w.found().to_owned()).collect();
        let mut checked = Vec::with_capacity(points);
        for point in 0..points {
            progress.phase(format!("reading point {} of {}", point + 1, grouped(points as u64)));
            let (scene, run) = self.scene(point)?;
            let told = self.grid.told(point);
            for warning in &scene.warnings {
                if !odd.iter().any(|known| known == warning.found()) {
                    odd.push(warning.found().to_owned());
                    progress.suspend(|| say(&format!("warning: {}", self.at_point(&told, warning))));
                }
            }
            let known = names(&scene);
            if let Some(gone) = shown.iter().find(|name| known.iter().all(|(known, _)| known != *name)) {
                let found = format!("{told}: a scene without {gone}");
                return Err(vec![Diagnostic::new(Kind::Missing, found, "the same figures at every point")]);
            }
            let plan = self.plan(&run)?;
            let files = scene.identity.files.iter().map(|(name, _)| name.clone()).collect();
            checked.push(Checked { key: self.key(&scene, &plan), plan, files });
        }
        progress.clear();
        Ok(checked)
    }

    fn key(&self, scene: &Scene, plan: &Plan) -> String {
        format!(
            "{}\nsweep: {} seed {}, {} x {} photons\ncells: {:?}",
            scene_key(scene),
            plan.algorithm().name(),
            plan.seed(),
            plan.replicates(),
            plan.photons_per_replicate(),
            self.cells
        )
    }

    /// The command line where it speaks, else the scene's [run], else the defaults.
    fn plan(&self, run: &RunDefaults) -> Result<Plan> {
        let args = self.args;
        let photons = count("--photons", args.photons.as_ref())?.or(run.photons);
        let mut settings = Settings { photons, ..Settings::default() };
        // Where choices share a coordinate, one that a neighbour makes otherwise changes those after it, too.
        settings.algorithm.variant = Variant::QmcInverse;
        settings.algorithm = algorithm(settings.algorithm, args.variant.as_ref(), args.sequence.as_ref())?;
        settings.seed = args.seed.or(run.seed).unwrap_or(settings.seed);
        // A scene's replicates yield to a sequence that can have only one; the command line's do not.
        let of_scene = run.replicates.filter(|_| settings.algorithm.sequence.is_randomised());
        settings.replicates = args.replicates.or(of_scene);
        Plan::new(&settings)
    }

    /// Every file that is read.
    pub fn inputs(&self, checked: &[Checked]) -> Vec<PathBuf> {
        let Some(path) = self.args.scene.as_deref() else { return Vec::new() };
        let mut inputs = results::inputs(Some(path), &self.original);
        let folder = path.parent().map(PathBuf::from).unwrap_or_default();
        inputs.extend(checked.iter().flat_map(|point| &point.files).map(|name| folder.join(name)));
        inputs.sort();
        inputs.dedup();
        inputs
    }

    /// The sweep with what was found at its points.
    pub fn results(
        &self,
        shown: Vec<String>,
        checked: &[Checked],
        points: Vec<Option<PointFigures>>,
    ) -> Sweep {
        Sweep {
            scene_name: self.original.identity.name.clone(),
            scene_sha256: self.original.identity.sha256.clone(),
            command: command_line(),
            tracing: tracing(checked),
            notes: self.notes(),
            grid: self.grid.clone(),
            shown,
            points,
        }
    }

    fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        for (name, [nu, nv]) in &self.cells {
            notes
                .push(format!("cells of {name}: {nu} x {nv}, chosen at the first point and the same at all"));
        }
        if self.original.camera.is_some() {
            notes.push(
                "the camera's picture is not made: a sweep traces what receivers and far fields get"
                    .to_owned(),
            );
        }
        notes
    }
}

/// How the points are traced, in words.
fn tracing(checked: &[Checked]) -> String {
    let Some(Checked { plan, .. }) = checked.first() else { return String::new() };
    if checked.iter().any(|point| point.plan != *plan) {
        return format!("as [run] says at each point, {}", plan.algorithm().name());
    }
    format!(
        "{} photons a point in {}, seed {}, {}: the same points of the sequence in every scene",
        grouped(plan.photons()),
        match plan.replicates() {
            1 => "one replicate, which has no error".to_owned(),
            many => format!("{many} replicates"),
        },
        plan.seed(),
        plan.algorithm().name()
    )
}
