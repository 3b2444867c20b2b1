//! Position Based Dynamics (Müller et al. 2007) with the compliance of XPBD (Macklin et al. 2016): each constraint C moves its
//! particles along its gradient by `Δλ = (−C − α̃ λ) / (Σ w |∇C|² + α̃)`, `α̃ = 1 / (weight · h²)`.
//!
//! Colors are those of constraints, not of particles: two of one color share none. In Jacobi's reading all constraints act from the
//! same positions, each divided by the number of constraints at its busiest particle, so that momentum is kept where averaging
//! particle by particle (Macklin et al. 2014) would lose it.

mod coloring;
mod kind;

use glam::{Vec3, Vec3A};
use vivace_model::Model;

use crate::pd::sum_in_pieces;
use crate::{Preconditioner, SolverError, Stages};
use kind::{Kind, Kinds};

/// A model prepared for Position Based Dynamics, and the positions while a step is solved.
#[derive(Debug)]
pub struct PositionBased {
    kinds: Vec<Box<dyn Kind>>,
    n_colors: u32,
    /// Inverse masses \[1/kg\]; 0 where pinned.
    w: Vec<f32>,
    counts: Vec<f32>,
    h: f32,
    predicted: Vec<Vec3A>,
    q: Vec<Vec3A>,
    remembered: Vec<Vec3A>,
    previous: Vec<Vec3A>,
    is_extrapolated: bool,
    saved: Vec<Vec3A>,
    sums: Vec<Vec3A>,
}

impl PositionBased {
    /// Colors the constraints.
    ///
    /// # Errors
    /// More constraints than 32 bits can number.
    pub fn new(model: &Model) -> Result<Self, SolverError> {
        let (kinds, n_colors) = Kinds::of(model)?;
        let n = model.n_particles();
        let mut counts = vec![0.0; n];
        kinds.iter().for_each(|kind| kind.count(&mut counts));
        let zeros = || vec![Vec3A::ZERO; n];
        Ok(Self {
            kinds,
            n_colors,
            w: model.masses().iter().map(|mass| 1.0 / mass).collect(),
            counts,
            h: 0.0,
            predicted: zeros(),
            q: zeros(),
            remembered: zeros(),
            previous: zeros(),
            is_extrapolated: false,
            saved: zeros(),
            sums: zeros(),
        })
    }

    /// Number of classes of constraints.
    #[must_use]
    pub fn n_colors(&self) -> usize {
        self.n_colors as usize
    }

    /// How many kinds of constraints there are: one pass each.
    #[must_use]
    pub fn n_passes(&self) -> usize {
        self.kinds.len()
    }

    pub(crate) fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        // Attachments are the last kind, and the only one with a target.
        if let Some(kind) = self.kinds.last_mut() {
            kind.set_target(idx, target);
        }
    }

    /// Begins a step of `h` \[s\] from `predicted` \[m\].
    pub(crate) fn begin(&mut self, h: f32, predicted: &[Vec3]) {
        self.h = h;
        for (q, &p) in self.q.iter_mut().zip(predicted) {
            *q = p.into();
        }
        self.predicted.copy_from_slice(&self.q);
        self.previous.copy_from_slice(&self.q);
        self.is_extrapolated = false;
        self.kinds.iter_mut().for_each(|kind| kind.begin(h));
    }

    /// Writes the positions \[m\].
    pub(crate) fn end(&self, positions: &mut [Vec3]) {
        for (position, &q) in positions.iter_mut().zip(&self.q) {
            *position = q.into();
        }
    }
}

impl Stages for PositionBased {
    fn n_colors(&self) -> u32 {
        self.n_colors
    }

    fn project(&mut self) {}

    fn relax_color(&mut self, color: u32, omega: f32) {
        for kind in &mut self.kinds {
            kind.relax_color(color, omega, &self.w, &mut self.q);
        }
    }

    /// Particles are shared between colors, so the base is that of the whole iteration: with the last color all particles are
    /// extrapolated.
    fn relax_color_from_previous(&mut self, color: u32, omega: f32) {
        if color == 0 {
            self.remember();
        }
        self.relax_color(color, 1.0);
        if color + 1 == self.n_colors {
            self.extrapolate(omega);
        }
    }

    fn relax_all(&mut self, omega: f32) {
        self.sums.fill(Vec3A::ZERO);
        for kind in &mut self.kinds {
            kind.relax_all(omega, &self.w, &self.counts, &self.q, &mut self.sums);
        }
        for (q, sum) in self.q.iter_mut().zip(&self.sums) {
            *q += *sum;
        }
    }

    fn relax_in_order(&mut self, omega: f32) {
        for kind in &mut self.kinds {
            kind.relax_in_order(omega, &self.w, &mut self.q);
        }
    }

    // `Solver::check` lets no linear solver come here.
    fn solve_by_conjugate_gradient(&mut self, _: Preconditioner, _: u32) {}

    fn solve_directly(&mut self) {}

    fn remember(&mut self) {
        self.remembered.copy_from_slice(&self.q);
        self.kinds.iter_mut().for_each(|kind| kind.remember());
        self.is_extrapolated = false;
    }

    fn extrapolate(&mut self, omega: f32) {
        if omega != 1.0 {
            for (q, previous) in self.q.iter_mut().zip(&self.previous) {
                *q = *previous + omega * (*q - *previous);
            }
        }
        std::mem::swap(&mut self.previous, &mut self.remembered);
        self.kinds.iter_mut().for_each(|kind| kind.extrapolate(omega));
        self.is_extrapolated = true;
    }

    fn moved(&self) -> f32 {
        let before = if self.is_extrapolated { &self.previous } else { &self.remembered };
        let sum = sum_in_pieces(self.q.len(), |i| f64::from((self.q[i] - before[i]).length_squared()));
        #[expect(clippy::cast_possible_truncation, reason = "positions are f32")]
        let moved = (sum / self.q.len().max(1) as f64).sqrt() as f32;
        moved
    }

    fn objective(&self) -> f64 {
        let inertia = sum_in_pieces(self.q.len(), |i| {
            let squared = f64::from((self.q[i] - self.predicted[i]).length_squared());
            if self.w[i] > 0.0 {
                squared / (2.0 * f64::from(self.w[i]) * f64::from(self.h * self.h))
            } else {
                0.0
            }
        });
        inertia + self.kinds.iter().map(|kind| kind.energy(&self.q)).sum::<f64>()
    }

    fn residual(&mut self) -> f64 {
        self.sums.fill(Vec3A::ZERO);
        self.kinds.iter().for_each(|kind| kind.add_gradient(&self.q, &mut self.sums));
        let squared_h = self.h * self.h;
        let of = |i: usize| {
            let inertia = (self.q[i] - self.predicted[i]) / (self.w[i] * squared_h);
            if self.w[i] > 0.0 { f64::from((inertia + self.sums[i]).length_squared()) } else { 0.0 }
        };
        let n_free = self.w.iter().filter(|w| **w > 0.0).count();
        (sum_in_pieces(self.q.len(), of) / n_free.max(1) as f64).sqrt()
    }

    fn save(&mut self) {
        self.saved.copy_from_slice(&self.q);
        self.kinds.iter_mut().for_each(|kind| kind.save());
    }

    fn restore(&mut self) {
        self.q.copy_from_slice(&self.saved);
        self.previous.copy_from_slice(&self.saved);
        self.kinds.iter_mut().for_each(|kind| kind.restore());
        self.is_extrapolated = false;
    }
}
