//! The head of a state: what a run is of, and what must be the same to go on from it.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::error::words::grouped;
use crate::error::{Diagnostic, Kind, Result};
use crate::files::excerpt::cut;
use crate::run::goal::Looks;
use crate::run::kept::is_together;
use crate::run::pilot::MOST_BY_PILOT;
use crate::run::replicates::Course;
use crate::run::turns::Turns;
use crate::run::{Algorithm, ErrorGoal, ErrorOf, Plan, Settings};
use crate::scene::Scene;
use crate::scene::camera::Method;
use crate::scene::receiver::Receiver;

/// What a run is of: what must be the same for a state to be gone on from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// Version of the program: another one may trace other photons.
    caustix: String,
    /// The scene as it was named.
    pub scene: String,
    /// SHA-256 of what its results depend on.
    scene_sha256: String,
    /// The algorithm, by name.
    algorithm: String,
    seed: u64,
    photons_per_replicate: u64,
    /// Replicates.
    pub replicates: u32,
    /// How they are traced.
    way: Way,
    /// The indices of every replicate that this is of.
    pub(super) part: [u64; 2],
    /// Which part of how many, counted from 1, where it is one.
    pub part_of: Option<[u32; 2]>,
    /// The index up to which all replicates are traced; in turn: of the replicate at hand.
    done: u64,
    /// Photons traced, over all replicates.
    traced: u64,
    /// Cells along u and v of the receivers that a pilot divided.
    cells: Vec<Option<[u32; 2]>>,
    /// Units of a photon in far fields.
    pub(super) units_of_a_photon: u64,
    /// The error to be reached, as a fraction, and what it is of.
    goal: Option<(f64, String)>,
    pub(super) looks: Looks,
    trace_s: f64,
}

/// How the replicates of a run are traced, and what is kept of them.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// Together.
    Together,
    /// In turn, for receivers alone.
    InTurn,
    /// In turn, for a picture from photon maps.
    Map,
    /// In turn, for a picture of splats.
    Splat,
}

impl Way {
    /// That of a scene and a plan.
    fn of(scene: &Scene, plan: &Plan, is_part: bool) -> Self {
        match &scene.camera {
            _ if is_part => Self::Together,
            Some(camera) if camera.method == Method::Splat => Self::Splat,
            Some(_) => Self::Map,
            None if is_together(scene, plan) => Self::Together,
            None => Self::InTurn,
        }
    }
}

impl Head {
    /// Of replicates together, where they are.
    pub fn of(course: &Course<'_>, goal: Option<ErrorGoal>, part_of: Option<[u32; 2]>) -> Self {
        let run = &course.run;
        let traced = (run.done(), run.photons());
        Self {
            part_of,
            goal: goal.map(|goal| (goal.relative(), goal.of().name().to_owned())),
            looks: course.looks.clone(),
            trace_s: course.trace_s,
            way: Way::Together,
            ..Self::new((run.scene(), run.plan()), run.part(), traced, run.units_of_a_photon())
        }
    }

    /// Of replicates in turn, where they are.
    pub fn of_turns(turns: &Turns<'_>) -> Self {
        let (plan, traced) = (turns.plan(), (turns.tracer.photons, turns.photons()));
        let (all, units) =
            (0..plan.photons_per_replicate(), turns.receivers.far_fields().units_of_a_photon());
        Self { trace_s: turns.trace_s(), ..Self::new((turns.scene(), plan), all, traced, units) }
    }

    fn new(
        (scene, plan): (&Scene, &Plan),
        part: Range<u64>,
        (done, traced): (u64, u64),
        units_of_a_photon: u64,
    ) -> Self {
        Self {
            caustix: env!("CARGO_PKG_VERSION").to_owned(),
            scene: scene.identity.name.clone(),
            scene_sha256: scene.identity.results.clone(),
            algorithm: plan.algorithm().name(),
            seed: plan.seed(),
            photons_per_replicate: plan.photons_per_replicate(),
            replicates: plan.replicates(),
            way: Way::of(scene, plan, false),
            part: [part.start, part.end],
            part_of: None,
            done,
            traced,
            cells: scene.receivers.iter().map(Receiver::cells_by_pilot).collect(),
            units_of_a_photon,
            goal: None,
            looks: Looks::default(),
            trace_s: 0.0,
        }
    }

    /// The settings of its run.
    ///
    /// # Errors
    /// An algorithm that this version does not have.
    pub fn settings(&self) -> Result<Settings> {
        let photons = self.photons_per_replicate.checked_mul(self.replicates.into());
        Ok(Settings {
            photons: Some(photons.unwrap_or(u64::MAX)),
            replicates: Some(self.replicates),
            seed: self.seed,
            algorithm: Algorithm::parse(&self.algorithm)?,
        })
    }

    /// The error that its run was to reach.
    pub fn goal(&self) -> Option<ErrorGoal> {
        let (relative, of) = self.goal.as_ref()?;
        ErrorGoal::new(*relative, ErrorOf::from_name(of)?).ok()
    }

    /// Photons of each replicate, and how many of this part are traced.
    pub fn photons(&self) -> (u64, u64) {
        (self.photons_per_replicate, self.done.saturating_sub(self.part[0]))
    }

    /// Photons traced, over all replicates.
    pub fn traced(&self) -> u64 {
        self.traced
    }

    /// Whether all of its photons are traced.
    pub fn is_done(&self) -> bool {
        self.done == self.part[1]
    }

    /// Time of tracing, s.
    pub fn trace_s(&self) -> f64 {
        self.trace_s
    }

    /// That another state is of a part of the same run.
    ///
    /// # Errors
    /// What differs, by name.
    pub fn check_same_run(&self, other: &Self) -> Result<()> {
        let of = |head: &Self| head.part_of.map_or(1, |[_, of]| of);
        let differs = |what: &str, [found, required]: [&dyn std::fmt::Display; 2]| {
            let of_other = format!("a state of another run: {what} {found}");
            Err(Diagnostic::new(Kind::Range, of_other, format!("{what} {required}, as of the first")))
        };
        if other.caustix != self.caustix {
            return differs("by caustix", [&cut(&other.caustix), &cut(&self.caustix)]);
        }
        if other.scene_sha256 != self.scene_sha256 || other.cells != self.cells {
            return differs(
                "of the scene",
                [&cut(&other.scene), &format!("{} as it was there", cut(&self.scene))],
            );
        }
        if other.algorithm != self.algorithm {
            return differs("by", [&cut(&other.algorithm), &cut(&self.algorithm)]);
        }
        for (what, found, required) in [
            ("with seed", other.seed, self.seed),
            ("with photons a replicate:", other.photons_per_replicate, self.photons_per_replicate),
            ("with replicates:", other.replicates.into(), self.replicates.into()),
            ("with parts:", of(other).into(), of(self).into()),
        ] {
            if found != required {
                return differs(what, [&found, &required]);
            }
        }
        Ok(())
    }

    /// That it is of the indices that its part of the run has.
    ///
    /// # Errors
    /// Another number of photons since.
    pub fn check_part(&self, plan: &Plan) -> Result<()> {
        let Some([k, of]) = self.part_of else { return Ok(()) };
        let [start, end] = self.part;
        if (start..end) == plan.part([k, of]) {
            return Ok(());
        }
        let n = grouped(plan.photons_per_replicate());
        let found = format!(
            "part {k} of {of} of a run of another number of photons: indices {start} to {end} of each replicate"
        );
        let required = format!(
            "those of {n} photons a replicate: photons are added to a run when its parts are merged, not to its parts"
        );
        Err(Diagnostic::new(Kind::Range, found, required))
    }

    /// Divides the receivers of a scene as the run's pilot did.
    pub fn divide(&self, scene: &mut Scene) {
        for (receiver, cells) in scene.receivers.iter_mut().zip(&self.cells) {
            cells.iter().for_each(|cells| receiver.take_cells_of_pilot(*cells));
        }
    }

    /// That it is of the photons of a scene and a plan, however many.
    ///
    /// # Errors
    /// What differs, by name.
    pub fn check_photons(&self, scene: &Scene, plan: &Plan) -> Result<()> {
        let version = env!("CARGO_PKG_VERSION");
        let is_scene = self.scene_sha256 == scene.identity.results;
        let is_possible = |n: &u32| (1..=MOST_BY_PILOT).contains(n);
        let is_divided = self.cells.len() == scene.receivers.len()
            && self.cells.iter().flatten().flatten().all(is_possible);
        let differs = |found: String, required: String| Err(Diagnostic::new(Kind::Range, found, required));
        if self.caustix != version {
            let found = format!("the state of a run by caustix {}", cut(&self.caustix));
            return differs(
                found,
                format!("one by caustix {version}: another version may trace other photons"),
            );
        }
        if !(is_scene && is_divided) {
            let found =
                format!("the state of a run of another scene, or of {} as it was before", cut(&self.scene));
            return differs(found, format!("one of {} as it is now, files included", scene.identity.name));
        }
        let name = plan.algorithm().name();
        if (&self.algorithm, self.seed) != (&name, plan.seed()) {
            let found = format!("the state of a run by {}, seed {}", cut(&self.algorithm), self.seed);
            return differs(found, format!("one by {name}, seed {}", plan.seed()));
        }
        Ok(())
    }

    /// That it is of a scene and a plan: of the same photons, of which there may be more now, in more replicates.
    ///
    /// # Errors
    /// What differs, by name.
    pub fn check(&self, scene: &Scene, plan: &Plan) -> Result<()> {
        self.check_photons(scene, plan)?;
        let differs = |found: String, required: String| Err(Diagnostic::new(Kind::Range, found, required));
        let number = |n: u64, replicates: u32| format!("{replicates} replicates of {} photons", grouped(n));
        let required = number(plan.photons_per_replicate(), plan.replicates());
        if Way::of(scene, plan, self.part_of.is_some()) != self.way
            || (self.way != Way::Together && !self.is_of_plan(plan))
        {
            let kept = number(self.photons_per_replicate, self.replicates);
            let found = format!("the state of a run of {kept}, one replicate after another");
            let why = "nothing can be added to replicates that are traced in turn, as those of pictures are";
            return differs(found, format!("one of {required}: {why}"));
        }
        if self.done > plan.photons_per_replicate() || self.replicates > plan.replicates() {
            let found = format!("the state of {}", number(self.done, self.replicates));
            return differs(
                found,
                format!("at most the {required} that are asked for: more can be added, none taken away"),
            );
        }
        Ok(())
    }

    fn is_of_plan(&self, plan: &Plan) -> bool {
        (self.photons_per_replicate, self.replicates) == (plan.photons_per_replicate(), plan.replicates())
    }
}
