//! What is held, by hand and by the scene.

use std::collections::BTreeSet;

use vivace_model::ModelError;
use vivace_scene::{Held, Hold, Pose};
use vivace_solver::PinMove;

use super::Simulation;
use crate::{Grab, Patch, SimError, Vec3};

impl Simulation {
    /// Takes and lets go what the scene drags from or until a time in [`start`, `end`). Returns what was held before, if that
    /// is something else.
    pub(super) fn follow_drags(
        &mut self,
        start: f64,
        end: f64,
    ) -> Result<Option<(Vec<Patch>, u64)>, SimError> {
        let is_now = |time: f64| (start..end).contains(&time.max(0.0));
        let is_changed = |drag: &Held| is_now(drag.path.start()) || drag.release.is_some_and(is_now);
        if !self.drags.iter().any(is_changed) {
            return Ok(None);
        }
        let (mut grabs, mut n_grabs) = (self.grabs.clone(), self.n_grabs);
        for (idx, drag) in self.drags.iter().enumerate() {
            if is_now(drag.path.start()) {
                grabs.push(Patch { drag: Some(idx), ..self.patch(&drag.particles, drag.hold, n_grabs)? });
                n_grabs += 1;
            }
            if drag.release.is_some_and(is_now) {
                grabs.retain(|patch| patch.drag != Some(idx));
            }
        }
        let before = (self.grabs.clone(), self.n_grabs);
        self.set_grabs(grabs)?;
        self.n_grabs = n_grabs;
        Ok(Some(before))
    }

    /// Leads what is held to where it has to be at `time` \[s\].
    pub(super) fn lead(&mut self, time: f64) -> Result<(), SimError> {
        self.moves.clear();
        let mut attachment = self.n_attachments;
        for patch in &mut self.grabs {
            if let Some(drag) = patch.drag.and_then(|idx| self.drags.get(idx)) {
                patch.pose = drag.path.pose(time);
            }
            for (particle, to) in patch.targets() {
                let from = self.state.positions[particle as usize];
                match patch.hold {
                    Hold::Pin if from != to => self.moves.push(PinMove { particle, from, to }),
                    Hold::Pin => {}
                    Hold::Spring(_) => {
                        self.system.set_attachment_target(attachment, to)?;
                        attachment += 1;
                    }
                }
            }
        }
        Ok(self.system.move_pins(&self.moves)?)
    }

    /// Takes hold of particles where they are now, until [`Simulation::release`]: by a spring of its own for each, whose other end can be
    /// moved, or as if by an infinite mass. A patch keeps its shape at those ends: see [`Simulation::move_grab`].
    ///
    /// Springs change no more than the diagonal of Y (a direct solver factors it anew in the next step); pins are no unknowns, and
    /// the system is prepared anew. Both cost nothing per frame once it is done, but moving the ends.
    ///
    /// # Errors
    /// No particles, one that does not exist, is named twice or is pinned; a stiffness that is not finite and positive. Nothing has
    /// changed.
    ///
    /// ```
    /// use vivace_sim::{Budget, Hold, Simulation, Solver, Vec3, scene::tablecloth};
    ///
    /// let mut simulation = Simulation::new(&tablecloth(20), Solver::default())?;
    /// let hand = simulation.grab(&[398, 399], Hold::Spring(1000.0))?;
    /// for frame in 1..=10 {
    ///     simulation.drag(hand, Vec3::Y * 0.01 * frame as f32)?;
    ///     simulation.step(Budget::iterations(20))?;
    /// }
    /// assert!((simulation.positions()[399].y - 0.1).abs() < 0.01);
    /// simulation.release(hand)?;
    /// # Ok::<(), vivace_sim::SimError>(())
    /// ```
    pub fn grab(&mut self, particles: &[u32], hold: Hold) -> Result<Grab, SimError> {
        self.sync()?;
        let patch = self.patch(particles, hold, self.n_grabs)?;
        let grab = patch.grab;
        self.set_grabs(self.grabs.iter().cloned().chain([patch]).collect())?;
        self.n_grabs += 1;
        Ok(grab)
    }

    /// Particles where they are now.
    fn patch(&self, particles: &[u32], hold: Hold, number: u64) -> Result<Patch, SimError> {
        let at = |&particle: &u32| self.state.positions.get(particle as usize).copied().unwrap_or_default();
        let taken_at: Vec<Vec3> = particles.iter().map(at).collect();
        let patch = Patch {
            grab: Grab(number),
            particles: particles.to_vec(),
            middle: Patch::middle_of(&taken_at),
            taken_at,
            hold,
            pose: Pose::IDENTITY,
            drag: None,
        };
        patch.check(self.model().n_particles())?;
        match particles.iter().find(|&&particle| self.model().is_pinned(particle)) {
            Some(&particle) => Err(ModelError::Pinned { particle }.into()),
            None => Ok(patch),
        }
    }

    /// Where what is held has to be at the end of the next step, seen from where it was taken \[m\].
    ///
    /// # Errors
    /// As [`Simulation::move_grab`].
    pub fn drag(&mut self, grab: Grab, by: Vec3) -> Result<(), SimError> {
        let rotation = self.grabs[self.held(grab)?].pose.rotation;
        self.move_grab(grab, Pose { at: by, rotation })
    }

    /// Where what is held has to be at the end of the next step: turned about the middle of where it was taken, then moved. What the
    /// scene dragged until now is yours from then on.
    ///
    /// # Errors
    /// There is no such grab; a target that is not finite or is beyond 10¹² m, a rotation that is none. Nothing has changed.
    pub fn move_grab(&mut self, grab: Grab, pose: Pose) -> Result<(), SimError> {
        let idx = self.held(grab)?;
        let n_particles = self.model().n_particles();
        let patch = &mut self.grabs[idx];
        let before = std::mem::replace(&mut patch.pose, pose);
        if let Err(error) = patch.check(n_particles) {
            patch.pose = before;
            return Err(error);
        }
        patch.drag = None;
        Ok(())
    }

    /// Lets go: from the next step on all is as if the particles had never been held, but for where they are and how they move.
    ///
    /// # Errors
    /// There is no such grab.
    pub fn release(&mut self, grab: Grab) -> Result<(), SimError> {
        self.held(grab)?;
        self.set_grabs(self.grabs.iter().filter(|patch| patch.grab != grab).cloned().collect())
    }

    /// What is held.
    #[must_use]
    pub fn grabs(&self) -> &[Patch] {
        &self.grabs
    }

    fn held(&self, grab: Grab) -> Result<usize, SimError> {
        let idx = self.grabs.iter().position(|patch| patch.grab == grab);
        idx.ok_or(SimError::NoGrab { grab: grab.0 })
    }

    /// Holds these, and nothing else.
    pub(super) fn set_grabs(&mut self, grabs: Vec<Patch>) -> Result<(), SimError> {
        let pins = |grabs: &[Patch]| -> BTreeSet<u32> {
            let pins = grabs.iter().filter(|patch| patch.hold == Hold::Pin);
            pins.flat_map(|patch| &patch.particles).copied().collect()
        };
        let springs = |patch: &Patch| match patch.hold {
            Hold::Pin => Vec::new(),
            Hold::Spring(stiffness) => patch.targets().map(|(p, target)| (p, target, stiffness)).collect(),
        };
        let (old, new) = (pins(&self.grabs), pins(&grabs));
        let springs: Vec<(u32, Vec3, f32)> = grabs.iter().flat_map(springs).collect();
        if old == new {
            self.system.replace_attachments(self.n_attachments, &springs)?;
        } else {
            let mut model = self.model().clone();
            old.difference(&new).try_for_each(|&particle| model.unpin(particle))?;
            new.difference(&old).try_for_each(|&particle| model.pin(particle))?;
            model.replace_attachments(self.n_attachments, &springs)?;
            self.system.set_model(model)?;
        }
        self.forget_place();
        self.grabs = grabs;
        Ok(())
    }
}
