//! Minimizes the objective: local-global iterations, quasi-Newton steps, Newton steps.

use std::collections::VecDeque;

use glam::DVec3;

use super::objective::Objective;
use crate::SolverError;
use crate::cholesky::Cholesky;

/// Local-global iterations (Bouaziz et al. 2014) before anything faster. A cloth that buckles has many minima; these lead to the
/// one that Projective Dynamics itself would find.
const LOCAL_GLOBAL: u32 = 50;
/// Quasi-Newton steps (Liu, Bouaziz and Kavan 2017) before Newton's are tried.
const QUASI_NEWTON: u32 = 100;
/// Quasi-Newton steps until Newton's are tried again, where the Hessian is not positive definite yet.
const UNTIL_NEWTON: u32 = 25;
/// Quasi-Newton steps from one Hessian, where it is only an upper bound.
const STEPS_PER_BOUND: u32 = 30;
/// Iterations of all kinds.
const MOST: u32 = 1500;
/// Pairs of steps and gradients that a quasi-Newton step remembers.
const MEMORY: usize = 8;
/// Halvings of a step until it is given up.
const HALVINGS: u32 = 40;

/// Y, the Hessian, and their factors.
#[derive(Debug)]
pub(crate) struct Minimizer {
    pub(crate) objective: Objective,
    y: Cholesky,
    hessian: Option<Cholesky>,
    /// One number for each unknown.
    flat: Vec<f64>,
}

/// Where a minimization is.
struct Iterate {
    x: Vec<DVec3>,
    gradient: Vec<DVec3>,
    value: f64,
}

/// What a minimization ended with.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Minimum {
    pub(crate) iterations: u32,
    /// ‖∇g‖ \[N\].
    pub(crate) gradient: f64,
    /// g \[J\].
    pub(crate) value: f64,
}

impl Minimizer {
    pub(crate) fn new(objective: Objective) -> Result<Self, SolverError> {
        let mut y = Cholesky::new(objective.pattern.clone(), 3, None)?;
        y.factor(&objective.y())?;
        let flat = vec![0.0; 3 * objective.free.len()];
        Ok(Self { objective, y, hessian: None, flat })
    }

    /// ‖∇g(x)‖ \[N\].
    pub(crate) fn gradient_norm(&self, x: &[DVec3], predicted: &[DVec3]) -> f64 {
        let mut gradient = vec![DVec3::ZERO; x.len()];
        self.objective.evaluate(x, predicted, &mut gradient);
        norm(&gradient)
    }

    /// Moves x to a minimum of g: until ‖∇g‖ is `tolerance` \[N\], or no step lowers it.
    pub(crate) fn minimize(
        &mut self,
        x: &mut Vec<DVec3>,
        predicted: &[DVec3],
        tolerance: f64,
    ) -> Result<Minimum, SolverError> {
        let mut at = Iterate { gradient: vec![DVec3::ZERO; x.len()], x: std::mem::take(x), value: 0.0 };
        at.value = self.objective.evaluate(&at.x, predicted, &mut at.gradient);
        let mut pairs = Pairs::default();
        let mut iterations = 0;
        let (mut is_newton, mut next_newton) = (false, LOCAL_GLOBAL + QUASI_NEWTON);
        let steps_per_hessian = if self.objective.is_hessian_exact { 1 } else { STEPS_PER_BOUND };
        while norm(&at.gradient) > tolerance && iterations < MOST {
            if iterations < LOCAL_GLOBAL {
                // The global step `Y x = b` is x − Y⁻¹ ∇g, and never raises g.
                let step = self.solved(at.gradient.clone(), false);
                at.x.iter_mut().zip(&step).for_each(|(x, step)| *x -= *step);
                at.value = self.objective.evaluate(&at.x, predicted, &mut at.gradient);
                iterations += 1;
                continue;
            }
            if iterations >= next_newton && self.objective.is_hessian_worth_it {
                let was_newton = std::mem::replace(&mut is_newton, self.factor_hessian(&at.x)?);
                if is_newton || was_newton {
                    pairs.clear();
                }
                next_newton = iterations + if is_newton { steps_per_hessian } else { UNTIL_NEWTON };
            }
            let direction = pairs.direction(&at.gradient, |gradient| self.solved(gradient, is_newton));
            let Some(next) = self.search(&at, &direction, predicted) else {
                if pairs.is_empty() {
                    break;
                }
                pairs.clear();
                continue;
            };
            pairs.push(&at, &next);
            at = next;
            iterations += 1;
        }
        let minimum = Minimum { iterations, gradient: norm(&at.gradient), value: at.value };
        *x = at.x;
        Ok(minimum)
    }

    /// Returns whether the Hessian is positive definite, as it is around a minimum: only then Newton's steps are of use.
    fn factor_hessian(&mut self, x: &[DVec3]) -> Result<bool, SolverError> {
        if self.hessian.is_none() {
            let order: Vec<u32> =
                self.y.order().iter().flat_map(|row| [3 * row, 3 * row + 1, 3 * row + 2]).collect();
            self.hessian = Some(Cholesky::new(self.objective.hessian_pattern(), 1, Some(&order))?);
        }
        let Some(hessian) = &mut self.hessian else { return Ok(false) };
        Ok(hessian.factor(&self.objective.hessian(x)).is_ok())
    }

    /// Y⁻¹ `v`, or the Hessian's inverse times v.
    fn solved(&mut self, mut v: Vec<DVec3>, with_hessian: bool) -> Vec<DVec3> {
        let Self { objective, y, hessian, flat } = self;
        let n = objective.free.len();
        let (factor, index): (_, fn(usize, usize, usize) -> usize) = match hessian {
            Some(hessian) if with_hessian => (hessian, |_, k, axis| 3 * k + axis),
            _ => (y, |n, k, axis| n * axis + k),
        };
        for (k, &particle) in objective.free.iter().enumerate() {
            for axis in 0..3 {
                flat[index(n, k, axis)] = v[particle as usize][axis];
            }
        }
        factor.solve_in_place(flat);
        for (k, &particle) in objective.free.iter().enumerate() {
            v[particle as usize] = DVec3::from_array(std::array::from_fn(|axis| flat[index(n, k, axis)]));
        }
        v
    }

    /// Halves a step until g falls enough (Armijo 1966); where g has no more digits, until the slope does (Hager and Zhang 2005).
    fn search(&self, at: &Iterate, direction: &[DVec3], predicted: &[DVec3]) -> Option<Iterate> {
        let slope = dot(&at.gradient, direction);
        if slope >= 0.0 || !slope.is_finite() {
            return None;
        }
        let mut step = 1.0;
        for _ in 0..HALVINGS {
            let x: Vec<DVec3> = at.x.iter().zip(direction).map(|(x, d)| *x + step * *d).collect();
            let mut next = Iterate { gradient: vec![DVec3::ZERO; x.len()], x, value: 0.0 };
            next.value = self.objective.evaluate(&next.x, predicted, &mut next.gradient);
            let is_lower = next.value <= at.value + 1e-4 * step * slope;
            let is_level = (next.value - at.value).abs() <= 1e-12 * at.value.abs();
            if is_lower || is_level && dot(&next.gradient, direction).abs() <= 0.9 * slope.abs() {
                return Some(next);
            }
            step *= 0.5;
        }
        None
    }
}

/// What a quasi-Newton step remembers: steps, changes of the gradient, one over their products.
#[derive(Default)]
struct Pairs(VecDeque<(Vec<DVec3>, Vec<DVec3>, f64)>);

impl Pairs {
    fn clear(&mut self) {
        self.0.clear();
    }

    fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn push(&mut self, from: &Iterate, to: &Iterate) {
        let difference =
            |a: &[DVec3], b: &[DVec3]| -> Vec<DVec3> { a.iter().zip(b).map(|(a, b)| *a - *b).collect() };
        let (step, change) = (difference(&to.x, &from.x), difference(&to.gradient, &from.gradient));
        let product = dot(&step, &change);
        if product > 0.0 {
            self.0.truncate(MEMORY - 1);
            self.0.push_front((step, change, 1.0 / product));
        }
    }

    /// The two loops of L-BFGS (Nocedal 1980) around `solved`, the initial inverse Hessian.
    fn direction(&self, gradient: &[DVec3], solved: impl FnOnce(Vec<DVec3>) -> Vec<DVec3>) -> Vec<DVec3> {
        let mut v = gradient.to_vec();
        let mut shares = Vec::with_capacity(MEMORY);
        for (step, change, inverse) in &self.0 {
            let share = inverse * dot(step, &v);
            v.iter_mut().zip(change).for_each(|(v, change)| *v -= share * *change);
            shares.push(share);
        }
        let mut v = solved(v);
        for ((step, change, inverse), share) in self.0.iter().zip(shares).rev() {
            let scale = share - inverse * dot(change, &v);
            v.iter_mut().zip(step).for_each(|(v, step)| *v += scale * *step);
        }
        v.iter_mut().for_each(|v| *v = -*v);
        v
    }
}

fn dot(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.dot(*b)).sum()
}

fn norm(v: &[DVec3]) -> f64 {
    dot(v, v).sqrt()
}
