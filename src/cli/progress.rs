//! The line of progress, Ctrl-C, and the clock of studies.

use std::fmt;
use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use console::Term;
use cpu_time::ProcessTime;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle};

use crate::error::{Diagnostic, Kind, Result};
use crate::report::numbers::{duration, grouped};

use super::{exit, say};

/// Set by the first Ctrl-C; the second ends the process at once.
pub(super) static INTERRUPTED: AtomicBool = AtomicBool::new(false);

/// Makes Ctrl-C set [`INTERRUPTED`].
pub(super) fn catch_interrupts() {
    let handler = || {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(i32::from(exit::INTERRUPTED));
        }
    };
    // Fails only where a handler is set already; then Ctrl-C does what that one does.
    if ctrlc::set_handler(handler).is_err() {
        say("caustix: Ctrl-C cannot be caught here; it will end the run without results");
    }
}

/// What a run is at, on a terminal; nothing elsewhere. Phases follow one another, and some have a bar.
pub(super) struct Progress {
    bar: ProgressBar,
    state: Arc<State>,
}

/// What is shown. Many threads count; the drawing is a thread of its own.
struct State {
    phase: Mutex<String>,
    /// Photons done and to be done, and those of them that an earlier run did.
    done: AtomicU64,
    earlier: AtomicU64,
    all: u64,
    /// The share of a picture that is done, in millionths; [`NO_PICTURE`] while photons are traced.
    picture: AtomicU64,
    started: Instant,
}

const NO_PICTURE: u64 = u64::MAX;

impl Progress {
    /// Of so many photons; 0 for phases alone, none of which has a bar.
    pub fn new(quiet: bool, phase: &str, photons: u64) -> Self {
        let visible = !quiet && std::io::stderr().is_terminal();
        let target =
            if visible { ProgressDrawTarget::stderr_with_hz(8) } else { ProgressDrawTarget::hidden() };
        let bar = ProgressBar::with_draw_target(None, target);
        let state = Arc::new(State {
            phase: Mutex::new(phase.to_string()),
            done: AtomicU64::new(0),
            earlier: AtomicU64::new(0),
            all: photons,
            picture: AtomicU64::new(NO_PICTURE),
            started: Instant::now(),
        });
        let drawn = Arc::clone(&state);
        let draw = move |_: &ProgressState, out: &mut dyn fmt::Write| {
            let (_, columns) = Term::stderr().size();
            let _drawn = out.write_str(&drawn.line(usize::from(columns)));
        };
        if let Ok(style) = ProgressStyle::with_template("{line}") {
            bar.set_style(style.with_key("line", draw));
        }
        if visible {
            bar.enable_steady_tick(Duration::from_millis(250));
        }
        Self { bar, state }
    }

    /// The next phase.
    pub fn phase(&self, phase: impl Into<String>) {
        *self.state.phase.lock().unwrap_or_else(PoisonError::into_inner) = phase.into();
        self.state.picture.store(NO_PICTURE, Ordering::Relaxed);
    }

    /// So many more photons are done.
    pub fn inc(&self, photons: u64) {
        self.state.done.fetch_add(photons, Ordering::Relaxed);
        self.state.picture.store(NO_PICTURE, Ordering::Relaxed);
    }

    /// So many photons were done by an earlier run.
    pub fn after(&self, photons: u64) {
        self.state.earlier.store(photons, Ordering::Relaxed);
        self.inc(photons);
    }

    /// This share of a picture is done.
    pub fn picture(&self, share: f64) {
        self.state.picture.store((1e6 * share.clamp(0.0, 1.0)) as u64, Ordering::Relaxed);
    }

    /// Does what writes to the terminal, with the line out of its way.
    pub fn suspend<T>(&self, write: impl FnOnce() -> T) -> T {
        self.bar.suspend(write)
    }

    /// Takes the line away.
    pub fn clear(&self) {
        self.bar.finish_and_clear();
    }
}

impl State {
    fn line(&self, columns: usize) -> String {
        let millionths = self.picture.load(Ordering::Relaxed);
        if millionths != NO_PICTURE {
            return line(columns, "camera", Some(millionths as f64 / 1e6), &[]);
        }
        let phase = self.phase.lock().unwrap_or_else(PoisonError::into_inner).clone();
        if self.all == 0 {
            return line(columns, &phase, None, &[]);
        }
        let (done, all) = (self.done.load(Ordering::Relaxed).min(self.all), self.all);
        let per_second = done.saturating_sub(self.earlier.load(Ordering::Relaxed)) as f64
            / self.started.elapsed().as_secs_f64().max(1e-3);
        let share = done as f64 / all as f64;
        if per_second <= 0.0 {
            return line(columns, &phase, Some(share), &[]);
        }
        let left = format!("{} left", duration((all - done) as f64 / per_second));
        let speed = format!("{} photons/s", grouped(per_second as u64));
        line(columns, &phase, Some(share), &[left, speed])
    }
}

/// One line of at most so many columns: the phase, a bar and the share, and what of the rest has room.
fn line(columns: usize, phase: &str, share: Option<f64>, rest: &[String]) -> String {
    const BAR: (usize, usize) = (10, 40);
    // In the last column some terminals begin a new line.
    let room = columns.saturating_sub(1);
    let cut = |text: &str, most: usize| match text.chars().count() {
        n if n <= most => text.to_string(),
        _ => text.chars().take(most.saturating_sub(2)).chain("..".chars().take(most)).collect(),
    };
    let Some(share) = share else { return cut(phase, room) };
    // 100 % is what is done, not what is nearly so.
    let percent = format!("{:>3} %", (100.0 * share) as u32);
    let phase = cut(phase, (room / 2).max(8));
    let mut told = format!("{phase} {percent}");
    if told.chars().count() > room {
        return cut(&phase, room);
    }
    for more in rest {
        let longer = format!("{told}, {more}");
        if longer.chars().count() <= room {
            told = longer;
        }
    }
    let left = room.saturating_sub(told.chars().count() + 3);
    if left < BAR.0 {
        return told;
    }
    let width = left.min(BAR.1);
    let full = ((share * width as f64) as usize).min(width);
    let bar = format!("[{}{}]", "=".repeat(full), " ".repeat(width - full));
    format!("{phase} {bar}{}", &told[phase.len()..])
}

/// Processor time of the process, over all its threads.
///
/// # Errors
/// [`Kind::Io`] on a system that does not tell it.
pub(super) fn processor_time() -> Result<Duration> {
    ProcessTime::try_now().map(|time| time.as_duration()).map_err(|e| {
        let required = "a system that tells it, for cost at equal time";
        Diagnostic::new(Kind::Io, format!("no processor time: {e}"), required)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn state(all: u64, done: u64, picture: u64) -> State {
        State {
            phase: Mutex::new("tracing".into()),
            done: AtomicU64::new(done),
            earlier: AtomicU64::new(0),
            all,
            picture: AtomicU64::new(picture),
            started: Instant::now() - Duration::from_secs(4),
        }
    }

    #[test]
    fn a_line_fits_every_terminal_and_drops_what_matters_least() {
        let rest = ["12 s left".to_string(), "1 038 871 photons/s".to_string()];
        for (columns, told) in [
            (120, "tracing [==================                      ]  45 %, 12 s left, 1 038 871 photons/s"),
            (80, "tracing [=============                ]  45 %, 12 s left, 1 038 871 photons/s"),
            (60, "tracing [=== ]  45 %, 12 s left, 1 038 871 photons/s"),
            (44, "tracing [=======         ]  45 %, 12 s left"),
            (30, "tracing  45 %, 12 s left"),
            (14, "tracing  45 %"),
            (9, "tracing"),
            (5, "tr.."),
            (1, ""),
            (0, ""),
        ] {
            let line = line(columns, "tracing", Some(0.4599), &rest);
            assert!(line.chars().count() < columns.max(1), "{columns}: {line}");
            if columns != 60 && columns != 80 {
                assert_eq!(line, told, "{columns}");
            }
        }
        // A long phase leaves room for the share.
        let long = line(60, "qmc-inverse-reuse:halton-faure-rotation, seed 2 of 4", Some(1.0), &rest);
        assert!(long.chars().count() < 60 && long.contains("100 %") && long.contains(".. "), "{long}");
        assert_eq!(line(20, "reading scenes/wavy_glass_seen.toml", None, &[]), "reading scenes/wa..");
    }

    #[test]
    fn phases_are_told_with_grouped_numbers() {
        // 4 s for a quarter: 12 s are left.
        let tracing = state(4_000_000, 1_000_000, NO_PICTURE).line(200);
        assert!(tracing.starts_with("tracing [==========     "), "{tracing}");
        assert!(
            tracing.contains("]  25 %, 12 s left, 249 9") || tracing.contains("]  25 %, 12 s left, 250 0"),
            "{tracing}"
        );
        assert!(state(4_000_000, 1_000_000, 500_000).line(200).starts_with("camera [===================="));
        assert_eq!(state(0, 0, NO_PICTURE).line(80), "tracing");
        // What is nearly done is not done.
        assert!(state(1_000_000, 999_999, NO_PICTURE).line(80).contains(" 99 %"));
    }
}
