//! The progress bar, Ctrl-C, and the clock of studies.

use std::io::IsTerminal;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

use cpu_time::ProcessTime;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};

use crate::error::{Diagnostic, Kind, Result};

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

/// A bar over this many photons on a terminal, nothing elsewhere.
pub(super) fn progress_bar(quiet: bool, photons: u64) -> ProgressBar {
    let visible = !quiet && std::io::stderr().is_terminal();
    let target = if visible { ProgressDrawTarget::stderr_with_hz(8) } else { ProgressDrawTarget::hidden() };
    let bar = ProgressBar::with_draw_target(Some(photons), target);
    let template = "{msg} {bar:32} {percent:>3} %  {human_pos} of {human_len} photons  {per_sec}  {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.enable_steady_tick(Duration::from_millis(250));
    bar
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
