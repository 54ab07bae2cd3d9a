//! What a surface is beside its shape and material.

/// How a surface is joined to those that it touches.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Joint {
    /// By a film of no thickness of the medium that surrounds both.
    Film,
    /// There is nothing between.
    Glued,
}

/// What a surface is beside its shape and material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SurfaceOptions {
    /// Of transparent bodies that overlap, the one of the highest priority fills the common space; of equal ones, the
    /// smaller.
    pub priority: i32,
    /// How it is joined to what it touches: by a film, if nothing is said.
    pub contact: Option<Joint>,
}
