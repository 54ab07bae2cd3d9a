//! Small numerical tools: frames, solvers.
