//! From coordinates to events and directions.
