//! What `caustix check` foretells: photons and time of an error.

use std::sync::atomic::AtomicBool;
use std::time::Duration;

use serde::Serialize;

use crate::error::{Kind, Result};
use crate::report::numbers::{duration, percent};
use crate::run::forecast::{Forecast, PILOT, forecast};
use crate::run::{ErrorGoal, ErrorOf, Plan, Settings, choose_cells};
use crate::scene::Scene;

use super::deadline::flagged;

/// What an error is expected to take, from a pilot.
#[derive(Debug, Serialize)]
pub struct ForecastCheck {
    /// What it is of.
    error_of: &'static str,
    /// The relative standard error, as a fraction.
    error: f64,
    /// Photons in all.
    photons: u64,
    /// Time of tracing on this machine, s.
    seconds: f64,
}

/// The error whose cost is told.
const TOLD_ERROR: f64 = 0.01;
/// The longest pilot for it.
const LONGEST_PILOT: Duration = Duration::from_secs(20);

/// What an error of 1 % will take, of cells and of the flux; nothing where the pilot takes too long.
///
/// # Errors
/// A ledger that does not balance (a defect of the program).
pub fn foretold(scene: &mut Scene) -> Result<Vec<ForecastCheck>> {
    if scene.receivers.is_empty() {
        return Ok(Vec::new());
    }
    let goals: Vec<ErrorGoal> = [ErrorOf::Cells, ErrorOf::Flux]
        .into_iter()
        .filter_map(|of| ErrorGoal::new(TOLD_ERROR, of).ok())
        .collect();
    let is_over = AtomicBool::new(false);
    let forecasts = flagged(LONGEST_PILOT, &is_over, || {
        choose_cells(scene, &Plan::new(&Settings::default())?, &is_over)?;
        forecast(scene, &goals, &is_over)
    });
    let check = |of: Forecast| ForecastCheck {
        error_of: of.goal.of().name(),
        error: of.goal.relative(),
        photons: of.photons,
        seconds: of.seconds,
    };
    match forecasts {
        Err(e) if e.kind() == Kind::Interrupted => Ok(Vec::new()),
        forecasts => Ok(forecasts?.into_iter().map(check).collect()),
    }
}

impl ForecastCheck {
    /// What is printed of it.
    pub fn text(&self) -> String {
        let Self { error_of, error, photons, seconds } = self;
        // Of an expectation no more than a power of two is known.
        let about = match photons.checked_next_power_of_two() {
            Some(_) if *photons <= PILOT => format!("fewer than 2^{} photons", PILOT.trailing_zeros()),
            Some(power) => format!("about 2^{} photons", power.trailing_zeros()),
            _ => "more photons than a run has".into(),
        };
        let error = percent(*error);
        let time = if *seconds < 1.0 { "less than a second".into() } else { duration(*seconds) };
        format!("error      {error} % of {error_of}: {about}, {time} here\n")
    }
}
