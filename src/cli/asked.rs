//! What the command line asks of a run: how many photons, which error, how long, which part.

use std::time::{Duration, Instant};

use crate::error::{Diagnostic, Kind, Result};
use crate::files::run_state::Head;
use crate::files::scene_toml::RunDefaults;
use crate::report::numbers::grouped;
use crate::run::{ErrorGoal, ErrorOf, Goal, Plan, Settings};
use crate::scene::Scene;

use super::{RenderArgs, algorithm, count, in_option, say};

/// What the command line asks of a run.
pub struct Asked<'a> {
    args: &'a RenderArgs,
    scene_run: RunDefaults,
    photons: Option<u64>,
    error: Option<ErrorGoal>,
    until: Option<Instant>,
    /// Which part of how many.
    pub part: Option<[u32; 2]>,
}

/// Most parts of a run.
const MOST_PARTS: u32 = 1 << 16;

impl<'a> Asked<'a> {
    /// Reads the options.
    ///
    /// # Errors
    /// What cannot be read, and what does not go together.
    pub fn new(args: &'a RenderArgs, scene_run: RunDefaults, started: Instant) -> Result<Self> {
        let photons = count("--photons", args.photons.as_ref())?;
        let part = args.part.as_deref().map(part).transpose()?;
        let time = args.time.as_deref().map(seconds).transpose()?;
        let error = error(args)?;
        if part.is_some() && (error.is_some() || time.is_some()) {
            let found = "--part with --error or --time";
            return Err(Diagnostic::new(
                Kind::Range,
                found,
                "--photons alone: parts do not know of each other",
            ));
        }
        // Beyond what a clock can tell there is no end.
        let until = time.and_then(|time| started.checked_add(time));
        Ok(Self { args, scene_run, photons, error, until, part })
    }

    /// That the camera of a scene can have what is asked for.
    ///
    /// # Errors
    /// Options that pictures do not have.
    pub fn check_camera(&self, scene: &Scene) -> Result<()> {
        let option = match self {
            Self { error: Some(_), .. } => "--error",
            Self { until: Some(_), .. } => "--time",
            _ => return Ok(()),
        };
        if scene.camera.is_none() {
            return Ok(());
        }
        let found = format!("{option} and a scene with [camera]");
        let required =
            "a scene without a camera: a picture is made of a number of photons that is known before";
        Err(Diagnostic::new(Kind::Range, found, required))
    }

    /// The plan and what ends it: the command line where it speaks, else the state gone on from, else the scene's [run],
    /// else the defaults.
    ///
    /// # Errors
    /// Settings that do not go together.
    pub fn plan(&self, head: Option<&Head>) -> Result<(Plan, Goal)> {
        let Self { args, scene_run, .. } = self;
        let kept = head.map(Head::settings).transpose()?;
        // Who asks for a number of photons goes on to that number.
        let kept_goal = head.and_then(Head::goal).filter(|_| self.photons.is_none());
        let error = self.error.or(kept_goal);
        let mut settings = kept.unwrap_or(Settings {
            photons: scene_run.photons,
            seed: scene_run.seed.unwrap_or(Settings::default().seed),
            ..Settings::default()
        });
        settings.algorithm = algorithm(settings.algorithm, args.variant.as_ref(), args.sequence.as_ref())?;
        settings.seed = args.seed.unwrap_or(settings.seed);
        // A scene's replicates yield to a sequence that can have only one; the command line's do not.
        let of_scene = scene_run.replicates.filter(|_| settings.algorithm.sequence.is_randomised());
        let replicates = args.replicates.or(settings.replicates).or(of_scene);
        settings.photons = self.photons.or_else(|| match (self.error, head) {
            (Some(_), _) => None,
            // More replicates are of as many photons each.
            (None, Some(head)) => head.photons().0.checked_mul(replicates.unwrap_or(head.replicates).into()),
            (None, None) => settings.photons,
        });
        settings.replicates = replicates;
        if let Some(error) = error.filter(|_| settings.algorithm.sequence.is_randomised()) {
            settings = error.settings(settings);
        }
        Ok((Plan::new(&settings)?, Goal { error, until: self.until }))
    }

    /// The plan that cells are chosen for: that of a run to an error has as many photons as the error will take, so it is one
    /// without.
    ///
    /// # Errors
    /// None that the plan of the run has not told.
    pub fn plan_of_cells(&self, plan: &Plan) -> Result<Plan> {
        let is_open = self.error.is_some() && self.photons.is_none();
        if is_open {
            Plan::new(&Settings { photons: self.scene_run.photons, ..Settings::default() })
        } else {
            Ok(*plan)
        }
    }

    /// Says where a plan has another number of photons than was asked for.
    pub fn say_rounding(&self, plan: &Plan) {
        let of_scene = self.scene_run.photons.filter(|_| !self.args.resume && self.error.is_none());
        if let Some(asked) = self.photons.or(of_scene).filter(|n| *n != plan.photons()) {
            let (traced, asked, replicates) = (grouped(plan.photons()), grouped(asked), plan.replicates());
            say(&format!(
                "caustix: {traced} photons instead of {asked}: {replicates} replicates of equal size"
            ));
        }
    }
}

/// The error asked for.
fn error(args: &RenderArgs) -> Result<Option<ErrorGoal>> {
    let of = match args.error_of.as_deref() {
        None => ErrorOf::default(),
        Some(name) => ErrorOf::from_name(name).ok_or_else(|| {
            let names = ErrorOf::ALL.map(ErrorOf::name).join(", ");
            Diagnostic::new(Kind::Unknown, format!("--error-of {name}"), format!("one of: {names}"))
        })?,
    };
    let Some(text) = &args.error else { return Ok(None) };
    let number = text.trim().strip_suffix('%').unwrap_or(text.trim()).trim_end();
    let percent = number.parse::<f64>().map_err(|_| {
        let required = "a standard error in percent, like 1 or 0.5%";
        let error = Diagnostic::new(Kind::Syntax, format!("--error {text}"), required);
        if number.contains(',') { error.hint(format!("write {}", number.replace(',', "."))) } else { error }
    })?;
    ErrorGoal::new(percent / 100.0, of).map(Some).map_err(|e| in_option(&format!("--error {text}: "), &e))
}

/// A time like 90, 90s, 10min or 1.5h.
fn seconds(text: &str) -> Result<Duration> {
    const UNITS: [(&str, f64); 7] = [
        ("min", 60.0),
        ("hours", 3600.0),
        ("hour", 3600.0),
        ("h", 3600.0),
        ("d", 86_400.0),
        ("s", 1.0),
        ("m", 60.0),
    ];
    let trimmed = text.trim();
    let unit = UNITS.iter().find_map(|(unit, seconds)| Some((trimmed.strip_suffix(unit)?, seconds)));
    let (number, unit) = unit.unwrap_or((trimmed, &1.0));
    let time = number.trim_end().parse::<f64>().ok().map(|number| number * unit);
    time.filter(|time| *time > 0.0).and_then(|time| Duration::try_from_secs_f64(time).ok()).ok_or_else(|| {
        let required = "a time above 0: seconds, or like 90s, 10min, 1.5h";
        Diagnostic::new(Kind::Syntax, format!("--time {text}"), required)
    })
}

/// K/N: the Kth of N parts.
fn part(text: &str) -> Result<[u32; 2]> {
    let numbers = text.split_once('/').map(|(k, n)| (k.trim().parse::<u32>(), n.trim().parse::<u32>()));
    match numbers {
        Some((Ok(k), Ok(n))) if (1..=n).contains(&k) && n <= MOST_PARTS => Ok([k, n]),
        _ => {
            let required =
                format!("K/N: the Kth of N parts, K from 1 to N, N at most {MOST_PARTS}; like 3/16");
            Err(Diagnostic::new(Kind::Syntax, format!("--part {text}"), required))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_and_parts_are_read_as_people_write_them() {
        for (text, s) in [
            ("90", 90.0),
            ("90 s", 90.0),
            ("10min", 600.0),
            ("1.5h", 5400.0),
            ("2m", 120.0),
            ("1d", 86_400.0),
        ] {
            assert_eq!(seconds(text).unwrap().as_secs_f64(), s, "{text}");
        }
        for text in ["", "0", "-1", "1 week", "nan", "1e300h", "min"] {
            assert!(seconds(text).is_err(), "{text}");
        }
        assert_eq!((part("3/16").unwrap(), part(" 1 / 1 ").unwrap()), ([3, 16], [1, 1]));
        for text in ["0/16", "17/16", "3", "3/", "-1/4", "1/100000", "a/b"] {
            assert!(part(text).is_err(), "{text}");
        }
    }
}
