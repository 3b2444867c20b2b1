//! The answer of a time step in `f64`: what solvers are measured against.
//!
//! Implicit Euler's step is a minimum of `g(x) = 1/(2h²) Σ m |x − s|² + Σ W(x)` (Liu et al. 2013, Bouaziz et al. 2014), s being the
//! prediction and W the energies of constraints. Here it is found to the last digits, with nothing of the solvers' own code but
//! the rest data of constraints and the wrapper of the Cholesky factorization: local-global iterations first, because g has many minima and that is where they lead, then
//! quasi-Newton steps with Y as first guess of the Hessian (Liu, Bouaziz and Kavan 2017), then Newton's. On one thread.

mod kinds;
mod minimize;
mod objective;
mod svd;
#[cfg(test)]
mod tests;

use glam::{DVec3, Vec3};
use vivace_model::{Forces, Model, ModelError, State, check_time_step};

use crate::SolverError;
use minimize::Minimizer;
use objective::Objective;

/// Solves steps of one model and one size to the end.
#[derive(Debug)]
pub struct Reference {
    model: Model,
    h: f64,
    tolerance: f64,
    minimizer: Minimizer,
}

/// Positions and velocities in `f64`.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReferenceState {
    /// q \[m\].
    pub positions: Vec<DVec3>,
    /// v \[m/s\].
    pub velocities: Vec<DVec3>,
}

/// A step, solved.
#[derive(Debug, Clone, PartialEq)]
pub struct Answer {
    /// s of Eq. 1 \[m\].
    pub predicted: Vec<DVec3>,
    /// x*, where g has a minimum \[m\].
    pub positions: Vec<DVec3>,
    /// Iterations of all kinds.
    pub iterations: u32,
    /// ‖∇g(x*)‖ relative to what acts from outside, Σ m |a|, or, where nothing does, to ‖∇g(s)‖ \[1\].
    pub gradient: f64,
    /// g(x*) \[J\].
    pub objective: f64,
}

/// The gradient that is small enough, relative to what [`Answer::gradient`] is.
const TOLERANCE: f64 = 1e-9;

impl From<&State> for ReferenceState {
    fn from(state: &State) -> Self {
        let exact = |values: &[Vec3]| values.iter().map(|v| v.as_dvec3()).collect();
        Self { positions: exact(&state.positions), velocities: exact(&state.velocities) }
    }
}

impl Answer {
    /// ‖x − x*‖ / ‖s − x*‖ \[1\]: 1 where a solver starts, 0 where it ought to end. NaN if s is the answer and x too.
    ///
    /// # Panics
    /// `positions` are not as many as the particles.
    #[must_use]
    pub fn error(&self, positions: &[Vec3]) -> f64 {
        assert_eq!(positions.len(), self.positions.len(), "one position for each particle");
        let left =
            positions.iter().zip(&self.positions).map(|(x, exact)| x.as_dvec3().distance_squared(*exact));
        let first = self.predicted.iter().zip(&self.positions).map(|(s, exact)| s.distance_squared(*exact));
        (left.sum::<f64>() / first.sum::<f64>()).sqrt()
    }
}

impl Reference {
    /// Prepares `model` for steps of `h` \[s\].
    ///
    /// # Errors
    /// A step that [`check_time_step`] refuses; Y cannot be factored.
    pub fn new(model: &Model, h: f64) -> Result<Self, SolverError> {
        #[expect(clippy::cast_possible_truncation, reason = "the bound need not be exact")]
        check_time_step(h as f32)?;
        let minimizer = Minimizer::new(Objective::new(model, h))?;
        Ok(Self { model: model.clone(), h, tolerance: TOLERANCE, minimizer })
    }

    /// Ends a solve at this gradient, in the unit of [`Answer::gradient`]: 10⁻⁹ unless told otherwise, and at least that.
    pub fn set_tolerance(&mut self, gradient: f64) {
        self.tolerance = gradient.max(TOLERANCE);
    }

    /// Moves the target of attachment `idx` \[m\].
    ///
    /// # Errors
    /// As [`Model::set_attachment_target`].
    pub fn set_attachment_target(&mut self, idx: usize, target: Vec3) -> Result<(), ModelError> {
        self.model.set_attachment_target(idx, target)?;
        self.minimizer.objective.set_attachment_target(idx, target);
        Ok(())
    }

    /// The answer of the step from `state`. Where rounding ends it before the gradient is small enough, [`Answer::gradient`] says so.
    ///
    /// # Errors
    /// A state or forces that cannot be simulated; the Hessian cannot be factored.
    pub fn solve(&mut self, state: &State, forces: &Forces) -> Result<Answer, SolverError> {
        state.check(&self.model)?;
        self.solve_exact(&state.into(), forces)
    }

    /// As [`Reference::solve`], from a state in `f64`.
    ///
    /// # Errors
    /// As [`Reference::solve`].
    pub fn solve_exact(&mut self, state: &ReferenceState, forces: &Forces) -> Result<Answer, SolverError> {
        forces.check()?;
        self.check(state)?;
        let (h, masses) = (self.h, self.model.masses());
        let accelerations = self.accelerations(state, forces);
        let is_free = |i: usize| masses[i].is_finite();
        let predict = |i: usize| {
            let (q, v) = (state.positions[i], state.velocities[i]);
            if is_free(i) { q + h * v + h * h * accelerations[i] } else { q }
        };
        let predicted: Vec<DVec3> = (0..masses.len()).map(predict).collect();
        let free = (0..masses.len()).filter(|&i| is_free(i));
        let outer: f64 = free.map(|i| f64::from(masses[i]) * accelerations[i].length()).sum();
        let unit = if outer > 0.0 { outer } else { self.minimizer.gradient_norm(&predicted, &predicted) };
        let mut positions = predicted.clone();
        let minimum = self.minimizer.minimize(&mut positions, &predicted, self.tolerance * unit)?;
        if let Some(particle) = positions.iter().position(|x| !x.is_finite()) {
            return Err(SolverError::Diverged { particle });
        }
        let gradient = if unit > 0.0 { minimum.gradient / unit } else { 0.0 };
        Ok(Answer {
            predicted,
            positions,
            iterations: minimum.iterations,
            gradient,
            objective: minimum.value,
        })
    }

    /// Advances `state` to the answer of its step: positions, and velocities `(x* − q) / h`, damped.
    ///
    /// # Errors
    /// As [`Reference::solve`]; the state is then as it was.
    pub fn step(&mut self, state: &mut ReferenceState, forces: &Forces) -> Result<Answer, SolverError> {
        let answer = self.solve_exact(state, forces)?;
        let scale = (-f64::from(forces.damping) * self.h).exp() / self.h;
        let all = state.positions.iter_mut().zip(&mut state.velocities).zip(&answer.positions);
        for ((q, v), x) in all {
            *v = (*x - *q) * scale;
            *q = *x;
        }
        Ok(answer)
    }

    fn check(&self, state: &ReferenceState) -> Result<(), ModelError> {
        let expected = self.model.n_particles();
        for (what, values) in [("positions", &state.positions), ("velocities", &state.velocities)] {
            if values.len() != expected {
                return Err(ModelError::Length { what, expected, found: values.len() });
            }
            if let Some(particle) = values.iter().position(|v| !State::is_in_range(v.as_vec3())) {
                return Err(ModelError::NotFinite { what, particle, value: values[particle].as_vec3() });
            }
        }
        Ok(())
    }

    fn accelerations(&self, state: &ReferenceState, forces: &Forces) -> Vec<DVec3> {
        let mut accelerations = vec![forces.gravity.as_dvec3(); self.model.n_particles()];
        let (q, v) = (&state.positions, &state.velocities);
        forces.add_wind(&self.model, self.h, q, v, &mut Vec::new(), |i, a| accelerations[i] += a);
        accelerations
    }
}
