//! The GPU backend against the CPU's, bit for bit. These tests need an adapter, if a software one, and fail where there is none.

mod cases;
mod colliding;
mod collisions;
mod colorings;
mod device;
mod frames;
mod kernels;
mod kinds;
mod position_based;
mod profile;
mod read_back;
mod recoloring;
mod sweep;
mod vertices;

use vivace_gpu::Gpu;

/// The adapter of this machine.
fn gpu() -> Gpu {
    Gpu::new().unwrap_or_else(|error| panic!("{error}"))
}
