//! What a surface does with a photon.
