//! The `caustix` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    caustix::command()
}
