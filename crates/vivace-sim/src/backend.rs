//! Where a simulation runs.

use vivace_model::Model;
use vivace_solver::{Solver, SolverError, System};

#[cfg(feature = "gpu")]
use crate::{Budget, Scene, SimError, Simulation};
#[cfg(feature = "gpu")]
use std::path::Path;

/// Where a simulation runs.
#[derive(Debug, Default)]
pub struct Backend(Place);

#[derive(Debug, Default)]
enum Place {
    #[default]
    Cpu,
    #[cfg(feature = "gpu")]
    Gpu(Box<vivace_gpu::Gpu>),
    /// Counts what a GPU would take.
    #[cfg(feature = "gpu")]
    Footprint(vivace_gpu::Footprint),
}

impl Backend {
    /// The CPU: threads of the rayon pool that a step is called in.
    #[must_use]
    pub fn cpu() -> Self {
        Self::default()
    }

    /// The fastest GPU of this machine, or what plays one there. Both frameworks, with every relaxation that is not serial: what is
    /// not done there is refused by name.
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
            #[cfg(feature = "gpu")]
            Place::Footprint(footprint) => System::on(model, solver, footprint),
        }
    }

    /// Whether positions stay where the host does not see them.
    pub(crate) fn is_device(&self) -> bool {
        !matches!(self.0, Place::Cpu)
    }
}

/// Bytes that a scene takes on a GPU with this solver, while frames run within this budget and the host reads them back: what
/// [`Gpu::allocated`](vivace_gpu::Gpu::allocated) will say after the first. No GPU is needed, and none is asked. Files of meshes are looked
/// for in `folder`. Positions that are read aside ([`Simulation::read_positions`]) take 16 bytes a particle more, for each that is on its
/// way.
///
/// ```
/// use std::path::Path;
/// use vivace_sim::{Budget, Solver, device_bytes, scene::tablecloth};
///
/// let bytes = device_bytes(&tablecloth(100), Path::new("."), Solver::default(), Budget::iterations(15))?;
/// assert!(bytes < 10_000_000);
/// # Ok::<(), vivace_sim::SimError>(())
/// ```
///
/// # Errors
/// As [`Simulation::new_on`] and [`Simulation::step`].
#[cfg(feature = "gpu")]
pub fn device_bytes(scene: &Scene, folder: &Path, solver: Solver, budget: Budget) -> Result<u64, SimError> {
    let footprint = vivace_gpu::Footprint::new();
    let backend = Backend(Place::Footprint(footprint.clone()));
    Simulation::build(scene, folder, solver, backend)?.step(budget)?;
    Ok(footprint.allocated())
}

#[cfg(feature = "gpu")]
impl From<vivace_gpu::Gpu> for Backend {
    fn from(gpu: vivace_gpu::Gpu) -> Self {
        Self(Place::Gpu(Box::new(gpu)))
    }
}
