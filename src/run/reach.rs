//! The error that a run has, of what it is to reach.

use crate::error::{Diagnostic, Kind, Result};
use crate::estimate::replicates::standard_error_of_cell;
use crate::scene::Scene;

use super::goal::{ErrorGoal, ErrorOf, Goal};
use super::kept::is_together;
use super::outcome::{Estimate, Outcome};
use super::plan::Plan;

impl Goal {
    /// That a scene and a plan can end before all photons are traced.
    ///
    /// # Errors
    /// Points made for their number, maps too large for all replicates at a time: no part of them is a sample. Of an error: one
    /// replicate; nothing to have the error of.
    pub fn check(&self, scene: &Scene, plan: &Plan) -> Result<()> {
        let what = match (&self.error, self.until) {
            (None, None) => return Ok(()),
            (Some(_), _) => "an error to be reached",
            (None, Some(_)) => "a time to be kept",
        };
        if let Some(error) = &self.error {
            error.check(scene, plan)?;
        }
        if is_together(scene, plan) {
            return Ok(());
        }
        let found = format!("{what} by replicates that are traced one after another");
        let required = "replicates together: fewer cells or replicates, a sequence that is not made for its number of points";
        Err(Diagnostic::new(Kind::Range, found, required))
    }
}

impl ErrorGoal {
    /// That replicates together can reach it.
    pub(super) fn check(&self, scene: &Scene, plan: &Plan) -> Result<()> {
        let fail = |found: String, required: &str| Err(Diagnostic::new(Kind::Range, found, required));
        let sequence = plan.algorithm().sequence;
        if plan.replicates() < 2 {
            let found = format!("an error to be reached by one replicate of \"{}\"", sequence.name());
            return fail(found, "several replicates: the points of one set have no spread");
        }
        let of_receivers = !scene.receivers.is_empty();
        let of_far_fields = self.of() == ErrorOf::Flux && !scene.far_fields.is_empty();
        if of_receivers || of_far_fields {
            return Ok(());
        }
        let required = match scene.far_fields.is_empty() {
            true => "a scene with a receiver",
            false => "--error-of flux in a scene of far fields alone",
        };
        fail(format!("the error of {} without a receiver", self.of().name()), required)
    }

    /// The relative standard error that an outcome has, of the receiver where it is largest: infinite where nothing arrived;
    /// `None` where it is not known.
    pub fn measured(&self, scene: &Scene, outcome: &Outcome) -> Option<f64> {
        let relative = |e: Estimate| Some(e.standard_error? / e.value);
        let receivers = scene.receivers.iter().enumerate();
        let of_receivers = receivers.map(|(i, receiver)| match self.of() {
            ErrorOf::Flux => relative(outcome.receiver_flux_lm(i)),
            ErrorOf::Mean => relative(match receiver.grid {
                Some(grid) => outcome.grid(i, grid.area_m2).0,
                None => outcome.receiver_flux_lm(i),
            }),
            ErrorOf::Cells => of_cells(outcome, i, receiver.areas_m2()),
            ErrorOf::Max => {
                outcome.peak_lx(i, receiver.areas_m2()).map(|peak| peak.standard_error / peak.value)
            }
        });
        let far_fields = if self.of() == ErrorOf::Flux { scene.far_fields.len() } else { 0 };
        let of_far_fields = (0..far_fields).map(|i| relative(outcome.far_field_lm(i)[0]));
        let mut largest = 0.0;
        for error in of_receivers.chain(of_far_fields) {
            let error = error?;
            if error.is_nan() || error > largest {
                largest = if error.is_nan() { f64::INFINITY } else { error };
            }
        }
        Some(largest)
    }
}

/// sqrt(mean by area of the squared standard errors of the cells) over the mean illuminance. Cells of few photons owe the error
/// of counting (METHOD 7), so that none is certain.
fn of_cells(outcome: &Outcome, receiver: usize, areas_m2: &[f64]) -> Option<f64> {
    let cells = &outcome.cells()[receiver];
    let area = |cell: usize| areas_m2.get(cell).or(areas_m2.first()).copied().unwrap_or(0.0);
    let (mut squares, mut all_m2, mut photons) = (0.0, 0.0, 0);
    for (cell, (sum, square)) in cells.sum.iter().zip(&cells.square).enumerate() {
        let error = standard_error_of_cell(*sum, *square, outcome.replicates)?;
        let area = area(cell);
        // A face without area takes no photons.
        if area > 0.0 {
            (squares, all_m2, photons) = (squares + error * error / area, all_m2 + area, photons + sum);
        }
    }
    Some((squares * all_m2).sqrt() / photons as f64)
}
