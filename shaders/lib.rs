//! The kernels of Vivace, and the interface of whatever runs them.
//!
//! An algorithm is a schedule of kernels, written once over a [`Backend`]. A [`Kernel`] is a *gather*: invocation `i` reads
//! what it likes and writes element `i` of one array (or elements that are its own in this run, see [`Scatter`]), so neither the number
//! of threads nor their order can show in a result.
//! Randomness is a hash of (seed, round, vertex), see [`pcg`]; no generator state passes from vertex to vertex.
//!
//! The Rust function here is the definition of its kernel. Those of the colorings are plain loops over `u32`, nothing that WGSL could not say. Its
//! twin for a device stands beside it under the same name, `<name>.wgsl`, and the tests hold the two to the same answers.

mod backend;
mod kernel;
mod shader;

#[path = "collision/mod.rs"]
pub mod collision;
#[path = "coloring/mod.rs"]
pub mod coloring;
#[path = "constraint/mod.rs"]
pub mod constraint;
#[path = "common/determinant.rs"]
mod determinant;
#[path = "common/lanes.rs"]
pub mod lanes;
#[path = "linear/mod.rs"]
pub mod linear;
#[path = "local/mod.rs"]
pub mod local;
#[path = "common/mat3.rs"]
pub mod mat3;
#[path = "pbd/mod.rs"]
pub mod pbd;
#[path = "common/pcg.rs"]
pub mod pcg;
#[path = "pd/mod.rs"]
pub mod pd;
#[path = "step/mod.rs"]
pub mod step;

pub use backend::{Backend, PARAMS_BYTES, Params, RoundCount, View};
pub use kernel::{
    CountDown, Element, Expand, Host, HostViews, Inputs, Kernel, Lower, Map, Memory, Scatter, Select, Update,
    ViewVisitor, Views,
};
pub use shader::{Form, ListShader, MOST_KEYS, Shader};
