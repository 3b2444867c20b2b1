//! A model on its way through time.

use std::ops::Range;
use std::path::Path;
#[cfg(feature = "gpu")]
use std::sync::Arc;

use vivace_model::{Forces, Model, ModelError, State, check_time_step};
use vivace_scene::Scene;
#[cfg(feature = "gpu")]
use vivace_solver::Resident;
use vivace_solver::collision::Obstacle;
use vivace_solver::{Budget, Collisions, Ease, Solver, SolverError, StepReport, System};

#[cfg(feature = "gpu")]
use crate::gpu::Gpu;
use crate::{Backend, PendingPositions, SimError, Snapshot, Vec3};

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
}

/// Where the state of a simulation is that of an earlier frame.
#[derive(Debug, Clone, Copy)]
struct Seen {
    frame: u64,
    time: f64,
    ease: Ease,
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
        let (model, state) = scene.build(folder)?;
        let mut simulation =
            Self::from_model_on(model, state, scene.forces, scene.time_step, solver, backend)?;
        if let Some(collisions) = &scene.collisions {
            simulation.set_collisions(Some(collisions), folder)?;
        }
        Ok(simulation)
    }

    /// Lets the model collide from where it is now, which is taken as its shape at rest and should not intersect itself; or no more.
    /// Files of obstacles are looked for in `folder`.
    ///
    /// # Errors
    /// A thickness that the mesh is too fine for; an obstacle that cannot be; a solver or a backend that has no collisions.
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
            let position = obstacle.from.position.as_dvec3();
            let at = |time: f64| (position + velocity.as_dvec3() * time).as_vec3();
            (obstacle.from.position, obstacle.to.position) = (at(start), at(end));
            obstacles.push(obstacle);
        }
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
        })
    }

    /// The next frame.
    ///
    /// # Errors
    /// A budget or force that cannot be; a result that is not finite; a GPU that fails or is lost. The simulation is then as it was.
    pub fn step(&mut self, budget: Budget) -> Result<StepReport, SimError> {
        if self.seen.is_some() {
            let report = self.advance(budget)?;
            self.sync()?;
            return Ok(report);
        }
        self.place_obstacles();
        let report = self.system.step(&mut self.state, &self.forces, self.time_step, budget)?;
        self.count_frame();
        Ok(report)
    }

    fn count_frame(&mut self) {
        self.frame += 1;
        self.time += f64::from(self.time_step);
    }

    /// The next frame, which on a GPU stays there: the host waits for nothing, and [`Simulation::positions`], [`Simulation::state`] and
    /// [`Simulation::snapshot`] are those of the last frame that it has seen, until [`Simulation::sync`] or [`Simulation::step`]. A budget
    /// of seconds or a tolerance makes it wait all the same. On the CPU this is [`Simulation::step`].
    ///
    /// # Errors
    /// As [`Simulation::step`]; what goes wrong on a GPU comes out of [`Simulation::sync`]. The simulation is then as the host has seen it
    /// last.
    pub fn advance(&mut self, budget: Budget) -> Result<StepReport, SimError> {
        if !self.is_on_device {
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
        self.model().attachments_of(body)
    }

    /// Moves the target of an attachment \[m\]: dragging.
    ///
    /// # Errors
    /// There is no such attachment; a target that is not finite or is beyond 10¹² m.
    pub fn set_target(&mut self, attachment: usize, target: Vec3) -> Result<(), SimError> {
        Ok(self.system.set_attachment_target(attachment, target)?)
    }

    /// Where the attachments pull to \[m\].
    pub fn targets(&self) -> impl ExactSizeIterator<Item = Vec3> {
        self.model().constraints().attachments.rest.iter().map(|attachment| attachment.target)
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
        #[cfg(feature = "gpu")]
        {
            self.place = None;
        }
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
            contacts: self.system.contact_memory(),
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
        count("particles", self.model().n_particles(), snapshot.state.positions.len())?;
        count("attachments", self.model().constraints().attachments.len(), snapshot.targets.len())?;
        snapshot.state.check(self.model())?;
        snapshot.forces.check()?;
        check_time_step(snapshot.time_step)?;
        if !snapshot.time.is_finite() {
            #[expect(clippy::cast_possible_truncation, reason = "not a number, or infinite")]
            let (what, value) = ("the time of the snapshot [s]", snapshot.time as f32);
            return Err(ModelError::Value { what, value, need: "finite" }.into());
        }
        let contacts = self.system.contact_memory();
        self.system.set_contact_memory(&snapshot.contacts)?;
        let before: Vec<Vec3> = self.targets().collect();
        for (attachment, &target) in snapshot.targets.iter().enumerate() {
            if let Err(error) = self.set_target(attachment, target) {
                for (attachment, &target) in before.iter().enumerate() {
                    self.set_target(attachment, target)?;
                }
                self.system.set_contact_memory(&contacts)?;
                return Err(error);
            }
        }
        self.system.set_ease(snapshot.ease);
        self.seen = None;
        self.state.clone_from(&snapshot.state);
        self.forces = snapshot.forces;
        self.time_step = snapshot.time_step;
        self.frame = snapshot.frame;
        self.time = snapshot.time;
        Ok(())
    }
}
