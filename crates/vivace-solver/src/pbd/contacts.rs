//! The contacts of a frame in Position Based Dynamics: C = n · (A q − origin) − distance ≥ 0, with friction in position form.
//!
//! They are projected after all other constraints, color by color: two of a color share no free particle. The multiplier along the
//! normal never pulls; the one across it takes back what has slipped since the start of the frame, up to friction times the first.

use std::ops::Range;

use glam::{Vec3, Vec4};
use rayon::prelude::*;
use vivace_kernels::constraint::{Constraint, Contact, Xpbd};

use super::kind::scatter;
use crate::contacts::Found;
use crate::history::History;
use crate::parallel::sum;

/// How much stiffer a contact is than the inertia of its particles: α̃ = Σ w a² over this.
pub(crate) const STIFFNESS: f32 = 100.0;
/// Contacts that one thread projects before another may take over.
const GRAIN: usize = 256;

/// Contacts by color.
#[derive(Debug, Default)]
pub(crate) struct Contacts {
    colors: Vec<Range<usize>>,
    particles: Vec<[u32; 4]>,
    rest: Vec<Contact>,
    /// Multipliers across the normal, and along it: \[N s²\] with inverse masses, forces \[N\] with mobilities.
    lambdas: Vec<Vec4>,
    history: History<Vec4>,
    moves: Vec<[Vec4; 4]>,
    /// Scratch: colors at each particle.
    taken: Vec<[u64; N_WORDS]>,
}

impl Contacts {
    /// Takes those of a (small) step. `place` says where each of the model's particles is in `q`, which has the inverse masses where
    /// `squared_h` is the square of the step \[s²\], and mobilities \[m/N\] where it is 1.
    pub(crate) fn set(&mut self, found: &Found<'_>, place: &impl Fn(u32) -> u32, q: &[Vec4], squared_h: f32) {
        let softness = |contact: &vivace_collision::Contact| -> f32 {
            let of = |(&p, &a): (&u32, &f32)| q[place(p) as usize].w * a * a;
            contact.particles.iter().zip(&contact.weights).map(of).sum()
        };
        let all = found.contacts.iter().map(softness).enumerate();
        // Between pinned particles nothing can be done.
        let all: Vec<(usize, f32)> = all.filter(|&(_, softness)| softness > 0.0).collect();
        let particles = |k: usize| {
            let [a, b, c, d] = found.contacts[k].particles;
            [place(a), place(b), place(c), place(d)]
        };
        let colors = color(&all, &particles, q, &mut self.taken);
        let n_colors = colors.iter().map(|&color| color as usize + 1).max().unwrap_or(0);
        let classes = vivace_graph::Csr::group_by(n_colors, &colors);
        self.colors.clear();
        self.colors.extend(classes.offsets().windows(2).map(|ends| ends[0] as usize..ends[1] as usize));
        self.particles.clear();
        self.rest.clear();
        for &k in classes.items() {
            let (k, softness) = all[k as usize];
            self.particles.push(particles(k));
            self.rest.push(found.rest(k, STIFFNESS / (softness * squared_h)));
        }
        self.lambdas.clear();
        self.lambdas.resize(all.len(), Vec4::ZERO);
        self.moves.resize(all.len(), [Vec4::ZERO; 4]);
        self.history.fit(all.len());
    }

    pub(crate) fn n_colors(&self) -> usize {
        self.colors.len()
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rest.is_empty()
    }

    /// Forgets the multipliers.
    pub(crate) fn begin(&mut self) {
        self.lambdas.fill(Vec4::ZERO);
        self.history.begin(&self.lambdas);
    }

    pub(crate) fn history(&mut self) -> (&mut History<Vec4>, &mut [Vec4]) {
        (&mut self.history, &mut self.lambdas)
    }

    /// Projects those of one color.
    pub(crate) fn relax_color(&mut self, color: usize, xpbd: &Xpbd, q: &mut [Vec4]) {
        let range = self.colors[color].clone();
        if rayon::current_num_threads() == 1 || range.len() < 2 * GRAIN {
            range.for_each(|k| self.relax(k, xpbd, q));
            return;
        }
        let (rest, particles) = (&self.rest[range.clone()], &self.particles[range.clone()]);
        let (lambdas, moves) = (&mut self.lambdas[range.clone()], &mut self.moves[range]);
        let positions = &*q;
        let all = rest.par_iter().zip(particles).zip(lambdas).zip(&mut *moves);
        all.with_min_len(GRAIN).for_each(|(((rest, particles), lambda), moves)| {
            *moves = correct(rest, particles, xpbd, positions, lambda);
        });
        scatter(particles, moves, q);
    }

    /// Projects all, one after another.
    pub(super) fn relax_in_order(&mut self, xpbd: &Xpbd, q: &mut [Vec4]) {
        (0..self.rest.len()).for_each(|k| self.relax(k, xpbd, q));
    }

    /// Adds to `sums` what each would do from the same q, over the number of constraints at its busiest particle.
    pub(super) fn relax_all(&mut self, xpbd: &Xpbd, counts: &[f32], q: &[Vec4], sums: &mut [Vec4]) {
        let all = self.rest.par_iter().zip(&self.particles).zip(&mut self.lambdas).zip(&mut self.moves);
        all.with_min_len(GRAIN).for_each(|(((rest, particles), lambda), moves)| {
            let busiest = particles.iter().map(|&p| counts[p as usize]).fold(1.0, f32::max);
            *moves = correct(rest, particles, &Xpbd { omega: xpbd.omega / busiest, ..*xpbd }, q, lambda);
        });
        scatter(&self.particles, &self.moves, sums);
    }

    /// Adds the number of contacts of each free particle.
    pub(super) fn count(&self, q: &[Vec4], counts: &mut [f32]) {
        for (particles, rest) in self.particles.iter().zip(&self.rest) {
            for (slot, &p) in particles.iter().enumerate() {
                if q[p as usize].w > 0.0 && rest.weights[slot] != 0.0 {
                    counts[p as usize] += 1.0;
                }
            }
        }
    }

    /// w C²/2 of all that are violated \[J\]; friction has no energy here.
    pub(crate) fn energy(&self, at: &(impl Fn(u32) -> Vec3 + Sync)) -> f64 {
        sum(0..self.rest.len(), &|k: usize| {
            let (c, _) = self.rest[k].deviation(&self.particles[k].map(at));
            0.5 * f64::from(self.rest[k].weight()) * f64::from(c) * f64::from(c)
        })
    }

    /// Adds w C ∇C to each particle \[N\].
    pub(super) fn add_gradient(&self, q: &[Vec4], sums: &mut [Vec4]) {
        for (particles, rest) in self.particles.iter().zip(&self.rest) {
            let (c, gradient) = rest.deviation(&corners(particles, q));
            for (&p, gradient) in particles.iter().zip(gradient) {
                sums[p as usize] += (gradient * (rest.weight() * c)).extend(0.0);
            }
        }
    }

    fn relax(&mut self, k: usize, xpbd: &Xpbd, q: &mut [Vec4]) {
        let moves = correct(&self.rest[k], &self.particles[k], xpbd, q, &mut self.lambdas[k]);
        for (&p, step) in self.particles[k].iter().zip(moves) {
            q[p as usize] += step;
        }
    }
}

fn corners(particles: &[u32; 4], q: &[Vec4]) -> [Vec3; 4] {
    particles.map(|p| q[p as usize].truncate())
}

/// By how much a contact moves its particles \[m\].
fn correct(rest: &Contact, particles: &[u32; 4], xpbd: &Xpbd, q: &[Vec4], lambda: &mut Vec4) -> [Vec4; 4] {
    let w: [f32; 4] = std::array::from_fn(|slot| q[particles[slot] as usize].w * rest.weights[slot]);
    let softness: f32 = w.iter().zip(rest.weights.to_array()).map(|(w, a)| w * a).sum();
    let compliance = softness / STIFFNESS;
    let scale = 1.0 / (softness + compliance);
    // Beyond the surface there is nothing to be gained.
    let omega = xpbd.omega.min(1.0);
    let [aq] = rest.apply(&corners(particles, q));
    let along = (lambda.w + omega * scale * (rest.depth(aq) - compliance * lambda.w)).max(0.0);
    let held = lambda.truncate();
    let mut across = held - (rest.slip(aq) + held * compliance) * (omega * scale);
    let (most, length) = (rest.friction * along, across.length());
    if length > most {
        across *= most / length;
    }
    let step = rest.normal * (along - lambda.w) + (across - held);
    *lambda = across.extend(along);
    w.map(|w| (step * w).extend(0.0))
}

/// Colors that first fit chooses from, in words of 64: beyond them each contact has one of its own.
const N_WORDS: usize = 4;

/// A color for each of `all`, by first fit: two that share a free particle differ. Work in proportion to the contacts.
fn color(
    all: &[(usize, f32)],
    particles: &impl Fn(usize) -> [u32; 4],
    q: &[Vec4],
    taken: &mut Vec<[u64; N_WORDS]>,
) -> Vec<u32> {
    taken.resize(taken.len().max(q.len()), [0; N_WORDS]);
    let mut beyond = 64 * N_WORDS;
    let mut color = |&(k, _): &(usize, f32)| {
        // Also those of weight 0: where they are shows in the rounding. An obstacle's is one particle four times.
        let particles = particles(k);
        let n = if particles[0] == particles[1] { 1 } else { 4 };
        let particles = particles[..n].iter().map(|&p| p as usize).filter(|&p| q[p].w > 0.0);
        let mut used = [0; N_WORDS];
        for p in particles.clone() {
            used.iter_mut().zip(&taken[p]).for_each(|(used, taken)| *used |= taken);
        }
        let color = if let Some(word) = used.iter().position(|&word| word != u64::MAX) {
            let bit = used[word].trailing_ones();
            particles.for_each(|p| taken[p][word] |= 1 << bit);
            64 * word + bit as usize
        } else {
            beyond += 1;
            beyond - 1
        };
        // Fewer colors than contacts, which are 32-bit.
        u32::try_from(color).unwrap_or(u32::MAX)
    };
    let colors = all.iter().map(&mut color).collect();
    all.iter().flat_map(|&(k, _)| particles(k)).for_each(|p| taken[p as usize] = [0; N_WORDS]);
    colors
}
