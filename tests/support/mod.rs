//! What test binaries of several themes share: scenes and runs, the judgement of maps, tests of distributions, quadrature, the real
//! data files, the command, and tables and angles that share no code with what is tested.
// Each binary uses a part of it.
#![allow(dead_code)]

pub mod angles;
pub mod caustic_views;
pub mod cells;
pub mod coverage;
pub mod data;
pub mod density;
pub mod given;
pub mod healthy;
pub mod judge;
pub mod lamp;
pub mod ldt;
pub mod local;
pub mod maps;
pub mod pictures;
pub mod png;
pub mod quadrature;
pub mod random;
pub mod scatter_files;
pub mod scenes;
pub mod sphere_table;
pub mod statistics;
pub mod stranger;
pub mod tables;
pub mod vouched;
