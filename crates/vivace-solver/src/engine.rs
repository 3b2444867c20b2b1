//! What runs the lines of Algorithm 1.

use std::any::Any;
use std::fmt::Debug;

use glam::Vec3;
use vivace_model::{Forces, Model, State};

use crate::{Solver, SolverError, Stages};

/// A framework where it runs, with the positions and velocities of a frame.
pub(crate) trait Engine: Debug + Send + Sync {
    /// The backend, where there is one, as what it is.
    fn backend(&mut self) -> Option<&mut dyn Any> {
        None
    }

    /// How many colors a sweep has.
    fn n_colors(&self) -> usize;

    /// How many passes beside the sweep itself an iteration has.
    fn n_passes(&self) -> usize;

    /// Takes another solver.
    ///
    /// # Errors
    /// It does not exist here; the old one stays.
    fn set_solver(&mut self, model: &Model, solver: &Solver) -> Result<(), SolverError>;

    /// Moves the target of attachment `idx`, which exists \[m\].
    fn set_attachment_target(&mut self, idx: usize, target: Vec3);

    /// What depends on the time step alone. Returns at once where it is the same.
    ///
    /// # Errors
    /// The model has no solution in numbers for this time step.
    fn prepare(&mut self, h: f32) -> Result<(), SolverError>;

    /// Where a frame begins.
    fn load(&mut self, state: &State);

    /// Line 1: `q⁰ = q + h v + h² M⁻¹ f`.
    fn predict(&mut self, model: &Model, forces: &Forces, h: f32);

    /// Makes ready for lines 3 to 8, from what was predicted.
    fn begin(&mut self, h: f32);

    /// Lines 3 to 8.
    fn stages(&mut self) -> &mut dyn Stages;

    /// Line 9: `v = (q' − q) / h`, damped; the next (small) step begins where this one ends.
    fn update_velocities(&mut self, forces: &Forces, h: f32);

    /// Where the frame has ended.
    ///
    /// # Errors
    /// It is not a state; `state` is as it was.
    fn store(&mut self, model: &Model, state: &mut State) -> Result<(), SolverError>;
}
