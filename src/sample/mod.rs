//! From coordinates to events and directions.
//!
//! [`coordinates`] hands out a photon's coordinates and counts them; [`choose`] picks discrete events and renormalises
//! what is left of the coordinate (METHOD 2); [`discrete`] does the same for tables; [`marginal`] (the cell equation),
//! [`cell`] and [`grid`] sample a tabulated density on the sphere by inverse functions (METHOD 3), [`compact`] many densities
//! on one grid (METHOD 4); [`rejection`] is what they are compared with, [`method`] names the ways.

pub mod cell;
pub mod choose;
pub mod compact;
pub mod coordinates;
pub mod discrete;
pub mod grid;
pub mod marginal;
pub mod method;
pub mod rejection;
