//! The command as a user types it.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "../support/mod.rs"]
mod support;

mod absorber;
mod bsdf;
mod check;
mod contract;
#[cfg(unix)]
mod interrupts;
mod lamp_set;
#[cfg(unix)]
mod long_runs;
mod maps_open;
mod misuse;
mod outputs;
mod photometry;
mod picture;
mod result_set;
#[cfg(unix)]
mod result_set_cut;
mod results_kept;
mod sample;
mod shell;
#[cfg(unix)]
mod strangers;
#[cfg(unix)]
mod sweep;
