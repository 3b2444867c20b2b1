//! What a kind of constraint adds beyond Y, on a device: see `pd/pass.rs`, of which this is the twin.

use glam::Vec4;
use vivace_kernels::Backend;
use vivace_kernels::constraint::Constraint;
use vivace_kernels::local::{Block, Energy, Project, Pull, PullFused};
use vivace_model::{KindVisitor, Model, Store};

use crate::SolverError;
use crate::error::narrow;
use crate::pd::layout::Layout;
use crate::pd::pass::{nonlinear, slots};

/// A kind's local step.
pub(super) trait Pass<B: Backend>: Send {
    /// How many constraints there are.
    fn len(&self) -> u32;
    /// Computes all projections from q.
    fn project(&mut self, backend: &B, q: &B::Buffer<Vec4>);
    /// Adds `w Aᵀ p` for the particles in `list`, p as last projected.
    fn pull_projected(&self, backend: &B, list: &B::List, pulls: &mut B::Buffer<Vec4>);
    /// Adds `w Aᵀ p(q)` for the particles in `list`.
    fn pull_fused(&self, backend: &B, list: &B::List, q: &B::Buffer<Vec4>, pulls: &mut B::Buffer<Vec4>);
    /// Adds by how much the kind's exact blocks of the particles in `list` differ from its part in Y.
    fn add_to_blocks(
        &self,
        backend: &B,
        list: &B::List,
        q: &B::Buffer<Vec4>,
        blocks: &mut B::Buffer<[Vec4; 2]>,
    );
    /// The energy of each constraint \[J\].
    fn energies(&self, backend: &B, q: &B::Buffer<Vec4>, energies: &mut B::Buffer<f32>);
}

/// The pass of kind `C`.
struct KindPass<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize> {
    n: u32,
    all: B::List,
    particles: B::Buffer<[u32; N]>,
    rest: B::Buffer<C>,
    projected: B::Buffer<[Vec4; R]>,
    /// Particle to `constraint · N + slot`.
    offsets: B::Buffer<u32>,
    slots: B::Buffer<u32>,
}

/// Collects the passes of a model.
pub(super) struct Passes<'a, B: Backend> {
    backend: &'a B,
    layout: &'a Layout,
    passes: Vec<Box<dyn Pass<B>>>,
    failed: Option<SolverError>,
}

impl<'a, B: Backend + 'static> Passes<'a, B> {
    /// One pass for each kind that needs it.
    pub(super) fn of(
        backend: &'a B,
        model: &Model,
        layout: &'a Layout,
    ) -> Result<Vec<Box<dyn Pass<B>>>, SolverError> {
        let mut passes = Self { backend, layout, passes: Vec::new(), failed: None };
        model.constraints().visit(&mut passes);
        passes.failed.map_or(Ok(passes.passes), Err)
    }
}

impl<B: Backend + 'static> KindVisitor for Passes<'_, B> {
    fn visit<C: Constraint<N, R>, const N: usize, const R: usize>(&mut self, store: &Store<C, N>) {
        let Some((particles, rest)) = nonlinear(store, self.layout) else { return };
        match KindPass::<B, C, N, R>::new(self.backend, &particles, &rest, self.layout.n_free) {
            Ok(pass) => self.passes.push(Box::new(pass)),
            Err(error) => self.failed = Some(error),
        }
    }
}

impl<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize> KindPass<B, C, N, R> {
    fn new(backend: &B, particles: &[[u32; N]], rest: &[C], n_free: usize) -> Result<Self, SolverError> {
        let (offsets, slots) = slots(particles, n_free)?;
        let n = narrow("constraints", rest.len())?;
        Ok(Self {
            n,
            all: backend.range(0..n),
            particles: backend.upload(particles),
            rest: backend.upload(rest),
            projected: backend.filled(rest.len(), [Vec4::ZERO; R]),
            offsets: backend.upload(&offsets),
            slots: backend.upload(&slots),
        })
    }
}

impl<B: Backend, C: Constraint<N, R>, const N: usize, const R: usize> Pass<B> for KindPass<B, C, N, R> {
    fn len(&self) -> u32 {
        self.n
    }

    fn project(&mut self, backend: &B, q: &B::Buffer<Vec4>) {
        let inputs = (backend.view(&self.particles), backend.view(&self.rest), backend.view(q));
        backend.map::<Project<C, N, R>>(&self.all, &(), inputs, &mut self.projected);
    }

    fn pull_projected(&self, backend: &B, list: &B::List, pulls: &mut B::Buffer<Vec4>) {
        let (offsets, slots) = (backend.view(&self.offsets), backend.view(&self.slots));
        let inputs = (offsets, slots, backend.view(&self.rest), backend.view(&self.projected));
        backend.map::<Pull<C, N, R>>(list, &(), inputs, pulls);
    }

    fn pull_fused(&self, backend: &B, list: &B::List, q: &B::Buffer<Vec4>, pulls: &mut B::Buffer<Vec4>) {
        let (offsets, slots) = (backend.view(&self.offsets), backend.view(&self.slots));
        let (particles, rest) = (backend.view(&self.particles), backend.view(&self.rest));
        let inputs = (offsets, slots, particles, rest, backend.view(q));
        backend.map::<PullFused<C, N, R>>(list, &(), inputs, pulls);
    }

    fn add_to_blocks(
        &self,
        backend: &B,
        list: &B::List,
        q: &B::Buffer<Vec4>,
        blocks: &mut B::Buffer<[Vec4; 2]>,
    ) {
        let (offsets, slots) = (backend.view(&self.offsets), backend.view(&self.slots));
        let (particles, rest) = (backend.view(&self.particles), backend.view(&self.rest));
        let inputs = (offsets, slots, particles, rest, backend.view(q));
        backend.map::<Block<C, N, R>>(list, &(), inputs, blocks);
    }

    fn energies(&self, backend: &B, q: &B::Buffer<Vec4>, energies: &mut B::Buffer<f32>) {
        let inputs = (backend.view(&self.particles), backend.view(&self.rest), backend.view(q));
        backend.map::<Energy<C, N, R>>(&self.all, &(), inputs, energies);
    }
}
