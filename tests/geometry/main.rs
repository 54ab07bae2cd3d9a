//! Shapes, meshes and the search for hits.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::print_stdout, missing_docs)]

mod bodies;
mod meshes;
mod nonsense;
mod obj;
mod search;
mod sides;
mod watertight;
