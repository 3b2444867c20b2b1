//! A model, prepared for a solver.

mod stepping;

use glam::{Vec3, Vec4};
use vivace_coloring::{Vivace, color};
use vivace_kernels::Backend;
use vivace_model::{Model, ModelError, State, Tear};

use crate::collisions::Collisions;
use crate::device::OnDevice;
use crate::engine::Engine;
use crate::host::Host;
use crate::rounding::Rounding;
use crate::step::Ease;
use crate::{Framework, Relaxation, Solver, SolverError};

/// A model with everything that does not change from frame to frame: coloring, matrix, scratch. A step allocates nothing after the
/// first of its size.
///
/// Work runs in the rayon pool it is called in; the answer is the same, bit for bit, on any number of threads.
#[derive(Debug)]
pub struct System {
    model: Model,
    rounding: Rounding,
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
            rounding: Rounding::new(&model),
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
        self.rounding = Rounding::new(&self.model);
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
        self.rounding = Rounding::new(&model);
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
    /// ([`StepReport::colors`](crate::StepReport::colors) counts those, too), are as many as any frame may take. Where a coloring does not end within its rounds or its
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
