//! Relaxations: schedules of [`Stages`].

mod chebyshev;
mod estimate;
mod gauss_seidel;
mod trace;

use crate::step::Ease;
use crate::{Base, Relaxation, Rho, Stages};
pub(crate) use estimate::spectral_radius;
pub(crate) use trace::Weights;

/// Where a relaxation stands within a time step.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Schedule {
    relaxation: Relaxation,
    /// Chebyshev's weights; begin anew with each time step.
    weights: chebyshev::Weights,
    /// Iterations done since the start, or since acceleration was lowered.
    k: u32,
    /// Sweeps since the local step; 0 asks for another.
    sweeps: u32,
    /// Sweeps before over-relaxation begins.
    delay: u32,
}

impl Schedule {
    /// Before the first iteration, with acceleration eased as `ease` says.
    pub(crate) fn new(relaxation: Relaxation, ease: Ease, is_safe: bool) -> Self {
        let least_delay = if is_safe { SAFE_DELAY } else { 0 };
        let (rho, delay) = match relaxation {
            Relaxation::Chebyshev { rho, delay, .. } | Relaxation::ChebyshevGaussSeidel { rho, delay } => {
                (rho, delay.max(least_delay))
            }
            Relaxation::SymmetricChebyshev { rho } => (rho, least_delay),
            _ => (Rho::Given(0.0), 0),
        };
        let half = 0.5_f32.powi(ease.level().min(100).cast_signed());
        let rho = (1.0 - (1.0 - rho.or(ease.rho())) / half).max(0.0);
        let relaxation = eased(relaxation, ease.level(), half);
        let weights = chebyshev::Weights::new(rho, delay);
        Self { relaxation, weights, k: 0, sweeps: 0, delay: least_delay }
    }

    /// One iteration: the body of the loop in Algorithm 1, after the local step where it is apart.
    pub(crate) fn iterate(&mut self, stages: &mut dyn Stages) {
        if self.sweeps == 0 || self.sweeps >= stages.n_sweeps() {
            stages.project();
            self.sweeps = 0;
        }
        self.sweeps += 1;
        match self.relaxation {
            Relaxation::Jacobi { omega } => stages.relax_all(omega),
            Relaxation::Chebyshev { gamma, .. } => {
                let weight = self.weights.next();
                chebyshev::accelerated(stages, weight, |stages| stages.relax_all(gamma));
            }
            Relaxation::GaussSeidel { omega, base: Base::Latest } => {
                gauss_seidel::forward(stages, self.ramped(omega));
            }
            Relaxation::GaussSeidel { omega, base: Base::PreviousInPlace } => {
                gauss_seidel::from_previous(stages, if self.k == 0 { 1.0 } else { omega });
            }
            Relaxation::GaussSeidel { omega, base: Base::PreviousAfterSweep } => {
                let weight = if self.k == 0 { 1.0 } else { omega };
                chebyshev::accelerated(stages, weight, |stages| gauss_seidel::forward(stages, 1.0));
            }
            Relaxation::SymmetricChebyshev { .. } => {
                let weight = self.weights.next();
                chebyshev::accelerated(stages, weight, gauss_seidel::symmetric);
            }
            Relaxation::ChebyshevGaussSeidel { .. } => {
                let weight = self.weights.next();
                chebyshev::accelerated(stages, weight, |stages| gauss_seidel::forward(stages, 1.0));
            }
            Relaxation::Lexicographic { omega } => stages.relax_in_order(self.ramped(omega)),
            Relaxation::ConjugateGradient { preconditioner, inner } => {
                stages.solve_by_conjugate_gradient(preconditioner, inner);
            }
            Relaxation::Direct => stages.solve_directly(),
        }
        stages.touch();
        self.k += 1;
    }

    /// The next iteration makes the local step anew.
    pub(crate) fn project_anew(&mut self) {
        self.sweeps = 0;
    }

    /// After an iteration that hardly moved: whether the local step was made anew just before it, so that nothing else will move
    /// either. If not, the next iteration makes it.
    pub(crate) fn settle(&mut self) -> bool {
        let is_fresh = self.sweeps == 1;
        self.sweeps = 0;
        is_fresh
    }

    fn ramped(&self, omega: f32) -> f32 {
        if self.k < self.delay { omega.min(1.0) } else { omega }
    }
}

/// Whether safeguarding can help: plain iterations never raise the objective of Projective Dynamics.
pub(crate) fn is_accelerated(relaxation: Relaxation) -> bool {
    match relaxation {
        Relaxation::GaussSeidel { omega, .. } | Relaxation::Lexicographic { omega } => omega > 1.0,
        Relaxation::Jacobi { omega } => omega > 0.5,
        Relaxation::Chebyshev { .. }
        | Relaxation::SymmetricChebyshev { .. }
        | Relaxation::ChebyshevGaussSeidel { .. } => true,
        Relaxation::ConjugateGradient { .. } | Relaxation::Direct => false,
    }
}

/// Under the safeguard, acceleration waits for so many iterations. A step of a few accelerated ones lowers its own objective and
/// still feeds the velocity: animations blew up for ω = 1.9 with 1 to 5 iterations a step, 1.7 with 1 and 2, 1.5 with 1, whatever the
/// objective said.
const SAFE_DELAY: u32 = 5;

/// The relaxation with its acceleration halved `level` times, that is times `half`: ω towards 1. ρ goes away from 1, by [`Schedule::new`].
fn eased(relaxation: Relaxation, level: u32, half: f32) -> Relaxation {
    let towards_one = |omega: f32| if omega > 1.0 { 1.0 + (omega - 1.0) * half } else { omega };
    match relaxation {
        Relaxation::Jacobi { omega } => Relaxation::Jacobi { omega: omega * half },
        // The first steps back lower ρ; if that does not help, Jacobi itself diverges.
        Relaxation::Chebyshev { rho, gamma, delay } if level > 4 => {
            Relaxation::Chebyshev { rho, gamma: gamma * half * 16.0, delay }
        }
        Relaxation::GaussSeidel { omega, base } => {
            Relaxation::GaussSeidel { omega: towards_one(omega), base }
        }
        Relaxation::Lexicographic { omega } => Relaxation::Lexicographic { omega: towards_one(omega) },
        other => other,
    }
}
