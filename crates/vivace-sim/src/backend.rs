//! Where a simulation runs.

use vivace_model::Model;
use vivace_solver::{Solver, SolverError, System};

#[cfg(feature = "gpu")]
use crate::SimError;

/// Where a simulation runs.
#[derive(Debug, Default)]
pub struct Backend(Place);

#[derive(Debug, Default)]
enum Place {
    #[default]
    Cpu,
    #[cfg(feature = "gpu")]
    Gpu(Box<vivace_gpu::Gpu>),
}

impl Backend {
    /// The CPU: threads of the rayon pool that a step is called in.
    #[must_use]
    pub fn cpu() -> Self {
        Self::default()
    }

    /// The fastest GPU of this machine, or what plays one there. Projective Dynamics, with every relaxation that is not serial:
    /// what is not done there is refused by name.
    ///
    /// # Errors
    /// There is none, or it lacks what WebGPU promises: says what to install.
    #[cfg(feature = "gpu")]
    pub fn gpu() -> Result<Self, SimError> {
        Ok(vivace_gpu::Gpu::new()?.into())
    }

    /// A device and queue of your own, beside whatever else you do with them.
    ///
    /// # Errors
    /// A limit of the device is below what the kernels take.
    #[cfg(feature = "gpu")]
    pub fn gpu_from_device(
        device: vivace_gpu::wgpu::Device,
        queue: vivace_gpu::wgpu::Queue,
    ) -> Result<Self, SimError> {
        Ok(vivace_gpu::Gpu::from_device(device, queue)?.into())
    }

    /// The model, prepared for a solver there.
    pub(crate) fn system(self, model: Model, solver: Solver) -> Result<System, SolverError> {
        match self.0 {
            Place::Cpu => System::new(model, solver),
            #[cfg(feature = "gpu")]
            Place::Gpu(gpu) => System::on(model, solver, *gpu),
        }
    }
}

#[cfg(feature = "gpu")]
impl From<vivace_gpu::Gpu> for Backend {
    fn from(gpu: vivace_gpu::Gpu) -> Self {
        Self(Place::Gpu(Box::new(gpu)))
    }
}
