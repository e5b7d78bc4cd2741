//! dynamics (being written)
