//! How many photons an error will take, from a pilot.

use std::sync::atomic::AtomicBool;

use crate::error::Result;
use crate::scene::Scene;

use super::goal::{ErrorGoal, Goal, Looks};
use super::kept::is_together;
use super::plan::{Plan, Settings};
use super::replicates::trace_until;

/// Photons of the pilot; a half of them is looked at, too, for the rate at which the error falls.
pub const PILOT: u64 = 1 << 16;

/// What an error is expected to take.
#[derive(Debug, Clone, Copy)]
pub struct Forecast {
    /// The error.
    pub goal: ErrorGoal,
    /// Photons in all.
    pub photons: u64,
    /// Time of tracing here, s.
    pub seconds: f64,
}

/// What each of these errors will take, by a pilot of 2^16 photons; those that a scene cannot have, and those of which no light
/// arrives, are left out. Receivers have their cells.
///
/// # Errors
/// An interrupt; a ledger that does not balance (a defect of the program).
pub fn forecast(scene: &Scene, goals: &[ErrorGoal], interrupt: &AtomicBool) -> Result<Vec<Forecast>> {
    let mut looks = vec![Looks::default(); goals.len()];
    let mut photons_per_s = 0.0;
    let plan =
        |photons| Plan::new(&goals[0].settings(Settings { photons: Some(photons), ..Settings::default() }));
    for photons in [PILOT / 2, PILOT] {
        let plan = plan(photons)?;
        if !is_together(scene, &plan) {
            return Ok(Vec::new());
        }
        let outcome = trace_until(scene, &plan, Goal::default(), interrupt, &|_| {})?;
        photons_per_s = outcome.photons as f64 / outcome.trace_s;
        for (goal, looks) in goals.iter().zip(&mut looks) {
            if goal.check(scene, &plan).is_ok() {
                looks.take(
                    plan.photons_per_replicate(),
                    goal.measured(scene, &outcome).unwrap_or(f64::INFINITY),
                );
            }
        }
    }
    let replicates = u64::from(plan(PILOT)?.replicates());
    let of = |(goal, looks): (&ErrorGoal, Looks)| {
        let photons = looks.expected(goal.relative())?.saturating_mul(replicates);
        Some(Forecast { goal: *goal, photons, seconds: photons as f64 / photons_per_s })
    };
    Ok(goals.iter().zip(looks).filter_map(of).collect())
}
