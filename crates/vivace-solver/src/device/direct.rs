//! The global step by a Cholesky factor on a device: see `pd/direct.rs`, of which this is the twin.

mod partition;

use glam::Vec4;
use vivace_kernels::Backend;
use vivace_kernels::linear::{Pick, PickUniform, Substitute, SubstituteUniform};
use vivace_kernels::pd::{Row, Tap};

use crate::SolverError;
use crate::cholesky::Cholesky;
use crate::pd::direct::{check, lower_triangle};
use crate::pd::rows::Rows;
use partition::Partition;

/// A factor, and where its solutions come to be.
pub(super) struct Direct<B: Backend> {
    cholesky: Cholesky,
    partition: Partition,
    on_host: Vec<Tap>,
    rows: B::Buffer<Row>,
    taps: B::Buffer<Tap>,
    /// The right-hand side, the solution of the first substitution, that of the second: in the partition's order.
    vectors: B::Buffer<Vec4>,
    /// The rows of Y in the partition's order, and where each one's solution is.
    order: B::Buffer<u32>,
    places: B::Buffer<u32>,
    free: B::List,
    n_free: u32,
    /// One for each level and substitution, in the order in which they are solved.
    levels: Vec<B::List>,
}

impl<B: Backend> Direct<B> {
    /// Analyses Y and takes all memory.
    ///
    /// # Errors
    /// Not enough memory; more entries than 32 bits can number.
    pub(super) fn new(backend: &B, rows: &Rows, n_free: u32) -> Result<Self, SolverError> {
        let (pattern, _) = lower_triangle(rows, &vec![0.0; rows.len()]);
        let cholesky = Cholesky::new(pattern, 3, None)?;
        let partition = Partition::new(&cholesky)?;
        let on_host = vec![Tap::default(); partition.n_taps as usize];
        let levels = partition.levels().map(|level| backend.range(level)).collect();
        Ok(Self {
            rows: backend.upload(&partition.rows),
            taps: backend.upload(&on_host),
            vectors: backend.filled(3 * rows.len(), Vec4::ZERO),
            order: backend.upload(&partition.order),
            places: backend.upload(&partition.solutions()),
            free: backend.range(0..n_free),
            n_free,
            levels,
            on_host,
            partition,
            cholesky,
        })
    }

    /// Factors Y, with `anchor_weights` \[N/m\] on its diagonal.
    ///
    /// # Errors
    /// Y is not positive definite in `f64`, or too ill-conditioned for a solve in `f32`.
    pub(super) fn factor(
        &mut self,
        backend: &B,
        rows: &Rows,
        anchor_weights: &[f32],
    ) -> Result<(), SolverError> {
        let (_, values) = lower_triangle(rows, anchor_weights);
        self.cholesky.factor(&values)?;
        self.partition.invert(&self.cholesky.blocks(), &mut self.on_host);
        check(rows, anchor_weights, |x| self.partition.solve_in_place(&self.on_host, x))?;
        backend.write(&mut self.taps, &self.on_host);
        Ok(())
    }

    /// Adds to q the δ \[m\] of `Y δ = residual` \[N\].
    pub(super) fn solve(&mut self, backend: &B, residual: &B::Buffer<Vec4>, q: &mut B::Buffer<Vec4>) {
        let Self { vectors, free, n_free, .. } = self;
        let [picks, adds] = [0, 1].map(|adds| PickUniform { adds });
        backend.map::<Pick>(free, &picks, (backend.view(&self.order), backend.view(residual)), vectors);
        let first = SubstituteUniform { first: *n_free };
        for level in &self.levels {
            let factor = (backend.view(&self.rows), backend.view(&self.taps));
            backend.update::<Substitute>(level, &first, factor, vectors);
        }
        backend.map::<Pick>(free, &adds, (backend.view(&self.places), backend.view(vectors)), q);
    }
}
