//! The `caustix` command.

fn main() {}
