//! A model, prepared for a solver.

use std::time::Instant;

use glam::{Vec3, Vec4};
use vivace_coloring::{Vivace, color};
use vivace_kernels::Backend;
use vivace_model::{Forces, Model, ModelError, State, Tear, check_time_step};

use crate::collisions::Collisions;
use crate::contacts::{ContactMemory, SmallStep};
use crate::device::OnDevice;
use crate::engine::Engine;
use crate::host::Host;
use crate::step::{Ease, solve};
use crate::{Budget, ContactReport, Framework, Relaxation, Solver, SolverError, StepReport};

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
    /// Colors of the particles that were built, once a tear has made more of them: see [`System::tear`].
    home: Vec<u32>,
    /// Where pinned particles go in the next step, and in a small one.
    moves: Vec<PinMove>,
    pins: Vec<(u32, Vec3)>,
}

/// The way of a pinned particle in a step.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PinMove {
    /// The particle.
    pub particle: u32,
    /// Where it is at the start \[m\].
    pub from: Vec3,
    /// Where it is at the end \[m\].
    pub to: Vec3,
}

impl PinMove {
    /// Where it is at the end of small step `k` of `n`.
    fn after(&self, k: u32, n: u32) -> (u32, Vec3) {
        let to = if k + 1 == n { self.to } else { self.from.lerp(self.to, (k + 1) as f32 / n as f32) };
        (self.particle, to)
    }
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

impl System {
    /// Prepares `model` for `solver`: graph, coloring, rows of Y.
    ///
    /// # Errors
    /// Parameters out of range; a combination that does not exist; more constraints than 32 bits can number.
    pub fn new(model: Model, solver: Solver) -> Result<Self, SolverError> {
        solver.check()?;
        let engine = Host::new(&model, &solver, &[])?;
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
        Self {
            model,
            solver,
            engine,
            ease,
            is_measuring: false,
            collisions: None,
            has_state: false,
            home: Vec::new(),
            moves: Vec::new(),
            pins: Vec::new(),
        }
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
        let colors = self.colors_of(&self.model);
        let detector = self.collisions.as_ref().map(Collisions::detector);
        self.engine.set_solver(&self.model, &solver, &colors, detector)?;
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
        self.engine.stages().forget();
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

    /// Keeps the first `n` attachments, and puts `more` in place of the others: particle, target \[m\], stiffness \[N/m\]. The graph and its
    /// coloring stay as they are; what depends on the diagonal of Y is made anew in the next step, a factor of Y too. (On a device in
    /// Position Based Dynamics all is made anew.) Before [`System::advance`] a state has to be loaded.
    ///
    /// # Errors
    /// As [`Model::replace_attachments`]; what a device does not hold. Nothing has changed.
    pub fn replace_attachments(&mut self, n: usize, more: &[(u32, Vec3, f32)]) -> Result<(), SolverError> {
        let kept: Vec<(u32, Vec3, f32)> = self.model.attachments().skip(n).collect();
        self.model.replace_attachments(n, more)?;
        let colors = self.colors_of(&self.model);
        let detector = self.collisions.as_ref().map(Collisions::detector);
        if let Err(error) = self.engine.set_attachments(&self.model, &self.solver, &colors, detector) {
            self.model.replace_attachments(n, &kept)?;
            return Err(error);
        }
        self.has_state = false;
        Ok(())
    }

    /// Takes what has become of the model by [`Model::pin`], [`Model::tear`] and the like: all but the coloring, which is inherited where
    /// something is torn, and what the safeguard remembers is made anew.
    ///
    /// # Errors
    /// As [`System::new`]; what detection refuses. The old model stays.
    pub fn set_model(&mut self, model: Model) -> Result<(), SolverError> {
        if self.home.is_empty() && model.parents().len() > self.model.parents().len() {
            self.home = color(&self.model.graph()?).colors().to_vec();
        }
        let (parents, old) = (model.parents(), self.model.parents());
        let n_same = parents.iter().zip(old).take_while(|(new, old)| new == old).count();
        let n_kept = model.n_particles() - parents.len() + n_same;
        let is_torn = model.surface() != self.model.surface();
        let torn = self.collisions.as_ref().filter(|_| is_torn).map(|all| all.torn(&model, n_kept));
        let torn = torn.transpose()?;
        let colors = self.colors_of(&model);
        let detector = self.collisions.as_ref().map(Collisions::detector);
        let detector = torn.as_ref().map(|(detector, _)| detector).or(detector);
        self.engine.set_solver(&model, &self.solver, &colors, detector)?;
        if let (Some(collisions), Some(torn)) = (&mut self.collisions, torn) {
            collisions.set_torn(torn);
        }
        self.model = model;
        self.has_state = false;
        self.moves.clear();
        Ok(())
    }

    /// The colors that a torn model inherits: each copy has that of its parent, whose neighbors its own are copies of. None for a model that
    /// is not torn.
    fn colors_of(&self, model: &Model) -> Vec<u32> {
        let n_built = model.n_particles() - model.parents().len();
        if model.parents().is_empty() || self.home.len() < n_built {
            return Vec::new();
        }
        // A system that was made of a torn model begins with more than was built.
        let mut colors = self.home.clone();
        colors.truncate(model.n_particles());
        for &parent in &model.parents()[colors.len() - n_built..] {
            colors.push(colors[parent as usize]);
        }
        colors
    }

    /// Tears the model and its state: see [`Model::find_tears`]. Costs what [`System::set_model`] does.
    ///
    /// # Errors
    /// A state that is not of this model; tears that are not; what a device does not hold. Nothing has changed.
    pub fn tear(&mut self, state: &mut State, tears: &[Tear]) -> Result<(), SolverError> {
        state.check(&self.model)?;
        let mut model = self.model.clone();
        model.tear(tears)?;
        self.set_model(model)?;
        state.tear(tears);
        Ok(())
    }

    /// Moves pinned particles in the next step, evenly over its small steps; in that after it they rest. Replaces what was asked for
    /// before.
    ///
    /// # Errors
    /// A particle that does not exist or is not pinned; a position that [`State::is_in_range`] refuses. Nothing has changed.
    pub fn move_pins(&mut self, moves: &[PinMove]) -> Result<(), ModelError> {
        for &PinMove { particle, from, to } in moves {
            if particle as usize >= self.model.n_particles() || !self.model.is_pinned(particle) {
                return Err(ModelError::NotPinned { particle });
            }
            if let Some(&value) = [from, to].iter().find(|at| !State::is_in_range(**at)) {
                let (what, particle) = ("ways of pinned particles", particle as usize);
                return Err(ModelError::NotFinite { what, particle, value });
            }
        }
        self.moves.clear();
        self.moves.extend_from_slice(moves);
        Ok(())
    }

    /// Lets the model collide, or no more.
    ///
    /// # Errors
    /// More primitives than can be numbered; what a device does not hold.
    pub fn set_collisions(&mut self, collisions: Option<Collisions>) -> Result<(), SolverError> {
        // Contacts of the last step are gone.
        let colors = self.colors_of(&self.model);
        let detector = collisions.as_ref().map(Collisions::detector);
        self.engine.set_solver(&self.model, &self.solver, &colors, detector)?;
        self.has_state = false;
        self.collisions = collisions;
        Ok(())
    }

    /// Colors the graph anew in every frame, by rounds of Algorithm 2 with another seed each time, or no more: line 2 where the paper has it,
    /// for what its cost is. On a device, in Projective Dynamics; nobody waits for it, so its classes, some of which may be empty
    /// ([`StepReport::colors`] counts those, too), are as many as any frame may take. Where a coloring does not end within its rounds or its
    /// colors, the frame takes the one that the system was made with. Another solver ends it, and a snapshot does not know of it.
    ///
    /// # Errors
    /// [`SolverError::NoRecoloring`]: the CPU, Position Based Dynamics, a relaxation that does not sweep color by color, or a graph of more
    /// than some sixty colors.
    pub fn set_recoloring(&mut self, recoloring: Option<Vivace>) -> Result<(), SolverError> {
        let is_swept = self.solver.relaxation.is_colored()
            && !matches!(self.solver.relaxation, Relaxation::ConjugateGradient { .. });
        if recoloring.is_some() && !is_swept {
            return Err(SolverError::NoRecoloring { why: "its relaxation does not sweep color by color" });
        }
        self.engine.set_recoloring(recoloring)
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
        let start = Instant::now();
        self.engine.stages().learn(&mut self.ease, &mut StepReport::default());
        let before = self.before();
        check(forces, h, &budget)?;
        self.load(state)?;
        let mut report = self.advance_from(start, forces, h, &budget, &before)?;
        let mut finish_start = Instant::now();
        // Contacts that found no room are looked for again, with more: until there is as much as there may be.
        loop {
            match self.engine.report_contacts(&mut report.contacts) {
                Ok(false) => break,
                Ok(true) => {
                    self.set_ease(before.ease);
                    self.engine.load(state);
                    report = self.advance_from(start, forces, h, &budget, &before)?;
                    finish_start = Instant::now();
                }
                Err(error) => return Err(self.undo(error, &before)),
            }
        }
        self.moves.clear();
        self.engine.stages().learn(&mut self.ease, &mut report);
        if let Err(error) = self.read(state) {
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
    /// is read back, but what a tolerance looks at: the safeguard decides there, and [`System::ease`] hears of it with [`System::store`],
    /// which also tells what went wrong; its report counts no backoffs, has no objective of the safeguard's and knows no contacts. Room
    /// for contacts is what the last [`System::step`] or [`System::store`] has left.
    ///
    /// # Errors
    /// A force, step or budget that cannot be simulated; there is no state: nothing has changed then. Contacts that cannot be found: another
    /// state has to be loaded.
    pub fn advance(&mut self, forces: &Forces, h: f32, budget: Budget) -> Result<StepReport, SolverError> {
        let (start, before) = (Instant::now(), self.before());
        check(forces, h, &budget)?;
        let report = self.advance_from(start, forces, h, &budget, &before)?;
        self.moves.clear();
        Ok(report)
    }

    /// Reads the state where the last step has left it.
    ///
    /// # Errors
    /// There is none; it is not finite, or the device has failed: `state` is as it was, and another has to be loaded.
    pub fn store(&mut self, state: &mut State) -> Result<(), SolverError> {
        if !self.has_state {
            return Err(SolverError::NoState);
        }
        let found = self.engine.report_contacts(&mut ContactReport::default());
        self.has_state = found.is_ok();
        found?;
        self.read(state)
    }

    fn read(&mut self, state: &mut State) -> Result<(), SolverError> {
        if !std::mem::take(&mut self.has_state) {
            return Err(SolverError::NoState);
        }
        state.check(&self.model)?;
        self.engine.stages().learn(&mut self.ease, &mut StepReport::default());
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
        self.engine.recolor();
        report.times.setup = start.elapsed().as_secs_f64();
        if let Err(error) = self.substeps(forces, h, n_substeps, budget, start, &mut report) {
            return Err(self.undo(error, before));
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
        self.set_ease(before.ease);
        self.has_state = false;
        let restored = before.memory.as_ref().map_or(Ok(()), |memory| self.engine.set_memory(memory));
        restored.err().unwrap_or(error)
    }

    /// Algorithm 1 for each of `n` small steps; contacts are looked for before the first, and held to after the last.
    fn substeps(
        &mut self,
        forces: &Forces,
        h: f32,
        n: u32,
        budget: &Budget,
        start: Instant,
        report: &mut StepReport,
    ) -> Result<(), SolverError> {
        let predict_start = Instant::now();
        if self.collisions.is_some() {
            self.predict(forces, h, [0, 1]);
        }
        let detect_start = Instant::now();
        report.times.predict += (detect_start - predict_start).as_secs_f64();
        if let Some(collisions) = &mut self.collisions {
            self.engine.detect(collisions, h, &mut report.contacts)?;
            report.times.detect += detect_start.elapsed().as_secs_f64();
        }
        let small_h = h / n as f32;
        for k in 0..n {
            let share = share_of(budget, k, n);
            let small = SmallStep { k, n, h: small_h };
            self.substep(forces, small, &share, start, report)?;
        }
        if let Some(collisions) = &mut self.collisions {
            let guard_start = Instant::now();
            self.engine.guard(collisions, forces, h, &mut report.contacts)?;
            report.times.guard += guard_start.elapsed().as_secs_f64();
        }
        Ok(())
    }

    /// Line 1, with pinned particles where they are led, after small step k of n.
    fn predict(&mut self, forces: &Forces, h: f32, [k, n]: [u32; 2]) {
        self.engine.predict(&self.model, forces, h);
        self.pins.clear();
        self.pins.extend(self.moves.iter().map(|way| way.after(k, n)));
        if !self.pins.is_empty() {
            self.engine.place(&self.pins);
        }
    }

    /// Algorithm 1.
    fn substep(
        &mut self,
        forces: &Forces,
        small: SmallStep,
        budget: &Budget,
        start: Instant,
        report: &mut StepReport,
    ) -> Result<(), SolverError> {
        let predict_start = Instant::now();
        // That of a step which is one small step has been made for its contacts.
        if self.collisions.is_none() || small.n > 1 {
            self.predict(forces, small.h, [small.k, small.n]);
        }
        let estimate_start = Instant::now();
        report.times.predict += (estimate_start - predict_start).as_secs_f64();
        if self.ease.lacks_rho(self.solver.relaxation, small.h) {
            self.engine.begin(small.h);
            self.ease.estimate_rho(self.engine.stages(), self.solver.relaxation, small.h);
            report.times.setup += estimate_start.elapsed().as_secs_f64();
        }
        let color_start = Instant::now();
        if let Some(collisions) = &self.collisions {
            self.engine.take_contacts(&self.model, collisions, small, &mut report.contacts)?;
            let seconds = color_start.elapsed().as_secs_f64();
            // Later small steps have the same contacts, and color none.
            *(if small.k == 0 { &mut report.times.color } else { &mut report.times.solve }) += seconds;
        }
        let solve_start = Instant::now();
        self.engine.begin(small.h);
        solve(self.engine.stages(), &self.solver, budget, start, &mut self.ease, report);
        let finish_start = Instant::now();
        report.times.solve += (finish_start - solve_start).as_secs_f64();
        self.engine.update_velocities(forces, small.h);
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
