//! Position Based Dynamics (Müller et al. 2007) with the compliance of XPBD (Macklin et al. 2016): each constraint C moves its
//! particles along its gradient by `Δλ = (−C − α̃ λ) / (Σ w |∇C|² + α̃)`, `α̃ = 1 / (weight · h²)`.
//!
//! C is such that the energy is w/2 C², but for volumes, where that holds near rest (`TetVolume`).
//!
//! Colors are those of constraints, not of particles: two of one color share none. In Jacobi's reading all constraints act from the
//! same positions, each divided by the number of constraints at its busiest particle, so that momentum is kept where averaging
//! particle by particle (Macklin et al. 2014) would lose it.

pub(crate) mod arranged;
pub(crate) mod coloring;
pub(crate) mod contacts;
mod halves;
mod kind;

use glam::{Vec3, Vec4};
use vivace_kernels::constraint::Xpbd;
use vivace_model::Model;

use crate::contacts::Found;
use crate::history::History;
use crate::host::Solve;
use crate::parallel::sum;
use crate::{Preconditioner, SolverError, Stages};
use contacts::Contacts;
pub(crate) use contacts::STIFFNESS as CONTACT_STIFFNESS;
use kind::{Kind, Kinds};

/// Where XPBD comes to rest is near the minimum of the objective, not at it, so plain iterations climb a little.
pub(crate) const TOLERATED_RISE: f64 = 1.0;

/// A model prepared for Position Based Dynamics, and the positions while a step is solved.
#[derive(Debug)]
pub(crate) struct PositionBased {
    kinds: Vec<Box<dyn Kind>>,
    /// Whether the last of these is that of attachments, which come and go.
    has_attachments: bool,
    /// Of these; those of contacts follow.
    n_colors: u32,
    contacts: Contacts,
    n_free: usize,
    /// Constraints of each free particle, without and with contacts.
    own_counts: Vec<f32>,
    counts: Vec<f32>,
    h: f32,
    predicted: Vec<Vec4>,
    /// Positions \[m\], and inverse masses \[1/kg\]: 0 where pinned.
    q: Vec<Vec4>,
    history: History<Vec4>,
    sums: Vec<Vec4>,
}

impl PositionBased {
    /// Colors the constraints.
    ///
    /// # Errors
    /// More constraints than 32 bits can number.
    pub(crate) fn new(model: &Model) -> Result<Self, SolverError> {
        let n = model.n_particles();
        let q: Vec<Vec4> = model.masses().iter().map(|mass| Vec3::ZERO.extend(1.0 / mass)).collect();
        let n_free = q.iter().filter(|q| q.w > 0.0).count();
        let mut framework = Self {
            kinds: Kinds::of(model)?,
            has_attachments: !model.constraints().attachments.is_empty(),
            n_colors: 0,
            contacts: Contacts::default(),
            n_free,
            own_counts: vec![0.0; n],
            counts: Vec::new(),
            h: 0.0,
            predicted: q.clone(),
            q,
            history: History::new(n),
            sums: vec![Vec4::ZERO; n],
        };
        framework.count();
        Ok(framework)
    }

    /// Counts colors, and the constraints of each particle.
    fn count(&mut self) {
        self.n_colors = self.kinds.iter().map(|kind| kind.n_colors()).max().unwrap_or(0);
        self.own_counts.fill(0.0);
        self.kinds.iter().for_each(|kind| kind.count(&mut self.own_counts));
        // What is pinned moves for nobody, however many ask.
        let pinned = self.own_counts.iter_mut().zip(&self.q).filter(|(_, q)| q.w == 0.0);
        pinned.for_each(|(count, _)| *count = 0.0);
        self.counts.clone_from(&self.own_counts);
    }
}

impl PositionBased {
    fn xpbd(&self, omega: f32) -> Xpbd {
        Xpbd { squared_h: self.h * self.h, omega }
    }
}

impl Solve for PositionBased {
    /// One for each kind.
    fn n_passes(&self) -> usize {
        self.kinds.len()
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        self.kinds.iter_mut().for_each(|kind| kind.set_attachment_target(idx, target));
    }

    fn set_attachments(&mut self, model: &Model) {
        if std::mem::take(&mut self.has_attachments) {
            self.kinds.pop();
        }
        self.count();
        let attachments = &model.constraints().attachments;
        if !attachments.is_empty() {
            // Particle numbers are 32-bit by construction of the model.
            let n_particles = u32::try_from(model.n_particles()).unwrap_or(u32::MAX);
            self.kinds.push(kind::of_attachments(attachments, self.n_colors, n_particles));
            self.has_attachments = true;
            self.count();
        }
    }

    /// Nothing here depends on the time step alone.
    fn prepare(&mut self, _: f32) -> Result<(), SolverError> {
        Ok(())
    }

    fn set_contacts(&mut self, found: &Found<'_>) -> usize {
        self.contacts.set(found, &|p| p, &self.q, found.h * found.h);
        self.counts.copy_from_slice(&self.own_counts);
        self.contacts.count(&self.q, &mut self.counts);
        self.contacts.n_colors()
    }

    fn begin(&mut self, h: f32, predicted: &[Vec3]) {
        self.h = h;
        for (q, &p) in self.q.iter_mut().zip(predicted) {
            *q = p.extend(q.w);
        }
        self.predicted.copy_from_slice(&self.q);
        self.history.begin(&self.q);
        self.kinds.iter_mut().for_each(|kind| kind.begin(h));
        self.contacts.begin();
    }

    fn end(&mut self, positions: &mut [Vec3]) {
        for (position, &q) in positions.iter_mut().zip(&self.q) {
            *position = q.truncate();
        }
    }
}

impl Stages for PositionBased {
    fn n_colors(&self) -> u32 {
        self.n_colors + u32::try_from(self.contacts.n_colors()).unwrap_or(u32::MAX)
    }

    fn project(&mut self) {}

    fn relax_color(&mut self, color: u32, omega: f32) {
        if let Some(color) = color.checked_sub(self.n_colors) {
            let xpbd = self.xpbd(omega);
            self.contacts.relax_color(color as usize, &xpbd, &mut self.q);
            return;
        }
        for kind in &mut self.kinds {
            kind.relax_color(color, omega, &mut self.q);
        }
    }

    /// Particles are shared between colors, so the base is that of the whole iteration: with the last color all particles are
    /// extrapolated.
    fn relax_color_from_previous(&mut self, color: u32, omega: f32) {
        if color == 0 {
            self.remember();
        }
        self.relax_color(color, 1.0);
        if color + 1 == self.n_colors() {
            self.extrapolate(omega);
        }
    }

    fn relax_all(&mut self, omega: f32) {
        self.sums.fill(Vec4::ZERO);
        for kind in &mut self.kinds {
            kind.relax_all(omega, &self.counts, &self.q, &mut self.sums);
        }
        let xpbd = self.xpbd(omega);
        self.contacts.relax_all(&xpbd, &self.counts, &self.q, &mut self.sums);
        for (q, sum) in self.q.iter_mut().zip(&self.sums) {
            *q += *sum;
        }
    }

    fn relax_in_order(&mut self, omega: f32) {
        for kind in &mut self.kinds {
            kind.relax_in_order(omega, &mut self.q);
        }
        let xpbd = self.xpbd(omega);
        self.contacts.relax_in_order(&xpbd, &mut self.q);
    }

    // `Solver::check` lets no linear solver come here.
    fn solve_by_conjugate_gradient(&mut self, _: Preconditioner, _: u32) {}

    fn solve_directly(&mut self) {}

    fn remember(&mut self) {
        self.history.remember(&self.q);
        self.kinds.iter_mut().for_each(|kind| kind.remember());
        let (history, lambdas) = self.contacts.history();
        history.remember(lambdas);
    }

    fn extrapolate(&mut self, omega: f32) {
        self.history.extrapolate(&mut self.q, omega);
        self.kinds.iter_mut().for_each(|kind| kind.extrapolate(omega));
        let (history, lambdas) = self.contacts.history();
        history.extrapolate(lambdas, omega);
    }

    fn moved(&mut self) -> f32 {
        let before = self.history.before();
        let squared = |i: usize| f64::from((self.q[i] - before[i]).length_squared());
        #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
        let moved = (sum(0..self.q.len(), &squared) / self.n_free.max(1) as f64).sqrt() as f32;
        moved
    }

    fn objective(&mut self) -> f64 {
        let of = |i: usize| {
            let (squared, w) = (f64::from((self.q[i] - self.predicted[i]).length_squared()), self.q[i].w);
            if w > 0.0 { squared / (2.0 * f64::from(w) * f64::from(self.h * self.h)) } else { 0.0 }
        };
        let inertia = sum(0..self.q.len(), &of);
        let kinds = inertia + self.kinds.iter().map(|kind| kind.energy(&self.q)).sum::<f64>();
        if self.contacts.is_empty() {
            kinds
        } else {
            kinds + self.contacts.energy(&|p| self.q[p as usize].truncate())
        }
    }

    fn tolerated_rise(&self) -> f64 {
        TOLERATED_RISE
    }

    fn residual(&mut self) -> f64 {
        self.sums.fill(Vec4::ZERO);
        self.kinds.iter().for_each(|kind| kind.add_gradient(&self.q, &mut self.sums));
        self.contacts.add_gradient(&self.q, &mut self.sums);
        let squared_h = self.h * self.h;
        let of = |i: usize| {
            let w = self.q[i].w;
            let inertia = (self.q[i] - self.predicted[i]) / (w * squared_h);
            if w > 0.0 { f64::from((inertia + self.sums[i]).length_squared()) } else { 0.0 }
        };
        (sum(0..self.q.len(), &of) / self.n_free.max(1) as f64).sqrt()
    }

    fn save(&mut self) {
        self.history.save(&self.q);
        self.kinds.iter_mut().for_each(|kind| kind.save());
        let (history, lambdas) = self.contacts.history();
        history.save(lambdas);
    }

    fn restore(&mut self) {
        self.history.restore(&mut self.q);
        self.kinds.iter_mut().for_each(|kind| kind.restore());
        let (history, lambdas) = self.contacts.history();
        history.restore(lambdas);
    }
}
