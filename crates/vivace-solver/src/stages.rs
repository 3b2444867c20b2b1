//! The verbs of a relaxation.

use crate::{Ease, Preconditioner, Relaxation, StepReport};

/// See [`Stages::tolerated_rise`].
pub(crate) const TOLERATED_RISE: f64 = 1e-4;

/// What an iteration is made of. A relaxation is a schedule of these, written once; Projective Dynamics and Position Based
/// Dynamics, and any device, say what they do.
///
/// Positions q are kept inside. `previous` is q an iteration earlier, as Chebyshev's three-term recurrence and two readings of
/// line 7 need it.
pub(crate) trait Stages {
    /// How many colors a sweep has.
    fn n_colors(&self) -> u32;

    /// The local step, where it is apart from the sweeps.
    fn project(&mut self);

    /// Sweeps for each local step: 1 where projections are part of the sweep.
    fn n_sweeps(&self) -> u32 {
        1
    }

    /// Lines 5 to 7 for the members of one color: `q += omega · (q̂ − q)`.
    fn relax_color(&mut self, color: u32, omega: f32);

    /// As [`Stages::relax_color`], from the previous positions: `q = previous + omega · (q̂ − previous)`. Remembers q as previous.
    fn relax_color_from_previous(&mut self, color: u32, omega: f32);

    /// All members at once from the same positions: `q += omega · (q̂ − q)`.
    fn relax_all(&mut self, omega: f32);

    /// One after another in the model's own order, on one thread.
    fn relax_in_order(&mut self, omega: f32);

    /// The linear system of the local step, by so many steps of preconditioned conjugate gradients.
    fn solve_by_conjugate_gradient(&mut self, preconditioner: Preconditioner, inner: u32);

    /// The linear system of the local step, exactly.
    fn solve_directly(&mut self);

    /// Before the first iteration: projects contacts where particles were predicted, where they are no part of the sweeps.
    fn meet(&mut self) {}

    /// Ends an iteration: projects contacts, where they are no part of the sweeps.
    fn touch(&mut self) {}

    /// Keeps a copy of q to extrapolate from.
    fn remember(&mut self);

    /// Chebyshev: `q = previous + omega · (q − previous)`, where previous was an iteration earlier, and keeps what
    /// [`Stages::remember`] saw as previous.
    fn extrapolate(&mut self, omega: f32);

    /// Root mean square distance between q and what [`Stages::remember`] saw \[m\].
    fn moved(&mut self) -> f32;

    /// The objective g(q) that the time step minimises \[J\]: inertia and the energy of the constraints.
    fn objective(&mut self) -> f64;

    /// By how much of itself the objective may rise without cause for alarm: rounding in `f32`, which averages to 10⁻⁵ over a few
    /// hundred nearly unstretched springs. What diverges grows by factors.
    fn tolerated_rise(&self) -> f64 {
        TOLERATED_RISE
    }

    /// Root mean square of the objective's gradient over the free particles \[N\].
    fn residual(&mut self) -> f64;

    /// Until all that was asked for is done, where that is not so anyway: for a budget of time.
    fn wait(&mut self) {}

    /// Keeps q to come back to.
    fn save(&mut self);

    /// Brings back what [`Stages::save`] kept, and forgets the iterations since.
    fn restore(&mut self);

    /// Where decisions are made where the positions are: a small step of `most` iterations begins, whose weights and what is kept of it are
    /// found there, as the safeguard would. Whether it is so.
    fn watch(&mut self, relaxation: Relaxation, most: u32, ease: Ease, rounding: f64) -> bool {
        let _ = (relaxation, most, ease, rounding);
        false
    }

    /// After [`Stages::watch`]: iteration `k` begins, from 0.
    fn turn(&mut self, k: u32) {
        let _ = k;
    }

    /// After [`Stages::watch`]: time to look, after `k` iterations.
    fn look(&mut self, k: u32, is_last: bool) {
        let _ = (k, is_last);
    }

    /// What was decided there since it was last asked for.
    fn learn(&mut self, ease: &mut Ease, report: &mut StepReport) {
        let _ = (ease, report);
    }

    /// What was decided there does not count.
    fn forget(&mut self) {}
}
