//! What `caustix compare` says: a table for the terminal, compare.csv and compare.md, all from one
//! [`crate::lab::study::results::Study`].

pub mod csv;
pub mod numbers;
pub mod remarks;
pub mod markdown;
pub mod text;
