//! What runs the lines of Algorithm 1.

use std::any::Any;
use std::fmt::Debug;

use glam::Vec3;
use vivace_collision::Detector;
use vivace_coloring::Vivace;
use vivace_model::{Forces, Model, State};

use crate::collisions::Collisions;
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

    /// Takes another solver, or another model, whose particles have these colors and whose surface is prepared for detection so, if there
    /// are any.
    ///
    /// # Errors
    /// It does not exist here; the old one stays.
    fn set_solver(
        &mut self,
        model: &Model,
        solver: &Solver,
        colors: &[u32],
        detector: Option<&Detector>,
    ) -> Result<(), SolverError>;

    /// Colors anew in every frame, or no more.
    ///
    /// # Errors
    /// The engine does not.
    fn set_recoloring(&mut self, recoloring: Option<Vivace>) -> Result<(), SolverError> {
        let why = "the CPU keeps particles color by color";
        recoloring.map_or(Ok(()), |_| Err(SolverError::NoRecoloring { why }))
    }

    /// A frame begins: line 2, where it colors anew; what contacts did is counted anew.
    fn begin_frame(&mut self) {}

    /// Moves the target of attachment `idx`, which exists \[m\].
    fn set_attachment_target(&mut self, idx: usize, target: Vec3);

    /// Takes the attachments of `model`, of which nothing else has changed. What held a state may have lost it.
    ///
    /// # Errors
    /// What this engine does not hold; the old ones stay.
    fn set_attachments(
        &mut self,
        model: &Model,
        solver: &Solver,
        colors: &[u32],
        detector: Option<&Detector>,
    ) -> Result<(), SolverError>;

    /// What depends on the time step alone. Returns at once where it is the same.
    ///
    /// # Errors
    /// The model has no solution in numbers for this time step.
    fn prepare(&mut self, h: f32) -> Result<(), SolverError>;

    /// Where a frame begins.
    fn load(&mut self, state: &State);

    /// Line 1: `q⁰ = q + h v + h² M⁻¹ f`.
    fn predict(&mut self, model: &Model, forces: &Forces, h: f32);

    /// After line 1: puts pinned particles elsewhere \[m\].
    fn place(&mut self, pins: &[(u32, Vec3)]);

    /// Finds the contacts of the (small) step of `h` \[s\] from where it begins to what was predicted for its end.
    ///
    /// # Errors
    /// Detection refuses what was predicted, or an obstacle.
    fn detect(
        &mut self,
        collisions: &mut Collisions,
        h: f32,
        report: &mut ContactReport,
    ) -> Result<(), SolverError>;

    /// Makes constraints of the contacts that were found, where that is apart from finding them.
    fn take_contacts(&mut self, collisions: &Collisions, h: f32, report: &mut ContactReport) {
        let _ = (collisions, h, report);
    }

    /// Forgets contacts, until there are others.
    fn drop_contacts(&mut self);

    /// After line 8: holds back what has passed through something since the (small) step began.
    ///
    /// # Errors
    /// As [`Engine::detect`].
    fn guard(&mut self, collisions: &mut Collisions, report: &mut ContactReport) -> Result<(), SolverError>;

    /// After all that: what contacts did in the step, where that was not told before; whether some were left out for want of room, and there is
    /// more room now.
    ///
    /// # Errors
    /// What went wrong in finding out, or in making room.
    fn report_contacts(&mut self, report: &mut ContactReport) -> Result<bool, SolverError> {
        let _ = report;
        Ok(false)
    }

    /// Makes ready for lines 3 to 8, from what was predicted.
    fn begin(&mut self, h: f32);

    /// Lines 3 to 8.
    fn stages(&mut self) -> &mut dyn Stages;

    /// After line 8: hands over what was solved for.
    fn end(&mut self) {}

    /// Line 9: `v = (q' − q) / h`, damped; the next (small) step begins where this one ends.
    fn update_velocities(&mut self, forces: &Forces, h: f32);

    /// Where the frame has ended.
    ///
    /// # Errors
    /// It is not a state; `state` is as it was.
    fn store(&mut self, model: &Model, state: &mut State) -> Result<(), SolverError>;
}
