//! What a run says of itself: where its photons found that the scene is not what its numbers would be right for.

use crate::error::warning::{Severity, Warning};
use crate::geometry::SurfaceId;
use crate::scene::Scene;
use crate::scene::receiver::ReceiverSide;

use super::Outcome;

/// Of a photon's flux: killed walks that take away more than this are more than a receiver's error can hide.
const KILLED_IN_DOUBT: f64 = 1e-6;
/// And more than this is a wrong number.
const KILLED_WRONG: f64 = 1e-3;
/// Smooth normals that turn more than this share of photons back change what a mesh does.
const CORRECTED: f64 = 0.01;
/// Of an emitter's photons: meeting nothing, this many are no accident.
const MISSED: f64 = 0.999;

/// The warnings of a finished run, the gravest first.
pub fn warnings(scene: &Scene, outcome: &Outcome) -> Vec<Warning> {
    let run = Run { scene, outcome, photons: (outcome.photons as f64).max(1.0) };
    let mut all: Vec<Warning> = run.contradicted().collect();
    all.extend(run.lost_in_bodies());
    all.extend(run.trapped());
    all.extend(run.killed());
    all.extend(run.corrected());
    all.extend(run.turned_away());
    all.extend(run.aimed_away());
    all.sort_by_key(|warning| std::cmp::Reverse(warning.severity));
    all
}

struct Run<'a> {
    scene: &'a Scene,
    outcome: &'a Outcome,
    photons: f64,
}

impl Run<'_> {
    fn name(&self, surface: SurfaceId) -> String {
        self.scene.geometry.surfaces()[surface.0 as usize].name.clone()
    }

    /// A share in words, with no more digits than it means.
    fn percent(share: f64) -> String {
        match 100.0 * share {
            p if p >= 10.0 => format!("{p:.0} %"),
            p if p >= 0.01 => format!("{p:.2} %"),
            p => format!("{p:.0e} %"),
        }
    }

    fn contradicted(&self) -> impl Iterator<Item = Warning> {
        self.outcome.census.exceptions.contradicted.iter().map(|(&surface, &count)| {
            let (name, share) = (self.name(surface), count as f64 / self.photons);
            let is_open = !self.scene.geometry.is_closed(surface);
            let remedy = if is_open {
                "if it is the far face of a pane, turn it round so that its front looks out; if the lamp or camera stands \
                 behind it, say `medium`; a body with both faces (a box) needs neither"
            } else {
                "leave `ior_outside` away: the medium outside a body is the one that is there"
            };
            Warning {
                severity: Severity::Untrusted,
                code: "contradicted-medium",
                message: format!(
                    "light reached surface \"{name}\" in another medium than the scene says is there, {} times a photon",
                    Self::percent(share)
                ),
                surfaces: vec![name],
                share: Some(share),
                remedy: remedy.into(),
            }
        })
    }

    fn lost_in_bodies(&self) -> impl Iterator<Item = Warning> {
        self.outcome.census.exceptions.lost.iter().map(|(&surface, &count)| {
            let (name, share) = (self.name(surface), count as f64 / self.photons);
            Warning {
                severity: Severity::Untrusted,
                code: "lost-in-body",
                message: format!("{} of all photons left the scene inside \"{name}\"", Self::percent(share)),
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
                code: "trapped",
                message: format!(
                    "total reflection keeps {} of all light in \"{name}\" for ever{on_it}",
                    Self::percent(share)
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
        let severity = match share {
            0.0 => return None,
            s if s > KILLED_WRONG => Severity::Untrusted,
            s if s > KILLED_IN_DOUBT => Severity::Doubtful,
            _ => Severity::Note,
        };
        Some(Warning {
            severity,
            code: "killed",
            message: format!(
                "{} of all photons were ended after {} events, before they were absorbed or had left; receivers that \
                 they could still have reached show too little, and their errors leave that out",
                Self::percent(share),
                crate::transport::walk::MAX_EVENTS
            ),
            surfaces: Vec::new(),
            share: Some(share),
            remedy: "give the surfaces between which light goes round a reflectance below 1, or a way out"
                .into(),
        })
    }

    fn corrected(&self) -> Option<Warning> {
        let share = self.outcome.census.exceptions.corrected_directions as f64 / self.photons;
        (share > CORRECTED).then(|| Warning {
            severity: Severity::Doubtful,
            code: "corrected-directions",
            message: format!(
                "smooth normals sent light to the wrong side of its facet, {} times a photon, and it was mirrored back",
                Self::percent(share)
            ),
            surfaces: Vec::new(),
            share: Some(share),
            remedy: "use a finer mesh, or an exact shape".into(),
        })
    }

    /// Receivers that stay dark although light reaches their other side.
    fn turned_away(&self) -> impl Iterator<Item = Warning> {
        let receivers = self.scene.receivers.iter().enumerate();
        receivers.filter_map(|(i, receiver)| {
            let count = self.outcome.turned_away[i];
            if self.outcome.totals().sum[i] > 0 || count == 0 {
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

    /// Emitters whose light meets nothing.
    fn aimed_away(&self) -> impl Iterator<Item = Warning> {
        let ledger = &self.outcome.ledger;
        let missed = self.outcome.census.missed.iter();
        missed.filter_map(move |(&emitter, &count)| {
            let share = count as f64 / (ledger.emitted[emitter] as f64).max(1.0);
            if share < MISSED {
                return None;
            }
            Some(Warning {
                severity: Severity::Doubtful,
                code: "aimed-away",
                message: format!(
                    "{} of the light of emitter \"{}\" leaves the scene without meeting any surface",
                    Self::percent(share),
                    self.scene.emitter_names[emitter]
                ),
                surfaces: Vec::new(),
                share: Some(count as f64 / self.photons),
                remedy: "look at its position and aim: is it below the floor, or turned away?".into(),
            })
        })
    }
}

/// Four significant digits.
fn four_digits(x: f64) -> String {
    let digits = if x > 0.0 { (3 - x.log10().floor() as i32).clamp(0, 12) } else { 0 };
    format!("{x:.*}", digits as usize)
}
