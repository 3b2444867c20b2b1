//! Kernels of Position Based Dynamics over particles; those over constraints are in [`crate::local`].

mod inertia;
mod residual;

use bytemuck::{Pod, Zeroable};

use crate::Shader;

pub use inertia::Inertia;
pub use residual::Residual;

/// The time step.
#[derive(Debug, Clone, Copy, Pod, Zeroable)]
#[repr(C)]
pub struct StepUniform {
    /// h² \[s²\].
    pub squared_h: f32,
}

/// Every kernel of this module.
pub const SHADERS: [Shader; 2] = [Shader::map::<Inertia>(), Shader::map::<Residual>()];
