//! Small numerical tools: frames, solvers, elementary functions that are the same on every machine.

pub mod digest;
pub mod frame;
pub mod solve;
pub mod trig;
pub mod varint;
