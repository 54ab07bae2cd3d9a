//! What studies and certificates say, and whether it is right.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

#[path = "../support/mod.rs"]
mod support;

mod account;
mod certificate;
mod compare_numbers;
mod compare_report;
mod compare_resume;
mod made_up;
mod reference;
mod room;
mod sweep;
