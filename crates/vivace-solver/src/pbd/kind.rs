//! The constraints of one kind, color by color.

use std::ops::Range;

use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use vivace_kernels::constraint::Constraint;
use vivace_model::{KindVisitor, Model, Store};

use super::coloring::color_constraints;
use crate::SolverError;
use crate::pd::{GRAIN, sum_in_pieces};

/// What Position Based Dynamics does with a kind.
pub(super) trait Kind: Send + Sync + std::fmt::Debug {
    /// Forgets the multipliers: a time step of `h` \[s\] begins.
    fn begin(&mut self, h: f32);
    /// Projects the constraints of one color, one after another or at once: they share no particle.
    fn relax_color(&mut self, color: u32, omega: f32, w: &[f32], q: &mut [Vec3A]);
    /// Adds to `sums` what every constraint would do from the same q, over the number of constraints of its busiest particle.
    fn relax_all(&mut self, omega: f32, w: &[f32], counts: &[f32], q: &[Vec3A], sums: &mut [Vec3A]);
    /// Projects all constraints in the model's order.
    fn relax_in_order(&mut self, omega: f32, w: &[f32], q: &mut [Vec3A]);
    /// Their energy w C² / 2 \[J\].
    fn energy(&self, q: &[Vec3A]) -> f64;
    /// Counts the constraints of each particle.
    fn count(&self, counts: &mut [f32]);
    /// Moves the target of attachment `idx` of the model, if this kind is that of attachments.
    fn set_target(&mut self, idx: usize, target: Vec3);
}

/// Kind `C`.
#[derive(Debug)]
struct KindOf<C, const N: usize, const R: usize> {
    /// Members of each color.
    colors: Vec<Range<usize>>,
    particles: Vec<[u32; N]>,
    rest: Vec<C>,
    /// Where the model's constraints stand here.
    place: Vec<u32>,
    /// Multipliers \[N s²\].
    lambdas: Vec<f32>,
    h: f32,
    moves: Vec<[Vec3; N]>,
}

/// Collects the kinds of a model.
pub(super) struct Kinds {
    colors: Vec<u32>,
    n_colors: u32,
    n_seen: usize,
    kinds: Vec<Box<dyn Kind>>,
}

impl Kinds {
    /// The kinds that the model holds, and the number of colors.
    pub(super) fn of(model: &Model) -> Result<(Vec<Box<dyn Kind>>, u32), SolverError> {
        let (colors, n_colors) = color_constraints(model)?;
        let mut kinds = Self { colors, n_colors, n_seen: 0, kinds: Vec::new() };
        model.constraints().visit(&mut kinds);
        Ok((kinds.kinds, n_colors))
    }
}

impl KindVisitor for Kinds {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        let of_kind = &self.colors[self.n_seen..self.n_seen + store.len()];
        self.n_seen += store.len();
        let members = vivace_graph::Csr::group_by(self.n_colors as usize, of_kind);
        let ends = members.offsets().windows(2).map(|ends| ends[0] as usize..ends[1] as usize).collect();
        let order = members.items();
        let mut place = vec![0; order.len()];
        for (k, &constraint) in (0..).zip(order) {
            place[constraint as usize] = k;
        }
        let pick = |&constraint: &u32| constraint as usize;
        self.kinds.push(Box::new(KindOf::<C, N, R> {
            colors: ends,
            particles: order.iter().map(pick).map(|k| store.particles[k]).collect(),
            rest: order.iter().map(pick).map(|k| store.rest[k]).collect(),
            place,
            lambdas: vec![0.0; store.len()],
            h: 1.0,
            moves: vec![[Vec3::ZERO; N]; store.len()],
        }));
    }
}

/// One projection of XPBD (Macklin, Müller, Chentanez 2016, Eq. 18): adds to λ, returns by how much each particle moves.
#[inline]
fn project<C: Constraint<N, R>, const N: usize, const R: usize>(
    rest: &C,
    particles: &[u32; N],
    squared_h: f32,
    omega: f32,
    w: &[f32],
    q: &[Vec3A],
    lambda: &mut f32,
) -> [Vec3; N] {
    let (c, gradient) = rest.deviation(&particles.map(|p| q[p as usize].into()));
    let compliance = 1.0 / (rest.weight() * squared_h);
    let mut denominator = compliance;
    for (gradient, &p) in gradient.iter().zip(particles) {
        denominator += w[p as usize] * gradient.length_squared();
    }
    let step = omega * (-c - compliance * *lambda) / denominator;
    *lambda += step;
    std::array::from_fn(|slot| gradient[slot] * (w[particles[slot] as usize] * step))
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kind for KindOf<C, N, R> {
    fn begin(&mut self, h: f32) {
        self.h = h;
        self.lambdas.fill(0.0);
    }

    fn relax_color(&mut self, color: u32, omega: f32, w: &[f32], q: &mut [Vec3A]) {
        let range = self.colors[color as usize].clone();
        let squared_h = self.h * self.h;
        let constraints = self.particles[range.clone()].iter().zip(&self.rest[range.clone()]);
        if rayon::current_num_threads() == 1 || range.len() < 2 * GRAIN {
            for ((particles, rest), lambda) in constraints.zip(&mut self.lambdas[range]) {
                let moves = project(rest, particles, squared_h, omega, w, q, lambda);
                for (&p, step) in particles.iter().zip(moves) {
                    q[p as usize] += Vec3A::from(step);
                }
            }
            return;
        }
        let moves = &mut self.moves[range.clone()];
        let lambdas = &mut self.lambdas[range.clone()];
        let all = self.particles[range.clone()].par_iter().zip(&self.rest[range]).zip(lambdas).zip(&mut *moves);
        let positions = &*q;
        all.with_min_len(GRAIN).for_each(|(((particles, rest), lambda), moves)| {
            *moves = project(rest, particles, squared_h, omega, w, positions, lambda);
        });
        for ((particles, _), moves) in constraints.zip(moves) {
            for (&p, step) in particles.iter().zip(moves) {
                q[p as usize] += Vec3A::from(*step);
            }
        }
    }

    fn relax_all(&mut self, omega: f32, w: &[f32], counts: &[f32], q: &[Vec3A], sums: &mut [Vec3A]) {
        let squared_h = self.h * self.h;
        let moves = self.moves.par_iter_mut().zip(&mut self.lambdas).zip(&self.particles).zip(&self.rest);
        moves.with_min_len(GRAIN).for_each(|(((moves, lambda), particles), rest)| {
            let busiest = particles.iter().map(|&p| counts[p as usize]).fold(1.0, f32::max);
            *moves = project(rest, particles, squared_h, omega / busiest, w, q, lambda);
        });
        for (particles, moves) in self.particles.iter().zip(&self.moves) {
            for (&p, step) in particles.iter().zip(moves) {
                sums[p as usize] += Vec3A::from(*step);
            }
        }
    }

    fn relax_in_order(&mut self, omega: f32, w: &[f32], q: &mut [Vec3A]) {
        let squared_h = self.h * self.h;
        for &k in &self.place {
            let k = k as usize;
            let moves =
                project(&self.rest[k], &self.particles[k], squared_h, omega, w, q, &mut self.lambdas[k]);
            for (&p, step) in self.particles[k].iter().zip(moves) {
                q[p as usize] += Vec3A::from(step);
            }
        }
    }

    fn energy(&self, q: &[Vec3A]) -> f64 {
        sum_in_pieces(self.rest.len(), |k| {
            let (c, _) = self.rest[k].deviation(&self.particles[k].map(|p| q[p as usize].into()));
            0.5 * f64::from(self.rest[k].weight()) * f64::from(c) * f64::from(c)
        })
    }

    fn count(&self, counts: &mut [f32]) {
        for &p in self.particles.iter().flatten() {
            counts[p as usize] += 1.0;
        }
    }

    fn set_target(&mut self, idx: usize, target: Vec3) {
        if let Some(&k) = self.place.get(idx) {
            self.rest[k as usize].set_target(target);
        }
    }
}
