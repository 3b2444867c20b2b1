//! An engine on a device: Projective Dynamics as kernels over any [`Backend`].
//!
//! Positions and velocities stay on the device from frame to frame; the host compares what it is given with what it handed out last,
//! and writes only what is new. Within a frame nothing is read back, but where the host has to decide: `⌈n/256⌉` numbers and no more for
//! a tolerance (after each iteration), for the safeguard (after 8, 16, 32, 48, … iterations) and where a step is measured. What a
//! device could not do is remembered and comes out where the frame is stored.
//!
//! A color is a range of particles and one dispatch; constraints that are neither springs nor flat hinges add one for each of their
//! kinds, if projections are fused, and blocks two more.

mod frame;
mod history;
mod motion;
mod pass;
mod rows;
mod sums;

use std::any::Any;
use std::fmt::{self, Debug};
use std::sync::{Mutex, PoisonError};

use glam::Vec3;
use vivace_kernels::Backend;
use vivace_model::{Forces, Model, State};

use crate::engine::Engine;
use crate::{Framework, Preconditioner, Relaxation, Solver, SolverError, Stages};
use frame::Frame;

/// A device and what it holds.
struct Device<B: Backend> {
    backend: B,
    frame: Frame<B>,
}

/// A device, which may stay on one thread at a time: shared, it tells nothing but counts.
pub(crate) struct OnDevice<B: Backend> {
    device: Mutex<Device<B>>,
    n_colors: usize,
    n_passes: usize,
}

impl<B: Backend + 'static> OnDevice<B> {
    /// Prepares `model` for `solver`.
    ///
    /// # Errors
    /// What no device does; an array that this one does not hold.
    pub(crate) fn new(backend: B, model: &Model, solver: &Solver) -> Result<Self, SolverError> {
        let frame = Frame::new(&backend, model, solver)?;
        let (n_colors, n_passes) = (frame.n_colors(), frame.n_passes());
        Ok(Self { device: Mutex::new(Device { backend, frame }), n_colors, n_passes })
    }

    fn device(&mut self) -> &mut Device<B> {
        self.device.get_mut().unwrap_or_else(PoisonError::into_inner)
    }
}

impl<B: Backend> Debug for OnDevice<B> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("OnDevice").field("n_colors", &self.n_colors).finish_non_exhaustive()
    }
}

/// What a solver asks of a device, if a device does it: what is serial stays on the host.
///
/// # Errors
/// Names it, and what to take in its place.
pub(crate) fn check(solver: &Solver) -> Result<(), SolverError> {
    let refused = |what, instead| Err(SolverError::NotOnDevice { what, instead });
    if solver.framework == Framework::PositionBased {
        return refused("Position Based Dynamics", "Projective Dynamics");
    }
    match solver.relaxation {
        Relaxation::Lexicographic { .. } => {
            refused("the lexicographic sweep", "Gauss-Seidel, color by color")
        }
        Relaxation::ConjugateGradient { .. } => refused("conjugate gradients", "Chebyshev or Gauss-Seidel"),
        Relaxation::Direct => refused("the direct solver", "Chebyshev or Gauss-Seidel"),
        _ => Ok(()),
    }
}

impl<B: Backend + Send + 'static> Engine for OnDevice<B> {
    fn backend(&mut self) -> Option<&mut dyn Any> {
        Some(&mut self.device().backend)
    }

    fn n_colors(&self) -> usize {
        self.n_colors
    }

    fn n_passes(&self) -> usize {
        self.n_passes
    }

    fn set_solver(&mut self, model: &Model, solver: &Solver) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        *frame = Frame::new(backend, model, solver)?;
        Ok(())
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        self.device().frame.set_attachment_target(idx, target);
    }

    fn prepare(&mut self, h: f32) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        frame.prepare(backend, h)
    }

    fn load(&mut self, state: &State) {
        let Device { backend, frame } = self.device();
        frame.load(backend, state);
    }

    fn predict(&mut self, model: &Model, forces: &Forces, h: f32) {
        let Device { backend, frame } = self.device();
        frame.predict(backend, model, forces, h);
    }

    fn begin(&mut self, _: f32) {
        let Device { backend, frame } = self.device();
        frame.begin(backend);
    }

    fn stages(&mut self) -> &mut dyn Stages {
        self.device()
    }

    fn update_velocities(&mut self, forces: &Forces, h: f32) {
        let Device { backend, frame } = self.device();
        frame.motion.update_velocities(backend, forces, h);
    }

    fn store(&mut self, model: &Model, state: &mut State) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        frame.store(backend, model, state)
    }
}

impl<B: Backend + 'static> Stages for Device<B> {
    fn n_colors(&self) -> u32 {
        u32::try_from(self.frame.n_colors()).unwrap_or(u32::MAX)
    }

    fn project(&mut self) {
        self.frame.project(&self.backend);
    }

    fn n_sweeps(&self) -> u32 {
        self.frame.n_sweeps()
    }

    fn relax_color(&mut self, color: u32, omega: f32) {
        self.frame.relax_color(&self.backend, color as usize, omega);
    }

    fn relax_color_from_previous(&mut self, color: u32, omega: f32) {
        self.frame.relax_color_from_previous(&self.backend, color as usize, omega);
    }

    fn relax_all(&mut self, omega: f32) {
        self.frame.relax_all(&self.backend, omega);
    }

    // `check` lets none of these come here.
    fn relax_in_order(&mut self, _: f32) {}

    fn solve_by_conjugate_gradient(&mut self, _: Preconditioner, _: u32) {}

    fn solve_directly(&mut self) {}

    fn remember(&mut self) {
        let Frame { history, motion, .. } = &mut self.frame;
        history.remember(&self.backend, &motion.q);
    }

    fn extrapolate(&mut self, omega: f32) {
        let Frame { history, motion, .. } = &mut self.frame;
        history.extrapolate(&self.backend, &mut motion.q, omega);
    }

    fn moved(&mut self) -> f32 {
        self.frame.moved(&self.backend)
    }

    fn objective(&mut self) -> f64 {
        self.frame.objective(&self.backend)
    }

    fn residual(&mut self) -> f64 {
        self.frame.residual(&self.backend)
    }

    fn save(&mut self) {
        let Frame { history, motion, .. } = &mut self.frame;
        history.save(&self.backend, &motion.q);
    }

    fn restore(&mut self) {
        let Frame { history, motion, .. } = &mut self.frame;
        history.restore(&self.backend, &mut motion.q);
    }

    fn wait(&mut self) {
        self.frame.wait(&self.backend);
    }
}
