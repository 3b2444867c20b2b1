//! Frames that the host does not see.

use vivace_solver::{Budget, Ease, SolverError, StepReport};

use super::Simulation;
#[cfg(feature = "gpu")]
use crate::Resident;
#[cfg(feature = "gpu")]
use crate::gpu::Gpu;
use crate::{PendingPositions, SimError};

/// Where the state of a simulation is that of an earlier frame.
#[derive(Debug, Clone, Copy)]
pub(super) struct Seen {
    pub(super) frame: u64,
    pub(super) time: f64,
    pub(super) ease: Ease,
}

impl Simulation {
    /// Whether a frame is led or ended by what the host sees: grabs, drags, tears.
    pub(super) fn needs_host(&self) -> bool {
        !self.grabs.is_empty() || !self.drags.is_empty() || self.model().can_tear()
    }

    /// The next frame, which on a GPU stays there: the host waits for nothing, and [`Simulation::positions`], [`Simulation::state`] and
    /// [`Simulation::snapshot`] are those of the last frame that it has seen, until [`Simulation::sync`] or [`Simulation::step`]. A budget
    /// of seconds or a tolerance makes it wait all the same. On the CPU, and while something is held or may tear, this is [`Simulation::step`].
    ///
    /// # Errors
    /// As [`Simulation::step`]; what goes wrong on a GPU comes out of [`Simulation::sync`]. The simulation is then as the host has seen it
    /// last.
    pub fn advance(&mut self, budget: Budget) -> Result<StepReport, SimError> {
        if !self.is_on_device || self.needs_host() {
            return self.step(budget);
        }
        let seen = Seen { frame: self.frame, time: self.time, ease: self.system.ease() };
        if self.seen.is_none() {
            self.system.load(&self.state)?;
        }
        let report = self.system.advance(&self.forces, self.time_step, budget);
        let report = report.map_err(|error| self.go_back(error))?;
        self.seen.get_or_insert(seen);
        self.count_frame();
        Ok(report)
    }

    /// Lets the host see the last frame: waits for it, and reads it back. Returns at once where it has.
    ///
    /// # Errors
    /// A result that is not finite; a GPU that has failed or is lost. The simulation is then as the host has seen it last.
    pub fn sync(&mut self) -> Result<(), SimError> {
        if self.seen.is_some() {
            self.system.store(&mut self.state).map_err(|error| self.go_back(error))?;
            self.seen = None;
        }
        Ok(())
    }

    /// What the host has not seen is lost.
    fn go_back(&mut self, error: SolverError) -> SolverError {
        if let Some(Seen { frame, time, ease }) = self.seen.take() {
            (self.frame, self.time) = (frame, time);
            self.system.set_ease(ease);
        }
        error
    }

    /// The positions of the last frame on their way to the host, which goes on: see [`PendingPositions`]. There may be several at the same
    /// time; each holds the positions of its frame.
    ///
    /// # Errors
    /// The GPU has no memory for them, or is lost.
    pub fn read_positions(&mut self) -> Result<PendingPositions, SimError> {
        #[cfg(feature = "gpu")]
        if self.seen.is_some()
            && let Some(Resident { backend, positions, place }) = self.system.resident::<Gpu>()
        {
            let copy = backend.read_back(positions)?;
            let place = self.place.get_or_insert_with(|| place.into()).clone();
            return Ok(PendingPositions::on_the_way(copy, place));
        }
        Ok(PendingPositions::here(self.state.positions.clone()))
    }

    /// The positions where they lie on the GPU, for a renderer on the same device: those of the last frame, once there was one. `None` on
    /// the CPU.
    #[cfg(feature = "gpu")]
    pub fn resident(&mut self) -> Option<Resident<'_, Gpu>> {
        self.system.resident()
    }

    /// The system was prepared anew, in another order perhaps.
    pub(super) fn forget_place(&mut self) {
        #[cfg(feature = "gpu")]
        {
            self.place = None;
        }
    }
}
