//! The stages of Position Based Dynamics as runs of kernels: see `pbd/mod.rs`, of which this is the twin. Particles keep the model's
//! order.

use glam::{Vec3, Vec4};
use vivace_collision::Detector;
use vivace_coloring::Vivace;
use vivace_kernels::Backend;
use vivace_kernels::constraint::Xpbd;
use vivace_kernels::pbd::{Inertia, Residual, StepUniform};
use vivace_kernels::step::{CopyVector, ExtrapolateUniform, SetVector, SetVectorUniform, SquaredDistance};
use vivace_model::{Forces, Model, State};

use super::collide::Resists;
use super::history::History;
use super::kind::{Found, Kind, Kinds};
use super::motion::Motion;
use super::sums::Sums;
use super::watch::Watch;
use super::{Solve, failure};
use crate::error::narrow;
use crate::pbd::TOLERATED_RISE;
use crate::pd::layout::Layout;
use crate::{Ease, Relaxation, SolverError, StepReport};

/// A model prepared for Position Based Dynamics on a device, and all that changes in a frame.
pub(super) struct PositionBased<B: Backend> {
    kinds: Vec<Box<dyn Kind<B>>>,
    n_colors: u32,
    layout: Layout,
    n: u32,
    particles: B::List,
    squared_h: f32,
    predicted: B::Buffer<Vec4>,
    motion: Motion<B>,
    history: History<B>,
    gradients: B::Buffer<Vec4>,
    /// Numbers that are added up together.
    groups: Vec<u32>,
    sums: Sums<B>,
    watch: Watch<B, Xpbd>,
    /// What the device could not do in this frame.
    failed: Option<SolverError>,
}

impl<B: Backend + 'static> PositionBased<B> {
    /// Colors the constraints, where `relaxation` goes color by color, and takes all memory.
    pub(super) fn new(backend: &B, model: &Model, relaxation: Relaxation) -> Result<Self, SolverError> {
        let Found { kinds, lens, n_colors } = Kinds::of(backend, model, relaxation)?;
        let n = narrow("particles", model.n_particles())?;
        let layout = Layout::plain(model);
        let zeros = || backend.filled(n as usize, Vec4::ZERO);
        let groups: Vec<u32> = lens.into_iter().chain([n]).collect();
        let frame = Self {
            kinds,
            n_colors,
            n,
            particles: backend.range(0..n),
            squared_h: 1.0,
            predicted: zeros(),
            motion: Motion::new(backend, model, &layout, n),
            history: History::new(backend, n, n),
            gradients: zeros(),
            sums: Sums::new(backend, &groups),
            groups,
            watch: Watch::new(backend),
            failed: None,
            layout,
        };
        frame.check(backend)?;
        Ok(frame)
    }

    /// Whether the device holds all arrays.
    fn check(&self, backend: &B) -> Result<(), SolverError> {
        let checked = backend.fetch(&self.motion.q, &mut []);
        checked.and_then(|()| self.kinds.iter().try_for_each(|kind| kind.check(backend))).map_err(failure)
    }

    fn xpbd(&self, omega: f32) -> Xpbd {
        Xpbd { squared_h: self.squared_h, omega }
    }

    fn step(&self) -> StepUniform {
        StepUniform { squared_h: self.squared_h }
    }

    /// Adds up the objective \[J\].
    fn add_objective(&mut self, backend: &B) {
        let step = self.step();
        let Self { motion, sums, .. } = self;
        let inputs = (backend.view(&self.predicted), backend.view(&motion.q));
        backend.map::<Inertia>(&self.particles, &step, inputs, &mut sums.numbers);
        sums.add(backend, self.n);
        for kind in &self.kinds {
            kind.add_energy(backend, &motion.q, sums);
        }
        if let Some(contacts) = &motion.contacts {
            contacts.add_energy(backend, Resists::Inertia, self.squared_h, &motion.q, sums);
        }
    }

    /// What was added up; not a number where the device fails, which is a rise to the safeguard.
    fn total(&mut self, backend: &B) -> f64 {
        self.sums.total(backend).unwrap_or_else(|error| {
            self.failed = Some(failure(error));
            f64::NAN
        })
    }

    /// The root of the mean of a number of each particle over those that are free.
    fn root_mean(&mut self, backend: &B) -> f64 {
        self.sums.add(backend, self.n);
        (self.total(backend) / self.layout.n_free.max(1) as f64).sqrt()
    }
}

impl<B: Backend + 'static> Solve<B> for PositionBased<B> {
    fn n_colors(&self) -> usize {
        self.n_colors as usize
    }

    fn positions(&self) -> (&B::Buffer<Vec4>, &[u32]) {
        (&self.motion.q, &self.layout.place)
    }

    fn n_passes(&self) -> usize {
        self.kinds.len()
    }

    fn set_recoloring(&mut self, _: &B, recoloring: Option<Vivace>) -> Result<(), SolverError> {
        let why = "Position Based Dynamics keeps constraints color by color";
        recoloring.map_or(Ok(()), |_| Err(SolverError::NoRecoloring { why }))
    }

    fn begin_frame(&mut self, backend: &B) {
        self.motion.begin_frame(backend);
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        self.kinds.iter_mut().for_each(|kind| kind.set_attachment_target(idx, target));
    }

    fn prepare(&mut self, backend: &B, _: f32) -> Result<(), SolverError> {
        self.kinds.iter_mut().for_each(|kind| kind.prepare(backend));
        Ok(())
    }

    fn load(&mut self, backend: &B, state: &State) {
        self.failed = None;
        self.motion.load(backend, &self.layout, state);
    }

    fn predict(&mut self, backend: &B, model: &Model, forces: &Forces, h: f32) {
        self.motion.predict(backend, model, &self.layout, forces, h);
    }

    fn place(&mut self, backend: &B, pins: &[(u32, Vec3)]) {
        self.motion.place(backend, &self.layout, pins);
    }

    fn set_collisions(&mut self, backend: &B, detector: Option<&Detector>) -> Result<(), SolverError> {
        self.motion.set_collisions(backend, &self.layout, detector)?;
        self.fit_sums(backend);
        Ok(())
    }

    fn has_contact_color(&self) -> bool {
        self.motion.contacts.is_some()
    }

    fn motion(&mut self) -> (&mut Motion<B>, &mut Sums<B>, &[u32]) {
        (&mut self.motion, &mut self.sums, &self.groups)
    }

    fn relax_contacts(&mut self, backend: &B) {
        self.motion.relax_contacts(backend, Resists::Inertia);
    }

    fn begin(&mut self, backend: &B, h: f32) {
        self.squared_h = h * h;
        let q = &self.motion.q;
        backend.map::<CopyVector>(&self.particles, &(), (backend.view(q),), &mut self.predicted);
        self.history.begin(backend, q);
        self.kinds.iter_mut().for_each(|kind| kind.begin(backend));
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.begin(backend));
    }

    fn update_velocities(&mut self, backend: &B, forces: &Forces, h: f32) {
        self.motion.update_velocities(backend, forces, h);
    }

    fn store(&mut self, backend: &B, model: &Model, state: &mut State) -> Result<(), SolverError> {
        self.failed.take().map_or(Ok(()), Err)?;
        self.motion.store(backend, model, &self.layout, state)
    }

    fn project(&mut self, _: &B) {}

    fn relax_color(&mut self, backend: &B, color: usize, omega: f32) {
        let xpbd = self.xpbd(omega);
        let params = self.watch.sweep(&xpbd);
        for kind in &mut self.kinds {
            kind.relax_color(backend, color, params, &mut self.motion.q);
        }
    }

    fn relax_color_from_previous(&mut self, backend: &B, color: usize, omega: f32) {
        if color == 0 {
            self.remember(backend);
        }
        self.relax_color(backend, color, 1.0);
        if color + 1 == self.n_colors() {
            self.extrapolate(backend, omega);
        }
    }

    fn relax_all(&mut self, backend: &B, omega: f32) {
        let xpbd = self.xpbd(omega);
        let params = self.watch.sweep(&xpbd);
        for kind in &mut self.kinds {
            kind.find_moves(backend, params, &self.motion.q);
        }
        for kind in &self.kinds {
            kind.gather(backend, &self.particles, &mut self.motion.q);
        }
    }

    fn relax_in_order(&mut self, backend: &B, omega: f32) {
        let xpbd = self.xpbd(omega);
        for kind in &mut self.kinds {
            kind.relax_in_order(backend, &xpbd, &mut self.motion.q);
        }
    }

    fn remember(&mut self, backend: &B) {
        self.history.remember(backend, &self.motion.q);
        self.kinds.iter_mut().for_each(|kind| kind.remember(backend));
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.remember(backend));
    }

    fn extrapolate(&mut self, backend: &B, omega: f32) {
        let weight = &ExtrapolateUniform { omega };
        let weight = self.watch.extrapolation(weight);
        self.history.extrapolate(backend, &mut self.motion.q, weight);
        self.kinds.iter_mut().for_each(|kind| kind.extrapolate(backend, weight));
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.extrapolate(backend, weight));
    }

    fn moved(&mut self, backend: &B) -> f32 {
        let inputs = (backend.view(&self.motion.q), backend.view(self.history.before()));
        backend.map::<SquaredDistance>(&self.particles, &(), inputs, &mut self.sums.numbers);
        #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
        let moved = self.root_mean(backend) as f32;
        moved
    }

    fn objective(&mut self, backend: &B) -> f64 {
        self.add_objective(backend);
        self.total(backend)
    }

    fn tolerated_rise(&self) -> f64 {
        TOLERATED_RISE
    }

    fn residual(&mut self, backend: &B) -> f64 {
        let nothing = SetVectorUniform { value: Vec4::ZERO };
        backend.map::<SetVector>(&self.particles, &nothing, (), &mut self.gradients);
        if let Some(contacts) = &mut self.motion.contacts {
            contacts.add_gradient(backend, 1.0 / self.squared_h, &mut self.gradients);
        }
        let q = &self.motion.q;
        for kind in &self.kinds {
            kind.add_gradient(backend, &self.particles, q, &mut self.gradients);
        }
        let inputs = (backend.view(&self.predicted), backend.view(q), backend.view(&self.gradients));
        let step = self.step();
        backend.map::<Residual>(&self.particles, &step, inputs, &mut self.sums.numbers);
        self.root_mean(backend)
    }

    fn wait(&mut self, backend: &B) {
        let mut first = [Vec4::ZERO];
        let n = first.len().min(self.n as usize);
        if let Err(error) = backend.fetch(&self.motion.q, &mut first[..n]) {
            self.failed = Some(failure(error));
        }
    }

    fn save(&mut self, backend: &B) {
        self.history.save(backend, &self.motion.q);
        self.kinds.iter_mut().for_each(|kind| kind.save(backend));
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.save(backend));
    }

    fn restore(&mut self, backend: &B) {
        self.history.restore(backend, &mut self.motion.q);
        self.kinds.iter_mut().for_each(|kind| kind.restore(backend));
        self.motion.contacts.iter_mut().for_each(|contacts| contacts.restore(backend));
    }

    fn watch(&mut self, backend: &B, of: (Relaxation, u32), ease: Ease, rounding: f64) {
        let squared_h = self.squared_h;
        self.watch.begin(backend, of, ease, rounding, squared_h, |omega| Xpbd { squared_h, omega });
        self.look(backend, 0, false);
        self.save(backend);
    }

    fn turn(&mut self, k: u32) {
        self.watch.turn(k);
    }

    fn look(&mut self, backend: &B, k: u32, is_last: bool) {
        self.add_objective(backend);
        let rise = self.tolerated_rise();
        self.watch.look(backend, &mut self.sums, k, is_last, rise);
        if k > 0 {
            self.history.follow(backend, self.watch.known(), &mut self.motion.q);
            self.kinds.iter_mut().for_each(|kind| kind.follow(backend, self.watch.known()));
            self.motion.contacts.iter_mut().for_each(|contacts| contacts.follow(backend, self.watch.known()));
        }
    }

    fn learn(&mut self, backend: &B, ease: &mut Ease, report: &mut StepReport) {
        if let Err(error) = self.watch.learn(backend, ease, report) {
            self.failed = Some(failure(error));
        }
    }

    fn forget(&mut self) {
        self.watch.forget();
    }
}
