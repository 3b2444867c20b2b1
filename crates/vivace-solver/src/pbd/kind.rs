//! The constraints of one kind, color by color.

use std::ops::Range;

use glam::{Vec3, Vec3A};
use rayon::prelude::*;
use vivace_kernels::constraint::{Constraint, Xpbd};
use vivace_model::{KindVisitor, Model, Store};

use super::coloring::color_constraints;
use crate::SolverError;
use crate::history::History;
use crate::parallel::sum;

/// What Position Based Dynamics does with a kind.
pub(super) trait Kind: Send + Sync + std::fmt::Debug {
    /// Multipliers go where positions go: see [`Stages`](crate::Stages).
    fn remember(&mut self);
    fn extrapolate(&mut self, omega: f32);
    fn save(&mut self);
    fn restore(&mut self);
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
    /// Adds the gradient of their energy, w C ∇C, to each particle \[N\].
    fn add_gradient(&self, q: &[Vec3A], sums: &mut [Vec3A]);
    /// Counts the constraints of each particle.
    fn count(&self, counts: &mut [f32]);
    /// Moves the target of attachment `idx` of the model, if this kind is that of attachments.
    fn set_attachment_target(&mut self, idx: usize, target: Vec3);
}

/// Constraints that one thread projects before another may take over.
const GRAIN: usize = 256;

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
    history: History<f32>,
    h: f32,
    moves: Vec<[Vec3A; N]>,
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
            history: History::new(store.len()),
            h: 1.0,
            moves: vec![[Vec3A::ZERO; N]; store.len()],
        }));
    }
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kind for KindOf<C, N, R> {
    fn begin(&mut self, h: f32) {
        self.h = h;
        self.lambdas.fill(0.0);
        self.history.begin(&self.lambdas);
    }

    fn remember(&mut self) {
        self.history.remember(&self.lambdas);
    }

    fn extrapolate(&mut self, omega: f32) {
        self.history.extrapolate(&mut self.lambdas, omega);
    }

    fn save(&mut self) {
        self.history.save(&self.lambdas);
    }

    fn restore(&mut self) {
        self.history.restore(&mut self.lambdas);
    }

    fn relax_color(&mut self, color: u32, omega: f32, w: &[f32], q: &mut [Vec3A]) {
        let range = self.colors[color as usize].clone();
        let xpbd = Xpbd { inverse_masses: w, squared_h: self.h * self.h, omega };
        let (rest, particles) = (&self.rest[range.clone()], &self.particles[range.clone()]);
        let lambdas = &mut self.lambdas[range.clone()];
        // Springs, four at a time, are done before what other threads find is applied.
        let least = if N == 2 { usize::MAX } else { 2 * GRAIN };
        if rayon::current_num_threads() == 1 || range.len() < least {
            return C::correct_all(rest, particles, &xpbd, q, lambdas);
        }
        // Found in parallel, then applied: the host has no way to write scattered elements from many threads.
        let moves = &mut self.moves[range];
        let positions = &*q;
        let all = particles.par_iter().zip(rest).zip(lambdas).zip(&mut *moves).with_min_len(GRAIN);
        all.for_each(|(((particles, rest), lambda), moves)| {
            *moves = rest.correct(particles, &xpbd, positions, lambda);
        });
        scatter(particles, moves, q);
    }

    fn relax_all(&mut self, omega: f32, w: &[f32], counts: &[f32], q: &[Vec3A], sums: &mut [Vec3A]) {
        let squared_h = self.h * self.h;
        let moves = self.moves.par_iter_mut().zip(&mut self.lambdas).zip(&self.particles).zip(&self.rest);
        moves.with_min_len(GRAIN).for_each(|(((moves, lambda), particles), rest)| {
            let busiest = particles.iter().map(|&p| counts[p as usize]).fold(1.0, f32::max);
            let xpbd = Xpbd { inverse_masses: w, squared_h, omega: omega / busiest };
            *moves = rest.correct(particles, &xpbd, q, lambda);
        });
        scatter(&self.particles, &self.moves, sums);
    }

    fn relax_in_order(&mut self, omega: f32, w: &[f32], q: &mut [Vec3A]) {
        let xpbd = Xpbd { inverse_masses: w, squared_h: self.h * self.h, omega };
        for &k in &self.place {
            let one = k as usize..k as usize + 1;
            C::correct_all(
                &self.rest[one.clone()],
                &self.particles[one.clone()],
                &xpbd,
                q,
                &mut self.lambdas[one],
            );
        }
    }

    fn energy(&self, q: &[Vec3A]) -> f64 {
        sum(0..self.rest.len(), &|k: usize| {
            let (c, _) = self.rest[k].deviation(&self.particles[k].map(|p| q[p as usize].into()));
            0.5 * f64::from(self.rest[k].weight()) * f64::from(c) * f64::from(c)
        })
    }

    fn add_gradient(&self, q: &[Vec3A], sums: &mut [Vec3A]) {
        for (particles, rest) in self.particles.iter().zip(&self.rest) {
            let (c, gradient) = rest.deviation(&particles.map(|p| q[p as usize].into()));
            for (&p, gradient) in particles.iter().zip(gradient) {
                sums[p as usize] += Vec3A::from(gradient) * (rest.weight() * c);
            }
        }
    }

    fn count(&self, counts: &mut [f32]) {
        for &p in self.particles.iter().flatten() {
            counts[p as usize] += 1.0;
        }
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        // Attachments alone hold one particle.
        if N == 1
            && let Some(&k) = self.place.get(idx)
        {
            self.rest[k as usize].set_target(target);
        }
    }
}

/// Adds to each constraint's particles what it moves them by, in order.
fn scatter<const N: usize>(particles: &[[u32; N]], moves: &[[Vec3A; N]], q: &mut [Vec3A]) {
    for (particles, moves) in particles.iter().zip(moves) {
        for (&p, step) in particles.iter().zip(moves) {
            q[p as usize] += *step;
        }
    }
}
