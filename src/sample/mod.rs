//! From coordinates to events and directions.
//!
//! [`chooser`] asks for decisions, [`coordinates`] answers with a photon's coordinates and counts them.
//! [`choose`] renormalises what is left of a coordinate after a discrete event (METHOD 2), [`discrete`] does
//! so for tables of events. Tables on the sphere (METHOD 3): [`angles`] are their rows and columns,
//! [`marginal`] solves the cell equation, [`cell`] samples one cell, [`grid`] one table, [`compact`] many
//! tables over the same angles (METHOD 4), of which [`shares`] chooses the cells. [`rejection`] is what
//! inverse functions are compared with, [`uniform_map`] the emission of references; [`method`] names the
//! ways.

pub mod method;
pub mod choose;
pub mod discrete;
pub mod chooser;
pub mod coordinates;
pub mod angles;
pub mod marginal;
pub mod cell;
pub mod rejection;
pub mod grid;
pub mod uniform_map;
pub mod shares;
pub mod compact;
