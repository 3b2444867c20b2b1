//! What runs the lines of Algorithm 1.

use std::any::Any;
use std::fmt::Debug;

use glam::Vec3;
use vivace_model::{Forces, Model, State};

use crate::collisions::Collisions;
use crate::contacts::ContactMemory;
use crate::{ContactReport, Solver, SolverError, Stages};

/// A framework where it runs, with the positions and velocities of a frame.
pub(crate) trait Engine: Debug + Send + Sync {
    /// Where there is a backend: it, the positions on it, and the place of each of the model's particles among them.
    fn resident(&mut self) -> Option<(&dyn Any, &dyn Any, &[u32])> {
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

    /// Makes ready for collisions, or forgets them.
    ///
    /// # Errors
    /// More primitives than can be numbered; what a device does not hold.
    fn set_collisions(&mut self, collisions: Option<&Collisions>) -> Result<(), SolverError> {
        let _ = collisions;
        Ok(())
    }

    /// Finds the contacts of the step from where it begins to what was predicted, and takes them.
    ///
    /// # Errors
    /// Detection refuses what was predicted, or an obstacle.
    fn collide(
        &mut self,
        model: &Model,
        collisions: &mut Collisions,
        h: f32,
        report: &mut ContactReport,
    ) -> Result<(), SolverError>;

    /// After lines 3 to 8: holds back what would pass through.
    ///
    /// # Errors
    /// As [`Engine::collide`].
    fn guard(&mut self, collisions: &mut Collisions, report: &mut ContactReport) -> Result<(), SolverError>;

    /// After [`Engine::store`]: what contacts did in the step, where that was not told before.
    ///
    /// # Errors
    /// What went wrong in finding out.
    fn report_contacts(&mut self, report: &mut ContactReport) -> Result<(), SolverError> {
        let _ = report;
        Ok(())
    }

    /// What the coloring of the next step depends on.
    fn memory(&self) -> ContactMemory {
        ContactMemory::default()
    }

    /// Takes up where another stood.
    ///
    /// # Errors
    /// It is not that of this model.
    fn set_memory(&mut self, _: &ContactMemory) -> Result<(), SolverError> {
        Ok(())
    }

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
