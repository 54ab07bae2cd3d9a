//! What the readers of photometric files share: numbers with their places, angles put right, the checks of a
//! table.

pub mod angles;
pub mod checks;
pub mod lines;
pub mod number;

/// Something to say about a file, at a byte.
pub(crate) struct Said {
    pub offset: usize,
    pub found: String,
    pub required: String,
    pub hint: String,
}
