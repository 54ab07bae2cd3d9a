//! A whole run: settings in, maps and ledger out.
