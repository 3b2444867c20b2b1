//! A model on its way through time.

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::Path;
#[cfg(feature = "gpu")]
use std::sync::Arc;
use std::time::Instant;

use vivace_model::{Forces, Model, ModelError, State, Tear, check_time_step};
use vivace_scene::{Built, Held, Hold, Pose, Scene};
#[cfg(feature = "gpu")]
use vivace_solver::Resident;
use vivace_solver::collision::{self, Contact, Obstacle};
use vivace_solver::{
    Budget, Collisions, ContactMemory, Ease, PinMove, Solver, SolverError, StepReport, System,
};

#[cfg(feature = "gpu")]
use crate::gpu::Gpu;
use crate::{Backend, Grab, Patch, PendingPositions, SimError, Snapshot, Torn, Vec3};

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
            let pose = obstacle.from;
            (obstacle.from, obstacle.to) = (at(pose, *velocity, start), at(pose, *velocity, end));
            obstacles.push(obstacle);
        }
    }

    /// The contacts that the last step has found; none without collisions.
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

    /// A step, and what tears after it.
    fn step_and_tear(&mut self, budget: Budget) -> Result<StepReport, SimError> {
        if !self.model().can_tear() {
            return Ok(self.system.step(&mut self.state, &self.forces, self.time_step, budget)?);
        }
        self.before.clone_from(&self.state);
        let ease = self.system.ease();
        let contacts = self.system.collisions().map(|_| self.system.contact_memory());
        let mut report = self.system.step(&mut self.state, &self.forces, self.time_step, budget)?;
        let start = Instant::now();
        if let Err(error) = self.tear(&mut report) {
            self.state.clone_from(&self.before);
            self.system.set_ease(ease);
            contacts.map_or(Ok(()), |contacts| self.system.set_contact_memory(&contacts))?;
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
    fn unheld(&self) -> Result<Box<Model>, SimError> {
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

    /// Takes and lets go what the scene drags from or until a time in [`start`, `end`). Returns what was held before, if that
    /// is something else.
    fn follow_drags(&mut self, start: f64, end: f64) -> Result<Option<(Vec<Patch>, u64)>, SimError> {
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
    fn lead(&mut self, time: f64) -> Result<(), SimError> {
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
    fn set_grabs(&mut self, grabs: Vec<Patch>) -> Result<(), SimError> {
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

    fn count_frame(&mut self) {
        self.frame += 1;
        self.time += f64::from(self.time_step);
    }

    /// Whether a frame is led or ended by what the host sees: grabs, drags, tears.
    fn needs_host(&self) -> bool {
        !self.grabs.is_empty() || !self.drags.is_empty() || self.model().can_tear()
    }

    /// The system was prepared anew, in another order perhaps.
    fn forget_place(&mut self) {
        #[cfg(feature = "gpu")]
        {
            self.place = None;
        }
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
        let now = self.unheld()?;
        let (grabs, contacts) = (self.grabs.clone(), self.system.contact_memory());
        let targets: Vec<Vec3> = self.targets().collect();
        let is_torn = model.is_some();
        if let Err(error) = self.take(model, &snapshot.grabs, &snapshot.targets, &snapshot.contacts) {
            self.take(is_torn.then_some(now), &grabs, &targets, &contacts)?;
            return Err(error);
        }
        if is_torn {
            self.whole.get_or_insert(now);
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
        contacts: &ContactMemory,
    ) -> Result<(), SimError> {
        if let Some(model) = unheld {
            self.system.set_model(*model)?;
            self.grabs.clear();
        }
        self.set_grabs(grabs.to_vec())?;
        for (attachment, &target) in targets.iter().enumerate() {
            self.set_target(attachment, target)?;
        }
        Ok(self.system.set_contact_memory(contacts)?)
    }
}

/// A pose at the start, `time` \[s\] later.
fn at(pose: collision::Pose, velocity: Vec3, time: f64) -> collision::Pose {
    let position = pose.position.as_dvec3() + velocity.as_dvec3() * time;
    collision::Pose { position: position.as_vec3(), ..pose }
}
