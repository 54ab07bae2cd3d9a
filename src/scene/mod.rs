//! Scenes: what is read from a scene file, checked once.
