//! An engine on the host: what both frameworks share there, before and after they solve.

use std::fmt::Debug;

use glam::{DMat3, Vec3};
use vivace_collision::Detector;
use vivace_model::{Forces, Model, State};

use crate::collisions::Collisions;
use crate::contacts::Found;
use crate::engine::Engine;
use crate::pbd::PositionBased;
use crate::pd::ProjectiveDynamics;
use crate::{ContactReport, Framework, Solver, SolverError, Stages};

/// A framework on the host.
pub(crate) trait Solve: Stages + Debug + Send + Sync {
    /// How many passes an iteration has.
    fn n_passes(&self) -> usize;

    /// See [`Engine::set_attachment_target`].
    fn set_attachment_target(&mut self, idx: usize, target: Vec3);

    /// See [`Engine::set_attachments`].
    fn set_attachments(&mut self, model: &Model);

    /// See [`Engine::prepare`].
    fn prepare(&mut self, h: f32) -> Result<(), SolverError>;

    /// Takes the contacts of a small step, after [`Solve::prepare`] and before [`Solve::begin`]; how many colors they have.
    fn set_contacts(&mut self, found: &Found<'_>) -> usize;

    /// Begins a step of `h` \[s\] from `predicted` (s of Eq. 1) \[m\], in the model's order.
    fn begin(&mut self, h: f32, predicted: &[Vec3]);

    /// Writes the positions, in the model's order \[m\].
    fn end(&mut self, positions: &mut [Vec3]);
}

/// A framework, and what moves.
#[derive(Debug)]
pub(crate) struct Host {
    framework: Box<dyn Solve>,
    /// Positions before the (small) step, predicted, and after it; velocities and accelerations.
    before: Vec<Vec3>,
    predicted: Vec<Vec3>,
    after: Vec<Vec3>,
    velocities: Vec<Vec3>,
    accelerations: Vec<Vec3>,
    /// Scratch of the wind: empty without one.
    drags: Vec<DMat3>,
}

/// The framework that `solver` asks for.
fn framework(model: &Model, solver: &Solver, colors: &[u32]) -> Result<Box<dyn Solve>, SolverError> {
    Ok(match solver.framework {
        Framework::ProjectiveDynamics { local, vertex } => {
            Box::new(ProjectiveDynamics::new(model, local, vertex, solver.relaxation, colors)?)
        }
        Framework::PositionBased => Box::new(PositionBased::new(model)?),
    })
}

impl Host {
    /// Prepares `model` for `solver`.
    ///
    /// # Errors
    /// More constraints than 32 bits can number.
    pub(crate) fn new(model: &Model, solver: &Solver, colors: &[u32]) -> Result<Self, SolverError> {
        let zeros = || vec![Vec3::ZERO; model.n_particles()];
        Ok(Self {
            framework: framework(model, solver, colors)?,
            before: zeros(),
            predicted: zeros(),
            after: zeros(),
            velocities: zeros(),
            accelerations: zeros(),
            drags: Vec::new(),
        })
    }
}

impl Engine for Host {
    fn n_colors(&self) -> usize {
        self.framework.n_colors() as usize
    }

    fn n_passes(&self) -> usize {
        self.framework.n_passes()
    }

    fn set_solver(
        &mut self,
        model: &Model,
        solver: &Solver,
        colors: &[u32],
        _: Option<&Detector>,
    ) -> Result<(), SolverError> {
        // Another model may have other particles.
        *self = Self::new(model, solver, colors)?;
        Ok(())
    }

    fn set_attachments(
        &mut self,
        model: &Model,
        _: &Solver,
        _: &[u32],
        _: Option<&Detector>,
    ) -> Result<(), SolverError> {
        self.framework.set_attachments(model);
        Ok(())
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        self.framework.set_attachment_target(idx, target);
    }

    fn prepare(&mut self, h: f32) -> Result<(), SolverError> {
        self.framework.prepare(h)
    }

    fn load(&mut self, state: &State) {
        self.before.copy_from_slice(&state.positions);
        self.velocities.copy_from_slice(&state.velocities);
    }

    fn predict(&mut self, model: &Model, forces: &Forces, h: f32) {
        self.accelerations.fill(forces.gravity);
        let (q, v) = (&self.before, &self.velocities);
        forces.add_wind(model, h.into(), q, v, &mut self.drags, |particle, acceleration| {
            self.accelerations[particle] += acceleration.as_vec3();
        });
        for (particle, predicted) in self.predicted.iter_mut().enumerate() {
            let (q, v) = (self.before[particle], self.velocities[particle]);
            let is_free = model.masses()[particle].is_finite();
            *predicted = if is_free { q + h * (v + h * self.accelerations[particle]) } else { q };
        }
    }

    fn place(&mut self, pins: &[(u32, Vec3)]) {
        pins.iter().for_each(|&(particle, at)| self.predicted[particle as usize] = at);
    }

    fn detect(
        &mut self,
        collisions: &mut Collisions,
        h: f32,
        report: &mut ContactReport,
    ) -> Result<(), SolverError> {
        collisions.detect(&self.before, &self.predicted, h, report)
    }

    fn take_contacts(&mut self, collisions: &Collisions, h: f32, report: &mut ContactReport) {
        report.colors = self.framework.set_contacts(&collisions.found(&self.before, h));
    }

    fn drop_contacts(&mut self) {
        self.framework.set_contacts(&Found { contacts: &[], before: &self.before, h: 1.0 });
    }

    fn guard(&mut self, collisions: &mut Collisions, report: &mut ContactReport) -> Result<(), SolverError> {
        collisions.limit(&self.before, &mut self.after, report)
    }

    fn begin(&mut self, h: f32) {
        self.framework.begin(h, &self.predicted);
    }

    fn stages(&mut self) -> &mut dyn Stages {
        &mut *self.framework
    }

    fn end(&mut self) {
        self.framework.end(&mut self.after);
    }

    fn update_velocities(&mut self, forces: &Forces, h: f32) {
        let scale = (-forces.damping * h).exp() / h;
        for ((velocity, after), before) in self.velocities.iter_mut().zip(&self.after).zip(&self.before) {
            *velocity = (*after - *before) * scale;
        }
        self.before.copy_from_slice(&self.after);
    }

    fn store(&mut self, model: &Model, state: &mut State) -> Result<(), SolverError> {
        check_end(model, &self.after, &self.velocities)?;
        state.positions.copy_from_slice(&self.after);
        state.velocities.copy_from_slice(&self.velocities);
        Ok(())
    }
}

/// Whether a frame has ended in a state.
///
/// # Errors
/// Names the particle that left the range of numbers.
pub(crate) fn check_end(model: &Model, positions: &[Vec3], velocities: &[Vec3]) -> Result<(), SolverError> {
    let is_bad = |i: &usize| !(State::is_in_range(positions[*i]) && State::is_in_range(velocities[*i]));
    // A pinned particle is never the cause: it has moved by 0 times what is not finite.
    let cause = |i: &usize| (model.masses()[*i].is_infinite(), *i);
    let worst = (0..positions.len()).filter(is_bad).min_by_key(cause);
    worst.map_or(Ok(()), |particle| Err(SolverError::Diverged { particle }))
}
