//! What a step says of itself.

use serde::{Deserialize, Serialize};

/// What one step did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct StepReport {
    /// Iterations of the relaxation, over all substeps.
    pub iterations: u32,
    /// Colors of the sweeps; 0 where the relaxation needs none.
    pub colors: u32,
    /// Root mean square distance that the last iteration moved the particles \[m\]. NaN without a tolerance in the budget.
    pub last_move: f32,
    /// Objective of the time step at its end \[J\], up to a constant of the step: inertia and energy of the constraints. NaN unless [`Solver::safeguard`] or
    /// [`System::set_measuring`] asks for it.
    ///
    /// [`Solver::safeguard`]: crate::Solver::safeguard
    /// [`System::set_measuring`]: crate::System::set_measuring
    pub objective: f64,
    /// Root mean square force that is out of balance at the end, over the free particles \[N\]: the gradient of the objective. NaN
    /// unless [`System::set_measuring`] asks for it.
    ///
    /// [`System::set_measuring`]: crate::System::set_measuring
    pub residual: f64,
    /// How often the safeguard took back an iteration and lowered the acceleration.
    pub backoffs: u32,
    /// Time per phase.
    pub times: PhaseTimes,
    /// Why it stopped.
    pub stop: Stop,
}

/// Seconds spent in each phase of a step.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PhaseTimes {
    /// Graph, coloring, matrix, factorisation: 0 where nothing changed.
    pub setup: f64,
    /// Outer forces and prediction.
    pub predict: f64,
    /// Iterations.
    pub solve: f64,
    /// Velocities, checks.
    pub finish: f64,
}

/// Why a step stopped.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stop {
    /// All iterations were done.
    #[default]
    Iterations,
    /// The time was up.
    Time,
    /// The particles moved no more than the tolerance.
    Tolerance,
}
