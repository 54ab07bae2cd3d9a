//! Cells of receivers that a scene leaves undivided, chosen once before a run.

use std::sync::atomic::AtomicBool;

use crate::error::Result;
use crate::estimate::replicates::standard_error_of_total;
use crate::scene::Scene;
use crate::scene::receiver::{DividedBy, Receiver};
use crate::tally::Moments;

use super::plan::{Plan, Settings};
use super::replicates::trace;

/// Relative standard error that a cell is to have.
pub const CELL_ERROR: f64 = 0.02;

/// Grids of the pilot: 1, 4, ..., 4^6 cells.
const LEVELS: u32 = 7;

/// The pilot's photons: this part of the run's, within these bounds.
const PART: u64 = 64;
const FEWEST_PHOTONS: u64 = 1 << 10;
const MOST_PHOTONS: u64 = 1 << 16;

/// Most cells along a side that a pilot chooses.
pub const MOST_BY_PILOT: u32 = 1024;
/// Cells along the longer side. A map of fewer shows nothing; more are for those who ask.
const COUNTS: [u32; 15] = [8, 12, 16, 24, 32, 48, 64, 96, 128, 192, 256, 384, 512, 768, MOST_BY_PILOT];

/// Whether cells are as few or as many as a pilot chooses, so that their error may be another than [`CELL_ERROR`].
pub fn is_at_bound(cells: [u32; 2]) -> Option<&'static str> {
    let [fewest, .., most] = COUNTS;
    match cells[0].max(cells[1]) {
        n if n <= fewest => Some("the fewest"),
        n if n >= most => Some("the most"),
        _ => None,
    }
}

/// How many times as long as the other side u is on a surface that goes round: about pi on a sphere.
const ROUND: f64 = 3.0;

/// Divides the receivers of a scene that have no `cells` so that a cell's standard error is about 2 % after this
/// plan's photons: half of the light falls on cells of less. Cells are about square in metres. They depend on the scene
/// and the number of photons alone, so that maps of other seeds and variants have the same.
///
/// # Errors
/// An interrupt; a ledger that does not balance (a defect of the program).
pub fn choose_cells(scene: &mut Scene, plan: &Plan, interrupt: &AtomicBool) -> Result<()> {
    let receivers = std::mem::take(&mut scene.receivers);
    let far_fields = std::mem::take(&mut scene.far_fields);
    let is_open = |receiver: &&Receiver| receiver.divided_by == DividedBy::Default;
    let level = |receiver: &Receiver, k: u32| {
        let mut divided = receiver.divided([1 << k; 2], DividedBy::Pilot);
        (divided.grid, divided.spot) = (None, None);
        divided
    };
    scene.receivers =
        receivers.iter().filter(is_open).flat_map(|r| (0..LEVELS).map(move |k| level(r, k))).collect();
    let errors = if scene.receivers.is_empty() { Ok(Vec::new()) } else { errors(scene, plan, interrupt) };
    (scene.receivers, scene.far_fields) = (receivers, far_fields);
    let open = scene.receivers.iter_mut().filter(|r| r.divided_by == DividedBy::Default);
    for (receiver, errors) in open.zip(errors?) {
        let aspect = receiver.size_m.map_or(ROUND, |[u, v]| u / v);
        *receiver = receiver.divided(counts(cells(&errors), aspect), DividedBy::Pilot);
    }
    Ok(())
}

/// Of each receiver and level: cells that a run of this plan could have with the error that the pilot has, and that error;
/// `None` where nothing arrived.
type Errors = [Option<(f64, f64)>; LEVELS as usize];

fn errors(scene: &Scene, plan: &Plan, interrupt: &AtomicBool) -> Result<Vec<Errors>> {
    let photons = (plan.photons() / PART).clamp(FEWEST_PHOTONS, MOST_PHOTONS).min(plan.photons());
    let pilot = Plan::new(&Settings { photons: Some(photons), ..Settings::default() })?;
    let outcome = trace(scene, &pilot, interrupt, &|_| {})?;
    // An error hangs on photons a cell, whether they are counted (their number to the power -1/2) or evenly spread.
    let more = plan.photons() as f64 / outcome.photons as f64;
    let of_level =
        |cells: &Moments| Some((cells.sum.len() as f64 * more, typical_error(cells, outcome.replicates)?));
    let of_receiver = |levels: &[Moments]| std::array::from_fn(|k| of_level(&levels[k]));
    Ok(outcome.cells().chunks_exact(LEVELS as usize).map(of_receiver).collect())
}

/// The relative standard error below which half of the light falls.
fn typical_error(cells: &Moments, replicates: u32) -> Option<f64> {
    let counts = cells.sum.iter().zip(&cells.square).filter(|(sum, _)| **sum > 0);
    let mut errors = counts
        .map(|(&sum, &square)| {
            let error = standard_error_of_total(sum, square, replicates)?;
            Some((error / sum as f64, sum))
        })
        .collect::<Option<Vec<_>>>()?;
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let light: u64 = errors.iter().map(|(_, sum)| sum).sum();
    let mut below = 0;
    errors
        .iter()
        .find(|(_, sum)| {
            below += sum;
            2 * below >= light
        })
        .map(|(error, _)| *error)
}

/// Number of cells with the error wanted, between two levels by a power law, beyond them by counting's.
fn cells(errors: &Errors) -> f64 {
    let known: Vec<_> = errors.iter().flatten().collect();
    let by_counting = |(cells, error): &(f64, f64)| cells * (CELL_ERROR / error).powi(2);
    let fine = known.iter().rposition(|(_, error)| *error <= CELL_ERROR);
    match (fine, known.first()) {
        (None, None) => 0.0,
        (None, Some(coarsest)) => by_counting(coarsest),
        (Some(last), _) if last + 1 == known.len() => by_counting(known[last]),
        (Some(at), _) => {
            let ((n0, e0), (n1, e1)) = (known[at], known[at + 1]);
            let part = libm::log(CELL_ERROR / e0) / libm::log(e1 / e0);
            n0 * libm::pow(n1 / n0, part)
        }
    }
}

/// Cells along u and v, about square on sides of this quotient.
fn counts(cells: f64, aspect: f64) -> [u32; 2] {
    let stretch = aspect.max(1.0 / aspect);
    let wanted = libm::sqrt(cells * stretch);
    // The nearest by quotient: below the geometric mean of neighbours the smaller one.
    let is_below = |pair: &[u32]| wanted * wanted < f64::from(pair[0]) * f64::from(pair[1]);
    let at = COUNTS.windows(2).position(is_below).unwrap_or(COUNTS.len() - 1);
    let longer = COUNTS[at];
    let shorter = (f64::from(longer) / stretch).round().max(1.0) as u32;
    if aspect >= 1.0 { [longer, shorter] } else { [shorter, longer] }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counting: an error of 1 / sqrt(photons a cell), here of 2^20 photons in the end.
    #[test]
    fn cells_follow_from_the_errors_of_the_levels() {
        let n = f64::from(1 << 20);
        let by_counting = std::array::from_fn(|k| {
            let cells = 64.0 * f64::from(1_u32 << (2 * k as u32));
            Some((cells, (cells / n).sqrt()))
        });
        let wanted = 0.0004 * n;
        assert!((cells(&by_counting) / wanted - 1.0).abs() < 1e-12);
        // All levels too fine, all too coarse, one known alone: the law of counting goes on.
        for levels in [0..1, 6..7, 2..4] {
            let few = std::array::from_fn(|k| by_counting[k].filter(|_| levels.contains(&k)));
            assert!((cells(&few) / wanted - 1.0).abs() < 1e-12, "{levels:?}");
        }
        assert_eq!(cells(&[None; LEVELS as usize]), 0.0);
    }

    #[test]
    fn cells_are_square_within_their_steps() {
        assert_eq!(counts(64.0 * 64.0, 1.0), [64, 64]);
        assert_eq!(counts(2.0 * 64.0 * 64.0, 0.5), [64, 128]);
        assert_eq!(counts(1000.0, 3.0), [48, 16]);
        // The ends: no fewer than 8 along the longer side, no more than 1024.
        assert_eq!((counts(0.0, 2.0), counts(1e12, 100.0)), ([8, 4], [1024, 10]));
        assert_eq!(
            [[8, 4], [10, 1024], [12, 4]].map(is_at_bound),
            [Some("the fewest"), Some("the most"), None]
        );
        // Between 96 and 128 the geometric mean decides: 110.85^2 = 12288.
        assert_eq!((counts(12_280.0, 1.0), counts(12_300.0, 1.0)), ([96, 96], [128, 128]));
    }

    #[test]
    fn the_typical_error_is_that_of_half_of_the_light() {
        let of = |replicates: [&[u64]; 2]| {
            let mut cells = Moments::new(replicates[0].len());
            replicates.into_iter().for_each(|counts| cells.absorb(counts.iter().copied()));
            typical_error(&cells, 2)
        };
        // 100 + 100 is off by the photon that a total always is, 60 + 40 by 20.
        assert_eq!(of([&[100, 60, 1], &[100, 40, 0]]), Some(1.0 / 200.0));
        assert_eq!(of([&[0, 60, 1], &[0, 40, 0]]), Some(0.2));
        assert_eq!(of([&[0], &[0]]), None);
    }
}
