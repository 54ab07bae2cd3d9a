//! How a table is sampled: by inverse functions, or by the rejection that they are compared with.

use crate::math::solve::Solver;

/// The way from coordinates to a direction of a table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Sampling {
    /// Inverse functions (METHOD 3), with this solver of the cell equation: two coordinates, the first of
    /// which also chooses the cell.
    Inverse(Solver),
    /// Rejection: proposals uniform in solid angle, accepted with value / largest value. The same density.
    Rejection(Rejection),
}

/// Where the proposals of a rejection come from, and what a rejected one is followed by.
///
/// Proposals inside a cell cannot be followed by the next point: that would choose another cell, and cells
/// would come out by flux times chance of acceptance. For the same reason the next point needs a scene with
/// one emitter.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Rejection {
    /// A cell chosen by its flux; proposals inside it against the largest of its corners, from the photon's
    /// next coordinates.
    #[default]
    Cell,
    /// Proposals from the whole table against its largest value, from the photon's next coordinates.
    Table,
    /// The same, each from the next point of the sequence: photon k is the k-th point whose proposal is
    /// accepted.
    NextPoint,
}

impl Rejection {
    /// Every one, in the order in which they are listed to users.
    pub const ALL: [Self; 3] = [Self::Cell, Self::Table, Self::NextPoint];

    /// The name in commands and files.
    pub const fn name(self) -> &'static str {
        ["cell", "table", "next-point"][self as usize]
    }

    /// The same in words.
    pub const fn description(self) -> &'static str {
        match self {
            Self::Cell => "rejection inside the cell, retries from the next coordinates",
            Self::Table => "rejection against the table's maximum, retries from the next coordinates",
            Self::NextPoint => "rejection against the table's maximum, retries from the next point",
        }
    }
}

impl Default for Sampling {
    fn default() -> Self {
        Self::Inverse(Solver::DEFAULT)
    }
}

impl Sampling {
    /// Whether a point of the sequence may give no photon.
    #[inline]
    pub const fn skips_points(self) -> bool {
        matches!(self, Self::Rejection(Rejection::NextPoint))
    }
}
