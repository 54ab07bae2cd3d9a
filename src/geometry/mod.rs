//! Shapes, meshes and the nearest hit.
