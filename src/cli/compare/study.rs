//! Algorithm variants against a reference.

use std::sync::atomic::Ordering;

use crate::cli::kept::{Kept, command_line, scene_key};
use crate::cli::progress::{INTERRUPTED, processor_time};
use crate::cli::start::thread_pool;
use crate::cli::{Done, count, exit, in_option};
use crate::error::{Diagnostic, Kind, Result};
use crate::files::parts::{from_bytes, to_bytes};
use crate::lab::study::account::Events;
use crate::lab::study::cells::Grids;
use crate::lab::study::reference::{
    MOST_REFERENCE_PHOTONS, REPLICATES, Reference, ReferencePlan, SEQUENCE, emission_map, trace_replicate,
};
use crate::lab::study::results;
use crate::lab::study::results::{Run, Study, VariantResult};
use crate::lab::study::runs::{LADDER_OCTAVES, ladder};
use crate::lab::study::table::Table;
use crate::plot::compare::drawing;
use crate::report::compare::csv::csv;
use crate::report::compare::markdown::markdown;
use crate::report::compare::text::text;
use crate::run::{Algorithm, MAX_PHOTONS, Variant};
use crate::scene::Scene;

use super::{CompareArgs, seeds};

/// Photons of each run where none is named.
const DEFAULT_PHOTONS: u64 = 1 << 20;
/// Reference photons for each photon of a run where none is named.
const REFERENCE_FACTOR: u64 = 100;
/// Cells along each side of the grids where none is named.
const DEFAULT_CELLS: [u32; 3] = [48, 128, 256];
/// Variants beside the paper's with `--full`.
const FULL: [&str; 7] = [
    "mc:table",
    "qmc:table",
    "qmc:next-point",
    "qmc-inverse:quadratic-newton",
    "qmc-inverse-reuse:quadratic-newton",
    "qmc-inverse-reuse:halton-rotation",
    "qmc-inverse-reuse:independent",
];

/// What a study writes.
const FILES: [&str; 3] = ["compare.csv", "compare.md", "compare.svg"];

/// Makes the study as far as it gets; the exit code.
pub fn run(args: &CompareArgs, scene: &Scene) -> Done {
    let asked = Asked::new(args, scene)?;
    let kept = Kept::start(args.order(scene, &FILES), asked.work())?;
    let pool = thread_pool(args.threads)?;
    let job = Job { scene, asked, kept };
    let study = pool.install(|| job.study(args))?;
    job.kept.progress.clear();
    let mut is_whole = true;
    if let Some(study) = &study {
        let table = Table::new(study);
        let [csv_file, told, plot] = FILES;
        let files = [
            (csv_file, csv(study, &table)),
            (told, markdown(study, &table)),
            (plot, drawing(study, &table).to_svg()),
        ];
        is_whole = job.kept.write(scene, &files, &text(study, &table))?;
    }
    Ok(match study {
        _ if !is_whole => exit::WRONG,
        _ if !INTERRUPTED.load(Ordering::Relaxed) => exit::DONE,
        Some(_) => job.kept.interrupted("the runs finished by then are in the table"),
        None => job.kept.interrupted("no run was finished"),
    })
}

/// What is asked for, made definite.
struct Asked<'s> {
    grids: Grids<'s>,
    algorithms: Vec<Algorithm>,
    seeds: Vec<u64>,
    photons: u64,
    ladder: Vec<u64>,
    reference: ReferencePlan,
}

impl<'s> Asked<'s> {
    fn new(args: &CompareArgs, scene: &'s Scene) -> Result<Self> {
        let cells = if args.cells.is_empty() { &DEFAULT_CELLS[..] } else { &args.cells };
        let mut cells = cells.to_vec();
        let mut seen = Vec::new();
        cells.retain(|k| !seen.contains(k) && (seen.push(*k), true).1);
        let grids = Grids::new(scene, &cells)?;
        let photons = count("--photons", args.photons.as_ref())?.unwrap_or(DEFAULT_PHOTONS);
        let from = count("--from", args.from.as_ref())?.unwrap_or((photons >> LADDER_OCTAVES).max(1));
        if photons == 0 || photons > MAX_PHOTONS || from == 0 || from > photons {
            let found = format!("errors from {from} to {photons} photons");
            return Err(Diagnostic::new(Kind::Range, found, "1 to 2^48 photons, rising"));
        }
        let seeds = seeds(args)?;
        let reference_photons = count("--reference-photons", args.reference_photons.as_ref())?
            .unwrap_or(photons.saturating_mul(REFERENCE_FACTOR).min(MOST_REFERENCE_PHOTONS));
        let algorithms = algorithms(args)?;
        // Before the reference, not after: it takes longest.
        algorithms.iter().try_for_each(|a| a.check_skipping(scene.emitters.is_single()))?;
        Ok(Self {
            grids,
            algorithms,
            ladder: ladder(from, photons),
            photons,
            reference: ReferencePlan::new(reference_photons, &seeds)?,
            seeds,
        })
    }

    /// Seeds that make a difference to an algorithm.
    fn seeds_of(&self, algorithm: Algorithm) -> &[u64] {
        if algorithm.sequence.is_randomised() { &self.seeds } else { &self.seeds[..1] }
    }

    /// Photons of one run: points that are made for their number are traced anew for each.
    fn photons_of(&self, algorithm: Algorithm) -> u64 {
        if algorithm.sequence.needs_number() { self.ladder.iter().sum() } else { self.photons }
    }

    /// Photons to be traced in all.
    fn work(&self) -> u64 {
        let of = |a: &Algorithm| self.seeds_of(*a).len() as u64 * self.photons_of(*a);
        self.algorithms.iter().map(of).sum::<u64>().saturating_add(self.reference.photons())
    }
}

fn algorithms(args: &CompareArgs) -> Result<Vec<Algorithm>> {
    let paper = Variant::ALL.map(Variant::name);
    let names: Vec<&str> = match (args.variants.is_empty(), args.full) {
        (false, _) => args.variants.iter().map(String::as_str).collect(),
        (true, false) => paper.to_vec(),
        (true, true) => paper.into_iter().chain(FULL).collect(),
    };
    let mut algorithms: Vec<Algorithm> = Vec::new();
    for name in names {
        let named = |e: Diagnostic| match name.contains([';', ' ']) {
            true => in_option("--variants: ", &e).hint("variants are parted by commas"),
            false => in_option("--variants: ", &e),
        };
        let algorithm = Algorithm::parse(name.trim()).map_err(named)?;
        if algorithms.contains(&algorithm) {
            let found = format!("variant {name} twice");
            return Err(Diagnostic::new(Kind::Range, found, "every variant once in --variants"));
        }
        algorithms.push(algorithm);
    }
    Ok(algorithms)
}

/// A study under way.
struct Job<'a> {
    scene: &'a Scene,
    asked: Asked<'a>,
    kept: Kept,
}

impl Job<'_> {
    /// The study, as far as it is; `None` where not even the reference is finished, or no run.
    fn study(&self, args: &CompareArgs) -> Result<Option<Study>> {
        let Some((reference, key)) = self.reference()? else { return Ok(None) };
        let runs = self.runs(&reference, &key)?;
        if runs.iter().all(Vec::is_empty) {
            return Ok(None);
        }
        let events = Events::count(self.scene);
        let asked = &self.asked;
        let variant = |(algorithm, runs): (&Algorithm, Vec<Run>)| VariantResult {
            name: algorithm.name(),
            description: algorithm.description(),
            runs,
            account: Some(events.account(self.scene, *algorithm)),
        };
        Ok(Some(Study {
            caustix_version: env!("CARGO_PKG_VERSION").into(),
            scene_name: self.scene.identity.name.clone(),
            scene_sha256: self.scene.identity.sha256.clone(),
            built_in: args.scene.is_none(),
            command: command_line(),
            receivers: asked.grids.names.clone(),
            grids: asked.grids.labels.clone(),
            asked_photons: asked.photons,
            ladder: asked.ladder.clone(),
            seeds: asked.seeds.clone(),
            threads: rayon::current_num_threads(),
            reference: results::ReferenceUsed {
                photons: asked.reference.photons(),
                replicates: REPLICATES,
                sequence: SEQUENCE.name().into(),
                emission_map: emission_map(self.scene).into(),
                seed: asked.reference.seed,
                own_nrms: reference.own_nrms().to_vec(),
                factor: asked.reference.photons() as f64 / asked.photons as f64,
            },
            variants: asked.algorithms.iter().zip(runs).map(variant).collect(),
            warnings: asked.grids.warnings.clone(),
        }))
    }

    /// The reference and its key; `None` after an interrupt.
    fn reference(&self) -> Result<Option<(Reference<'_>, String)>> {
        let plan = &self.asked.reference;
        let key = format!(
            "{}\nreference: {} seed {}, {REPLICATES} x {} photons, {}\ngrids: {:?} of {:?}",
            scene_key(self.scene),
            SEQUENCE.name(),
            plan.seed,
            plan.photons_per_replicate,
            emission_map(self.scene),
            self.asked.grids.labels,
            self.asked.grids.names,
        );
        let cells = self.asked.grids.cell_count();
        let mut replicates = Vec::new();
        for replicate in 0..REPLICATES {
            self.kept.progress.phase(format!("reference {} of {REPLICATES}", replicate + 1));
            let part = format!("{key}\nreplicate {replicate}");
            let found = self.kept.found("reference", &part);
            if let Some(counts) = found.and_then(|bytes| from_bytes(&bytes, cells)) {
                self.kept.progress.inc(plan.photons_per_replicate);
                replicates.push(counts);
                continue;
            }
            let traced = trace_replicate(&self.asked.grids, plan, replicate, &INTERRUPTED, &|n| {
                self.kept.progress.inc(n);
            })?;
            let Some(counts) = traced else { return Ok(None) };
            self.kept.parts.store("reference", &part, &to_bytes(&counts))?;
            replicates.push(counts);
        }
        Ok(Some((Reference::new(&self.asked.grids, plan, &replicates)?, key)))
    }

    /// Every run that is finished, by variant. Variants take turns, so that a machine that gets slower or faster does so
    /// for all of them.
    fn runs(&self, reference: &Reference<'_>, reference_key: &str) -> Result<Vec<Vec<Run>>> {
        let asked = &self.asked;
        let mut runs = vec![Vec::new(); asked.algorithms.len()];
        for (k, seed) in asked.seeds.iter().enumerate() {
            for (algorithm, runs_of) in asked.algorithms.iter().zip(&mut runs) {
                if !asked.seeds_of(*algorithm).contains(seed) {
                    continue;
                }
                self.kept.progress.phase(format!(
                    "{}, seed {} of {}",
                    algorithm.name(),
                    k + 1,
                    asked.seeds.len()
                ));
                match self.run(reference, *algorithm, *seed, reference_key)? {
                    Some(found) => runs_of.extend(found),
                    None => return Ok(runs),
                }
            }
        }
        Ok(runs)
    }

    /// One point set of one algorithm, found or traced; `None` after an interrupt.
    fn run(
        &self,
        reference: &Reference<'_>,
        algorithm: Algorithm,
        seed: u64,
        reference_key: &str,
    ) -> Result<Option<Vec<Run>>> {
        let asked = &self.asked;
        let key = format!("{reference_key}\nrun: {} seed {seed}, N {:?}", algorithm.name(), asked.ladder);
        self.kept.part("run", &key, asked.photons_of(algorithm), |progress| {
            reference.measure(algorithm, seed, &asked.ladder, processor_time, &INTERRUPTED, progress)
        })
    }
}
