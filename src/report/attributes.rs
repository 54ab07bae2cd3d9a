//! What an EXR says about its run: everything needed to repeat it, and nothing that a repetition would change (no time,
//! thread count, path or date).

use crate::files::exr::Value;
use crate::run::{Outcome, Plan};
use crate::scene::Scene;
use crate::scene::receiver::{Cells, Receiver};
use crate::scene::receiver::{ReceiverEvents, ReceiverSide};

use super::statistics::ReceiverStatistics;
use super::unknown::why_no_error;

/// Attributes of one receiver's map.
pub fn attributes(
    scene: &Scene,
    outcome: &Outcome,
    receiver: &Receiver,
    statistics: &ReceiverStatistics,
) -> Vec<(String, Value)> {
    let mut all = run_attributes(scene, &outcome.plan, outcome.photons, outcome.replicates);
    let mut text = |name: &str, value: &str| all.push((name.to_string(), Value::Text(value.to_string())));
    text("caustix.quantity", "illuminance: flux arriving before the event, per cell area");
    text("caustix.unit.Y", "lx");
    text("caustix.unit.standard_error", "lx");
    text("caustix.unit.hits", "photons");
    text("caustix.receiver", &receiver.name);
    text("caustix.surface", scene.geometry.name(receiver.surface));
    let side = match receiver.side {
        ReceiverSide::Front => "front",
        ReceiverSide::Back => "back",
        ReceiverSide::Both => "both",
    };
    let events = match receiver.events {
        ReceiverEvents::All => "all",
        ReceiverEvents::Direct => "direct",
        ReceiverEvents::Indirect => "indirect",
    };
    let layout = match receiver.cells {
        Cells::Grid { .. } => "row 0, column 0 is the (u = 0, v = 1) corner; u to the right",
        Cells::Faces { .. } => "face number = row * width + column; NaN beyond the last face",
    };
    text("caustix.side", side);
    text("caustix.events", events);
    text("caustix.layout", layout);
    if let Some(most) = statistics.rounded_hits() {
        let why = format!("up to {most} photons in a cell: a float holds 24 binary digits of it");
        text("caustix.hits_rounded", &why);
    }
    if let Some(why) = why_no_error(outcome) {
        text("caustix.standard_error_absent", why);
    }
    let mut number = |name: &str, value: f64| all.push((name.to_string(), Value::F64(value)));
    number("caustix.flux_lm", statistics.flux_lm);
    if let Some(error) = statistics.flux_standard_error_lm {
        number("caustix.flux_standard_error_lm", error);
    }
    number("caustix.area_m2", statistics.area_m2);
    number("caustix.mean_lx", statistics.mean_lx);
    if let Some([width, height]) = receiver.size_m {
        number("caustix.width_m", width);
        number("caustix.height_m", height);
    }
    all
}

/// What every file says: the program, the settings of a run, the number of photons and replicates that its numbers stand for, the
/// scene.
pub fn run_attributes(scene: &Scene, plan: &Plan, photons: u64, replicates: u32) -> Vec<(String, Value)> {
    let mut all = vec![("caustix.emitted_lm".to_string(), Value::F64(scene.emitters.flux_lm()))];
    let mut text = |name: &str, value: &str| all.push((name.to_string(), Value::Text(value.to_string())));
    text("caustix.version", env!("CARGO_PKG_VERSION"));
    let algorithm = plan.algorithm();
    text("caustix.variant", algorithm.variant.name());
    if algorithm.variant.rejects() {
        text("caustix.rejection", algorithm.rejection.name());
    } else {
        text("caustix.solver", algorithm.solver.name());
    }
    text("caustix.sequence", algorithm.sequence.name());
    text("caustix.seed", &plan.seed().to_string());
    text("caustix.photons", &photons.to_string());
    text("caustix.replicates", &replicates.to_string());
    text("caustix.scene.sha256", &scene.identity.sha256);
    text("caustix.scene.text", &scene.identity.text);
    for (i, (file, sha256)) in scene.identity.files.iter().enumerate() {
        text(&format!("caustix.scene.file{i}"), &format!("{sha256}  {file}"));
    }
    all
}
