//! Scenes: what is read from a scene file, checked once.

pub mod count;
pub mod description;
pub mod document;
pub mod file;
pub mod source;
pub mod suggest;
pub mod toml_table;
