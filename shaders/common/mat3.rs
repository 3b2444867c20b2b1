//! 3 × 3 matrices: nearest rotation and singular values.
