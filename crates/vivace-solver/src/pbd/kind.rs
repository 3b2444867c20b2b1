//! The constraints of one kind, color by color.

use std::ops::Range;

use glam::{Vec3, Vec4};
use rayon::prelude::*;
use vivace_kernels::constraint::{Attachment, BATCH, Constraint, Xpbd};
use vivace_model::{KindVisitor, Model, Store};

use super::arranged::Arranged;
use super::coloring::{color_attachments, color_constraints};
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
    fn relax_color(&mut self, color: u32, omega: f32, q: &mut [Vec4]);
    /// Adds to `sums` what every constraint would do from the same q, over the number of constraints of its busiest particle.
    fn relax_all(&mut self, omega: f32, counts: &[f32], q: &[Vec4], sums: &mut [Vec4]);
    /// Projects all constraints in the model's order.
    fn relax_in_order(&mut self, omega: f32, q: &mut [Vec4]);
    /// Their energy w C² / 2 \[J\].
    fn energy(&self, q: &[Vec4]) -> f64;
    /// Adds the gradient of their energy, w C ∇C, to each particle \[N\].
    fn add_gradient(&self, q: &[Vec4], sums: &mut [Vec4]);
    /// How many colors there are, up to the last that this kind has.
    fn n_colors(&self) -> u32;
    /// Counts the constraints of each particle.
    fn count(&self, counts: &mut [f32]);
    /// Moves the target of attachment `idx` of the model, if this kind is that of attachments.
    fn set_attachment_target(&mut self, idx: usize, target: Vec3);
}

/// Constraints that one thread projects before another may take over.
const GRAIN: usize = 256;

/// Kind `C`.
#[derive(Debug)]
struct KindOf<C: Constraint<N, R>, const N: usize, const R: usize> {
    /// Members of each color.
    colors: Vec<Range<usize>>,
    particles: Vec<[u32; N]>,
    rest: Vec<C>,
    /// Where the model's constraints stand here.
    place: Vec<u32>,
    /// Multipliers \[N s²\].
    lambdas: Vec<C::Multiplier>,
    history: History<C::Multiplier>,
    h: f32,
    moves: Vec<[Vec4; N]>,
}

/// Collects the kinds of a model.
pub(super) struct Kinds {
    colors: Vec<u32>,
    n_colors: u32,
    n_seen: usize,
    kinds: Vec<Box<dyn Kind>>,
}

impl Kinds {
    /// The kinds that the model holds, that of attachments last.
    pub(super) fn of(model: &Model) -> Result<Vec<Box<dyn Kind>>, SolverError> {
        let (colors, n_colors) = color_constraints(model)?;
        let mut kinds = Self { colors, n_colors, n_seen: 0, kinds: Vec::new() };
        model.constraints().visit(&mut kinds);
        Ok(kinds.kinds)
    }
}

/// The kind of attachments, beside others of so many colors.
pub(super) fn of_attachments(store: &Store<Attachment, 1>, n_colors: u32) -> Box<dyn Kind> {
    let (colors, n_colors) = color_attachments(store, n_colors);
    Box::new(KindOf::new(Arranged::new(store, &colors, n_colors)))
}

impl KindVisitor for Kinds {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        let of_kind = &self.colors[self.n_seen..self.n_seen + store.len()];
        self.n_seen += store.len();
        self.kinds.push(Box::new(KindOf::<C, N, R>::new(Arranged::new(store, of_kind, self.n_colors))));
    }
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> KindOf<C, N, R> {
    fn new(arranged: Arranged<C, N>) -> Self {
        let Arranged { colors, particles, rest, place } = arranged;
        let n = rest.len();
        Self {
            colors,
            particles,
            rest,
            place,
            lambdas: vec![C::Multiplier::default(); n],
            history: History::new(n),
            h: 1.0,
            moves: vec![[Vec4::ZERO; N]; n],
        }
    }
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> Kind for KindOf<C, N, R> {
    fn begin(&mut self, h: f32) {
        self.h = h;
        self.lambdas.fill(C::Multiplier::default());
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

    fn relax_color(&mut self, color: u32, omega: f32, q: &mut [Vec4]) {
        let Some(range) = self.colors.get(color as usize).cloned() else { return };
        let xpbd = Xpbd { squared_h: self.h * self.h, omega };
        let (rest, particles) = (&self.rest[range.clone()], &self.particles[range.clone()]);
        let lambdas = &mut self.lambdas[range.clone()];
        if rayon::current_num_threads() == 1 || range.len() < 2 * GRAIN {
            let (some_rest, rest) = rest.as_chunks();
            let (some_particles, particles) = particles.as_chunks();
            let (some_lambdas, lambdas) = lambdas.as_chunks_mut();
            for ((rest, particles), lambdas) in some_rest.iter().zip(some_particles).zip(some_lambdas) {
                if let Some(moves) = C::correct_batch(rest, particles, &xpbd, q, lambdas) {
                    for slot in 0..N {
                        for (particles, step) in particles.iter().zip(moves[slot]) {
                            q[particles[slot] as usize] += step;
                        }
                    }
                } else {
                    correct_each(rest, particles, &xpbd, q, lambdas);
                }
            }
            correct_each(rest, particles, &xpbd, q, lambdas);
            return;
        }
        // Found in parallel, then applied: the host has no way to write scattered elements from many threads.
        let moves = &mut self.moves[range];
        let positions = &*q;
        let (rest, some) = (rest.par_chunks(BATCH), particles.par_chunks(BATCH));
        let some = rest.zip(some).zip(lambdas.par_chunks_mut(BATCH)).zip(moves.par_chunks_mut(BATCH));
        some.with_min_len(GRAIN / BATCH).for_each(|(((rest, particles), lambdas), moves)| {
            if let (Some(rest), Some(particles), Some(lambdas)) =
                (rest.first_chunk(), particles.first_chunk(), lambdas.first_chunk_mut())
                && let Some(found) = C::correct_batch(rest, particles, &xpbd, positions, lambdas)
            {
                for (lane, moves) in moves.iter_mut().enumerate() {
                    *moves = std::array::from_fn(|slot| found[slot][lane]);
                }
                return;
            }
            for (((rest, particles), lambda), moves) in rest.iter().zip(particles).zip(lambdas).zip(moves) {
                *moves = rest.correct(particles, &xpbd, positions, lambda);
            }
        });
        scatter(particles, moves, q);
    }

    fn relax_all(&mut self, omega: f32, counts: &[f32], q: &[Vec4], sums: &mut [Vec4]) {
        let squared_h = self.h * self.h;
        let moves = self.moves.par_iter_mut().zip(&mut self.lambdas).zip(&self.particles).zip(&self.rest);
        moves.with_min_len(GRAIN).for_each(|(((moves, lambda), particles), rest)| {
            let busiest = particles.iter().map(|&p| counts[p as usize]).fold(1.0, f32::max);
            *moves = rest.correct(particles, &Xpbd { squared_h, omega: omega / busiest }, q, lambda);
        });
        scatter(&self.particles, &self.moves, sums);
    }

    fn relax_in_order(&mut self, omega: f32, q: &mut [Vec4]) {
        let xpbd = Xpbd { squared_h: self.h * self.h, omega };
        for &k in &self.place {
            let k = k as usize;
            correct_each(&self.rest[k..=k], &self.particles[k..=k], &xpbd, q, &mut self.lambdas[k..=k]);
        }
    }

    fn energy(&self, q: &[Vec4]) -> f64 {
        sum(0..self.rest.len(), &|k: usize| {
            let (c, _) = self.rest[k].deviation(&self.particles[k].map(|p| q[p as usize].truncate()));
            0.5 * f64::from(self.rest[k].weight()) * f64::from(c) * f64::from(c)
        })
    }

    fn add_gradient(&self, q: &[Vec4], sums: &mut [Vec4]) {
        for (particles, rest) in self.particles.iter().zip(&self.rest) {
            let (c, gradient) = rest.deviation(&particles.map(|p| q[p as usize].truncate()));
            for (&p, gradient) in particles.iter().zip(gradient) {
                sums[p as usize] += (gradient * (rest.weight() * c)).extend(0.0);
            }
        }
    }

    fn n_colors(&self) -> u32 {
        let last = self.colors.iter().rposition(|members| !members.is_empty());
        last.map_or(0, |last| u32::try_from(last + 1).unwrap_or(u32::MAX))
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

/// Projects one constraint after another.
fn correct_each<C: Constraint<N, R>, const N: usize, const R: usize>(
    rest: &[C],
    particles: &[[u32; N]],
    xpbd: &Xpbd,
    q: &mut [Vec4],
    lambdas: &mut [C::Multiplier],
) {
    for ((rest, particles), lambda) in rest.iter().zip(particles).zip(lambdas) {
        let moves = rest.correct(particles, xpbd, q, lambda);
        for (&particle, step) in particles.iter().zip(moves) {
            q[particle as usize] += step;
        }
    }
}

/// Adds to each constraint's particles what it moves them by, in order.
pub(super) fn scatter<const N: usize>(particles: &[[u32; N]], moves: &[[Vec4; N]], q: &mut [Vec4]) {
    for (particles, moves) in particles.iter().zip(moves) {
        for (&p, step) in particles.iter().zip(moves) {
            q[p as usize] += *step;
        }
    }
}
