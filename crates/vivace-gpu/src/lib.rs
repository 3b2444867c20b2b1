//! Runs Vivace kernels on a GPU, through wgpu: Vulkan, Metal, DirectX 12.
//!
//! [`Gpu`] is a [`vivace_kernels::Backend`]: what is written over that trait runs on it, and every coloring gives the answer that
//! it gives on the CPU, bit for bit.
//!
//! ```no_run
//! use vivace_coloring::{Algorithm, ConstraintGraph, Vivace};
//! use vivace_gpu::Gpu;
//!
//! let graph = ConstraintGraph::from_edges(4, &[[0, 1], [1, 2], [2, 3]])?;
//! let gpu = Gpu::new()?;
//! let outcome = Algorithm::Vivace(Vivace::DEFAULT).color_on(&gpu, &graph)?;
//! println!("{}: {} colors", gpu.adapter().name, outcome.coloring.n_colors());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # What happens where
//!
//! Arrays, lists, their lengths and the sizes of dispatches stay on the device. Dispatches are recorded into one compute pass; each
//! is as large as the list that it runs over, as the device itself has found (`dispatch_workgroups_indirect`). The host looks at
//! lengths only to end a loop over rounds, once for a batch of them, see [`vivace_kernels::Backend::rounds`].
//!
//! An array is read without waiting by [`Gpu::read_back`], and handed to a renderer, where it lies, by [`Buffer::raw`].
//! [`Gpu::profile`] says how long each kernel took.
//!
//! Everything stays inside WebGPU's default limits; only arrays may be as large as the device allows. Nothing here fails but the
//! making of a [`Gpu`] and the reading of results: an array that did not fit, or a device that was lost, is told there.
//!
//! One invocation walks the whole row of its vertex. A hub with tens of thousands of neighbors makes all wait, and Mesa's software
//! driver (seen in 22.3) silently ends the loops of an invocation after 65,535 iterations: colors of longer rows are wrong there.

mod error;
mod footprint;
mod gpu;
mod list;
mod memory;
mod pipeline;
mod profile;
mod read_back;
mod recorder;

pub use error::GpuError;
pub use footprint::Footprint;
pub use gpu::{Gpu, Grids};
pub use list::List;
pub use memory::{Buffer, GpuMemory};
pub use profile::{KernelTime, Profile};
pub use read_back::ReadBack;
pub use wgpu;
