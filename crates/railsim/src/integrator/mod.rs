//! integrator (being written)
