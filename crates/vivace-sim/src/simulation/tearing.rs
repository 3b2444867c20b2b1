//! What tears.

use std::time::Instant;

use vivace_model::{Model, Tear};
use vivace_scene::Hold;
use vivace_solver::{Budget, StepReport};

use super::Simulation;
use crate::{SimError, Torn};

impl Simulation {
    /// A step, and what tears after it.
    pub(super) fn step_and_tear(&mut self, budget: Budget) -> Result<StepReport, SimError> {
        if !self.model().can_tear() {
            return Ok(self.system.step(&mut self.state, &self.forces, self.time_step, budget)?);
        }
        self.before.clone_from(&self.state);
        let ease = self.system.ease();
        let mut report = self.system.step(&mut self.state, &self.forces, self.time_step, budget)?;
        let start = Instant::now();
        if let Err(error) = self.tear(&mut report) {
            self.state.clone_from(&self.before);
            self.system.set_ease(ease);
            return Err(error);
        }
        report.times.tear = start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// Tears what is stretched too far.
    fn tear(&mut self, report: &mut StepReport) -> Result<(), SimError> {
        let tears = self.model().find_tears(&self.state.positions);
        if tears.is_empty() {
            return Ok(());
        }
        if self.whole.is_none() {
            self.whole = Some(self.unheld()?);
        }
        self.system.tear(&mut self.state, &tears)?;
        self.forget_place();
        self.grabs.iter_mut().for_each(|patch| patch.tear(&tears));
        for tear in &tears {
            match tear {
                Tear::Split { triangles, .. } => {
                    report.tears.copies += 1;
                    report.tears.triangles += triangles.len();
                }
                Tear::Break { .. } => report.tears.springs += 1,
            }
        }
        self.tears.push(Torn { frame: self.frame + 1, tears });
        Ok(())
    }

    /// The model, held by nobody.
    pub(super) fn unheld(&self) -> Result<Box<Model>, SimError> {
        let mut model = Box::new(self.model().clone());
        let pins = self.grabs.iter().filter(|patch| patch.hold == Hold::Pin);
        pins.flat_map(|patch| &patch.particles).try_for_each(|&particle| model.unpin(particle))?;
        model.replace_attachments(self.n_attachments, &[])?;
        Ok(model)
    }

    /// What has torn since the start, frame by frame. Positions, velocities and the model's surface, springs and hinges have changed with it:
    /// copies are numbered after all particles that were there, triangles keep their numbers.
    #[must_use]
    pub fn tears(&self) -> &[Torn] {
        &self.tears
    }
}
