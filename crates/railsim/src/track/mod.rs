//! track (being written)
