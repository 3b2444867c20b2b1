//! An engine on a device: both frameworks as kernels over any [`Backend`].
//!
//! Positions and velocities stay on the device from frame to frame; the host compares what it is given with what it handed out last,
//! and writes only what is new. Within a frame nothing is read back, but where the host has to decide: `⌈n/256⌉` numbers and no more for
//! a tolerance (after each iteration), for the safeguard (after 8, 16, 32, 48, … iterations) and where a step is measured. What a
//! device could not do is remembered and comes out where the frame is stored.
//!
//! Collisions are found, colored, solved and guarded there too: `collide.rs`.
//!
//! In Projective Dynamics a color is a range of particles and one dispatch; constraints that are neither springs nor flat hinges add
//! one for each of their kinds, if projections are fused, and blocks two more. In Position Based Dynamics a color is a range of the
//! constraints of each kind, and a dispatch for each kind that has some of it. What solves the linear system of a global step
//! (`linear.rs`) is conjugate gradients, or a factor: a dispatch for each level of its tree.

mod collide;
mod conjugate_gradient;
#[cfg(feature = "direct")]
mod direct;
mod frame;
mod history;
mod kind;
mod linear;
mod motion;
mod pass;
mod position_based;
mod recolor;
mod rows;
mod sums;
mod watch;

use std::any::Any;
use std::fmt::{self, Debug};
use std::sync::{Mutex, PoisonError};

use glam::{Vec3, Vec4};
use vivace_collision::{Detector, Obstacle};
use vivace_coloring::Vivace;
use vivace_kernels::Backend;
use vivace_model::{Forces, Model, State};

use crate::collisions::Collisions;
use crate::engine::Engine;
use crate::{
    ContactReport, Ease, Framework, Preconditioner, Relaxation, Solver, SolverError, Stages, StepReport,
};
use collide::Collider;
use frame::Frame;
use motion::Motion;
use position_based::PositionBased;
use sums::Sums;

/// Iterations of a small step, at most, whose weights are laid out ahead. With more the host looks on the way.
const MOST_UNSEEN: u32 = 10_000;

/// A device and what it holds.
struct Device<B: Backend> {
    backend: B,
    frame: Box<dyn Solve<B>>,
}

/// What a device says that has failed.
fn failure(error: impl std::error::Error + Send + Sync + 'static) -> SolverError {
    SolverError::Device(Box::new(error))
}

/// A framework on a device, and what moves there in a frame: what [`Engine`] and [`Stages`] ask, told where it runs.
trait Solve<B: Backend>: Send {
    fn n_colors(&self) -> usize;
    fn n_passes(&self) -> usize;
    /// Positions, and the place of each of the model's particles among them.
    fn positions(&self) -> (&B::Buffer<Vec4>, &[u32]);
    fn n_sweeps(&self) -> u32 {
        1
    }
    fn set_recoloring(&mut self, backend: &B, recoloring: Option<Vivace>) -> Result<(), SolverError>;
    fn begin_frame(&mut self, backend: &B);
    fn set_attachment_target(&mut self, idx: usize, target: Vec3);
    /// Takes the attachments of `model`, of which nothing else has changed; `false` where that has to be made anew.
    fn set_attachments(&mut self, _model: &Model) -> bool {
        false
    }
    fn prepare(&mut self, backend: &B, h: f32) -> Result<(), SolverError>;
    fn load(&mut self, backend: &B, state: &State);
    fn predict(&mut self, backend: &B, model: &Model, forces: &Forces, h: f32);
    fn place(&mut self, backend: &B, pins: &[(u32, Vec3)]);
    fn set_collisions(&mut self, backend: &B, detector: Option<&Detector>) -> Result<(), SolverError>;
    /// Whether contacts come after all other constraints in a sweep.
    fn has_contact_color(&self) -> bool {
        false
    }
    /// What moves and collides, the numbers that are added up of it, and how many these are without contacts, group by group.
    fn motion(&mut self) -> (&mut Motion<B>, &mut Sums<B>, &[u32]);
    /// Makes room for what is added up.
    fn fit_sums(&mut self, backend: &B) {
        let (motion, sums, groups) = self.motion();
        let of_contacts = motion.contacts.iter().flat_map(Collider::groups);
        let all: Vec<u32> = groups.iter().copied().chain(of_contacts).collect();
        *sums = Sums::new(backend, &all);
    }
    fn detect(&mut self, backend: &B, obstacles: &[Obstacle]) -> Result<(), SolverError> {
        if self.motion().0.detect(backend, obstacles)? {
            self.fit_sums(backend);
        }
        Ok(())
    }
    fn relax_contacts(&mut self, _: &B) {}
    fn meet(&mut self, _: &B) {}
    fn touch(&mut self, _: &B) {}
    /// What contacts did in the step; whether some found no room, and there is more now.
    fn report_contacts(&mut self, backend: &B, report: &mut ContactReport) -> Result<bool, SolverError> {
        let (motion, sums, _) = self.motion();
        let has_grown = motion.report_contacts(backend, sums, report)?;
        if has_grown {
            self.fit_sums(backend);
        }
        Ok(has_grown)
    }
    fn begin(&mut self, backend: &B, h: f32);
    fn update_velocities(&mut self, backend: &B, forces: &Forces, h: f32);
    fn store(&mut self, backend: &B, model: &Model, state: &mut State) -> Result<(), SolverError>;
    fn project(&mut self, backend: &B);
    fn relax_color(&mut self, backend: &B, color: usize, omega: f32);
    fn relax_color_from_previous(&mut self, backend: &B, color: usize, omega: f32);
    fn relax_all(&mut self, backend: &B, omega: f32);
    fn relax_in_order(&mut self, backend: &B, omega: f32);
    // Solvers of the linear system come to Projective Dynamics alone.
    fn solve_by_conjugate_gradient(&mut self, _: &B, _: Preconditioner, _: u32) {}
    fn solve_directly(&mut self, _: &B) {}
    fn remember(&mut self, backend: &B);
    fn extrapolate(&mut self, backend: &B, omega: f32);
    fn moved(&mut self, backend: &B) -> f32;
    fn objective(&mut self, backend: &B) -> f64;
    fn tolerated_rise(&self) -> f64;
    fn residual(&mut self, backend: &B) -> f64;
    fn wait(&mut self, backend: &B);
    fn save(&mut self, backend: &B);
    fn restore(&mut self, backend: &B);
    fn watch(&mut self, backend: &B, of: (Relaxation, u32), ease: Ease, rounding: f64);
    fn turn(&mut self, k: u32);
    fn look(&mut self, backend: &B, k: u32, is_last: bool);
    fn learn(&mut self, backend: &B, ease: &mut Ease, report: &mut StepReport);
    fn forget(&mut self);
}

/// The framework that `solver` asks for.
fn frame<B: Backend + 'static>(
    backend: &B,
    model: &Model,
    solver: &Solver,
    colors: &[u32],
) -> Result<Box<dyn Solve<B>>, SolverError> {
    check(solver)?;
    Ok(match solver.framework {
        Framework::ProjectiveDynamics { .. } => Box::new(Frame::new(backend, model, solver, colors)?),
        Framework::PositionBased => Box::new(PositionBased::new(backend, model, solver.relaxation)?),
    })
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
        let frame = frame(&backend, model, solver, &[])?;
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
fn check(solver: &Solver) -> Result<(), SolverError> {
    let is_position_based = solver.framework == Framework::PositionBased;
    if !is_position_based && matches!(solver.relaxation, Relaxation::Lexicographic { .. }) {
        let (what, instead) = ("the lexicographic sweep", "Gauss-Seidel, color by color");
        return Err(SolverError::NotOnDevice { what, instead });
    }
    Ok(())
}

impl<B: Backend + Send + 'static> Engine for OnDevice<B> {
    fn resident(&mut self) -> Option<(&dyn Any, &dyn Any, &[u32])> {
        let Device { backend, frame } = self.device();
        let (positions, place) = frame.positions();
        Some((backend, positions, place))
    }

    fn n_colors(&self) -> usize {
        self.n_colors
    }

    fn n_passes(&self) -> usize {
        self.n_passes
    }

    fn set_solver(
        &mut self,
        model: &Model,
        solver: &Solver,
        colors: &[u32],
        detector: Option<&Detector>,
    ) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        let mut new = self::frame(backend, model, solver, colors)?;
        if detector.is_some() {
            new.set_collisions(backend, detector)?;
        }
        *frame = new;
        let counts = (frame.n_colors(), frame.n_passes());
        (self.n_colors, self.n_passes) = counts;
        Ok(())
    }

    fn set_recoloring(&mut self, recoloring: Option<Vivace>) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        frame.set_recoloring(backend, recoloring)?;
        self.n_colors = self.device().frame.n_colors();
        Ok(())
    }

    fn begin_frame(&mut self) {
        let Device { backend, frame } = self.device();
        frame.begin_frame(backend);
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        self.device().frame.set_attachment_target(idx, target);
    }

    fn set_attachments(
        &mut self,
        model: &Model,
        solver: &Solver,
        colors: &[u32],
        detector: Option<&Detector>,
    ) -> Result<(), SolverError> {
        if self.device().frame.set_attachments(model) {
            Ok(())
        } else {
            self.set_solver(model, solver, colors, detector)
        }
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

    fn place(&mut self, pins: &[(u32, Vec3)]) {
        let Device { backend, frame } = self.device();
        frame.place(backend, pins);
    }

    fn detect(
        &mut self,
        collisions: &mut Collisions,
        _: f32,
        _: &mut ContactReport,
    ) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        frame.detect(backend, collisions.moving())
    }

    fn drop_contacts(&mut self) {
        let Device { backend, frame } = self.device();
        frame.motion().0.drop_contacts(backend);
    }

    fn guard(&mut self, _: &mut Collisions, _: &mut ContactReport) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        frame.motion().0.guard(backend);
        Ok(())
    }

    fn report_contacts(&mut self, report: &mut ContactReport) -> Result<bool, SolverError> {
        let Device { backend, frame } = self.device();
        frame.report_contacts(backend, report)
    }

    fn begin(&mut self, h: f32) {
        let Device { backend, frame } = self.device();
        frame.begin(backend, h);
    }

    fn stages(&mut self) -> &mut dyn Stages {
        self.device()
    }

    fn update_velocities(&mut self, forces: &Forces, h: f32) {
        let Device { backend, frame } = self.device();
        frame.update_velocities(backend, forces, h);
    }

    fn store(&mut self, model: &Model, state: &mut State) -> Result<(), SolverError> {
        let Device { backend, frame } = self.device();
        frame.store(backend, model, state)
    }
}

impl<B: Backend + 'static> Stages for Device<B> {
    fn n_colors(&self) -> u32 {
        let n_colors = self.frame.n_colors() + usize::from(self.frame.has_contact_color());
        u32::try_from(n_colors).unwrap_or(u32::MAX)
    }

    fn project(&mut self) {
        self.frame.project(&self.backend);
    }

    fn n_sweeps(&self) -> u32 {
        self.frame.n_sweeps()
    }

    fn relax_color(&mut self, color: u32, omega: f32) {
        match color as usize {
            color if color < self.frame.n_colors() => self.frame.relax_color(&self.backend, color, omega),
            // After all other constraints come contacts.
            _ => self.frame.relax_contacts(&self.backend),
        }
    }

    fn relax_color_from_previous(&mut self, color: u32, omega: f32) {
        match color as usize {
            color if color < self.frame.n_colors() => {
                self.frame.relax_color_from_previous(&self.backend, color, omega);
            }
            _ => self.frame.relax_contacts(&self.backend),
        }
    }

    fn relax_all(&mut self, omega: f32) {
        self.frame.relax_all(&self.backend, omega);
        self.frame.relax_contacts(&self.backend);
    }

    fn relax_in_order(&mut self, omega: f32) {
        self.frame.relax_in_order(&self.backend, omega);
        self.frame.relax_contacts(&self.backend);
    }

    fn solve_by_conjugate_gradient(&mut self, preconditioner: Preconditioner, inner: u32) {
        self.frame.solve_by_conjugate_gradient(&self.backend, preconditioner, inner);
    }

    fn solve_directly(&mut self) {
        self.frame.solve_directly(&self.backend);
    }

    fn meet(&mut self) {
        self.frame.meet(&self.backend);
    }

    fn touch(&mut self) {
        self.frame.touch(&self.backend);
    }

    fn remember(&mut self) {
        self.frame.remember(&self.backend);
    }

    fn extrapolate(&mut self, omega: f32) {
        self.frame.extrapolate(&self.backend, omega);
    }

    fn moved(&mut self) -> f32 {
        self.frame.moved(&self.backend)
    }

    fn objective(&mut self) -> f64 {
        self.frame.objective(&self.backend)
    }

    fn tolerated_rise(&self) -> f64 {
        self.frame.tolerated_rise()
    }

    fn residual(&mut self) -> f64 {
        self.frame.residual(&self.backend)
    }

    fn save(&mut self) {
        self.frame.save(&self.backend);
    }

    fn restore(&mut self) {
        self.frame.restore(&self.backend);
    }

    fn wait(&mut self) {
        self.frame.wait(&self.backend);
    }

    fn watch(&mut self, relaxation: Relaxation, most: u32, ease: Ease, rounding: f64) -> bool {
        // What goes one by one takes its parameters from the host.
        let decides = !matches!(relaxation, Relaxation::Lexicographic { .. }) && most <= MOST_UNSEEN;
        if decides {
            self.frame.watch(&self.backend, (relaxation, most), ease, rounding);
        }
        decides
    }

    fn turn(&mut self, k: u32) {
        self.frame.turn(k);
    }

    fn look(&mut self, k: u32, is_last: bool) {
        self.frame.look(&self.backend, k, is_last);
    }

    fn learn(&mut self, ease: &mut Ease, report: &mut StepReport) {
        self.frame.learn(&self.backend, ease, report);
    }

    fn forget(&mut self) {
        self.frame.forget();
    }
}
