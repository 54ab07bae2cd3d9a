//! Point sequences: pure functions of (index, coordinate, seed, replicate).
