//! A model, prepared for a solver.

use std::time::Instant;

use glam::{Vec3, Vec4};
use vivace_kernels::Backend;
use vivace_model::{Forces, Model, ModelError, State, check_time_step};

use crate::collisions::Collisions;
use crate::contacts::ContactMemory;
use crate::device::OnDevice;
use crate::engine::Engine;
use crate::host::Host;
use crate::step::{Ease, solve};
use crate::{Budget, Framework, Relaxation, Solver, SolverError, StepReport};

/// A model with everything that does not change from frame to frame: coloring, matrix, scratch. A step allocates nothing after the
/// first of its size.
///
/// Work runs in the rayon pool it is called in; the answer is the same, bit for bit, on any number of threads.
#[derive(Debug)]
pub struct System {
    model: Model,
    solver: Solver,
    engine: Box<dyn Engine>,
    ease: Ease,
    is_measuring: bool,
    collisions: Option<Collisions>,
    /// Whether the engine holds a state to go on from.
    has_state: bool,
}

/// A state where it lies on a device, for a renderer there.
pub struct Resident<'a, B: Backend> {
    /// The device.
    pub backend: &'a B,
    /// Positions \[m\] as the last step has left them, and inverse masses \[1/kg\], 0 where pinned: in the solver's order, color by color.
    pub positions: &'a B::Buffer<Vec4>,
    /// Where each of the model's particles is in it.
    pub place: &'a [u32],
}

impl<B: Backend> std::fmt::Debug for Resident<'_, B> {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Resident").field("place", &self.place.len()).finish_non_exhaustive()
    }
}

/// What a step that failed has to bring back.
struct Before {
    ease: Ease,
    memory: Option<ContactMemory>,
}

/// Whether `solver` can do with contacts.
fn check_contacts(solver: &Solver, collisions: Option<&Collisions>) -> Result<(), SolverError> {
    let is_linear = matches!(solver.relaxation, Relaxation::Direct | Relaxation::ConjugateGradient { .. });
    if is_linear && collisions.is_some() {
        return Err(SolverError::NoContacts { relaxation: solver.relaxation.name() });
    }
    Ok(())
}

impl System {
    /// Prepares `model` for `solver`: graph, coloring, rows of Y.
    ///
    /// # Errors
    /// Parameters out of range; a combination that does not exist; more constraints than 32 bits can number.
    pub fn new(model: Model, solver: Solver) -> Result<Self, SolverError> {
        solver.check()?;
        let engine = Host::new(&model, &solver)?;
        Ok(Self::with_engine(model, solver, Box::new(engine)))
    }

    /// Prepares `model` for `solver` on a device, where its positions then stay from frame to frame: see [`System::step`]. Position
    /// Based Dynamics with every relaxation, Projective Dynamics with every one that is not serial.
    ///
    /// # Errors
    /// As [`System::new`]; what is not done on a device; what this one does not hold.
    pub fn on<B: Backend + Send + 'static>(
        model: Model,
        solver: Solver,
        backend: B,
    ) -> Result<Self, SolverError> {
        solver.check()?;
        let engine = OnDevice::new(backend, &model, &solver)?;
        Ok(Self::with_engine(model, solver, Box::new(engine)))
    }

    /// What [`System::on`] was given, and the positions on it; `None` on the CPU's own engine, or where the backend is of another type.
    pub fn resident<B: Backend + 'static>(&mut self) -> Option<Resident<'_, B>> {
        let (backend, positions, place) = self.engine.resident()?;
        Some(Resident { backend: backend.downcast_ref()?, positions: positions.downcast_ref()?, place })
    }

    fn with_engine(model: Model, solver: Solver, engine: Box<dyn Engine>) -> Self {
        let ease = Ease::default();
        Self { model, solver, engine, ease, is_measuring: false, collisions: None, has_state: false }
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The solver.
    #[must_use]
    pub fn solver(&self) -> Solver {
        self.solver
    }

    /// Takes another solver for the same model.
    ///
    /// # Errors
    /// As [`System::new`]; the old solver stays.
    pub fn set_solver(&mut self, solver: Solver) -> Result<(), SolverError> {
        solver.check()?;
        check_contacts(&solver, self.collisions.as_ref())?;
        self.engine.set_solver(&self.model, &solver)?;
        self.engine.set_collisions(self.collisions.as_ref())?;
        self.solver = solver;
        self.ease = Ease::default();
        self.has_state = false;
        Ok(())
    }

    /// What the safeguard remembers: with the state, all that the next step depends on.
    #[must_use]
    pub fn ease(&self) -> Ease {
        self.ease
    }

    /// Takes up where another system stood.
    pub fn set_ease(&mut self, ease: Ease) {
        self.ease = ease.clamped();
    }

    /// Whether each step reports its objective and residual, which takes about as long as two iterations.
    pub fn set_measuring(&mut self, is_on: bool) {
        self.is_measuring = is_on;
    }

    /// Moves the target of attachment `idx` \[m\]: dragging.
    ///
    /// # Errors
    /// As [`Model::set_attachment_target`].
    pub fn set_attachment_target(&mut self, idx: usize, target: Vec3) -> Result<(), ModelError> {
        self.model.set_attachment_target(idx, target)?;
        self.engine.set_attachment_target(idx, target);
        Ok(())
    }

    /// Lets the model collide, or no more.
    ///
    /// # Errors
    /// [`SolverError::NoContacts`]: the relaxation has none; what a device does not hold.
    pub fn set_collisions(&mut self, collisions: Option<Collisions>) -> Result<(), SolverError> {
        check_contacts(&self.solver, collisions.as_ref())?;
        // Those of the last step are gone.
        self.engine.set_solver(&self.model, &self.solver)?;
        self.engine.set_collisions(collisions.as_ref())?;
        self.has_state = false;
        self.collisions = collisions;
        Ok(())
    }

    /// Collisions, where there are any.
    #[must_use]
    pub fn collisions(&self) -> Option<&Collisions> {
        self.collisions.as_ref()
    }

    /// Collisions, where there are any: to move obstacles.
    pub fn collisions_mut(&mut self) -> Option<&mut Collisions> {
        self.collisions.as_mut()
    }

    /// What the coloring of the next step depends on beside its contacts: with [`System::ease`] and the state, all that the next step
    /// depends on.
    #[must_use]
    pub fn contact_memory(&self) -> ContactMemory {
        self.engine.memory()
    }

    /// Takes up where another system of this model stood.
    ///
    /// # Errors
    /// [`SolverError::Memory`]: it is not of this model. Nothing has changed.
    pub fn set_contact_memory(&mut self, memory: &ContactMemory) -> Result<(), SolverError> {
        self.engine.set_memory(memory)
    }

    /// How many colors a sweep has.
    #[must_use]
    pub fn n_colors(&self) -> usize {
        self.engine.n_colors()
    }

    /// How many passes beside the sweep itself an iteration has: one for each kind of constraint that needs one.
    #[must_use]
    pub fn n_passes(&self) -> usize {
        self.engine.n_passes()
    }

    /// Advances `state` by `h` \[s\]: Algorithm 1, once for each small step. On a device, `state` is written there unless it is the
    /// one that the last step has left, and read back when the frame is done; a budget of seconds makes the host wait after each
    /// iteration, a tolerance makes it look. Times are the host's: without such a budget most of a device's stand under `finish`.
    ///
    /// # Errors
    /// A state, force, step or budget that cannot be simulated; a result that is not finite. The state is then as it was.
    pub fn step(
        &mut self,
        state: &mut State,
        forces: &Forces,
        h: f32,
        budget: Budget,
    ) -> Result<StepReport, SolverError> {
        let (start, before) = (Instant::now(), self.before());
        check(forces, h, &budget)?;
        self.load(state)?;
        let mut report = self.advance_from(start, forces, h, &budget, &before)?;
        let finish_start = Instant::now();
        let stored = self.store(state);
        if let Err(error) = stored.and_then(|()| self.engine.report_contacts(&mut report.contacts)) {
            return Err(self.undo(error, &before));
        }
        report.times.finish += finish_start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// Puts a state where the system runs: for steps whose positions the host need not see, see [`System::advance`].
    ///
    /// # Errors
    /// A state that cannot be simulated.
    pub fn load(&mut self, state: &State) -> Result<(), SolverError> {
        state.check(&self.model)?;
        self.engine.load(state);
        self.has_state = true;
        Ok(())
    }

    /// As [`System::step`], from where the last step, this one or [`System::load`] has left the state to where it stays. On a device nothing
    /// is read back, but what the budget and the safeguard look at: contacts are not reported, and what went wrong comes out of [`System::store`].
    ///
    /// # Errors
    /// A force, step or budget that cannot be simulated; there is no state: nothing has changed then. Contacts that cannot be found: another
    /// state has to be loaded.
    pub fn advance(&mut self, forces: &Forces, h: f32, budget: Budget) -> Result<StepReport, SolverError> {
        let (start, before) = (Instant::now(), self.before());
        check(forces, h, &budget)?;
        self.advance_from(start, forces, h, &budget, &before)
    }

    /// Reads the state where the last step has left it.
    ///
    /// # Errors
    /// There is none; it is not finite, or the device has failed: `state` is as it was, and another has to be loaded.
    pub fn store(&mut self, state: &mut State) -> Result<(), SolverError> {
        if !std::mem::take(&mut self.has_state) {
            return Err(SolverError::NoState);
        }
        state.check(&self.model)?;
        self.engine.store(&self.model, state)?;
        self.has_state = true;
        Ok(())
    }

    fn advance_from(
        &mut self,
        start: Instant,
        forces: &Forces,
        h: f32,
        budget: &Budget,
        before: &Before,
    ) -> Result<StepReport, SolverError> {
        if !self.has_state {
            return Err(SolverError::NoState);
        }
        let n_substeps = self.solver.substeps.min(budget.iterations.unwrap_or(u32::MAX)).max(1);
        let small_h = h / n_substeps as f32;
        let mut report = StepReport::default();
        self.engine.prepare(small_h)?;
        report.times.setup = start.elapsed().as_secs_f64();
        for substep in 0..n_substeps {
            let share = share_of(budget, substep, n_substeps);
            if let Some(collisions) = &mut self.collisions {
                collisions.begin(substep, n_substeps);
            }
            if let Err(error) = self.substep(forces, small_h, &share, start, &mut report) {
                return Err(self.undo(error, before));
            }
        }
        let finish_start = Instant::now();
        if self.is_measuring {
            self.measure(&mut report);
        }
        if self.solver.relaxation.is_colored() {
            report.colors = u32::try_from(self.n_colors()).unwrap_or(u32::MAX);
        }
        report.times.finish += finish_start.elapsed().as_secs_f64();
        Ok(report)
    }

    /// What a step may change beside the state.
    fn before(&self) -> Before {
        Before { ease: self.ease, memory: self.collisions.is_some().then(|| self.engine.memory()) }
    }

    /// What comes back with `error`. The engine has no state any more.
    fn undo(&mut self, error: SolverError, before: &Before) -> SolverError {
        self.ease = before.ease;
        self.has_state = false;
        let restored = before.memory.as_ref().map_or(Ok(()), |memory| self.engine.set_memory(memory));
        restored.err().unwrap_or(error)
    }

    /// Algorithm 1.
    fn substep(
        &mut self,
        forces: &Forces,
        h: f32,
        budget: &Budget,
        start: Instant,
        report: &mut StepReport,
    ) -> Result<(), SolverError> {
        let predict_start = Instant::now();
        self.engine.predict(&self.model, forces, h);
        let detect_start = Instant::now();
        report.times.predict += (detect_start - predict_start).as_secs_f64();
        if let Some(collisions) = &mut self.collisions {
            self.engine.collide(&self.model, collisions, h, &mut report.contacts)?;
            report.times.detect += detect_start.elapsed().as_secs_f64();
        }
        let solve_start = Instant::now();
        self.engine.begin(h);
        solve(self.engine.stages(), &self.solver, budget, start, &mut self.ease, report);
        let guard_start = Instant::now();
        report.times.solve += (guard_start - solve_start).as_secs_f64();
        if let Some(collisions) = &mut self.collisions {
            self.engine.guard(collisions, &mut report.contacts)?;
            report.times.guard += guard_start.elapsed().as_secs_f64();
        }
        let finish_start = Instant::now();
        self.engine.update_velocities(forces, h);
        report.times.finish += finish_start.elapsed().as_secs_f64();
        Ok(())
    }

    /// The last small step, as it was left.
    fn measure(&mut self, report: &mut StepReport) {
        let stages = self.engine.stages();
        report.objective = Some(stages.objective());
        report.residual = Some(stages.residual());
    }

    /// What [`Relaxation::name`] calls the relaxation, and the framework.
    #[must_use]
    pub fn name(&self) -> String {
        let framework = match self.solver.framework {
            Framework::ProjectiveDynamics { .. } => "pd",
            Framework::PositionBased => "xpbd",
        };
        format!("{framework} {}", Relaxation::name(&self.solver.relaxation))
    }
}

fn check(forces: &Forces, h: f32, budget: &Budget) -> Result<(), SolverError> {
    budget.check()?;
    forces.check()?;
    Ok(check_time_step(h)?)
}

/// What small step `k` of `n` may use of a budget: its share of the iterations, and the time until its share has passed.
fn share_of(budget: &Budget, k: u32, n: u32) -> Budget {
    let iterations = budget.iterations.map(|all| {
        let until = |k: u32| u64::from(all) * u64::from(k) / u64::from(n);
        // At most `all`, which is 32-bit.
        u32::try_from(until(k + 1) - until(k)).unwrap_or(u32::MAX)
    });
    let seconds = budget.seconds.map(|all| all * f64::from(k + 1) / f64::from(n));
    Budget { iterations, seconds, ..*budget }
}

#[cfg(test)]
mod tests {
    use vivace_model::ModelBuilder;

    use super::*;

    #[test]
    fn what_is_too_heavy_or_stiff_for_numbers_is_not_pinned_in_silence() {
        for (mass, stiffness) in [(1e37, 1.0), (1.0, 3e38), (1e-44, 1e-44)] {
            let mut builder = ModelBuilder::new();
            builder.particles(&[Vec3::ZERO, Vec3::X, Vec3::Y], &[1.0, 1.0, mass]).unwrap();
            builder.springs(0, &[[2, 0], [2, 1]], stiffness).unwrap();
            builder.pin(0).unwrap();
            builder.pin(1).unwrap();
            let (model, mut state) = builder.build().unwrap();
            let before = state.clone();
            let mut system = System::new(model, Solver::default()).unwrap();
            let h = if mass < 1.0 { 1.0 } else { 0.01 };
            let error = system.step(&mut state, &Forces::default(), h, Budget::iterations(5)).unwrap_err();
            assert!(matches!(error, SolverError::Weight { particle: 2, .. }), "{error}");
            assert_eq!(state, before);
        }
    }
}
