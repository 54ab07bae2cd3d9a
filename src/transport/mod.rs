//! One photon from emission to its end, and the ledger of every lumen.
