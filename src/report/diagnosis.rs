//! What a run's replicates and doublings say of each receiver: in report.json always, in words with `--diagnose` (METHOD 10).

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use crate::estimate::diagnosis::{
    Diagnosis, Drift, FEWEST_PHOTONS, FEWEST_REPLICATES, Fault, Judgement, Moment, Rate, level,
};
use crate::run::Outcome;
use crate::scene::Scene;
use crate::surface::Material;

use super::numbers::{digits, grouped, percent, rounded, written};

/// What replicates and doublings say of a receiver. Names are those of report.json: they are only added to.
#[derive(Debug, Clone, Serialize)]
pub struct DiagnosisReport {
    /// "sound", "doubtful", or "unknown" where there is too little to tell.
    pub verdict: &'static str,
    /// The same in a sentence.
    pub says: String,
    /// A check is failed where chance alone is rarer than this: one healthy run in 100 fails any of all receivers.
    pub doubted_below: f64,
    /// Figure of merit of the flux by photons, 1 / (relative standard error^2 x photons).
    pub merit_per_photon: Option<f64>,
    /// Variance that the flux of as many independent photons would have, over that of this run; `null` where it is not known:
    /// where a photon may arrive more than once.
    pub independent_variance_ratio: Option<f64>,
    /// Flux and its error after each doubling.
    pub trend: Option<Vec<DoublingReport>>,
    /// Why there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub trend_absent: Option<&'static str>,
    /// The power of photons with which the error falls.
    pub rate: Option<Rate>,
    /// What later photons give more than the first ones.
    pub drift: Option<Drift>,
    /// Skewness over replicates.
    pub skewness: Option<Moment>,
    /// Excess kurtosis over replicates.
    pub excess_kurtosis: Option<Moment>,
}

/// The flux after a doubling.
#[derive(Debug, Clone, Serialize)]
pub struct DoublingReport {
    /// Photons of all replicates.
    pub photons: u64,
    /// Flux, lm.
    pub flux_lm: f64,
    /// Its standard error, relative; `null` where nothing arrived.
    pub relative_standard_error: Option<f64>,
}

/// Of all receivers; `None` for one replicate. All checks of all receivers are judged together.
pub(super) fn of_receivers(scene: &Scene, outcome: &Outcome) -> Vec<Option<DiagnosisReport>> {
    let receivers = scene.receivers.iter().enumerate();
    let found: Vec<Option<Diagnosis>> = receivers
        .map(|(i, receiver)| {
            outcome.diagnosis(i, matches!(scene.material(receiver.surface), Material::Absorber))
        })
        .collect();
    let level = level(found.iter().flatten().map(|of| of.checks.len()).sum());
    let emitted_lm = scene.emitters.flux_lm();
    found
        .iter()
        .map(|of| of.as_ref().map(|of| DiagnosisReport::new(of, level, emitted_lm, outcome)))
        .collect()
}

/// Figures of merit by tracing time, 1/s.
pub(super) fn merits_per_s(
    scene: &Scene,
    outcome: &Outcome,
    of: &[Option<DiagnosisReport>],
) -> BTreeMap<String, f64> {
    let speed = outcome.photons as f64 / outcome.trace_s;
    let merit = |of: &Option<DiagnosisReport>| Some(of.as_ref()?.merit_per_photon? * speed);
    let receivers = scene.receivers.iter().zip(of);
    receivers.filter_map(|(r, of)| Some((r.name.clone(), merit(of).filter(|m| m.is_finite())?))).collect()
}

impl DiagnosisReport {
    fn new(of: &Diagnosis, level: f64, emitted_lm: f64, outcome: &Outcome) -> Self {
        let judgement = of.judgement(level);
        let replicates = u64::from(of.replicates);
        let trend: Vec<DoublingReport> = of
            .trend
            .iter()
            .map(|doubling| DoublingReport {
                photons: doubling.photons * replicates,
                flux_lm: doubling.share * emitted_lm,
                relative_standard_error: doubling.relative_error,
            })
            .collect();
        Self {
            verdict: match judgement {
                Judgement::Sound => "sound",
                Judgement::Doubtful(_) => "doubtful",
                _ => "unknown",
            },
            says: sentence(of, &judgement),
            doubted_below: level,
            merit_per_photon: of.merit,
            independent_variance_ratio: of.against_independent,
            trend_absent: trend.is_empty().then(|| why_no_trend(outcome)),
            trend: (!trend.is_empty()).then_some(trend),
            rate: of.rate,
            drift: of.drift,
            skewness: of.skewness,
            excess_kurtosis: of.kurtosis,
        }
    }

    /// As it is printed.
    pub(super) fn text(&self, name: &str, merit_per_s: Option<f64>) -> String {
        written(|out| {
            writeln!(out, "\ndiagnosis \"{name}\": {}", self.says)?;
            if let Some(rate) = &self.rate {
                let [first, last] = rate.photons.map(grouped);
                let power = plus_minus(rate.value, rate.standard_error);
                writeln!(
                    out,
                    "  error        falls with the power {power} of photons, from {first} to {last} of a replicate"
                )?;
            }
            if let Some(drift) = &self.drift {
                let both = plus_minus(100.0 * drift.relative, 100.0 * drift.standard_error);
                writeln!(out, "  drift        later photons give {both} % more than the first ones")?;
            }
            let moment = |of: &Moment| plus_minus(of.value, of.standard_error);
            let shape = [("skewness", &self.skewness), ("excess kurtosis", &self.excess_kurtosis)];
            let shape = shape.map(|(name, of)| Some(format!("{name} {}", moment(of.as_ref()?))));
            let shape: Vec<String> = shape.into_iter().flatten().collect();
            if !shape.is_empty() {
                writeln!(out, "  replicates   {}", shape.join(", "))?;
            }
            if let Some(merit) = self.merit_per_photon {
                let seconds = merit_per_s.map_or(String::new(), |m| format!(", {} a second", digits(m)));
                writeln!(
                    out,
                    "  merit        1/(relative error^2 N) = {} a photon{seconds}",
                    rounded(merit, 3)
                )?;
            }
            if let Some(ratio) = self.independent_variance_ratio {
                let ratio = rounded(ratio, 3);
                writeln!(out, "  variance     independent photons would have {ratio} times as much")?;
            }
            for of in self.trend.iter().flatten() {
                let error = of.relative_standard_error.map_or("-".into(), percent);
                let photons = grouped(of.photons);
                writeln!(
                    out,
                    "  doubling     {photons:>17} photons: {} lm +- {error} %",
                    digits(of.flux_lm)
                )?;
            }
            if let Some(why) = self.trend_absent {
                writeln!(out, "  doubling     none: {why}")?;
            }
            Ok(())
        })
    }
}

/// A number of size 1 with its error, to two digits of it.
fn plus_minus(value: f64, error: f64) -> String {
    let decimals = (1.0 - libm::floor(libm::log10(error))).clamp(0.0, 12.0) as usize;
    format!("{value:.decimals$} +- {error:.decimals$}")
}

fn why_no_trend(outcome: &Outcome) -> &'static str {
    if outcome.doublings.is_empty() && outcome.plan.algorithm().sequence.needs_number() {
        "the points are made for their number, so the first of them are no sample"
    } else if outcome.doublings.is_empty() {
        "replicates were traced one after another, or have too few photons for one"
    } else {
        "the replicates have too few photons for one"
    }
}

fn sentence(of: &Diagnosis, judgement: &Judgement) -> String {
    match judgement {
        Judgement::Sound => {
            let is_tested = |faults: &[Fault]| of.checks.iter().any(|check| faults.contains(&check.fault));
            let power = of.rate.filter(|_| is_tested(&[Fault::Slow]));
            let parts = [
                power.map(|rate| {
                    let power = plus_minus(rate.value, rate.standard_error);
                    format!("the error falls with the power {power} of photons")
                }),
                is_tested(&[Fault::Drifts]).then(|| "earlier and later photons agree".to_owned()),
                is_tested(&[Fault::Scatters, Fault::Skewed, Fault::HeavyTailed])
                    .then(|| "replicates scatter as they should".to_owned()),
            ];
            format!("as it should be: {}", parts.into_iter().flatten().collect::<Vec<_>>().join(", "))
        }
        Judgement::Doubtful(faults) => {
            let faults: Vec<String> = faults.iter().filter_map(|fault| told(of, *fault)).collect();
            format!(
                "doubtful: {}; one healthy run in 100 is doubted, so try another --seed and more --replicates",
                faults.join("; ")
            )
        }
        Judgement::FewPhotons => format!(
            "too few photons to tell: {} arrived, and from {FEWEST_PHOTONS} on there is something to tell",
            grouped(of.arrived)
        ),
        Judgement::FewReplicates => format!(
            "too few replicates to tell: {}, and from {FEWEST_REPLICATES} on their spread tells of itself",
            of.replicates
        ),
        Judgement::Unchecked => {
            "nothing to tell: no doublings, and too few replicates for the shape of their spread".to_owned()
        }
    }
}

/// What is wrong.
fn told(of: &Diagnosis, fault: Fault) -> Option<String> {
    let moment = |of: Moment| plus_minus(of.value, of.standard_error);
    Some(match fault {
        Fault::Drifts => {
            let Drift { relative, standard_error, .. } = of.drift?;
            let errors = rounded(relative.abs() / standard_error, 2);
            let more = if relative > 0.0 { "more" } else { "less" };
            let percent = percent(relative.abs());
            format!(
                "the estimate drifts, later photons give {percent} % {more} than the first ones, {errors} standard errors"
            )
        }
        Fault::Slow => {
            let rate = of.rate?;
            let power = plus_minus(rate.value, rate.standard_error);
            format!(
                "the error falls with the power {power} of photons, slower than that of independent ones (0.5)"
            )
        }
        Fault::Scatters => {
            let times = rounded(1.0 / of.against_independent?, 2);
            format!("replicates scatter with {times} times the variance of independent photons")
        }
        Fault::Skewed => {
            format!("replicates are skewed ({}): few of them decide the error", moment(of.skewness?))
        }
        Fault::HeavyTailed => {
            format!(
                "few replicates are far off (excess kurtosis {}) and decide the error",
                moment(of.kurtosis?)
            )
        }
    })
}
