//! What a simulation refuses.

use vivace_model::ModelError;
use vivace_scene::SceneError;
use vivace_solver::SolverError;

/// Why something was refused. The simulation is as it was.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum SimError {
    /// The scene cannot be read or built.
    #[error(transparent)]
    Scene(#[from] SceneError),
    /// The solver or the budget cannot be, or the step left the range of numbers.
    #[error(transparent)]
    Solver(#[from] SolverError),
    /// There is no GPU, or none that will do. What goes wrong on one later is [`SolverError::Device`].
    #[cfg(feature = "gpu")]
    #[error(transparent)]
    Gpu(#[from] vivace_gpu::GpuError),
    /// A state, a force, a target or a time step cannot be.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// A grab that holds nothing.
    #[error("there are no particles to hold, or not as many as places; name at least one, and each once")]
    Nothing,
    /// A grab that is none, or no more.
    #[error("grab {grab} holds nothing: it was released, or is of another simulation")]
    NoGrab {
        /// Its number.
        grab: u64,
    },
    /// A text is not a snapshot.
    #[error("line {line}, column {column}: {reason}; is it a snapshot?")]
    Text {
        /// From 1.
        line: usize,
        /// From 1.
        column: usize,
        /// What was expected there.
        reason: String,
    },
    /// A snapshot of another model.
    #[error(
        "the snapshot has {found} {what}, the simulation {expected}; restore it in the scene it was taken of"
    )]
    Snapshot {
        /// Particles, attachments or drags.
        what: &'static str,
        /// In the simulation.
        expected: usize,
        /// In the snapshot.
        found: usize,
    },
}
