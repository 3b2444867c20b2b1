//! The constraints of one kind, color by color.

use glam::{Vec3, Vec4};
use rayon::prelude::*;
use vivace_kernels::constraint::{Attachment, Constraint, Xpbd};
use vivace_model::{KindVisitor, Model, Store};

use super::arranged::Arranged;
use super::coloring::{color_attachments, color_constraints};
use super::halves::{Halves, Stretch, relax_each};
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
    halves: Halves,
    /// Where those of each color and stretch begin, color by color; and where all end.
    ends: Vec<usize>,
    particles: Vec<[u32; N]>,
    /// Particles, by their place in the stretch of the constraint.
    places: Vec<[u32; N]>,
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
    n_particles: u32,
    n_seen: usize,
    kinds: Vec<Box<dyn Kind>>,
}

impl Kinds {
    /// The kinds that the model holds, that of attachments last.
    pub(super) fn of(model: &Model) -> Result<Vec<Box<dyn Kind>>, SolverError> {
        let (colors, n_colors) = color_constraints(model)?;
        // Particle numbers are 32-bit by construction of the model.
        let n_particles = u32::try_from(model.n_particles()).unwrap_or(u32::MAX);
        let mut kinds = Self { colors, n_colors, n_particles, n_seen: 0, kinds: Vec::new() };
        model.constraints().visit(&mut kinds);
        Ok(kinds.kinds)
    }
}

/// The kind of attachments, beside others of so many colors.
pub(super) fn of_attachments(store: &Store<Attachment, 1>, n_colors: u32, n_particles: u32) -> Box<dyn Kind> {
    let (colors, n_colors) = color_attachments(store, n_colors);
    Box::new(KindOf::new(store, &colors, n_colors, n_particles))
}

impl KindVisitor for Kinds {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        let of_kind = &self.colors[self.n_seen..self.n_seen + store.len()];
        self.n_seen += store.len();
        self.kinds.push(Box::new(KindOf::<C, N, R>::new(store, of_kind, self.n_colors, self.n_particles)));
    }
}

impl<C: Constraint<N, R>, const N: usize, const R: usize> KindOf<C, N, R> {
    fn new(store: &Store<C, N>, of_kind: &[u32], n_colors: u32, n_particles: u32) -> Self {
        let n_of_color = store.len() / (n_colors as usize).max(1);
        let halves = Halves::new(n_particles, n_of_color);
        // Fewer than there are constraints: every color and stretch has some, or the kind has one stretch.
        let n_stretches = halves.len();
        let of = |(&color, particles): (&u32, &[u32; N])| color * n_stretches + halves.of(particles).0;
        let keys: Vec<u32> = of_kind.iter().zip(&store.particles).map(of).collect();
        let Arranged { colors, particles, rest, place } = Arranged::new(store, &keys, n_colors * n_stretches);
        let ends = std::iter::once(0).chain(colors.iter().map(|range| range.end)).collect();
        let places = particles.iter().map(|particles| particles.map(|p| p - halves.of(particles).1));
        let n = rest.len();
        Self {
            halves,
            ends,
            places: places.collect(),
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
        let n = self.halves.len() as usize;
        let Some(ends) = self.ends.get(color as usize * n..=(color as usize + 1) * n) else { return };
        let (first, last) = (ends[0], ends[n]);
        let xpbd = Xpbd { squared_h: self.h * self.h, omega };
        let constraints = (&self.rest[first..last], &self.places[first..last]);
        let lambdas = &mut self.lambdas[first..last];
        let whole = Stretch::whole(self.halves, first, &ends[1..], constraints, lambdas, q);
        whole.relax(&xpbd, rayon::current_num_threads().next_power_of_two().ilog2());
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
            relax_each(&self.rest[k..=k], &self.particles[k..=k], &xpbd, q, &mut self.lambdas[k..=k]);
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
        let n = self.rest.len();
        let colors = self
            .ends
            .iter()
            .position(|&end| end == n)
            .map_or(0, |end| end.div_ceil(self.halves.len() as usize));
        u32::try_from(colors).unwrap_or(u32::MAX)
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
pub(super) fn scatter<const N: usize>(particles: &[[u32; N]], moves: &[[Vec4; N]], q: &mut [Vec4]) {
    for (particles, moves) in particles.iter().zip(moves) {
        for (&p, step) in particles.iter().zip(moves) {
            q[p as usize] += *step;
        }
    }
}
