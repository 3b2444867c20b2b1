//! A model on its way through time.

mod holding;
mod restoring;
mod tearing;
mod unseen;

use std::ops::Range;
use std::path::Path;
#[cfg(feature = "gpu")]
use std::sync::Arc;

use vivace_model::{Forces, Model, ModelError, State, check_time_step};
use vivace_scene::{Built, Held, Scene};
use vivace_solver::collision::{self, Contact, Obstacle};
use vivace_solver::{Budget, Collisions, PinMove, Solver, SolverError, StepReport, System};

use self::unseen::Seen;
use crate::{Backend, Patch, SimError, Torn, Vec3};

/// A model, its state, what acts on it, and a solver prepared for it.
///
/// Work runs in the rayon pool it is called in; under a budget of iterations the answer is the same, bit for bit, on any number of
/// threads.
#[derive(Debug)]
pub struct Simulation {
    system: System,
    state: State,
    forces: Forces,
    time_step: f32,
    frame: u64,
    time: f64,
    /// What the host has seen last, where frames have passed since that it has not.
    seen: Option<Seen>,
    is_on_device: bool,
    /// Where the solver has each particle, for positions that are read aside.
    #[cfg(feature = "gpu")]
    place: Option<Arc<[u32]>>,
    /// Where the scene's obstacles stand at the start, and how fast they move \[m/s\].
    obstacles: Vec<(Obstacle, Vec3)>,
    /// What the scene drags.
    drags: Vec<Held>,
    /// How many of the model's attachments are its own; those of grabs follow.
    n_attachments: usize,
    grabs: Vec<Patch>,
    n_grabs: u64,
    moves: Vec<PinMove>,
    /// The model as it was built; there once something has torn.
    whole: Option<Box<Model>>,
    tears: Vec<Torn>,
    /// The state before a step, of a model that may tear.
    before: State,
}

impl Simulation {
    /// Builds a scene; files of meshes are looked for in the current folder.
    ///
    /// # Errors
    /// What [`Scene::build`] and the solver refuse.
    pub fn new(scene: &Scene, solver: Solver) -> Result<Self, SimError> {
        Self::new_in(scene, Path::new("."), solver)
    }

    /// Builds a scene; files of meshes are looked for in `folder`.
    ///
    /// # Errors
    /// As [`Simulation::new`].
    pub fn new_in(scene: &Scene, folder: &Path, solver: Solver) -> Result<Self, SimError> {
        Self::build(scene, folder, solver, Backend::cpu())
    }

    /// Reads and builds a scene file (.ron or .json); files of meshes are looked for beside it.
    ///
    /// # Errors
    /// As [`Simulation::new`]; the file cannot be read.
    pub fn load(path: impl AsRef<Path>, solver: Solver) -> Result<Self, SimError> {
        let path = path.as_ref();
        let folder = path.parent().unwrap_or(Path::new("."));
        Self::new_in(&Scene::load(path)?, folder, solver)
    }

    /// Builds a scene and simulates it on `backend`; files of meshes are looked for in the current folder.
    ///
    /// # Errors
    /// As [`Simulation::new`]; what the backend does not do, or does not hold.
    pub fn new_on(scene: &Scene, solver: Solver, backend: Backend) -> Result<Self, SimError> {
        Self::build(scene, Path::new("."), solver, backend)
    }

    pub(crate) fn build(
        scene: &Scene,
        folder: &Path,
        solver: Solver,
        backend: Backend,
    ) -> Result<Self, SimError> {
        let Built { model, state, drags } = scene.build_all(folder)?;
        let mut simulation =
            Self::from_model_on(model, state, scene.forces, scene.time_step, solver, backend)?;
        simulation.drags = drags;
        if let Some(collisions) = &scene.collisions {
            simulation.set_collisions(Some(collisions), folder)?;
        }
        Ok(simulation)
    }

    /// Lets the model collide from where it is now, which is taken as its shape at rest and should not intersect itself; or no more.
    /// Files of obstacles are looked for in `folder`.
    ///
    /// # Errors
    /// A thickness that the mesh is too fine for; an obstacle that cannot be; what a device does not hold.
    pub fn set_collisions(
        &mut self,
        collisions: Option<&vivace_scene::Collisions>,
        folder: &Path,
    ) -> Result<(), SimError> {
        self.sync()?;
        let Some(of) = collisions else {
            self.obstacles.clear();
            return Ok(self.system.set_collisions(None)?);
        };
        let standing = of.obstacles(folder)?;
        let collisions = Collisions::new(self.model(), &self.state.positions, of.options());
        self.system.set_collisions(Some(collisions.map_err(SolverError::Collision)?))?;
        let velocities = of.obstacles.iter().map(|obstacle| obstacle.velocity);
        self.obstacles = standing.into_iter().zip(velocities).collect();
        Ok(())
    }

    /// Puts the obstacles where they are in this frame.
    fn place_obstacles(&mut self) {
        let (start, end) = (self.time, self.time + f64::from(self.time_step));
        let Some(collisions) = self.system.collisions_mut() else { return };
        let obstacles = collisions.obstacles_mut();
        obstacles.clear();
        for (obstacle, velocity) in &self.obstacles {
            let mut obstacle = obstacle.clone();
            let pose = obstacle.from;
            (obstacle.from, obstacle.to) = (at(pose, *velocity, start), at(pose, *velocity, end));
            obstacles.push(obstacle);
        }
    }

    /// The contacts that the last step has found; none without collisions, or where they stay on a device.
    #[must_use]
    pub fn contacts(&self) -> &[Contact] {
        self.system.collisions().map_or(&[], Collisions::contacts)
    }

    /// Where the scene's obstacles stand now, in order.
    pub fn obstacles(&self) -> impl ExactSizeIterator<Item = collision::Pose> {
        self.obstacles.iter().map(|(obstacle, velocity)| at(obstacle.from, *velocity, self.time))
    }

    /// A model of your own, with `time_step` \[s\] from frame to frame.
    ///
    /// # Errors
    /// A state, force, time step or solver that cannot be.
    pub fn from_model(
        model: Model,
        state: State,
        forces: Forces,
        time_step: f32,
        solver: Solver,
    ) -> Result<Self, SimError> {
        Self::from_model_on(model, state, forces, time_step, solver, Backend::cpu())
    }

    /// As [`Simulation::from_model`], on `backend`. On a GPU positions and velocities stay there from step to step; each step reads them
    /// back once, and writes them only where [`Simulation::set_state`] or a snapshot has changed them.
    ///
    /// # Errors
    /// As [`Simulation::from_model`]; what the backend does not do, or does not hold.
    pub fn from_model_on(
        model: Model,
        state: State,
        forces: Forces,
        time_step: f32,
        solver: Solver,
        backend: Backend,
    ) -> Result<Self, SimError> {
        state.check(&model)?;
        forces.check()?;
        check_time_step(time_step)?;
        let n_attachments = model.constraints().attachments.len();
        let is_on_device = backend.is_device();
        let system = backend.system(model, solver)?;
        Ok(Self {
            system,
            state,
            forces,
            time_step,
            frame: 0,
            time: 0.0,
            seen: None,
            is_on_device,
            #[cfg(feature = "gpu")]
            place: None,
            obstacles: Vec::new(),
            drags: Vec::new(),
            n_attachments,
            grabs: Vec::new(),
            n_grabs: 0,
            moves: Vec::new(),
            whole: None,
            tears: Vec::new(),
            before: State::default(),
        })
    }

    /// The next frame.
    ///
    /// # Errors
    /// A budget or force that cannot be; particles that the scene is to drag now and cannot; a result that is not finite; a GPU that fails
    /// or is lost. The simulation is then as it was.
    pub fn step(&mut self, budget: Budget) -> Result<StepReport, SimError> {
        if self.seen.is_some() && !self.needs_host() {
            let report = self.advance(budget)?;
            self.sync()?;
            return Ok(report);
        }
        self.sync()?;
        self.place_obstacles();
        let (start, end) = (self.time, self.time + f64::from(self.time_step));
        let before = self.follow_drags(start, end)?;
        match self.lead(end).and_then(|()| self.step_and_tear(budget)) {
            Ok(report) => {
                self.count_frame();
                Ok(report)
            }
            Err(error) => {
                if let Some((grabs, n_grabs)) = before {
                    self.set_grabs(grabs)?;
                    self.n_grabs = n_grabs;
                }
                self.lead(start)?;
                Err(error)
            }
        }
    }

    fn count_frame(&mut self) {
        self.frame += 1;
        self.time += f64::from(self.time_step);
    }

    /// Whether each step reports its objective \[J\] and residual \[N\], which takes about as long as two iterations, not counted
    /// in the budget. It is not part of a snapshot.
    pub fn set_measuring(&mut self, is_on: bool) {
        self.system.set_measuring(is_on);
    }

    /// Positions \[m\], as the host has seen them last: see [`Simulation::advance`].
    #[must_use]
    pub fn positions(&self) -> &[Vec3] {
        &self.state.positions
    }

    /// Positions and velocities, as the host has seen them last: see [`Simulation::advance`].
    #[must_use]
    pub fn state(&self) -> &State {
        &self.state
    }

    /// Puts the particles elsewhere.
    ///
    /// # Errors
    /// Arrays of a wrong length, or a particle whose values are not finite or are beyond 10¹²; the old state stays.
    pub fn set_state(&mut self, state: State) -> Result<(), SimError> {
        state.check(self.system.model())?;
        self.state = state;
        self.seen = None;
        Ok(())
    }

    /// The particles of body `body` of the scene, from 0: where they stand in [`Simulation::positions`] and in [`State`]. `None` if
    /// there is no such body. In a model of your own see [`Model::bodies`].
    #[must_use]
    pub fn particles_of(&self, body: usize) -> Option<Range<usize>> {
        self.model().bodies().get(body).map(|body| body.start as usize..body.end as usize)
    }

    /// The attachments of body `body` of the scene, from 0, for [`Simulation::set_target`]; none if there is no such body.
    pub fn attachments_of(&self, body: usize) -> impl Iterator<Item = usize> {
        self.model().attachments_of(body).take_while(|&attachment| attachment < self.n_attachments)
    }

    /// Moves the target of an attachment \[m\]: dragging.
    ///
    /// # Errors
    /// There is no such attachment; a target that is not finite or is beyond 10¹² m.
    pub fn set_target(&mut self, attachment: usize, target: Vec3) -> Result<(), SimError> {
        let n_attachments = self.n_attachments;
        if attachment >= n_attachments {
            return Err(ModelError::Attachment { attachment, n_attachments }.into());
        }
        Ok(self.system.set_attachment_target(attachment, target)?)
    }

    /// Where the attachments pull to \[m\].
    pub fn targets(&self) -> impl ExactSizeIterator<Item = Vec3> {
        self.model().attachments().take(self.n_attachments).map(|(_, target, _)| target)
    }

    /// What acts on the particles.
    #[must_use]
    pub fn forces(&self) -> &Forces {
        &self.forces
    }

    /// Changes what acts on the particles, from the next step on, which checks it.
    pub fn forces_mut(&mut self) -> &mut Forces {
        &mut self.forces
    }

    /// The model.
    #[must_use]
    pub fn model(&self) -> &Model {
        self.system.model()
    }

    /// The solver.
    #[must_use]
    pub fn solver(&self) -> Solver {
        self.system.solver()
    }

    /// Goes on with another solver.
    ///
    /// # Errors
    /// It cannot be; the old one stays. As [`Simulation::sync`].
    pub fn set_solver(&mut self, solver: Solver) -> Result<(), SimError> {
        self.sync()?;
        self.system.set_solver(solver)?;
        self.forget_place();
        Ok(())
    }

    /// Time from frame to frame \[s\].
    #[must_use]
    pub fn time_step(&self) -> f32 {
        self.time_step
    }

    /// Changes the time from frame to frame \[s\], from the next step on, which prepares the system anew.
    ///
    /// # Errors
    /// Not above 0 and at most 1000; the old one stays.
    pub fn set_time_step(&mut self, time_step: f32) -> Result<(), SimError> {
        check_time_step(time_step)?;
        self.time_step = time_step;
        Ok(())
    }

    /// Steps since the start.
    #[must_use]
    pub fn frame(&self) -> u64 {
        self.frame
    }

    /// Time since the start \[s\].
    #[must_use]
    pub fn time(&self) -> f64 {
        self.time
    }
}

/// A pose at the start, `time` \[s\] later.
fn at(pose: collision::Pose, velocity: Vec3, time: f64) -> collision::Pose {
    let position = pose.position.as_dvec3() + velocity.as_dvec3() * time;
    collision::Pose { position: position.as_vec3(), ..pose }
}
