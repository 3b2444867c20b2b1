//! Runs Vivace kernels on the CPU with rayon.
