//! The constraints of one kind on a device, color by color.

use std::ops::Range;

use glam::{Vec3, Vec4};
use vivace_graph::Csr;
use vivace_kernels::constraint::{Constraint, Xpbd};
use vivace_kernels::local::{Correct, Gather, Moves, Multiply, XpbdEnergy, XpbdGradient};
use vivace_kernels::step::{ExtrapolateUniform, SetVector, SetVectorUniform, Watch};
use vivace_kernels::{Backend, Params};
use vivace_model::{KindVisitor, Model, Store};

use super::history::History;
use super::sums::Sums;
use crate::error::narrow;
use crate::pbd::arranged::Arranged;
use crate::pbd::coloring::color_constraints;
use crate::{Relaxation, SolverError};

/// What Position Based Dynamics does with a kind. Positions are (x, y, z, inverse mass).
pub(super) trait Kind<B: Backend>: Send {
    /// Whether the device holds its arrays.
    fn check(&self, backend: &B) -> Result<(), B::Error>;
    /// Tells the device where targets are, if they have moved.
    fn prepare(&mut self, backend: &B);
    /// Multipliers go where positions go: see [`Stages`](crate::Stages).
    fn remember(&mut self, backend: &B);
    fn extrapolate(&mut self, backend: &B, weight: Params<'_, B, ExtrapolateUniform>);
    fn save(&mut self, backend: &B);
    fn restore(&mut self, backend: &B);
    /// Saves or restores, as the last look has decided.
    fn follow(&mut self, backend: &B, watch: &B::Buffer<Watch>);
    /// Forgets the multipliers: a time step begins.
    fn begin(&mut self, backend: &B);
    /// Projects the constraints of one color, all at once.
    fn relax_color(&mut self, backend: &B, color: usize, xpbd: Params<'_, B, Xpbd>, q: &mut B::Buffer<Vec4>);
    /// Projects all constraints in the model's order.
    fn relax_in_order(&mut self, backend: &B, xpbd: &Xpbd, q: &mut B::Buffer<Vec4>);
    /// What every constraint would do from the same q, over the number of constraints of its busiest particle; its multipliers after it.
    fn find_moves(&mut self, backend: &B, xpbd: Params<'_, B, Xpbd>, q: &B::Buffer<Vec4>);
    /// Does it.
    fn gather(&self, backend: &B, particles: &B::List, q: &mut B::Buffer<Vec4>);
    /// Adds their energy w C² / 2 \[J\] to `sums`.
    fn add_energy(&self, backend: &B, q: &B::Buffer<Vec4>, sums: &mut Sums<B>);
    /// Adds the gradient of their energy, w C ∇C, to each particle \[N\].
    fn add_gradient(
        &self,
        backend: &B,
        particles: &B::List,
        q: &B::Buffer<Vec4>,
        gradients: &mut B::Buffer<Vec4>,
    );
    /// Moves the target of attachment `idx` of the model, if this kind is that of attachments.
    fn set_attachment_target(&mut self, idx: usize, target: Vec3);
}

/// Kind `C`.
struct KindOf<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize> {
    n: u32,
    all: B::List,
    /// Members of each color; `None` where a color has none.
    colors: Vec<Option<B::List>>,
    particles: B::Buffer<[u32; N]>,
    rest: B::Buffer<C>,
    /// The rest data on the host, of the kind whose targets move, and where the model's constraints stand in it.
    held: Vec<C>,
    is_held_new: bool,
    place: Vec<u32>,
    /// Multipliers \[N s²\].
    lambdas: B::Buffer<Vec4>,
    history: History<B>,
    /// Particle to `constraint · N + slot`.
    offsets: B::Buffer<u32>,
    slots: B::Buffer<u32>,
    /// Constraints at the busiest particle of each, and moves \[m\]: none where the relaxation is not Jacobi's.
    busiest: B::Buffer<f32>,
    moves: B::Buffer<[Vec4; N]>,
}

/// Collects the kinds of a model.
pub(super) struct Kinds<'a, B: Backend> {
    backend: &'a B,
    colors: Vec<u32>,
    n_colors: u32,
    /// Constraints of each particle that moves; none where the relaxation is not Jacobi's.
    counts: Vec<f32>,
    n_particles: usize,
    n_seen: usize,
    kinds: Vec<Box<dyn Kind<B>>>,
    lens: Vec<u32>,
}

/// The kinds of a model, how many constraints each has, and the number of colors.
pub(super) struct Found<B: Backend> {
    pub(super) kinds: Vec<Box<dyn Kind<B>>>,
    pub(super) lens: Vec<u32>,
    pub(super) n_colors: u32,
}

impl<'a, B: Backend + 'static> Kinds<'a, B> {
    /// The kinds that the model holds. What needs no colors gets one, in the model's order.
    pub(super) fn of(backend: &'a B, model: &Model, relaxation: Relaxation) -> Result<Found<B>, SolverError> {
        let n = model.constraints().len();
        let (colors, n_colors) =
            if relaxation.is_colored() { color_constraints(model)? } else { (vec![0; n], 1) };
        // Every slot of a constraint is numbered.
        narrow("particles of constraints", 4 * n)?;
        let mut counts = Counts(Vec::new());
        if matches!(relaxation, Relaxation::Jacobi { .. } | Relaxation::Chebyshev { .. }) {
            counts.0.resize(model.n_particles(), 0.0);
            model.constraints().visit(&mut counts);
            // What is pinned moves for nobody, however many ask.
            (0..).zip(&mut counts.0).filter(|&(p, _)| model.is_pinned(p)).for_each(|(_, count)| *count = 0.0);
        }
        let mut kinds = Self {
            backend,
            colors,
            n_colors,
            counts: counts.0,
            n_particles: model.n_particles(),
            n_seen: 0,
            kinds: Vec::new(),
            lens: Vec::new(),
        };
        model.constraints().visit(&mut kinds);
        Ok(Found { kinds: kinds.kinds, lens: kinds.lens, n_colors })
    }
}

/// Counts the constraints of each particle.
struct Counts(Vec<f32>);

impl KindVisitor for Counts {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        store.particles.iter().flatten().for_each(|&p| self.0[p as usize] += 1.0);
    }
}

impl<B: Backend + 'static> KindVisitor for Kinds<'_, B> {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        let of_kind = &self.colors[self.n_seen..self.n_seen + store.len()];
        self.n_seen += store.len();
        let kind = KindOf::new(self, Arranged::new(store, of_kind, self.n_colors));
        self.lens.push(kind.n);
        self.kinds.push(Box::new(kind));
    }
}

impl<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize> KindOf<B, C, N, R> {
    fn new(kinds: &Kinds<'_, B>, arranged: Arranged<C, N>) -> Self {
        let backend = kinds.backend;
        let Arranged { colors, particles, rest, place } = arranged;
        // `Kinds::of` has seen that they are.
        let narrow = |n: usize| u32::try_from(n).unwrap_or_else(|_| unreachable!("32-bit"));
        let n = narrow(rest.len());
        let list = |range: Range<usize>| {
            (!range.is_empty()).then(|| backend.range(narrow(range.start)..narrow(range.end)))
        };
        let slots = Csr::group_by(kinds.n_particles, particles.as_flattened());
        let busiest =
            |particles: &[u32; N]| particles.iter().map(|&p| kinds.counts[p as usize]).fold(1.0, f32::max);
        let is_jacobi = !kinds.counts.is_empty();
        let busiest: Vec<f32> = particles.iter().filter(|_| is_jacobi).map(busiest).collect();
        Self {
            n,
            all: backend.range(0..n),
            colors: colors.into_iter().map(list).collect(),
            particles: backend.upload(&particles),
            rest: backend.upload(&rest),
            // Attachments alone hold one particle.
            is_held_new: false,
            held: if N == 1 { rest } else { Vec::new() },
            place,
            lambdas: backend.filled(n as usize, Vec4::ZERO),
            history: History::new(backend, n, n),
            offsets: backend.upload(slots.offsets()),
            slots: backend.upload(slots.items()),
            moves: backend.filled(busiest.len(), [Vec4::ZERO; N]),
            busiest: backend.upload(&busiest),
        }
    }
}

impl<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize> Kind<B> for KindOf<B, C, N, R> {
    fn check(&self, backend: &B) -> Result<(), B::Error> {
        backend.fetch(&self.rest, &mut [])?;
        backend.fetch(&self.slots, &mut [])?;
        backend.fetch(&self.moves, &mut [])?;
        backend.fetch(&self.lambdas, &mut [])
    }

    fn prepare(&mut self, backend: &B) {
        if std::mem::take(&mut self.is_held_new) {
            backend.write(&mut self.rest, &self.held);
        }
    }

    fn remember(&mut self, backend: &B) {
        self.history.remember(backend, &self.lambdas);
    }

    fn extrapolate(&mut self, backend: &B, weight: Params<'_, B, ExtrapolateUniform>) {
        self.history.extrapolate(backend, &mut self.lambdas, weight);
    }

    fn save(&mut self, backend: &B) {
        self.history.save(backend, &self.lambdas);
    }

    fn restore(&mut self, backend: &B) {
        self.history.restore(backend, &mut self.lambdas);
    }

    fn follow(&mut self, backend: &B, watch: &B::Buffer<Watch>) {
        self.history.follow(backend, watch, &mut self.lambdas);
    }

    fn begin(&mut self, backend: &B) {
        let nothing = SetVectorUniform { value: Vec4::ZERO };
        backend.map::<SetVector>(&self.all, &nothing, (), &mut self.lambdas);
        self.history.begin(backend, &self.lambdas);
    }

    fn relax_color(&mut self, backend: &B, color: usize, xpbd: Params<'_, B, Xpbd>, q: &mut B::Buffer<Vec4>) {
        if let Some(list) = &self.colors[color] {
            let inputs = (backend.view(&self.particles), backend.view(&self.rest));
            backend.scatter::<Correct<C, N, R>, N>(list, xpbd, inputs, q, &mut self.lambdas);
        }
    }

    fn relax_in_order(&mut self, backend: &B, xpbd: &Xpbd, q: &mut B::Buffer<Vec4>) {
        let inputs = (backend.view(&self.particles), backend.view(&self.rest));
        backend.scatter_in_order::<Correct<C, N, R>, N>(&self.all, xpbd, inputs, q, &mut self.lambdas);
    }

    fn find_moves(&mut self, backend: &B, xpbd: Params<'_, B, Xpbd>, q: &B::Buffer<Vec4>) {
        let Self { all, particles, rest, busiest, lambdas, moves, .. } = self;
        let inputs = (
            backend.view(particles),
            backend.view(rest),
            backend.view(q),
            backend.view(busiest),
            backend.view(lambdas),
        );
        backend.map::<Moves<C, N, R>>(all, xpbd, inputs, moves);
        let inputs = (backend.view(particles), backend.view(rest), backend.view(q), backend.view(busiest));
        backend.map::<Multiply<C, N, R>>(all, xpbd, inputs, lambdas);
    }

    fn gather(&self, backend: &B, particles: &B::List, q: &mut B::Buffer<Vec4>) {
        let inputs = (backend.view(&self.offsets), backend.view(&self.slots), backend.view(&self.moves));
        backend.map::<Gather<C, N, R>>(particles, &(), inputs, q);
    }

    fn add_energy(&self, backend: &B, q: &B::Buffer<Vec4>, sums: &mut Sums<B>) {
        let inputs = (backend.view(&self.particles), backend.view(&self.rest), backend.view(q));
        backend.map::<XpbdEnergy<C, N, R>>(&self.all, &(), inputs, &mut sums.numbers);
        sums.add(backend, self.n);
    }

    fn add_gradient(
        &self,
        backend: &B,
        particles: &B::List,
        q: &B::Buffer<Vec4>,
        gradients: &mut B::Buffer<Vec4>,
    ) {
        let (offsets, slots) = (backend.view(&self.offsets), backend.view(&self.slots));
        let inputs =
            (offsets, slots, backend.view(&self.particles), backend.view(&self.rest), backend.view(q));
        backend.map::<XpbdGradient<C, N, R>>(particles, &(), inputs, gradients);
    }

    fn set_attachment_target(&mut self, idx: usize, target: Vec3) {
        let place = self.place.get(idx).map(|&k| k as usize);
        if let Some(held) = place.and_then(|k| self.held.get_mut(k)) {
            held.set_target(target);
            self.is_held_new = true;
        }
    }
}
