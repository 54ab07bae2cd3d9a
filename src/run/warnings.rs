//! What a run says of itself: where it was found that the scene is not what its numbers would be right for, when it was
//! built and by the photons.

use crate::error::warning::{Severity, Warning, four_digits};
use crate::error::words::quoted_names;
use crate::geometry::{Shape, SurfaceId};
use crate::scene::Scene;
use crate::scene::inside::LAMP_INSIDE;
use crate::scene::receiver::ReceiverSide;
use crate::scene::sheets::{CLASH, Clash};
use crate::transport::mixed::{self, Witness};

use super::dark;
use super::goal::REPLICATES;
use super::kept::are_kept;
use super::{Outcome, StoppedBy};

/// The code of light that total reflection keeps.
pub const TRAPPED: &str = "trapped";
/// The code of a lamp whose light meets nothing.
const AIMED_AWAY: &str = "aimed-away";

/// Of all photons: more than this is missing, and it is more than a receiver's error can hide.
const MISSING_IN_DOUBT: f64 = 1e-6;
/// And more than this is a wrong number.
const MISSING_WRONG: f64 = 1e-3;
/// Smooth normals that turn more than this share of photons back change what a mesh does.
const CORRECTED: f64 = 0.01;
/// Smooth normals this far off their facets round an edge.
const OF_AN_EDGE_DEG: f64 = 30.0;
/// Of an emitter's photons: meeting nothing, this many are no accident.
const MISSED: f64 = 0.999;
/// Of so many, at least: a few may miss by chance.
const FEWEST_EMITTED: u64 = 1000;
/// Of a receiver on whose side nothing arrives: so many on the other one are no accident.
const FEWEST_TURNED_AWAY: u64 = 16;
/// Of all photons, this share in two media at one place are more than a gap at a rim.
const MIXED: f64 = 1e-3;

/// The warnings of a finished run, the gravest first.
pub fn warnings(scene: &Scene, outcome: &Outcome) -> Vec<Warning> {
    let run = Run { scene, outcome, photons: (outcome.photons as f64).max(1.0) };
    let mut all: Vec<Warning> = run.contradicted().collect();
    // What photons have met is told with its share, and not again.
    let is_met = |s| outcome.census.exceptions.contradicted.contains_key(s);
    let met: Vec<_> = scene.clashes.iter().filter(|c| c.surfaces.iter().any(is_met)).collect();
    let is_told = |found: &Warning| {
        found.code == CLASH
            && met.iter().any(|c| c.surfaces.iter().all(|s| found.surfaces.contains(&run.name(*s))))
    };
    all.extend(scene.found.iter().filter(|found| !is_told(found)).cloned());
    all.extend(run.mixed());
    all.extend(run.lost_in_bodies());
    all.extend(run.trapped());
    all.extend(run.killed());
    all.extend(run.corrected());
    // Of a lamp in a box the receiver on its outside gets nothing, whatever side it counts on.
    let is_shut = |w: &Warning| all.iter().any(|a| a.code == LAMP_INSIDE && a.surfaces == w.surfaces);
    let turned_away: Vec<_> = run.turned_away().filter(|w| !is_shut(w)).collect();
    all.extend(turned_away);
    all.extend(run.aimed_away());
    let is_explained = all.iter().any(|w| [LAMP_INSIDE, AIMED_AWAY].contains(&w.code));
    all.extend(dark::warnings(scene, outcome, is_explained));
    all.extend(run.in_turn());
    all.extend(run.stopped_early());
    all.sort_by_key(|warning| std::cmp::Reverse(warning.severity));
    all
}

/// The warning of a surface that a share of all photons or eye paths reach in another medium than it states.
pub fn contradiction(scene: &Scene, surface: SurfaceId, share: f64, message: String) -> Warning {
    Warning {
        severity: Severity::Untrusted,
        code: "contradicted-medium",
        message,
        surfaces: vec![scene.geometry.name(surface).to_owned()],
        share: Some(share),
        remedy: remedy_of_contradiction(scene, surface).into(),
    }
}

fn remedy_of_contradiction(scene: &Scene, surface: SurfaceId) -> &'static str {
    let is_turned = |clash: &&Clash| clash.same_way && clash.surfaces.contains(&surface);
    if let Some(clash) = scene.clashes.iter().find(is_turned) {
        clash.remedy()
    } else if scene.geometry.is_closed(surface) {
        "leave `ior_outside` away: the medium outside a body is the one that is there"
    } else {
        "if it is the far face of a pane, turn it round so that its front looks out; if the lamp or camera stands behind it, say \
         `medium`; a body with both faces (a box) needs neither"
    }
}

struct Run<'a> {
    scene: &'a Scene,
    outcome: &'a Outcome,
    photons: f64,
}

impl Run<'_> {
    fn name(&self, surface: SurfaceId) -> String {
        self.scene.geometry.name(surface).to_owned()
    }

    fn contradicted(&self) -> impl Iterator<Item = Warning> {
        self.outcome.census.exceptions.contradicted.iter().map(|(&surface, &count)| {
            let (name, share) = (self.name(surface), count as f64 / self.photons);
            let message = format!(
                "light reached surface \"{name}\" in another medium than the scene says is there, {} times a photon",
                times(share)
            );
            contradiction(self.scene, surface, share, message)
        })
    }

    /// Open surfaces that light goes through and past.
    fn mixed(&self) -> impl Iterator<Item = Warning> {
        let contradicted = &self.outcome.census.exceptions.contradicted;
        let found = mixed::probe(self.scene).into_iter();
        found.filter(|m| m.share >= MIXED && !contradicted.contains_key(&m.sheet)).map(|mixed| {
            let (name, [here, there]) = (self.name(mixed.sheet), mixed.media.map(|m| self.scene.media.ior(m)));
            let reach = format!("{} of all photons reach, through the open surface \"{name}\"", percent(mixed.share));
            let directly = |witness: String| {
                format!("{reach} and in a medium of refractive index {here}, what {witness} directly, in one of {there}")
            };
            let message = match mixed.witness {
                Witness::Emitter(i) => directly(format!("emitter \"{}\" lights", self.scene.emitter_names[i])),
                Witness::Camera => directly("the camera sees".to_owned()),
                Witness::Place(surface) => format!(
                    "{reach}, places in a medium of refractive index {here} with nothing between them and places on \"{}\" that \
                     light reaches beside it, in one of {there}",
                    self.name(surface)
                ),
            };
            Warning {
                severity: Severity::Doubtful,
                code: "mixed-media",
                message,
                surfaces: vec![name],
                share: Some(mixed.share),
                remedy: "a pane or a lens has two faces: draw a closed body (a box), or a second sheet whose front looks out on \
                         the other side; the surface of a liquid must reach to the walls that hold it"
                    .into(),
            }
        })
    }

    fn lost_in_bodies(&self) -> impl Iterator<Item = Warning> {
        self.outcome.census.exceptions.lost.iter().map(|(&surface, &count)| {
            let (name, share) = (self.name(surface), count as f64 / self.photons);
            Warning {
                severity: of_missing(share),
                code: "lost-in-body",
                message: format!("{} of all photons left the scene inside \"{name}\"", percent(share)),
                surfaces: vec![name],
                share: Some(share),
                remedy: "look for cracks, or for faces that overlap another body's, in its mesh".into(),
            }
        })
    }

    fn trapped(&self) -> impl Iterator<Item = Warning> {
        self.outcome.ledger.trapped.iter().map(|(&body, &count)| {
            let (name, share) = (self.name(body), count as f64 / self.photons);
            let is_measured = self.scene.receivers.iter().any(|receiver| receiver.surface == body);
            let on_it = if is_measured { "; the receiver on it shows what the limit lets it see" } else { "" };
            Warning {
                severity: if is_measured { Severity::Untrusted } else { Severity::Note },
                code: TRAPPED,
                message: format!(
                    "total reflection keeps {} of all light in \"{name}\" for ever{on_it}",
                    percent(share)
                ),
                surfaces: vec![name],
                share: Some(share),
                remedy: "no clear body does that in reality: what it absorbs, or lets out by its roughness, is not in the \
                         scene"
                    .into(),
            }
        })
    }

    fn killed(&self) -> Option<Warning> {
        let share = self.outcome.ledger.killed as f64 / self.photons;
        (share > 0.0).then(|| Warning {
            severity: of_missing(share),
            code: "killed",
            message: format!(
                "{} of all photons were ended after {} events, before they were absorbed or had left; receivers that \
                 they could still have reached show too little, and their errors leave that out",
                percent(share),
                crate::transport::walk::MAX_EVENTS
            ),
            surfaces: Vec::new(),
            share: Some(share),
            remedy: "give the surfaces between which light goes round a reflectance below 1, or a way out"
                .into(),
        })
    }

    fn corrected(&self) -> Option<Warning> {
        let exceptions = &self.outcome.census.exceptions;
        let share = exceptions.corrected() as f64 / self.photons;
        if share <= CORRECTED {
            return None;
        }
        // The most first; what adds little is not named.
        let mut by_surface: Vec<_> = exceptions.corrected_directions.iter().collect();
        by_surface.sort_by_key(|(_, count)| std::cmp::Reverse(**count));
        let is_many = |count: u64| count as f64 > 0.5 * CORRECTED * self.photons;
        let named = by_surface.iter().enumerate().filter(|(k, (_, count))| *k == 0 || is_many(**count));
        let ids: Vec<SurfaceId> = named.map(|(_, (surface, _))| **surface).collect();
        let surfaces: Vec<String> = ids.iter().map(|s| self.name(*s)).collect();
        let tilt_deg = ids.iter().map(|s| self.tilt_deg(*s)).fold(0.0, f64::max);
        let remedy = if tilt_deg > OF_AN_EDGE_DEG {
            "`smooth = false` for a body with sharp edges (or export it with normals that do not round them); for a curved one a \
             finer mesh, or an exact shape"
        } else {
            "use a finer mesh, or an exact shape"
        };
        Some(Warning {
            severity: Severity::Doubtful,
            code: "corrected-directions",
            message: format!(
                "smooth normals of {}, up to {tilt_deg:.0} degrees off their facets, sent light to the wrong side of the facet, \
                 {} times a photon, and it was mirrored back",
                quoted_names(&surfaces),
                times(share)
            ),
            surfaces,
            share: Some(share),
            remedy: remedy.into(),
        })
    }

    /// The most that smooth normals of a surface turn away from their facets.
    fn tilt_deg(&self, surface: SurfaceId) -> f64 {
        match &self.scene.geometry.surfaces()[surface.0 as usize].shape {
            Shape::Mesh(mesh) => mesh.largest_tilt().to_degrees(),
            _ => 0.0,
        }
    }

    /// Receivers that stay dark although light reaches their other side.
    fn turned_away(&self) -> impl Iterator<Item = Warning> {
        let receivers = self.scene.receivers.iter().enumerate();
        receivers.filter_map(|(i, receiver)| {
            let count = self.outcome.turned_away[i];
            if self.outcome.totals().sum[i] > 0 || count < FEWEST_TURNED_AWAY {
                return None;
            }
            let (side, other) = match receiver.side {
                ReceiverSide::Front => ("back", "back"),
                ReceiverSide::Back => ("front", "front"),
                ReceiverSide::Both => return None,
            };
            let lumens = count as f64 * self.outcome.photon_lm;
            let share = count as f64 / self.photons;
            Some(Warning {
                severity: Severity::Doubtful,
                code: "other-side",
                message: format!(
                    "nothing arrived at receiver \"{}\"; {} lm arrived on its {side}",
                    receiver.name,
                    four_digits(lumens)
                ),
                surfaces: vec![self.name(receiver.surface)],
                share: Some(share),
                remedy: format!("say side = \"{other}\" or \"both\", or turn the surface round"),
            })
        })
    }

    /// Replicates that could not advance together. (Those of a picture never do.)
    fn in_turn(&self) -> Option<Warning> {
        let plan = &self.outcome.plan;
        (self.scene.camera.is_none() && !are_kept(self.scene, plan)).then(|| Warning {
            severity: Severity::Note,
            code: "replicates-in-turn",
            message: format!(
                "the maps of all {} replicates take more than a gibibyte, so these were traced one after another",
                plan.replicates()
            ),
            surfaces: Vec::new(),
            share: None,
            remedy: "fewer cells or replicates, if an interrupted run is to have error bars from the first second on"
                .into(),
        })
    }

    /// An error that decided when to stop, from few replicates.
    fn stopped_early(&self) -> Option<Warning> {
        let outcome = self.outcome;
        let is_few = outcome.stopped_by == StoppedBy::Error && outcome.replicates < REPLICATES;
        is_few.then(|| Warning {
            severity: Severity::Note,
            code: "few-replicates",
            message: format!(
                "the error decided when to stop, and {} replicates find one too small now and then: intervals of 95 % cover \
                 down to 91 %",
                outcome.replicates
            ),
            surfaces: Vec::new(),
            share: None,
            remedy: format!("--replicates {REPLICATES}, or more"),
        })
    }

    /// Emitters whose light meets nothing.
    fn aimed_away(&self) -> impl Iterator<Item = Warning> {
        let ledger = &self.outcome.ledger;
        let missed = self.outcome.census.missed.iter();
        missed.filter_map(move |(&emitter, &count)| {
            let emitted = ledger.emitted[emitter];
            let share = count as f64 / (emitted as f64).max(1.0);
            let is_measured = self.scene.far_fields.iter().any(|field| field.surface.is_none());
            if share < MISSED || emitted < FEWEST_EMITTED || is_measured {
                return None;
            }
            Some(Warning {
                severity: Severity::Doubtful,
                code: AIMED_AWAY,
                message: format!(
                    "{} of the light of emitter \"{}\" leaves the scene without meeting any surface",
                    percent(share),
                    self.scene.emitter_names[emitter]
                ),
                surfaces: Vec::new(),
                share: Some(count as f64 / self.photons),
                remedy: "look at its position and aim: is it below the floor, or turned away?".into(),
            })
        })
    }
}

/// A share in words, with no more digits than it means.
pub fn percent(share: f64) -> String {
    match 100.0 * share {
        p if p >= 10.0 => format!("{p:.0} %"),
        p if p >= 0.01 => format!("{p:.2} %"),
        p => format!("{p:.0e} %"),
    }
}

/// How much it matters that this share of all photons is missing. (A ray that passes through an edge, to the last
/// bit, may be lost: that is no crack.)
fn of_missing(share: f64) -> Severity {
    match share {
        s if s > MISSING_WRONG => Severity::Untrusted,
        s if s > MISSING_IN_DOUBT => Severity::Doubtful,
        _ => Severity::Note,
    }
}

/// How many times a photon something happened, which may be more than once.
fn times(share: f64) -> String {
    match share {
        s if s >= 1.0 => format!("{s:.1}"),
        s if s >= 1e-3 => format!("{s:.3}"),
        s => format!("{s:.0e}"),
    }
}
