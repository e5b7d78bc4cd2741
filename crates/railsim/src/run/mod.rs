//! run (being written)
