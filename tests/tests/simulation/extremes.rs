//! Extremes.
