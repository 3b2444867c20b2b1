//! Cloth and soft bodies in ten lines.
//!
//! ```
//! use vivace_sim::{Budget, Simulation, Solver, scene::tablecloth};
//!
//! let mut simulation = Simulation::new(&tablecloth(20), Solver::default())?;
//! for _ in 0..30 {
//!     let report = simulation.step(Budget::milliseconds(2.0).and_iterations(20))?;
//!     assert!(report.iterations >= 1);
//! }
//! let lowest = simulation.positions().iter().map(|p| p.y).fold(f32::INFINITY, f32::min);
//! assert!(lowest < -0.5);
//! # Ok::<(), vivace_sim::SimError>(())
//! ```
//!
//! A [`Scene`] says what there is, in code or in a file; a [`Solver`] how it is solved; a [`Budget`] how long a frame may take. For
//! models of your own there is [`ModelBuilder`] and [`Simulation::from_model`]. SI units throughout; y is up.

mod backend;
mod error;
mod grab;
mod positions;
mod simulation;
mod snapshot;

pub use backend::Backend;
#[cfg(feature = "gpu")]
pub use backend::device_bytes;
pub use error::SimError;
pub use glam;
pub use glam::Vec3;
pub use grab::{Grab, Patch};
pub use positions::PendingPositions;
pub use simulation::Simulation;
pub use snapshot::{Snapshot, Torn};
#[cfg(feature = "gpu")]
pub use vivace_gpu as gpu;
pub use vivace_mesh as mesh;
pub use vivace_model::{Forces, Model, ModelBuilder, ModelError, State, Tear, TearLimit, Wind};
pub use vivace_scene as scene;
pub use vivace_scene::{Hold, Pose, Scene, SceneError};
#[cfg(feature = "gpu")]
pub use vivace_solver::Resident;
pub use vivace_solver::collision;
pub use vivace_solver::{
    Base, Budget, ContactReport, Ease, Framework, LocalStep, PhaseTimes, Preconditioner, Relaxation, Rho,
    Solver, SolverError, StepReport, Stop, TearReport, VertexSolve,
};
