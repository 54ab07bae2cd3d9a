//! Healthy runs of scenes whose light has a closed form, and how often their diagnosis doubts them.

use caustix::report::json::Report;
use caustix::report::statistics::ReceiverStatistics;
use caustix::run::Outcome;
use caustix::scene::Scene;
use caustix::sequence::Sequence;
use rayon::prelude::*;

use super::scenes::{run, scene};

/// Figures of one receiver of a run.
#[derive(Debug, Clone)]
pub struct Figures {
    pub verdict: &'static str,
    pub says: String,
    pub rate: Option<[f64; 2]>,
    pub drift: Option<[f64; 2]>,
    pub ratio: Option<f64>,
}

/// What report.json says of all receivers of an outcome.
pub fn figures(scene: &Scene, outcome: &Outcome) -> Vec<Figures> {
    let receivers = scene.receivers.iter().enumerate();
    let statistics: Vec<_> = receivers.map(|(i, r)| ReceiverStatistics::new(outcome, r, i)).collect();
    let files = vec![Vec::new(); statistics.len()];
    let report = Report::new(scene, outcome, &statistics, &files, 1.0);
    let of = report.receivers.iter().filter_map(|receiver| receiver.diagnosis.as_ref());
    of.map(|of| Figures {
        verdict: of.verdict,
        says: of.says.clone(),
        rate: of.rate.map(|rate| [rate.value, rate.standard_error]),
        drift: of.drift.map(|drift| [drift.relative, drift.standard_error]),
        ratio: of.independent_variance_ratio,
    })
    .collect()
}

const BLACK: &str = "[material.black]\ntype = \"absorber\"\n";

/// An isotropic lamp 1 m above a black plate, of which it lights `side` by `side` metres: discontinuous in two coordinates.
pub fn plate(side: f64) -> Scene {
    let corner = -0.5 * side;
    scene(&format!(
        "{BLACK}[[emitter]]\ntype = \"isotropic\"\nposition = [0.13, -0.21, 1]\nflux_lm = 1000\n[[surface]]\nname = \"plate\"\n\
         type = \"rectangle\"\nmaterial = \"black\"\ncorner = [{corner}, {corner}, 0]\nedge_u = [{side}, 0, 0]\n\
         edge_v = [0, {side}, 0]\n[[receiver]]\nsurface = \"plate\"\ncells = [1, 1]\n"
    ))
}

/// Four such plates around a lamp, a receiver each.
pub fn plates() -> Scene {
    let plate = |(i, [x, y]): (usize, [f64; 2])| {
        format!(
            "[[surface]]\nname = \"plate {i}\"\ntype = \"rectangle\"\nmaterial = \"black\"\ncorner = [{x}, {y}, 0]\nedge_u = [1.3, 0, 0]\n\
             edge_v = [0, 1, 0]\n[[receiver]]\nname = \"plate{i}\"\nsurface = \"plate {i}\"\ncells = [1, 1]\n"
        )
    };
    let corners = [[-1.4, -1.2], [0.1, -1.2], [-1.4, 0.1], [0.1, 0.1]];
    let plates: String = corners.into_iter().enumerate().map(plate).collect();
    scene(&format!(
        "{BLACK}[[emitter]]\ntype = \"isotropic\"\nposition = [0.03, -0.11, 0.4]\nflux_lm = 1000\n{plates}"
    ))
}

/// A lamp in a grey ball, at which photons arrive several times: a sum over reflections.
pub fn ball() -> Scene {
    scene(
        "[material.grey]\ntype = \"lambertian\"\nreflectance = 0.5\n[[emitter]]\ntype = \"isotropic\"\n\
         position = [0.23, -0.31, 0.17]\nflux_lm = 1000\n[[surface]]\nname = \"ball\"\ntype = \"sphere\"\nmaterial = \"grey\"\n\
         center = [0, 0, 0]\nradius = 1\n[[receiver]]\nsurface = \"ball\"\nside = \"back\"\ncells = [1, 1]\n",
    )
}

/// The figures of runs of these seeds.
pub fn of_seeds(
    scene: &Scene,
    sequence: Sequence,
    (per_replicate, replicates): (u64, u32),
    seeds: std::ops::Range<u64>,
) -> Vec<Vec<Figures>> {
    let of = |seed| figures(scene, &run(scene, sequence, per_replicate, replicates, seed));
    seeds.into_par_iter().map(of).collect()
}

/// Runs of which a receiver is doubted.
pub fn doubted(runs: &[Vec<Figures>]) -> usize {
    runs.iter().filter(|of| of.iter().any(|receiver| receiver.verdict == "doubtful")).count()
}

/// Mean of numbers and its standard error.
pub fn mean(numbers: &[f64]) -> [f64; 2] {
    let n = numbers.len() as f64;
    let mean = numbers.iter().sum::<f64>() / n;
    let square = numbers.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / (n - 1.0);
    [mean, (square / n).sqrt()]
}

/// The rates of all receivers, and the errors that they give themselves.
pub fn rates(runs: &[Vec<Figures>]) -> [Vec<f64>; 2] {
    let all = || runs.iter().flatten().filter_map(|of| of.rate);
    [all().map(|[rate, _]| rate).collect(), all().map(|[_, error]| error).collect()]
}
