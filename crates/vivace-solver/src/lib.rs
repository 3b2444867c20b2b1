//! Projective Dynamics and Position Based Dynamics, relaxed by colored Gauss-Seidel and by its rivals.
//!
//! [`System::step`] is Algorithm 1 of *Vivace* (Fratarcangeli, Tibaldo, Pellacini 2016). What varies is in two independent axes,
//! [`Framework`] and [`Relaxation`], and in how long it may take, [`Budget`]. A relaxation is a schedule of stages, written once; each
//! framework says what the stages do.

mod budget;
#[cfg(feature = "direct")]
mod cholesky;
mod collisions;
mod contacts;
mod device;
mod engine;
mod error;
mod history;
mod host;
mod parallel;
mod pbd;
mod pd;
mod relaxation;
mod report;
mod rounding;
mod safeguard;
mod solver;
mod stages;
mod step;
mod system;

#[cfg(feature = "direct")]
pub mod reference;

pub use budget::Budget;
pub use collisions::Collisions;
pub use error::SolverError;
pub use report::{ContactReport, PhaseTimes, StepReport, Stop, TearReport};
pub use solver::{Base, Framework, LocalStep, Preconditioner, Relaxation, Rho, Solver, VertexSolve};
use stages::Stages;
pub use step::Ease;
pub use system::{PinMove, Resident, System};
pub use vivace_collision as collision;
pub use vivace_model::{Forces, Model, ModelBuilder, ModelError, State, Tear, TearLimit, Wind};
