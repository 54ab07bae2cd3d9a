//! Where photons start.
