//! What the statistical tests share: tests of distributions with their p-values, quadrature, the real data files, and
//! photometric angles and masses that share no code with the sampler.
// Each test binary uses a part of it.
#![allow(dead_code)]

pub mod angles;
pub mod cells;
pub mod data;
pub mod density;
pub mod quadrature;
pub mod statistics;
