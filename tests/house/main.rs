//! The project's own rules, and the tools of its tests.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "../support/mod.rs"]
mod support;

mod circles;
mod layering;
mod support_checks;
