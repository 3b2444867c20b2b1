//! Snapshots.

use vivace_model::{Model, ModelError, check_time_step};

use super::Simulation;
use super::unseen::Seen;
use crate::{Patch, SimError, Snapshot, Torn, Vec3};

impl Simulation {
    /// All that changes, to be kept, as the host has seen it last: see [`Simulation::advance`].
    #[must_use]
    pub fn snapshot(&self) -> Snapshot {
        let now = Seen { frame: self.frame, time: self.time, ease: self.system.ease() };
        let Seen { frame, time, ease } = self.seen.unwrap_or(now);
        Snapshot {
            frame,
            time,
            time_step: self.time_step,
            forces: self.forces,
            ease,
            grabs: self.grabs.clone(),
            n_grabs: self.n_grabs,
            tears: self.tears.clone(),
            targets: self.targets().collect(),
            state: self.state.clone(),
        }
    }

    /// Goes back to a snapshot, of this simulation or of another of the same scene. Under a budget of iterations the frames that
    /// follow are the same bit for bit.
    ///
    /// # Errors
    /// A snapshot of another model, or with values that cannot be; the simulation stays as it was.
    pub fn restore(&mut self, snapshot: &Snapshot) -> Result<(), SimError> {
        let count = |what, expected, found| {
            if expected == found { Ok(()) } else { Err(SimError::Snapshot { what, expected, found }) }
        };
        let model = self.model_of(&snapshot.tears)?;
        let n_particles = model.as_deref().unwrap_or(self.model()).n_particles();
        count("particles", n_particles, snapshot.state.positions.len())?;
        count("attachments", self.n_attachments, snapshot.targets.len())?;
        let n_drags = snapshot.grabs.iter().filter_map(|patch| patch.drag).max().map_or(0, |last| last + 1);
        count("drags", self.drags.len(), n_drags.max(self.drags.len()))?;
        snapshot.grabs.iter().try_for_each(|patch| patch.check(n_particles))?;
        snapshot.state.check(model.as_deref().unwrap_or(self.model()))?;
        snapshot.forces.check()?;
        check_time_step(snapshot.time_step)?;
        if !snapshot.time.is_finite() {
            #[expect(clippy::cast_possible_truncation, reason = "not a number, or infinite")]
            let (what, value) = ("the time of the snapshot [s]", snapshot.time as f32);
            return Err(ModelError::Value { what, value, need: "finite" }.into());
        }
        let unheld = model.is_some().then(|| self.unheld()).transpose()?;
        let grabs = self.grabs.clone();
        let targets: Vec<Vec3> = self.targets().collect();
        if let Err(error) = self.take(model, &snapshot.grabs, &snapshot.targets) {
            self.take(unheld, &grabs, &targets)?;
            return Err(error);
        }
        if let Some(unheld) = unheld {
            self.whole.get_or_insert(unheld);
            self.tears.clone_from(&snapshot.tears);
        }
        self.n_grabs = snapshot.n_grabs;
        self.system.set_ease(snapshot.ease);
        self.seen = None;
        self.state.clone_from(&snapshot.state);
        self.forces = snapshot.forces;
        self.time_step = snapshot.time_step;
        self.frame = snapshot.frame;
        self.time = snapshot.time;
        Ok(())
    }

    /// The model after `tears`, held by nobody; `None` if it is the present one.
    fn model_of(&self, tears: &[Torn]) -> Result<Option<Box<Model>>, SimError> {
        if tears == self.tears {
            return Ok(None);
        }
        let mut model = self.whole.clone().map_or_else(|| self.unheld(), Ok)?;
        tears.iter().try_for_each(|torn| model.tear(&torn.tears))?;
        Ok(Some(model))
    }

    /// What of a snapshot the system may refuse.
    fn take(
        &mut self,
        unheld: Option<Box<Model>>,
        grabs: &[Patch],
        targets: &[Vec3],
    ) -> Result<(), SimError> {
        if let Some(model) = unheld {
            self.system.set_model(*model)?;
            self.grabs.clear();
        }
        self.set_grabs(grabs.to_vec())?;
        for (attachment, &target) in targets.iter().enumerate() {
            self.set_target(attachment, target)?;
        }
        Ok(())
    }
}
