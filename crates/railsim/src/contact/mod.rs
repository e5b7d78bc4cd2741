//! contact (being written)
